#include "optimize/felt_limits.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/scalar.hpp"

namespace gear3k::optimize {

namespace {

/// A value beyond this many times its limit is one that nothing moves.
constexpr double kMostTimes = 1e3;

/// Pushed back over moving with it, at a transparency L; no ratio has 2 and more.
double greatest_ratio(double limit) {
  constexpr double kMost = 2.0 - 1e-9;
  const double held = std::min(limit, kMost);
  return (2.0 + held) / (2.0 - held);
}

}  // namespace

template <class T>
T felt_margin(const FeltTask& task, const FeltLimit& limit, const FeltGearbox<T>& gearbox) {
  const double i = std::abs(gearbox.ratio);
  const T& eta_b = gearbox.backward;
  switch (limit.quantity) {
    case FeltQuantity::kInertia: {
      if (gearbox.inertia_kgm2) {
        return limit.value / (*gearbox.inertia_kgm2 + task.load_inertia_kgm2) - 1.0;
      }
      // 1/J = η_b/(J_load η_b + i² J_m).
      const double motor = i * i * task.rotor_inertia_kgm2;
      if (motor == 0.0) return eta_b * limit.value - eta_b * task.load_inertia_kgm2;
      return limit.value * eta_b / (task.load_inertia_kgm2 * eta_b + motor) - 1.0;
    }
    case FeltQuantity::kBreakaway: {
      const double held = i * task.static_Nm;
      return held > 0.0 ? T(limit.value / held * eta_b - 1.0) : eta_b;
    }
    case FeltQuantity::kTransparency:
      break;
  }
  const double c1 = i * task.coulomb_Nm;
  const double share = (task.transparency_torque_Nm - c1) / (task.transparency_torque_Nm + c1);
  return greatest_ratio(limit.value) * share * gearbox.forward * eta_b - 1.0;
}

double felt_miss(const FeltTask& task, const FeltLimit& limit, double violation) {
  const double left = 1.0 - violation;
  if (limit.quantity == FeltQuantity::kTransparency) {
    const double r = greatest_ratio(limit.value) / std::max(left, 1.0 / kMostTimes);
    return std::min(2.0 * (r - 1.0) / (r + 1.0), 2.0) - limit.value;
  }
  const bool nothing_held = limit.quantity == FeltQuantity::kBreakaway && !(task.static_Nm > 0.0);
  if (nothing_held) return 0.0;
  return limit.value * (1.0 / std::max(left, 1.0 / kMostTimes) - 1.0);
}

double felt_slope(const FeltLimit& limit) {
  if (limit.quantity != FeltQuantity::kTransparency) return 1.0 / limit.value;
  return 4.0 / ((2.0 - limit.value) * (2.0 + limit.value));
}

#define INSTANTIATE(T) \
  template T felt_margin<T>(const FeltTask&, const FeltLimit&, const FeltGearbox<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::optimize
