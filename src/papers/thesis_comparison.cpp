#include "papers/thesis_comparison.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "papers/thesis_ledger.hpp"
#include "papers/thesis_model.hpp"

namespace gear3k::papers {

ThesisComparison compare_thesis(const ThesisSources& sources) {
  if (sources.measured.size() < 4) {
    throw std::invalid_argument(
        fmt::format("measured pair losses: {} rows, allowed: at least 4", sources.measured.size()));
  }
  ThesisComparison comparison{.map = loss_map(sources.statements),
                              .models = loss_models(sources),
                              .rows = {},
                              .ledger = {}};
  comparison.rows = loss_rows(sources, comparison.models);
  comparison.ledger = thesis_ledger(sources, comparison);
  return comparison;
}

}  // namespace gear3k::papers
