#pragma once
// What an actuator is at its output: inertia, damping, friction, stiffness.

#include <optional>
#include <string>
#include <vector>

#include "actuator/actuator.hpp"

namespace gear3k::actuator {

/// By cause, times i² where it is on the motor's side; plain, without efficiencies.
struct Reflected {
  double motor_kgm2 = 0.0, gearbox_kgm2 = 0.0, load_kgm2 = 0.0, total_kgm2 = 0.0;
  bool gearbox_inertia_known = true;  ///< false: of a design's gears, taken as 0
  /// J2 + J1/η_b and J2 + η_f J1: torque over acceleration with the motor off, no drag; the first
  /// is empty where the output cannot drive the motor.
  std::optional<double> speeding_up_kgm2, slowing_down_kgm2;
  double motor_Nms = 0.0, gearbox_Nms = 0.0, total_Nms = 0.0;
  double coulomb_Nm = 0.0;  ///< |i| T_c + c2
  /// D2 + D1/η_b and c2 + c1/η_b: turned from outside, motor off.
  std::optional<double> backdriven_Nms, backdriven_coulomb_Nm;
  /// Torque that starts the output from outside with the motor off; empty where none does.
  std::optional<double> breakaway_Nm;
  std::optional<double> breakaway_motor_Nm;  ///< of the motor that starts the output, at the motor
  /// At the output; empty = rigid.  The total is both in series.
  std::optional<double> motor_Nm_rad, gearbox_Nm_rad, total_Nm_rad;
  std::vector<std::string> notes;
};

/// Source: own derivation, docs/theory §59.
Reflected reflected(const Actuator& actuator);

}  // namespace gear3k::actuator
