#include "app/compare.hpp"

#include <fmt/format.h>

#include <set>
#include <stdexcept>
#include <utility>

#include "app/evaluate.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app {

std::vector<report::ComparedDesign> compare(const CompareRequest& request) {
  if (request.designs.size() < 2) throw std::invalid_argument("compare: fewer than two designs");
  std::vector<report::ComparedDesign> compared;
  compared.reserve(request.designs.size());
  io::CollectedErrors errors;
  for (const CompareRequest::Item& item : request.designs) {
    errors.attempt([&] {
      design::Evaluation evaluation = evaluate(item.design, item.source);
      const design::OutputTerms terms = design::output_terms(item.design, evaluation);
      std::string label = evaluation.name;
      compared.push_back({.label = std::move(label),
                          .file = item.source,
                          .evaluation = std::move(evaluation),
                          .terms = terms});
    });
  }
  errors.raise();
  const auto labels_differ = [&] {
    std::set<std::string> labels;
    for (const report::ComparedDesign& one : compared) labels.insert(one.label);
    return labels.size() == compared.size() && !labels.contains("");
  };
  if (!labels_differ()) {
    for (report::ComparedDesign& one : compared) one.label = one.file;
  }
  for (std::size_t i = 0; i < compared.size() && !labels_differ(); ++i) {
    compared[i].label = fmt::format("{} ({})", compared[i].file, i + 1);
  }
  return compared;
}

}  // namespace gear3k::app
