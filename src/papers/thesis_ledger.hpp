#pragma once

#include <vector>

#include "papers/ledger.hpp"
#include "papers/thesis_comparison.hpp"

namespace gear3k::papers {

/// What the directional-impedance thesis prints and what it comes to, computed.
/// @param comparison  of the same sources, its ledger not used
/// @throws std::invalid_argument when no pair is measured in both directions
std::vector<LedgerEntry> thesis_ledger(const ThesisSources& sources,
                                       const ThesisComparison& comparison);

}  // namespace gear3k::papers
