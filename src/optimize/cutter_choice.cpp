#include "optimize/cutter_choice.hpp"

#include <algorithm>

namespace gear3k::optimize {

namespace {

bool reads_ring_root(const ConstraintRow& row) {
  if (!row.check) return false;
  const design::CheckRecord& record = *row.check->record;
  if (record.rating || record.id == design::CheckId::kRingCutter) return true;
  return record.tooth_form && row.check->subject.member != static_cast<int>(train::kMeshSP1);
}

}  // namespace

std::vector<std::array<int, 2>> cutter_choices(const Specification& spec) {
  const auto of = [&](std::size_t ring) {
    const std::vector<int>& listed = spec.cutter_teeth[ring];
    return listed.size() > 1 ? listed : std::vector{0};
  };
  std::vector<std::array<int, 2>> choices;
  for (const int first : of(train::kR1)) {
    for (const int second : of(train::kR2)) choices.push_back({first, second});
  }
  return choices;
}

RefinementProblem without_cutter_rows(const RefinementProblem& problem) {
  RefinementProblem eased = problem;
  std::erase_if(eased.rows, reads_ring_root);
  return eased;
}

}  // namespace gear3k::optimize
