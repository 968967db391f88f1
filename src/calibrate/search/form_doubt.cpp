#include "calibrate/search/form_doubt.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/search/free_shapes.hpp"

namespace gear3k::calibrate {

namespace {

/// A fit with one thing freer, as far as it concerns the parameters of the fit itself.
struct FreerFit {
  std::size_t effect = 0;  ///< whose form is another one; their number: none
  double aic = 0.0;
  Eigen::VectorXd value, variance;  ///< of the parameters of the fit itself; 0 of that effect
};

/// Fits with freer forms, of the parameters of one of several effects.
class FreerFits {
 public:
  FreerFits(const Problem& problem, const FinalFit& final, double scale)
      : problem_(problem),
        final_(final),
        scale_(scale),
        own_(inverse_normal(problem, final.hypothesis)) {}

  /// Of the fit itself.
  [[nodiscard]] const InverseNormal& own() const { return own_; }

  /// One with which the rows do not tell the parameters apart has the same thing twice (a level of
  /// friction beside a drift that has one from its start) and is left out.
  /// @param h  that of the fit with another form in the place of an effect, or with one more
  void add(Hypothesis h, std::size_t effect) {
    if (h.value.size() > static_cast<std::size_t>(kMostParameters)) return;
    const Fit trial = fit(problem_, std::move(h), scale_);
    if (!std::isfinite(trial.sum_of_squares)) return;
    const InverseNormal normal = inverse_normal(problem_, trial.hypothesis);
    constexpr double kSameTwice = 1e4;
    if (normal.inflation.maxCoeff() > kSameTwice * own_.inflation.maxCoeff()) return;
    const double variance = final_.scale * final_.scale;
    const Eigen::VectorXd all = variance * normal.variance;
    const Hypothesis& own = final_.hypothesis;
    FreerFit result{.effect = effect,
                    .aic = trial.sum_of_squares * scale_ * scale_ / variance +
                           2.0 * static_cast<double>(trial.hypothesis.value.size()),
                    .value = Eigen::VectorXd::Zero(count()),
                    .variance = Eigen::VectorXd::Zero(count())};
    for (std::size_t e = 0; e < own.effects.size(); ++e) {
      if (e == effect) continue;
      const auto parameters = static_cast<Eigen::Index>(own.effects[e].parameters.size());
      const auto here = static_cast<Eigen::Index>(value_offset(own, e));
      const auto there = static_cast<Eigen::Index>(value_offset(trial.hypothesis, e));
      for (Eigen::Index k = 0; k < parameters; ++k) {
        result.value[here + k] = trial.hypothesis.value[static_cast<std::size_t>(there + k)];
        result.variance[here + k] = all[there + k];
      }
    }
    fits_.push_back(std::move(result));
  }

  /// The factor of a parameter's deviation.
  /// @param effect  that it belongs to; @param aic  of the fit itself
  /// @param alike   its variance by rows that scatter alike
  [[nodiscard]] double factor(Eigen::Index parameter, std::size_t effect, double aic,
                              double alike) const {
    double least = aic;
    for (const FreerFit& f : fits_) {
      if (f.effect != effect) least = std::min(least, f.aic);
    }
    const double own = final_.hypothesis.value[static_cast<std::size_t>(parameter)];
    double sum = std::exp(-0.5 * (aic - least));
    double deviation = sum * std::sqrt(alike);
    for (const FreerFit& f : fits_) {
      if (f.effect == effect) continue;
      const double weight = std::exp(-0.5 * (f.aic - least));
      sum += weight;
      deviation += weight * std::hypot(std::sqrt(f.variance[parameter]), f.value[parameter] - own);
    }
    return std::max(1.0, deviation / (sum * std::sqrt(alike)));
  }

 private:
  [[nodiscard]] Eigen::Index count() const {
    return static_cast<Eigen::Index>(final_.hypothesis.value.size());
  }

  const Problem& problem_;
  const FinalFit& final_;
  double scale_;
  InverseNormal own_;
  std::vector<FreerFit> fits_;
};

/// A law whose reference is taken from the design or the data, and whether a constant that would
/// move it stands beside it.
bool has_fixed_reference(const Hypothesis& h) {
  const auto expands = [](const Candidate& c) { return c.cause->remedy == Remedy::kHousing; };
  const auto is_constant = [](const Candidate& c) { return c.cause->remedy == Remedy::kClearance; };
  return std::ranges::any_of(h.effects, expands) && std::ranges::none_of(h.effects, is_constant);
}

bool has_level(const Hypothesis& h) {
  return std::ranges::any_of(h.effects, [](const Candidate& c) {
    return c.cause->remedy == Remedy::kFrictionValue || has_level_parameter(c.parameters);
  });
}

}  // namespace

void widen_by_forms(const Problem& problem, const std::vector<Candidate>& all, double scale,
                    FinalFit& final) {
  const Hypothesis& h = final.hypothesis;
  // A law alone has no parameters beside it but those that its reference hides.
  const bool fixed_reference = has_fixed_reference(h);
  if ((h.effects.size() < 2 && !fixed_reference) || !(scale > 0.0) || !(final.scale > 0.0)) return;
  FreerFits fits(problem, final, scale);
  for (const Candidate& form : all) {
    if (is_refinement(form.form)) continue;
    for (std::size_t e = 0; e < h.effects.size(); ++e) {
      if (may_free(h, e, form)) fits.add(in_form(h, e, form), e);
    }
    if (form.cause->remedy == Remedy::kFrictionValue && form.form.weight > 0.0 && !has_level(h)) {
      fits.add(with(h, form), h.effects.size());
    }
    if (form.cause->remedy == Remedy::kClearance && form.form.weight > 0.0 && fixed_reference) {
      fits.add(with(h, form), h.effects.size());
    }
  }
  double squares = 0.0;
  Eigen::VectorXd residual = measured(problem.data) - final.simulated;
  Eigen::MatrixXd white = residual;
  problem.noise.whiten(white);
  for (const double r : white.reshaped()) squares += huber_square(r / scale);
  const double variance = final.scale * final.scale;
  const double aic = squares * scale * scale / variance + 2.0 * static_cast<double>(h.value.size());
  const Eigen::VectorXd alike = variance * fits.own().variance;
  Eigen::VectorXd wider = Eigen::VectorXd::Ones(alike.size());
  for (std::size_t e = 0; e < h.effects.size(); ++e) {
    const std::size_t first = value_offset(h, e);
    for (std::size_t k = first; k < first + h.effects[e].parameters.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      if (!final.determined[k] || final.at_bound[k] || !(alike[at] > 0.0)) continue;
      wider[at] = fits.factor(at, e, aic, alike[at]);
    }
  }
  final.covariance = wider.asDiagonal() * final.covariance * wider.asDiagonal();
}

}  // namespace gear3k::calibrate
