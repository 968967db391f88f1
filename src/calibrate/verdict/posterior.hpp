#pragma once
// How probable each cause is that explains a part of a discrepancy.

#include <vector>

#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {

/// Sets the probabilities of each effect's cause, of its alternatives, and of no cause of the
/// library: together 1 (docs/theory §30).
/// @param structure  whether a remainder is left beside the effects
void set_posteriors(std::vector<Effect>& effects, bool structure);

}  // namespace gear3k::calibrate
