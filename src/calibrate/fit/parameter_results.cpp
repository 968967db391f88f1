#include "calibrate/fit/parameter_results.hpp"

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

double interval_factor(const FinalFit& fit) {
  if (fit.scale_is_known || fit.degrees < 1) return numerics::kHalf95;
  return numerics::student_quantile(0.975, fit.degrees);
}

namespace {

/// A value of the fit, or one derived from those of the fit.
struct FittedValue {
  double value = 0.0;
  double variance = 0.0;
  bool at_bound = false;
  double beyond = 0.0;  ///< how far across the bound the rows would have it
};

/// Whether a value can be.  At a bound of the fit it is the bound's and not that of the rows: it
/// can be as long as the interval about where they would have it holds a value that can.
/// @param half  of the interval
bool is_plausible(const ParameterRecord& record, const FittedValue& of, double half) {
  if (record.is_of_shape) return true;
  const double reach = of.at_bound ? half : 0.0;
  const double wanted = of.value + of.beyond;
  return wanted + reach >= record.plausible_low && wanted - reach <= record.plausible_high;
}

ParameterResult parameter_result(const ParameterRecord& record, const FittedValue& of,
                                 double factor) {
  const double half = factor * std::sqrt(std::max(0.0, of.variance));
  return {.name = std::string(record.name),
          .unit = std::string(record.unit),
          .value = of.value,
          .low = of.value - half,
          .high = of.value + half,
          .at_bound = of.at_bound,
          .plausible = is_plausible(record, of, half),
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
    result.push_back(parameter_result(own.parameters[k],
                                      {.value = h.value[first + k],
                                       .variance = fit.covariance(at, at),
                                       .at_bound = fit.at_bound[first + k],
                                       .beyond = fit.beyond[first + k]},
                                      factor));
  }
  if (own.cause->derived == nullptr) return result;
  // As many slopes at a time as a Scalar has.
  std::vector<DerivedParameter> list;
  std::vector<Eigen::VectorXd> slopes;
  const auto count = static_cast<Eigen::Index>(h.value.size());
  for (Eigen::Index begin = 0; begin < count; begin += kMaxVariables) {
    const std::vector<Scalar> values = variables_of(h.value, static_cast<std::size_t>(begin));
    Modification all = simulation.unmodified({});
    apply(h, values, {}, simulation.kind(), all);
    const auto mine = std::span(values).subspan(first, own.parameters.size());
    list = own.cause->derived(own.form, mine, simulation, all);
    slopes.resize(list.size(), Eigen::VectorXd::Zero(count));
    const Eigen::Index slots = std::min<Eigen::Index>(kMaxVariables, count - begin);
    for (std::size_t k = 0; k < list.size(); ++k) {
      slopes[k].segment(begin, slots) = list[k].value.v.head(slots);
    }
  }
  std::ptrdiff_t leading = 0;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const DerivedParameter& d = list[k];
    const Eigen::VectorXd& slope = slopes[k];
    ParameterResult derived = parameter_result(
        d.record, {.value = d.value.a, .variance = slope.dot(fit.covariance * slope)}, factor);
    derived.derived = true;
    result.insert(d.leads ? result.begin() + leading++ : result.end(), std::move(derived));
  }
  return result;
}

}  // namespace gear3k::calibrate
