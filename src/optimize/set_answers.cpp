#include "optimize/set_answers.hpp"

#include <algorithm>
#include <utility>

namespace gear3k::optimize {

namespace {

bool keeps(std::span<const double> costs, std::span<const double> limits) {
  return std::ranges::equal(costs, limits, std::ranges::less_equal{});
}

}  // namespace

SetAnswers::SetAnswers(const Specification& spec, Objectives objectives)
    : spec_(&spec), objectives_(std::move(objectives)) {}

std::vector<double> SetAnswers::costs_of(const RefinedSet& set) const {
  std::vector<double> costs;
  costs.reserve(objectives_.each.size());
  for (const Objective objective : objectives_.each) {
    costs.push_back(-sense_of(objective) * objective_of(*spec_, set, objective));
  }
  return costs;
}

void SetAnswers::add(std::size_t ask, const RefinedSet& set) {
  if (has_design(set.status)) {
    known_[set.candidate].push_back({.ask = ask,
                                     .set = &set,
                                     .optimal = set.status == Status::kOptimal && !set.grid_cut,
                                     .costs = costs_of(set)});
  } else if (set.status == Status::kNoFeasibleFound && !set.grid_cut) {
    known_[set.candidate].push_back({.ask = ask, .set = nullptr, .optimal = false, .costs = {}});
  }
}

void SetAnswers::take(const CostAsk& ask, std::span<const RefinedSet> sets) {
  asks_.push_back(ask);
  for (const RefinedSet& set : sets) add(asks_.size() - 1, set);
}

void SetAnswers::keep(const CostAsk& ask, std::span<const RefinedSet> sets) {
  asks_.push_back(ask);
  for (const RefinedSet& set : sets) {
    kept_.push_back(set);
    add(asks_.size() - 1, kept_.back());
  }
}

std::optional<RefinedSet> SetAnswers::answer(const CostAsk& ask, const Candidate& candidate) const {
  const auto found = known_.find(candidate);
  if (found == known_.end()) return std::nullopt;
  RefinedSet none;
  none.candidate = candidate;
  none.status = Status::kNoFeasibleFound;
  for (const Known& known : found->second) {
    const CostAsk& past = asks_[known.ask];
    if (!keeps(ask.limits, past.limits)) continue;
    if (known.set == nullptr) return none;
    if (!known.optimal) continue;
    if (past.first == ask.first && keeps(known.costs, ask.limits)) return *known.set;
    if (known.costs[past.first] > ask.limits[past.first] + objectives_.slack[past.first]) {
      return none;
    }
  }
  return std::nullopt;
}

double SetAnswers::least_cost(const CostAsk& ask, const Candidate& candidate) const {
  double least = -kInfinity;
  const auto found = known_.find(candidate);
  if (found == known_.end()) return least;
  for (const Known& known : found->second) {
    const CostAsk& past = asks_[known.ask];
    if (!keeps(ask.limits, past.limits)) continue;
    if (known.set == nullptr) return kInfinity;
    if (!known.optimal || past.first != ask.first) continue;
    least = std::max(least, known.costs[ask.first] - objectives_.slack[ask.first]);
  }
  return least;
}

std::optional<RefinedSet> SetAnswers::best_within(const CostAsk& ask) const {
  const RefinedSet* best = nullptr;
  double least = 0.0;
  for (const auto& [candidate, all] : known_) {
    for (const Known& known : all) {
      if (known.set == nullptr || !keeps(known.costs, ask.limits)) continue;
      if (best != nullptr && !(known.costs[ask.first] < least)) continue;
      best = known.set;
      least = known.costs[ask.first];
    }
  }
  return best != nullptr ? std::optional(*best) : std::nullopt;
}

}  // namespace gear3k::optimize
