#pragma once
// What each effect of a fit adds, and what else would explain these data as well in its place.

#include <vector>

#include "calibrate/search/search.hpp"

namespace gear3k::calibrate {

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

/// Candidates of causes that are not in a hypothesis.
std::vector<Candidate> candidates_beside(const std::vector<Candidate>& all, const Hypothesis& h);

/// Whether a step or drift of a fit shows no change: a constant where it acts explains as well.
/// One with a value of its own at the start, or for each session, has to pay for what it has more
/// than that constant (explains_as_well()); another one has to be better by χ² 2.
bool shows_no_change(const Judge& judge, const Fit& found, std::size_t effect);

/// Whether an effect may carry no name: it shows no change, its sessions_are_alike(), or it
/// is_no_wave().
bool is_no_finding(const Judge& judge, const Fit& found, std::size_t effect);

/// p-value and BIC of an effect of the fit given the others, and its replacements: screened by
/// linearisation without the effect, then fitted; those within χ² 6 of the best, with another
/// coefficient of friction where they need one.
FoundEffect judge_effect(const Judge& judge, const SearchResult& result, std::size_t effect);

/// Takes a replacement in the place of an effect where it is the better name for the same thing:
/// the coefficient of friction (a parameter, within χ² 4 and plausible) before a missing effect, a
/// step between sessions before a law (χ² 2), and at a tie what stands earlier in the library.
void prefer_parameters(const Judge& judge, SearchResult& result);

/// Forms of as many parameters that are not searched for (Form::weight 0) in the place of those
/// found, where they explain as well within χ² 2 and are plausible.
void take_unsearched_forms(const Judge& judge, const std::vector<Candidate>& all,
                           SearchResult& result);

/// χ² by which a replacement must be ahead to be likelier than the name: what set_posteriors()
/// makes of either (docs/theory §30).
inline constexpr double kLikelier = 2.2;

/// Takes a replacement that is likelier than the name it may replace.  The coefficient of friction
/// stays, as it is preferred whatever is ahead by less than χ² 4; and so does a name where the
/// values of what is likelier are none that a gearbox shows, or where that is likelier only if its
/// shape costs nothing (Judge::of_any_shape()).
/// @returns whether one was taken: all effects are to be judged anew
bool take_likelier_name(const Judge& judge, SearchResult& result);

/// Takes both and looks for other bodies that show each cause as well; p-values and BIC become
/// those of the names that stay, and of a form that is not searched for the p-value is that of the
/// form which was.
void take_better_names(const Judge& judge, const std::vector<Candidate>& all, SearchResult& result);

}  // namespace gear3k::calibrate
