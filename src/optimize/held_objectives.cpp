#include "optimize/held_objectives.hpp"

#include <algorithm>
#include <cmath>

#include "optimize/objective_value.hpp"
#include "optimize/refine.hpp"

namespace gear3k::optimize {

namespace {

/// A limit on lost motion has to be above 0 [rad].
constexpr double kLeastLimit_rad = 1e-9;

ObjectiveLimit held_by_check(ObjectiveLimit limit) {
  limit.by_check = true;
  return limit;
}

/// Shifts, modules and the rest do not change it.
bool is_of_teeth(Objective objective) { return objective == Objective::kRatioError; }

/// Of a design what its refinements have to keep.
class HeldValues {
 public:
  HeldValues(const Specification& spec, const RefinedSet& set)
      : spec_(spec), best_(set), first_(value_of(set, first_objective(spec))) {}

  /// Betters one objective; the first one, where it is held, to kHeldWithin of its value at the
  /// outset.
  /// @returns false when `stop` became true
  bool better(Objective objective, const StopFlag& stop) {
    const Specification task = with_limits(spec_, objective, limits_beside(objective));
    const KnownTrain start{.train = train_of(spec_, best_),
                           .load = {.face_width_m = best_.train.face_width_m,
                                    .torque_Nm = best_.torque_capacity_Nm.value_or(0.0)}};
    const double before = value_of(best_, objective);
    auto found = refine(task, best_.candidate, stop,
                        {.to_beat = sense_of(objective) * before, .design = &start});
    if (!found) return false;
    if (!has_design(found->status) || !keeps(task, *found)) return true;
    const double gain = sense_of(objective) * (value_of(*found, objective) - before);
    if (!(gain > held_slack(before))) return true;
    found->index = best_.index;
    best_ = std::move(*found);
    return true;
  }

  [[nodiscard]] const RefinedSet& best() const { return best_; }

 private:
  [[nodiscard]] double value_of(const RefinedSet& set, Objective objective) const {
    return objective_of(spec_, set, objective);
  }

  [[nodiscard]] std::vector<ObjectiveLimit> limits_beside(Objective objective) const {
    std::vector<ObjectiveLimit> limits;
    for (const Objective other : spec_.objectives) {
      if (other == objective || is_of_teeth(other)) continue;
      double value = value_of(best_, other);
      if (other == first_objective(spec_)) value = first_ - sense_of(other) * held_slack(first_);
      if (other == Objective::kLostMotion) value = std::max(value, kLeastLimit_rad);
      limits.push_back({.objective = other, .value = value});
    }
    return limits;
  }

  /// Whether what limits of the refinement hold is held in all that they are worth: ends of it may
  /// miss them by what is feasible.
  [[nodiscard]] bool keeps(const Specification& task, const RefinedSet& set) const {
    return std::ranges::all_of(task.objective_limits, [&](const ObjectiveLimit& limit) {
      const double miss =
          sense_of(limit.objective) * (limit.value - value_of(set, limit.objective));
      return miss <= design::kFeasibilitySlack * std::abs(objective_scale(limit.objective, task));
    });
  }

  const Specification& spec_;
  RefinedSet best_;
  double first_;  ///< the first objective at the outset
};

}  // namespace

Specification with_limits(const Specification& spec, Objective first,
                          const std::vector<ObjectiveLimit>& limits) {
  using design::CheckId;
  Specification task = spec;
  task.objectives = {first};
  for (const ObjectiveLimit& limit : limits) {
    const auto lower = [&](std::optional<double>& bound, double value) {
      bound = bound ? std::min(*bound, value) : value;
    };
    switch (limit.objective) {
      case Objective::kLostMotion:
        task.objective_limits.push_back(held_by_check(limit));
        lower(task.limits[CheckId::kOutputBacklashMax], limit.value);
        break;
      case Objective::kOuterDiameter:
        task.objective_limits.push_back(held_by_check(limit));
        lower(task.limits[CheckId::kRingRootDiameter], limit.value - 2.0 * spec.bodies.ring_rim_m);
        break;
      case Objective::kRatioError:
        task.ratio.tolerance = std::min(task.ratio.tolerance, limit.value);
        break;
      default:
        task.objective_limits.push_back(limit);
        break;
    }
  }
  return task;
}

std::optional<RefinedSet> bettered(const Specification& spec, const RefinedSet& set,
                                   const StopFlag& stop) {
  const Objective first = first_objective(spec);
  HeldValues held(spec, set);
  for (const Objective objective : spec.objectives) {
    if (objective == first || is_of_teeth(objective)) continue;
    if (!held.better(objective, stop)) return std::nullopt;
  }
  if (!is_of_teeth(first) && !held.better(first, stop)) return std::nullopt;
  return held.best();
}

}  // namespace gear3k::optimize
