#include "optimize/stage_relaxer.hpp"

#include <algorithm>

#include "optimize/efficiency_bound.hpp"
#include "optimize/empty_stage.hpp"
#include "optimize/stage_tasks.hpp"

namespace gear3k::optimize {

namespace {

/// Sorted distinct keys, and the place of each candidate's key among them.
template <class KeyOf>
std::vector<Candidate> distinct_stages(std::span<const Candidate> candidates, KeyOf key_of,
                                       std::vector<std::uint32_t>& place) {
  std::vector<Candidate> keys;
  keys.reserve(candidates.size());
  for (const Candidate& c : candidates) keys.push_back(key_of(c));
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  place.clear();
  place.reserve(candidates.size());
  for (const Candidate& c : candidates) {
    const auto at = std::lower_bound(keys.begin(), keys.end(), key_of(c));
    place.push_back(static_cast<std::uint32_t>(at - keys.begin()));
  }
  return keys;
}

std::optional<Infeasibility> worst_of(std::span<const ShiftRange* const> ranges) {
  std::optional<Infeasibility> worst;
  for (const ShiftRange* range : ranges) {
    if (range->infeasible && (!worst || range->infeasible->violation > worst->violation)) {
      worst = range->infeasible;
    }
  }
  return worst;
}

void widen(Interval& whole, const Interval& part) {
  whole = {std::min(whole.lo, part.lo), std::max(whole.hi, part.hi)};
}

}  // namespace

StageKeys stage_keys(std::span<const Candidate> candidates) {
  StageKeys keys;
  keys.keys[0] = distinct_stages(
      candidates,
      [](const Candidate& c) {
        return Candidate{.teeth = {.S = c.teeth.S, .P1 = c.teeth.P1, .R1 = c.teeth.R1},
                         .planets = c.planets};
      },
      keys.of[0]);
  keys.keys[1] = distinct_stages(
      candidates,
      [](const Candidate& c) {
        return Candidate{.teeth = {.P2 = c.teeth.P2, .R2 = c.teeth.R2}, .planets = c.planets};
      },
      keys.of[1]);
  return keys;
}

StageRelaxer::StageRelaxer(const Specification& spec, const StageKeys& keys,
                           std::span<const Candidate> candidates, std::array<bool, 2> stages)
    : spec_(&spec), keys_(&keys), shifts_(spec, candidates) {
  if (!has_bounds(spec)) return;
  levels_ = StageTasks(spec).shares_lost_motion() ? kMostLevels : 1;
  if (bounds_flanks(spec) || bounds_roots(spec)) {
    if (stages[0]) take_flanks(0, keys, candidates);
    if (stages[1]) take_flanks(1, keys, candidates);
  }
}

RelaxedStage1 StageRelaxer::relax1(std::size_t index, const Ask& ask) const {
  const Specification& spec = *spec_;
  const Candidate& key = keys_->keys[0][index];
  const StageFlanks* flanks = flanks_of(0, index);
  const RelaxationEffort& effort = ask.effort;
  const StageTasks tasks(spec);
  RelaxedStage1 stage;
  const train::ToothSet& z = key.teeth;
  const std::array ranges{&shifts_.of(train::kS, z.S), &shifts_.of(train::kP1, z.P1),
                          &shifts_.of(train::kR1, z.R1)};
  stage.infeasible = worst_of(ranges);
  if (stage.infeasible) return stage;
  const std::array<Interval, 3> shifts{ranges[0]->widest, ranges[1]->widest, ranges[2]->widest};
  const auto task_of = [&](double share) {
    StageTask task = tasks.stage1(key, shifts, share);
    task.distance = ask.distance;
    return flanks != nullptr ? with_flanks(spec, task, *flanks) : task;
  };
  StageTask task = task_of(1.0);
  if (ask.sun_weight) {
    stage.sun_weight = *ask.sun_weight;
  } else {
    // At a typical loss factor, with stage 2 as stage 1 and the ratio that is asked for.
    constexpr double kTypical = 0.65;
    const bool forward = first_objective(spec) == Objective::kForwardEfficiency;
    const double g1 = train::g1(z);
    const double g2 = 1.0 - (1.0 + g1) / spec.ratio.target;
    const auto weight_at = [&](double factor) {
      const double e2 = 1.0 - factor * task.ring_loss;
      const auto w = loss_weights(g1, g2, {1.0 - factor * task.sun_loss, e2, e2}, forward);
      return w[1] > 0.0 ? w[0] / w[1] : 0.0;
    };
    const double weight = weight_at(kTypical);
    stage.sun_weight = weight > 0.0 ? weight : std::max(weight_at(0.0), 1e-3);
  }
  for (std::size_t level = 0; level < levels_; ++level) {
    Stage1Level& at = stage.level[level];
    task = task_of(share_of(level));
    task.sun_weight = stage.sun_weight;
    task.ring_weight = 1.0;
    const StageBound bound = relax_stage(task, effort.weighted);
    at.empty = bound.empty;
    if (bound.empty) {
      if (level + 1 == levels_ && ask.named) {
        stage.infeasible = name_empty_stage(spec, task, 0, effort.weighted);
        // Stage 2 is not to be called empty for a load on stage 1.
        if (is_load(stage.infeasible->check)) {
          stage.most_distance = center_distances(task).hi;
        }
      }
      continue;
    }
    widen(stage.distance, bound.center_distance);
    at.weighted = bound.least;
    at.point = bound.point;
    stage.most_distance = std::max(stage.most_distance, bound.center_distance.hi);
    task.ring_weight = 0.0;
    task.sun_weight = 1.0;
    at.sun = relax_stage(task, effort.alone).least;
    task.ring_weight = 1.0;
    task.sun_weight = 0.0;
    at.ring = relax_stage(task, effort.alone).least;
  }
  if (flanks != nullptr && !stage.infeasible) stage.reach = reach_of(task_of(1.0), effort);
  return stage;
}

RelaxedStage2 StageRelaxer::relax2(std::size_t index, const Ask& ask, double most_distance) const {
  const Candidate& key = keys_->keys[1][index];
  const StageFlanks* flanks = flanks_of(1, index);
  const RelaxationEffort& effort = ask.effort;
  const StageTasks tasks(*spec_);
  RelaxedStage2 stage;
  const train::ToothSet& z = key.teeth;
  const std::array ranges{&shifts_.of(train::kP2, z.P2), &shifts_.of(train::kR2, z.R2)};
  stage.infeasible = worst_of(ranges);
  if (stage.infeasible) return stage;
  const std::array<Interval, 2> shifts{ranges[0]->widest, ranges[1]->widest};
  const auto task_of = [&](double share) {
    StageTask task = tasks.stage2(key, shifts, share, most_distance);
    task.distance = ask.distance;
    return flanks != nullptr ? with_flanks(*spec_, task, *flanks) : task;
  };
  for (std::size_t level = 0; level < levels_; ++level) {
    Stage2Level& at = stage.level[level];
    const StageTask task = task_of(share_of(level));
    const StageBound bound = relax_stage(task, effort.weighted);
    at.empty = bound.empty;
    if (bound.empty) {
      if (level + 1 == levels_ && ask.named) {
        stage.infeasible = name_empty_stage(*spec_, task, 1, effort.weighted);
      }
      continue;
    }
    widen(stage.distance, bound.center_distance);
    at.ring = bound.least;
    at.point = bound.point;
  }
  if (flanks != nullptr && !stage.infeasible) stage.reach = reach_of(task_of(1.0), effort);
  return stage;
}

void StageRelaxer::take_flanks(std::size_t stage, const StageKeys& keys,
                               std::span<const Candidate> candidates) {
  const StageTasks tasks(*spec_);
  std::vector<StageTask> of_keys;
  of_keys.reserve(keys.keys[stage].size());
  for (const Candidate& key : keys.keys[stage]) {
    const auto z = train::teeth_of(key.teeth);
    const auto widest = [&](int gear) {
      return shifts_.of(gear, z[static_cast<std::size_t>(gear)]).widest;
    };
    of_keys.push_back(
        stage == 0
            ? tasks.stage1(key, {widest(train::kS), widest(train::kP1), widest(train::kR1)}, 1.0)
            : tasks.stage2(key, {widest(train::kP2), widest(train::kR2)}, 1.0, kInfinity));
  }
  flanks_[stage] = stage_flanks(*spec_, stage, of_keys, candidates, keys.of[stage]);
}

StageReach StageRelaxer::reach_of(StageTask task, const RelaxationEffort& effort) {
  StageReach reach;
  task.sun_weight = task.ring_weight = 1.0;  // they choose which side of a box is cut
  task.least = StageTask::Least::kDistance;
  const StageBound nearest = relax_stage(task, effort.weighted);
  reach.least_m = nearest.least;
  reach.by_root = nearest.by_root;
  task.least = StageTask::Least::kInverseDistance;
  const double least = relax_stage(task, effort.alone).least;
  if (least > 0.0) reach.most_m = 1.0 / least;
  return reach;
}

double StageRelaxer::share_of(std::size_t level) const {
  return static_cast<double>(level + 1) / static_cast<double>(levels_);
}

}  // namespace gear3k::optimize
