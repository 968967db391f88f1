#include "calibrate/search/judge.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/fit/wave_amplitude.hpp"

namespace gear3k::calibrate {

namespace {

double more_parameters(const Fit& fit, const Fit& best) {
  return static_cast<double>(fit.hypothesis.value.size()) -
         static_cast<double>(best.hypothesis.value.size());
}

}  // namespace

Judge::Judge(const Problem& problem, const std::vector<Candidate>& all, const Fit& best,
             double scale)
    : problem_(problem), all_(all), scale_(scale) {
  if (problem.noise.known_scale() > 0.0) return;
  const auto n = static_cast<double>(problem.data.rows.size());
  const auto parameters = static_cast<double>(best.hypothesis.value.size());
  const double least = problem.noise.least_scale();
  variance_ =
      std::max(winsorised(best.residual, scale).squaredNorm() / std::max(1.0, n - parameters),
               least * least);
}

double Judge::difference(const Fit& fit, const Fit& best) const {
  return chi(fit) - chi(best) +
         more_parameters(fit, best) * std::log(static_cast<double>(problem_.data.rows.size()));
}

bool Judge::explains_as_well(const Fit& fit, const Fit& best) const {
  constexpr double kMostRows = 150.0;
  const auto rows = static_cast<double>(problem_.data.rows.size());
  const double more = more_parameters(fit, best);
  return chi(fit) - chi(best) + more * std::log(more > 0.0 ? std::min(rows, kMostRows) : rows) <=
         kAsWell;
}

double Judge::of_any_shape(const Fit& fit, const Fit& best) const {
  constexpr double kAkaike = 2.0;
  return chi(fit) - chi(best) + kAkaike * more_parameters(fit, best);
}

bool Judge::draws_the_same(const Fit& fit, const Fit& best) const {
  return more_parameters(fit, best) > 0.0 && chi(fit) <= chi(best) + kPreferred;
}

double Judge::chi(const Fit& fit) const { return fit.sum_of_squares * scale_ * scale_ / variance_; }

bool shows_no_change(const Judge& judge, const Fit& found, std::size_t effect) {
  const Candidate& own = found.hypothesis.effects[effect];
  if (own.cause->as_constant == nullptr) return false;
  Candidate constant{
      .cause = own.cause, .form = own.cause->as_constant(own.form, own.form.law), .parameters = {}};
  constant.parameters = own.cause->parameters(constant.form, judge.problem().simulation.kind());
  const Fit alike =
      fit(judge.problem(), with(without(found.hypothesis, effect), constant), judge.scale());
  return own.parameters.size() > constant.parameters.size()
             ? judge.explains_as_well(alike, found)
             : judge.chi(alike) <= judge.chi(found) + kPreferred;
}

bool is_no_finding(const Judge& judge, const Fit& found, std::size_t effect) {
  return shows_no_change(judge, found, effect) ||
         sessions_are_alike(judge.problem(), found.hypothesis, effect, judge.variance()) ||
         is_no_wave(judge.problem(), found.hypothesis, effect, judge.variance());
}

}  // namespace gear3k::calibrate
