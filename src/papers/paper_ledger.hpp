#pragma once

#include <vector>

#include "papers/ledger.hpp"
#include "papers/reproduce.hpp"

namespace gear3k::papers {

/// What the low-backlash paper prints and what it comes to, computed.
/// @throws std::invalid_argument when a published gearbox has no defined geometry
std::vector<LedgerEntry> paper_ledger(const PublishedSources& sources);

}  // namespace gear3k::papers
