#pragma once
// What each effect of a fit adds, and what else would explain these data as well in its place.

#include <vector>

#include "calibrate/search/judge.hpp"
#include "calibrate/search/search.hpp"

namespace gear3k::calibrate {

/// Whether a cause is the coefficient of friction, which is no missing effect.
inline bool is_parameter(const Cause& cause) { return cause.remedy == Remedy::kFrictionValue; }
/// Whether it is what all rows have in common anyway: that coefficient, or a clearance.
inline bool is_level(const Cause& cause) {
  return is_parameter(cause) || cause.remedy == Remedy::kClearance;
}

/// Candidates of causes that are not in a hypothesis.
std::vector<Candidate> candidates_beside(const std::vector<Candidate>& all, const Hypothesis& h);

/// What all rows may have in common: the coefficient of friction among the candidates, of lost
/// motion a clearance; null where the data have neither.
const Candidate* level_of(const SearchResult& result);

/// p-value and BIC of an effect of the fit given the others, and its replacements: screened by
/// linearisation without the effect, then fitted; those within χ² 6 of the best, with another
/// coefficient of friction where they need one.
FoundEffect judge_effect(const Judge& judge, const SearchResult& result, std::size_t effect);

/// p-value and BIC of an effect by what is left without it.
/// @param searched  the effect as it was searched for
void weigh_effect(const Judge& judge, const SearchResult& result, std::size_t effect,
                  const Candidate& searched, FoundEffect& found);

/// Fits anew what may stand in the place of an effect, as another one has changed its name; what no
/// longer explains as well is taken out.
/// @param effect  whose replacements they are
void refit_beside(const Judge& judge, const SearchResult& result, std::size_t effect,
                  std::vector<Replacement>& list);

}  // namespace gear3k::calibrate
