#pragma once
// The backdrivability-factors paper's knee prosthesis over a stride.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "actuator/actuator.hpp"
#include "actuator/duty_cycle.hpp"

namespace gear3k::papers {

struct BackdrivabilityStatements;

/// Moment and angular speed of a joint over a stride, by a person's mass, as digitised.
struct MotionCurves {
  using Curve = std::vector<std::pair<double, double>>;  ///< stride [%], value; rising
  Curve moment_Nm_kg, speed_deg_s;
};

/// The paper's actuator, by which numbers.
enum class KneeNumbers {
  kPrinted,    ///< as eqs. 38, 41, 42 and 45 print them
  kEquations,  ///< as its own equations give them from Table I
  kCorrected,  ///< with the gearbox's drag taken out of its efficiency
};
actuator::Actuator knee_actuator(const BackdrivabilityStatements& s, KneeNumbers numbers);

/// A stretch of a cycle in which the load gives energy.
struct NegativeStretch {
  double from_s, to_s;
  bool begins_at_zero_torque, ends_at_zero_torque;  ///< else at zero speed
  double peak_torque_Nm;                            ///< largest magnitude
  double energy_J;                                  ///< that the load gives
};

struct KneeRun {
  std::string name{};
  actuator::Actuator actuator{};
  actuator::DutyCycle duty{};  ///< with its instants
  double peak_electrical_W = 0.0, least_electrical_W = 0.0;
};

struct KneeExample {
  actuator::Cycle cycle;
  double peak_torque_Nm = 0.0;  ///< of the load
  double peak_speed_rad_s = 0.0;
  double peak_power_W = 0.0, least_power_W = 0.0;  ///< that the knee gives
  std::vector<NegativeStretch> negative;
  std::vector<KneeRun> runs;  ///< printed, equations, corrected
  /// The corrected actuator with all torques of the knee raised to the paper's peak.
  std::optional<KneeRun> raised;
  std::vector<actuator::WithoutCause> without_each;  ///< of the corrected one
};

KneeExample knee_example(const BackdrivabilityStatements& s, const MotionCurves& curves);

}  // namespace gear3k::papers
