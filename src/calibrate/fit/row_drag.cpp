#include "calibrate/fit/row_drag.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/causes/drag_change.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

namespace {

/// How the torque goes with the speed; 0 of what is no such drag.
int power_of_speed(const Candidate& c) {
  if (c.cause->id == "drag_viscous") return 1;
  return c.cause->id == "drag_quadratic" ? 2 : 0;
}

}  // namespace

void add_implausible_drag(const Problem& problem, const FinalFit& fit, std::size_t effect,
                          std::vector<ParameterResult>& parameters) {
  const Candidate& own = fit.hypothesis.effects[effect];
  const int power = power_of_speed(own);
  const double sun_rad_s = range_of(problem.data, &Condition::sun_speed_rad_s).high;
  if (power == 0 || !(sun_rad_s > 0.0)) return;
  const double ratio = own.form.body == "output" ? std::abs(problem.simulation.ratio()) : 1.0;
  const double slope = std::pow(sun_rad_s / ratio, power);
  const std::size_t first = value_offset(fit.hypothesis, effect);
  const double torque_Nm = slope * fit.hypothesis.value[first];
  if (torque_Nm <= kMostDrag_Nm) return;
  const auto at = static_cast<Eigen::Index>(first);
  const double half =
      interval_factor(fit) * slope * std::sqrt(std::max(0.0, fit.covariance(at, at)));
  parameters.push_back({.name = "greatest_drag",
                        .unit = "Nm",
                        .value = torque_Nm,
                        .low = torque_Nm - half,
                        .high = torque_Nm + half,
                        .plausible = false,
                        .plausible_low = 0.0,
                        .plausible_high = kMostDrag_Nm,
                        .derived = true});
}

}  // namespace gear3k::calibrate
