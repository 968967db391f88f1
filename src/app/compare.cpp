#include "app/compare.hpp"

#include <algorithm>
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
  std::string errors;
  for (const CompareRequest::Item& item : request.designs) {
    try {
      design::Evaluation evaluation = evaluate(item.design, item.source);
      const design::OutputTerms terms = design::output_terms(item.design, evaluation);
      compared.push_back({.label = evaluation.name,
                          .file = item.source,
                          .evaluation = std::move(evaluation),
                          .terms = terms});
    } catch (const io::InvalidInput& error) {
      errors += (errors.empty() ? "" : "\n") + std::string(error.what());
    }
  }
  if (!errors.empty()) throw io::InvalidInput(errors);
  std::set<std::string> names;
  for (const report::ComparedDesign& one : compared) names.insert(one.label);
  if (names.size() < compared.size() || names.contains("")) {
    for (report::ComparedDesign& one : compared) one.label = one.file;
  }
  return compared;
}

}  // namespace gear3k::app
