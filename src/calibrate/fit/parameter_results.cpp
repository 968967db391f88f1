#include "calibrate/fit/parameter_results.hpp"

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

namespace {

/// Factor of a standard deviation for a 95 % interval: the normal's where the scatter is known,
/// else Student's.
double interval_factor(const FinalFit& fit) {
  constexpr double kNormal = 1.959963984540054;
  if (fit.scale_is_known || fit.degrees < 1) return kNormal;
  return numerics::student_quantile(0.975, fit.degrees);
}

ParameterResult parameter_result(const ParameterRecord& record, double value, double variance,
                                 double factor) {
  const double half = factor * std::sqrt(std::max(0.0, variance));
  return {.name = std::string(record.name),
          .unit = std::string(record.unit),
          .value = value,
          .low = value - half,
          .high = value + half,
          .plausible = value >= record.plausible_low && value <= record.plausible_high,
          .plausible_low = record.plausible_low,
          .plausible_high = record.plausible_high};
}

}  // namespace

std::vector<ParameterResult> parameter_results(const Simulation& simulation, const FinalFit& fit,
                                               std::size_t effect) {
  const Hypothesis& h = fit.hypothesis;
  const std::size_t first = value_offset(h, effect);
  const Candidate& own = h.effects[effect];
  const double factor = interval_factor(fit);
  std::vector<ParameterResult> result;
  for (std::size_t k = 0; k < own.parameters.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(first + k);
    result.push_back(
        parameter_result(own.parameters[k], h.value[first + k], fit.covariance(at, at), factor));
    result.back().at_bound = fit.at_bound[first + k];
  }
  if (own.cause->derived == nullptr) return result;
  const std::vector<Scalar> values = variables_of(h.value);
  Modification all = simulation.unmodified({});
  apply(h, values, {}, simulation.kind(), all);
  std::ptrdiff_t leading = 0;
  const auto mine = std::span(values).subspan(first, own.parameters.size());
  for (const DerivedParameter& d : own.cause->derived(own.form, mine, simulation, all)) {
    const Eigen::VectorXd slope = d.value.v.head(static_cast<Eigen::Index>(values.size()));
    ParameterResult derived =
        parameter_result(d.record, d.value.a, slope.dot(fit.covariance * slope), factor);
    derived.derived = true;
    result.insert(d.leads ? result.begin() + leading++ : result.end(), std::move(derived));
  }
  return result;
}

}  // namespace gear3k::calibrate
