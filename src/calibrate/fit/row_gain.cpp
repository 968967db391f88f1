#include "calibrate/fit/row_gain.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/causes/reading_change.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

void add_implausible_gain(const Problem& problem, const FinalFit& fit, std::size_t effect,
                          std::vector<ParameterResult>& parameters) {
  const Candidate& own = fit.hypothesis.effects[effect];
  if (own.cause->id != "drift" || target_of(own.form.name) != Target::kGain) return;
  const std::size_t first = value_offset(fit.hypothesis, effect);
  std::vector<Scalar> p;
  for (std::size_t k = 0; k < own.parameters.size(); ++k) {
    p.emplace_back(fit.hypothesis.value[first + k], static_cast<int>(k));
  }
  Scalar greatest(0.0);
  for (const Observation& row : problem.data.rows) {
    Modification m;
    own.cause->apply(own.form, p, row.condition, problem.data.kind, m);
    const Scalar change = m.sensor_gain - 1.0;
    if (std::abs(change.a) > std::abs(greatest.a)) greatest = change;
  }
  if (std::abs(greatest.a) <= kMostGainChange) return;
  const auto at = static_cast<Eigen::Index>(first);
  const auto count = static_cast<Eigen::Index>(own.parameters.size());
  const Eigen::VectorXd slope = greatest.v.head(count);
  const double variance = slope.dot(fit.covariance.block(at, at, count, count) * slope);
  const double half = interval_factor(fit) * std::sqrt(std::max(0.0, variance));
  parameters.push_back({.name = "greatest_gain_change",
                        .unit = "",
                        .value = greatest.a,
                        .low = greatest.a - half,
                        .high = greatest.a + half,
                        .plausible = false,
                        .plausible_low = -kMostGainChange,
                        .plausible_high = kMostGainChange,
                        .derived = true});
}

void judge_output_zero(const Problem& problem, const FinalFit& fit, std::size_t effect,
                       std::vector<ParameterResult>& parameters) {
  const Candidate& own = fit.hypothesis.effects[effect];
  if (own.cause->id != "sensor_offset" || place_of(own) != Place::kGearbox) return;
  constexpr double kShare = 0.1, kAnySensor_Nm = 1.0;
  const double most =
      std::max(kAnySensor_Nm, kShare * range_of(problem.data, &Condition::output_torque_Nm).high);
  ParameterResult& offset = parameters.front();
  offset.plausible_low = -most;
  offset.plausible_high = most;
  offset.plausible = std::abs(offset.value) <= most;
}

}  // namespace gear3k::calibrate
