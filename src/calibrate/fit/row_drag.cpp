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

/// The greatest torque of a drag that can be at a shaft: a gearbox that takes more to turn than to
/// carry its greatest load is none.
double most_drag_at_output_nm(const Problem& problem) {
  double carried_Nm = 0.0;
  for (const Observation& row : problem.data.rows) {
    carried_Nm = std::max(carried_Nm, std::abs(row.condition.output_torque_Nm));
  }
  return std::max(kMostDrag_Nm, carried_Nm);
}
/// The sun's torque is that of the load with the drag on top, backward less it.
/// @param at_1rads  the drag at 1 rad/s, which goes with the given power of the speed
double most_drag_at_sun_nm(const Problem& problem, double at_1rads, int power) {
  double carried_Nm = 0.0;
  for (const Observation& row : problem.data.rows) {
    const double own_Nm = at_1rads * std::pow(row.condition.sun_speed_rad_s, power);
    const bool forward = row.condition.direction == design::Direction::kForward;
    carried_Nm = std::max(carried_Nm, std::abs(row.response) + (forward ? -own_Nm : own_Nm));
  }
  return std::max(kMostDrag_Nm, carried_Nm);
}

/// Of a drag that is a torque itself.
void judge_torques(const Problem& problem, const Candidate& own,
                   std::vector<ParameterResult>& parameters) {
  const bool first_at_output = own.form.body == "output";
  for (ParameterResult& p : parameters) {
    if (p.name != "torque" && p.name != "other_torque") continue;
    const bool at_output = first_at_output == (p.name == "torque");
    p.plausible_high =
        at_output ? most_drag_at_output_nm(problem) : most_drag_at_sun_nm(problem, p.value, 0);
    p.plausible = p.value <= p.plausible_high;
  }
}

}  // namespace

void add_implausible_drag(const Problem& problem, const FinalFit& fit, std::size_t effect,
                          std::vector<ParameterResult>& parameters) {
  const Candidate& own = fit.hypothesis.effects[effect];
  if (own.cause->id == "drag_constant") judge_torques(problem, own, parameters);
  const int power = power_of_speed(own);
  const double sun_rad_s = range_of(problem.data, &Condition::sun_speed_rad_s).high;
  if (power == 0 || !(sun_rad_s > 0.0)) return;
  const bool at_output = own.form.body == "output";
  const double ratio = at_output ? std::abs(problem.simulation.ratio()) : 1.0;
  const double slope = std::pow(sun_rad_s / ratio, power);
  const std::size_t first = value_offset(fit.hypothesis, effect);
  const double torque_Nm = slope * fit.hypothesis.value[first];
  const double most_Nm = at_output
                             ? most_drag_at_output_nm(problem)
                             : most_drag_at_sun_nm(problem, fit.hypothesis.value[first], power);
  if (torque_Nm <= most_Nm) return;
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
                        .plausible_high = most_Nm,
                        .derived = true});
}

}  // namespace gear3k::calibrate
