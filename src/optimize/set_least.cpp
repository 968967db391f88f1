#include "optimize/set_least.hpp"

#include "optimize/cutter_choice.hpp"
#include "optimize/module_pairs.hpp"
#include "optimize/shift_range.hpp"

namespace gear3k::optimize {

namespace {

Specification for_least_lost_motion(const Specification& spec) {
  Specification task = spec;
  task.objectives = {Objective::kLostMotion};
  return task;
}

}  // namespace

LeastLostMotion::LeastLostMotion(const Specification& spec)
    : spec_(for_least_lost_motion(spec)), refiner_(spec_) {}

bool LeastLostMotion::knows(const Specification& spec) {
  return module_combinations(spec).size() == 1 && !spec.shift_step &&
         cutter_choices(spec).size() <= 1;
}

const LeastLostMotion::Least* LeastLostMotion::of(const Candidate& candidate,
                                                  const StopFlag& stop) {
  if (const Least* before = known(candidate)) return before;
  ShiftRanges shifts;
  const auto z = train::teeth_of(candidate.teeth);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    shifts[i] = shift_range(spec_, static_cast<int>(i), z[i]);
  }
  std::optional<BestOfSet> best = refiner_.best_end(candidate, shifts, stop);
  if (!best) return nullptr;
  Least least{.at = best->at};
  if (best->merit > -kInfinity) least.lost_motion_rad = -best->merit;
  const std::lock_guard lock(mutex_);
  return &known_.emplace(candidate, least).first->second;
}

const LeastLostMotion::Least* LeastLostMotion::known(const Candidate& candidate) const {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(candidate);
  return found != known_.end() ? &found->second : nullptr;
}

}  // namespace gear3k::optimize
