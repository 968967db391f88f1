#include "actuator/felt.hpp"

#include <cmath>
#include <stdexcept>

#include "actuator/chain.hpp"
#include "actuator/gear_model.hpp"

namespace gear3k::actuator {

namespace {

constexpr double kMostTorque_Nm = 1e12;
constexpr int kMostHalvings = 200;

/// The output torque at which a slow motion of this sense needs a torque of the fast side; empty
/// where none does.
std::optional<double> output_at(const GearModel& gear, double input_Nm, double sense) {
  const auto needed = [&](double output_Nm) {
    return gear.at({.load_Nm = -output_Nm, .sense = sense}).input_Nm;
  };
  try {
    double low = 0.0;
    double high = std::abs(input_Nm);
    if (needed(low) > input_Nm) {
      low = -high;
      while (needed(low) > input_Nm) {
        low *= 2.0;
        if (low < -kMostTorque_Nm) return std::nullopt;
      }
    }
    while (needed(high) < input_Nm) {
      high *= 2.0;
      if (high > kMostTorque_Nm) return std::nullopt;
    }
    for (int k = 0; k < kMostHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      if (!(middle > low && middle < high)) break;
      (needed(middle) < input_Nm ? low : high) = middle;
    }
    return high;
  } catch (const std::runtime_error&) {
    return std::nullopt;  // the train locks
  }
}

}  // namespace

FeltTorque felt_torque(const Actuator& actuator, double motor_Nm) {
  if (!(motor_Nm > 0.0)) throw std::invalid_argument("felt_torque: motor_Nm, allowed: above 0");
  const Chain chain = chain_of(actuator);
  const auto gear = gear_model(actuator);
  FeltTorque felt{.motor_Nm = motor_Nm};
  if (motor_Nm > chain.c1_Nm) felt.moving_with_Nm = output_at(*gear, motor_Nm - chain.c1_Nm, 1.0);
  felt.pushed_back_Nm = output_at(*gear, motor_Nm + chain.c1_Nm, -1.0);
  if (felt.moving_with_Nm && felt.pushed_back_Nm) {
    const double mean = 0.5 * (*felt.moving_with_Nm + *felt.pushed_back_Nm);
    if (mean > 0.0) felt.transparency = (*felt.pushed_back_Nm - *felt.moving_with_Nm) / mean;
  }
  return felt;
}

std::vector<LimitCheck> felt_checks(const Actuator& actuator, const Reflected& reflected,
                                    const std::optional<FeltTorque>& torque) {
  const FeltLimits& limits = actuator.felt;
  std::vector<LimitCheck> checks;
  if (limits.max_inertia_kgm2) {
    checks.push_back(
        limit_check("felt_inertia", "kg m2", reflected.speeding_up_kgm2, *limits.max_inertia_kgm2));
  }
  if (limits.max_breakaway_Nm) {
    checks.push_back(
        limit_check("breakaway", "N m", reflected.breakaway_Nm, *limits.max_breakaway_Nm));
  }
  if (limits.max_transparency && torque) {
    checks.push_back(
        limit_check("transparency", "", torque->transparency, *limits.max_transparency));
  }
  return checks;
}

}  // namespace gear3k::actuator
