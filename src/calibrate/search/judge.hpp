#pragma once
// How fits to the same data are compared, and which effects of them are no finding.

#include <vector>

#include "calibrate/fit/fit.hpp"

namespace gear3k::calibrate {

/// χ² by which an explanation may be worse than the best and still count as one: two hypotheses at
/// any distance are then confused with the truth left out in less than 1 % (z = √6 = 2.4).
inline constexpr double kAsWell = 6.0;
/// χ² by which the preferred of two may be worse: a step between sessions against a law.
inline constexpr double kPreferred = 2.0;
/// BIC that an effect beside another one has to pay: a law of slightly another shape than the true
/// one leaves what a second cause takes up.
inline constexpr double kBesideAnother = 10.0;
/// χ² below which two are alike: what rounding tells apart stays in the order of the library.
inline constexpr double kSameChi = 1e-6;

/// One scale and variance by which all fits to a problem are compared.
class Judge {
 public:
  /// @param best  whose residual states the variance, unless it is known
  /// (NoiseModel::known_scale())
  /// @param scale  of the treatment of outliers, as of fit()
  /// @param all  candidates, with those of free shape
  Judge(const Problem& problem, const std::vector<Candidate>& all, const Fit& best, double scale);

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const std::vector<Candidate>& candidates() const { return all_; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double variance() const { return variance_; }
  /// χ² of a fit at that scale.
  [[nodiscard]] double chi(const Fit& fit) const;
  /// χ² of a fit less that of another, with ln(rows) for every parameter that it has more: the
  /// difference of their BIC.
  [[nodiscard]] double difference(const Fit& fit, const Fit& best) const;
  /// Whether that is within 6 at no more than 150 rows: with many rows ln(rows) alone would leave
  /// out what has one parameter more, and is true.
  [[nodiscard]] bool explains_as_well(const Fit& fit, const Fit& best) const;
  /// Whether a fit of more parameters leaves no more than another, within χ² 2: no law of slightly
  /// another shape does that of an effect that stands out, unless these data do not tell their
  /// conditions apart (temperatures that differ by session only).  What its shape costs is then no
  /// evidence against its cause.
  [[nodiscard]] bool draws_the_same(const Fit& fit, const Fit& best) const;
  /// χ² of such a fit less that of another, with Akaike's 2 for every parameter that it has more.
  [[nodiscard]] double of_any_shape(const Fit& fit, const Fit& best) const;

 private:
  const Problem& problem_;
  const std::vector<Candidate>& all_;
  double scale_;
  double variance_ = 1.0;
};

/// Whether a step or drift of a fit shows no change: a constant where it acts explains as well.
/// One with a value of its own at the start, or for each session, has to pay for what it has more
/// than that constant (explains_as_well()); another one has to be better by χ² 2.
bool shows_no_change(const Judge& judge, const Fit& found, std::size_t effect);

/// Whether an effect may carry no name: it shows no change, its sessions_are_alike(), or it
/// is_no_wave().
bool is_no_finding(const Judge& judge, const Fit& found, std::size_t effect);

}  // namespace gear3k::calibrate
