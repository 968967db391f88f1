#pragma once
// What a hand or a controller feels at the output of an actuator, and limits of it.

#include <optional>
#include <vector>

#include "actuator/actuator.hpp"
#include "actuator/duty_cycle.hpp"
#include "actuator/reflected.hpp"

namespace gear3k::actuator {

/// Torques at the output while the motor holds a torque, the output turning slowly.
///
///   moving with it  Q = η_f (τ − c1) − c2      pushed back  Q = (τ + c1)/η_b + c2
///
/// of a designed train by its power flow.  Transparency: their difference over their mean, 0 for a
/// gearbox without losses.
struct FeltTorque {
  double motor_Nm = 0.0;                   ///< τ, at the output
  std::optional<double> moving_with_Nm{};  ///< empty where the motor's torque does not move it
  std::optional<double> pushed_back_Nm{};  ///< empty where no torque pushes it back
  std::optional<double> transparency{};    ///< empty without both
};

/// Source: own derivation, docs/theory §59.
/// @param motor_Nm  τ > 0, at the output
FeltTorque felt_torque(const Actuator& actuator, double motor_Nm);

/// The stated limits (Actuator::felt) held against what is felt: inertia (the greater one, that
/// speeds up from outside), breakaway from outside, transparency.
std::vector<LimitCheck> felt_checks(const Actuator& actuator, const Reflected& reflected,
                                    const std::optional<FeltTorque>& torque);

}  // namespace gear3k::actuator
