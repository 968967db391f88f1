// What is known of single sets: at most by their bounds, and after a run.

#include <algorithm>
#include <cmath>

#include "optimize/blocking.hpp"
#include "optimize/energy_box.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"

namespace gear3k::optimize {

double merit_bound(const Specification& spec, const SetBound& bound, const Candidate& candidate) {
  const auto best_of = [&](Objective objective) {
    switch (objective) {
      case Objective::kBackwardEfficiency:
        return bound.eta_b;
      case Objective::kForwardEfficiency:
        return bound.eta_f;
      case Objective::kCycleEnergy:
        return spec.cycle_energy->least(
            energy_box(spec, candidate.teeth, candidate.planets, bound.eta_f, bound.eta_b));
      default:
        return best_value(objective, spec, candidate.teeth, candidate.planets);
    }
  };
  for (const ObjectiveLimit& limit : spec.objective_limits) {
    const double slack =
        design::kFeasibilityTolerance * std::abs(objective_scale(limit.objective, spec));
    if (sense_of(limit.objective) * (best_of(limit.objective) - limit.value) < -slack) {
      return -std::numeric_limits<double>::infinity();
    }
  }
  const Objective first = first_objective(spec);
  return sense_of(first) * best_of(first);
}

std::optional<RefinedSet> set_at(const OptimizeResult& result, std::size_t k) {
  const auto refined = std::ranges::lower_bound(result.refined, k, {}, &RefinedSet::index);
  if (refined != result.refined.end() && refined->index == k) return *refined;
  if (!result.bounds) return std::nullopt;
  const SetBound bound = result.bounds->of(k);
  const Candidate& candidate = result.search.candidates[k];
  RefinedSet set;
  if (bound.infeasible) {
    set = proven_infeasible(candidate, *bound.infeasible);
  } else if (result.interrupted) {
    return std::nullopt;
  } else {
    set.candidate = candidate;
    set.status = Status::kBounded;
  }
  set.index = static_cast<std::uint32_t>(k);
  return set;
}

void for_each_set(const OptimizeResult& result,
                  const std::function<void(std::size_t, const std::optional<RefinedSet>&)>& visit) {
  for (std::size_t k = 0; k < result.search.candidates.size(); ++k) visit(k, set_at(result, k));
}

}  // namespace gear3k::optimize
