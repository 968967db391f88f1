#pragma once
// How much tells for each cause, and how probable those are that explain a part of a discrepancy.

#include <vector>

#include "calibrate/search/search.hpp"
#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {

/// Evidence of each cause by itself in its best form, the greatest first.
std::vector<CauseEvidence> first_evidence(const SearchResult& found);

/// Sets the probabilities of each effect's cause, of its alternatives, and of no cause of the
/// library: together 1 (docs/theory §30).
/// @param structure  whether a remainder is left beside the effects
void set_posteriors(std::vector<Effect>& effects, bool structure);

}  // namespace gear3k::calibrate
