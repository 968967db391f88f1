#pragma once
// How the two sides of a gearbox move under given torques: the forward problem.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "actuator/gear_model.hpp"

namespace gear3k::motion {

/// Torques and speed of both sides that move as one.
struct JointInput {
  double fast_Nm = 0.0;        ///< τ − D1 w − c1 s, at the output
  double fast_scale_Nm = 0.0;  ///< |τ| + |D1 w| + c1, for what rounding hides
  double load_Nm = 0.0;        ///< T_L
  double speed_rad_s = 0.0;
  int sense = 1;          ///< s
  int flow = 0;           ///< 1 forward, −1 backward, 0: that which there is
  bool starting = false;  ///< the output's friction is that at rest
};

/// What follows; docs/theory §66.
struct Joint {
  bool jammed = false;  ///< no acceleration satisfies both sides
  double acceleration_rad_s2 = 0.0;
  double mesh_Nm = 0.0, input_Nm = 0.0;  ///< m, u
  /// Above zero where the motor's side would run ahead (> 0 of its own sign, not of s), and what
  /// rounding hides of it.
  double lead = 0.0, lead_rounding = 0.0;
  std::array<double, actuator::kMostGearLosses> loss_W{};
};

/// A side by itself, within the gap.
struct FreeInput {
  double torque_Nm = 0.0;  ///< fast side: τ − D1 w − c1 s; output: T_L
  double speed_rad_s = 0.0;
  int sense = 1;
  bool starting = false;
};
struct FreeSide {
  double acceleration_rad_s2 = 0.0;
  std::array<double, actuator::kMostGearLosses> loss_W{};
};

class MotionGear {
 public:
  MotionGear() = default;
  MotionGear(const MotionGear&) = delete;
  MotionGear& operator=(const MotionGear&) = delete;
  virtual ~MotionGear() = default;

  [[nodiscard]] virtual const std::vector<std::string>& causes() const = 0;
  [[nodiscard]] virtual Joint joined(const JointInput& in) const = 0;
  /// What the motor's side has beyond what it takes to turn the output from rest [N m], at the
  /// output: s (F1 − h_s(−F0)), both forces of `in`; far below zero where the train locks.  §66.
  [[nodiscard]] virtual double breakaway_excess_nm(const JointInput& in) const = 0;
  [[nodiscard]] virtual FreeSide fast_alone(const FreeInput& in) const = 0;
  [[nodiscard]] virtual FreeSide output_alone(const FreeInput& in) const = 0;
  /// Common speed after a plastic impact of the two sides, of which the motor's at speeds[0]
  /// catches the output's at speeds[1] up; 0 where the train stops (locks).
  [[nodiscard]] virtual double speed_after_contact(const std::array<double, 2>& speeds) const = 0;
  /// Inertia of both sides [kg m²], at the output: with the gap open.
  [[nodiscard]] virtual std::array<double, 2> inertias_kgm2() const = 0;
};

/// The gearbox of an actuator whose load has `load_kgm2` besides its own.
std::unique_ptr<MotionGear> motion_gear(const actuator::Actuator& actuator, double load_kgm2);
/// Of a designed train.
std::unique_ptr<MotionGear> motion_train(const actuator::Actuator& actuator, double load_kgm2);

}  // namespace gear3k::motion
