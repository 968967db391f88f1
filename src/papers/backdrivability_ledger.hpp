#pragma once

#include <vector>

#include "papers/backdrivability.hpp"
#include "papers/ledger.hpp"

namespace gear3k::papers {

/// What the backdrivability-factors paper prints and what it comes to, computed.
/// @param comparison  of the same sources, its ledger not used
std::vector<LedgerEntry> backdrivability_ledger(const BackdrivabilitySources& sources,
                                                const BackdrivabilityComparison& comparison);

/// Its parts, numbered by the ledger: equations and scaling laws (sections 2 and 3), the numbers of
/// the knee actuator (eqs. 37 to 45), the stride (Figs. 10 and 11).
std::vector<LedgerEntry> equation_errata(const BackdrivabilitySources& sources,
                                         const BackdrivabilityComparison& comparison);
std::vector<LedgerEntry> knee_number_errata(const BackdrivabilitySources& sources);
std::vector<LedgerEntry> stride_errata(const BackdrivabilitySources& sources,
                                       const BackdrivabilityComparison& comparison);

}  // namespace gear3k::papers
