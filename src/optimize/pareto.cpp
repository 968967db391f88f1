#include "optimize/pareto.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace gear3k::optimize {

std::vector<std::size_t> pareto_front(const std::vector<RefinedSet>& sets, bool by_model) {
  using Costs = std::array<double, 4>;
  const auto costs_of = [&](const RefinedSet& s) {
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    const double eta_b = by_model ? s.eta_b_model.value_or(kNone) : s.eta_b;
    const double eta_f = by_model ? s.eta_f_model.value_or(kNone) : s.eta_f;
    return Costs{cost_in_steps(Objective::kBackwardEfficiency, eta_b),
                 cost_in_steps(Objective::kForwardEfficiency, eta_f),
                 cost_in_steps(Objective::kLostMotion, s.lost_motion_rad),
                 cost_in_steps(Objective::kOuterDiameter, s.ring_root_diameter_m)};
  };
  struct Entry {
    Costs costs;
    std::size_t index;
  };
  std::vector<Entry> entries;
  entries.reserve(sets.size());
  for (std::size_t k = 0; k < sets.size(); ++k) {
    if (has_design(sets[k].status)) {
      entries.push_back({.costs = costs_of(sets[k]), .index = k});
    }
  }
  // In this order a set is dominated by ones before it only; equals follow the first of them.
  std::ranges::sort(entries, [](const Entry& a, const Entry& b) {
    return a.costs != b.costs ? a.costs < b.costs : a.index < b.index;
  });
  std::vector<Entry> front;
  for (const Entry& entry : entries) {
    const bool dominated = std::ranges::any_of(front, [&](const Entry& other) {
      return std::ranges::equal(other.costs, entry.costs, std::less_equal<>());
    });
    if (!dominated) front.push_back(entry);
  }
  std::vector<std::size_t> indices;
  indices.reserve(front.size());
  for (const Entry& entry : front) indices.push_back(entry.index);
  std::ranges::sort(indices);
  return indices;
}

}  // namespace gear3k::optimize
