#pragma once

#include <vector>

#include "papers/backdrivability.hpp"
#include "papers/ledger.hpp"

namespace gear3k::papers {

/// What the backdrivability-factors paper prints and what it comes to, computed.
/// @param comparison  of the same sources, its ledger not used
std::vector<LedgerEntry> backdrivability_ledger(const BackdrivabilitySources& sources,
                                                const BackdrivabilityComparison& comparison);

}  // namespace gear3k::papers
