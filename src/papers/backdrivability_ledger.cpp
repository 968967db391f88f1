#include "papers/backdrivability_ledger.hpp"

#include <iterator>

namespace gear3k::papers {

std::vector<LedgerEntry> backdrivability_ledger(const BackdrivabilitySources& sources,
                                                const BackdrivabilityComparison& comparison) {
  std::vector<LedgerEntry> entries = equation_errata(sources, comparison);
  for (auto part : {knee_number_errata(sources), stride_errata(sources, comparison)}) {
    entries.insert(entries.end(), std::make_move_iterator(part.begin()),
                   std::make_move_iterator(part.end()));
  }
  for (std::size_t k = 0; k < entries.size(); ++k) entries[k].number = static_cast<int>(k) + 1;
  return entries;
}

}  // namespace gear3k::papers
