#include "calibrate/fit/wave_amplitude.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "calibrate/causes/reading_change.hpp"
#include "calibrate/fit/linearisation.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "numerics/distributions.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

namespace {

/// Half the 95 % interval of what an effect comes to.
/// @param slope  of that by the effect's parameters
double half_interval(const Problem& problem, const Hypothesis& h, std::size_t effect,
                     const Eigen::VectorXd& slope, double variance) {
  const WhitenedRows rows = whitened_rows(problem, h);
  if (!rows.runs) return std::numeric_limits<double>::infinity();
  // Each parameter in a unit of its own: of the rows that it changes.
  const Eigen::VectorXd unit =
      rows.jacobian.colwise().norm().transpose().cwiseMax(std::numeric_limits<double>::min());
  const Eigen::MatrixXd scaled = rows.jacobian * unit.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd inverse = numerics::pseudo_inverse(scaled.transpose() * scaled);
  Eigen::VectorXd by_all = Eigen::VectorXd::Zero(unit.size());
  by_all.segment(static_cast<Eigen::Index>(value_offset(h, effect)), slope.size()) = slope;
  by_all = by_all.cwiseQuotient(unit);
  return numerics::kHalf95 * std::sqrt(std::max(0.0, variance * by_all.dot(inverse * by_all)));
}

Eigen::VectorXd vector_of(std::span<const double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

bool sessions_are_alike(const Problem& problem, const Hypothesis& h, std::size_t effect,
                        double variance) {
  if (!gives_each_session_a_value(h.effects[effect].form)) return false;
  const Eigen::VectorXd value = vector_of(values_of(h, effect));
  const Eigen::VectorXd from_mean = value.array() - value.mean();
  const double deviation = from_mean.norm();
  if (!(deviation > 0.0)) return true;
  return deviation < half_interval(problem, h, effect, from_mean / deviation, variance);
}

bool is_no_wave(const Problem& problem, const Hypothesis& h, std::size_t effect, double variance) {
  const Candidate& own = h.effects[effect];
  if (!(own.form.order > 0.0)) return false;
  const Eigen::VectorXd p = vector_of(values_of(h, effect));
  const double amplitude = p.norm();
  if (!(amplitude > 0.0)) return true;
  const double in_mean = measured(problem.data).cwiseAbs().mean();
  const bool share = own.parameters.front().unit.empty();
  if (amplitude * (share ? in_mean : response_unit(problem.data.kind).si) > in_mean) return true;
  return amplitude < half_interval(problem, h, effect, p / amplitude, variance);
}

}  // namespace gear3k::calibrate
