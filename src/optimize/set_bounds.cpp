#include "optimize/set_bounds.hpp"

#include <algorithm>

#include "numerics/parallel.hpp"
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

/// Whether a proof is named rather than another: what blocks without a load first, then what is
/// missed by more.
bool blocks_more(const Infeasibility& proof, const Infeasibility& other) {
  const bool loaded = proof.check == design::CheckId::kFlankSafety;
  if (loaded != (other.check == design::CheckId::kFlankSafety)) return !loaded;
  return proof.violation > other.violation;
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

/// Proof that the length along the axis, which is the same for every tooth set, is too much.
std::optional<Infeasibility> too_long(const Specification& spec) {
  const auto& most = spec.limits[design::CheckId::kGearboxLength];
  if (!most) return std::nullopt;
  const auto widths = least_face_widths_m(spec);
  const auto extent = train::whole_extent(spec.axial);
  if (!extent && !(widths[0] > 0.0 && widths[1] > 0.0)) return std::nullopt;
  const double length = extent ? extent->to_m - extent->from_m : widths[0] + widths[1];
  const double scale = *most > 0.0 ? *most : length_scale_m(spec);
  const double excess = length - *most;
  if (excess <= 2.0 * design::kFeasibilityTolerance * scale) return std::nullopt;
  return Infeasibility{
      .check = design::CheckId::kGearboxLength, .miss_si = excess, .violation = excess / scale};
}

void widen(Interval& whole, const Interval& part) {
  whole = {std::min(whole.lo, part.lo), std::max(whole.hi, part.hi)};
}

}  // namespace

SetBounds::SetBounds(const Specification& spec, std::span<const Candidate> candidates,
                     Progress& progress)
    : spec_(&spec),
      candidates_(candidates),
      shifts_(spec, candidates),
      of_any_set_(too_long(spec)) {
  if (!has_bounds(spec)) return;
  levels_ = StageTasks(spec).shares_lost_motion() ? kMostLevels : 1;
  const auto keys1 = distinct_stages(
      candidates,
      [](const Candidate& c) {
        return Candidate{.teeth = {.S = c.teeth.S, .P1 = c.teeth.P1, .R1 = c.teeth.R1},
                         .planets = c.planets};
      },
      stage1_of_);
  const auto keys2 = distinct_stages(
      candidates,
      [](const Candidate& c) {
        return Candidate{.teeth = {.P2 = c.teeth.P2, .R2 = c.teeth.R2}, .planets = c.planets};
      },
      stage2_of_);
  if (bounds_flanks(spec)) {
    take_flanks(0, keys1);
    take_flanks(1, keys2);
  }
  progress.total = keys1.size() + keys2.size();
  stage1_.resize(keys1.size());
  numerics::parallel_for(keys1.size(), [&](std::size_t k) {
    if (!progress.stop.load(std::memory_order_relaxed)) {
      stage1_[k] = relax1(keys1[k], kUsual, {}, flanks_of(0, k));
    }
    ++progress.done;
  });
  for (const Stage1& stage : stage1_) {
    most_distance_ = std::max(most_distance_, stage.most_distance);
  }
  stage2_.resize(keys2.size());
  numerics::parallel_for(keys2.size(), [&](std::size_t k) {
    if (!progress.stop.load(std::memory_order_relaxed)) {
      stage2_[k] = relax2(keys2[k], kUsual, flanks_of(1, k));
    }
    ++progress.done;
  });
}

SetBounds::Stage1 SetBounds::relax1(const Candidate& key, const Effort& effort,
                                    std::optional<double> sun_weight,
                                    const StageFlanks* flanks) const {
  const Specification& spec = *spec_;
  const StageTasks tasks(spec);
  Stage1 stage;
  const train::ToothSet& z = key.teeth;
  const std::array ranges{&shifts_.of(train::kS, z.S), &shifts_.of(train::kP1, z.P1),
                          &shifts_.of(train::kR1, z.R1)};
  stage.infeasible = worst_of(ranges);
  if (stage.infeasible) return stage;
  const std::array<Interval, 3> shifts{ranges[0]->widest, ranges[1]->widest, ranges[2]->widest};
  const auto task_of = [&](double share) {
    const StageTask task = tasks.stage1(key, shifts, share);
    return flanks != nullptr ? with_flanks(spec, task, *flanks) : task;
  };
  StageTask task = task_of(1.0);
  if (sun_weight) {
    stage.sun_weight = *sun_weight;
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
      if (level + 1 == levels_) {
        stage.infeasible = name_empty_stage(spec, task, 0, effort.weighted);
        // Stage 2 is not to be called empty for a load on stage 1.
        if (stage.infeasible->check == design::CheckId::kFlankSafety) {
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

SetBounds::Reach SetBounds::reach_of(StageTask task, const Effort& effort) {
  Reach reach;
  task.sun_weight = task.ring_weight = 1.0;  // they choose which side of a box is cut
  task.least = StageTask::Least::kDistance;
  reach.least_m = relax_stage(task, effort.weighted).least;
  task.least = StageTask::Least::kInverseDistance;
  const double least = relax_stage(task, effort.alone).least;
  if (least > 0.0) reach.most_m = 1.0 / least;
  return reach;
}

std::optional<Infeasibility> SetBounds::flanks_apart(const Reach& stage1,
                                                     const Reach& stage2) const {
  if (flanks_[0].empty()) return std::nullopt;
  // Distances that flanks ask for rise with the safety.
  const double held = std::min(stage1.most_m / stage2.least_m, stage2.most_m / stage1.least_m);
  if (!(held < 1.0 - kRelaxationSlack)) return std::nullopt;
  const double miss = least_flank_safety_asked(*spec_) * (1.0 - held);
  return Infeasibility{.check = design::CheckId::kFlankSafety, .miss_si = miss, .violation = miss};
}

const StageFlanks* SetBounds::flanks_of(std::size_t stage, std::size_t key) const {
  return flanks_[stage].empty() ? nullptr : &flanks_[stage][key];
}

void SetBounds::take_flanks(std::size_t stage, std::span<const Candidate> keys) {
  const StageTasks tasks(*spec_);
  std::vector<StageTask> of_keys;
  of_keys.reserve(keys.size());
  for (const Candidate& key : keys) {
    const auto z = train::teeth_of(key.teeth);
    const auto widest = [&](int gear) {
      return shifts_.of(gear, z[static_cast<std::size_t>(gear)]).widest;
    };
    of_keys.push_back(
        stage == 0
            ? tasks.stage1(key, {widest(train::kS), widest(train::kP1), widest(train::kR1)}, 1.0)
            : tasks.stage2(key, {widest(train::kP2), widest(train::kR2)}, 1.0, kInfinity));
  }
  flanks_[stage] =
      stage_flanks(*spec_, stage, of_keys, candidates_, stage == 0 ? stage1_of_ : stage2_of_);
}

SetBounds::Stage2 SetBounds::relax2(const Candidate& key, const Effort& effort,
                                    const StageFlanks* flanks) const {
  const StageTasks tasks(*spec_);
  Stage2 stage;
  const train::ToothSet& z = key.teeth;
  const std::array ranges{&shifts_.of(train::kP2, z.P2), &shifts_.of(train::kR2, z.R2)};
  stage.infeasible = worst_of(ranges);
  if (stage.infeasible) return stage;
  const std::array<Interval, 2> shifts{ranges[0]->widest, ranges[1]->widest};
  const auto task_of = [&](double share) {
    const StageTask task = tasks.stage2(key, shifts, share, most_distance_);
    return flanks != nullptr ? with_flanks(*spec_, task, *flanks) : task;
  };
  for (std::size_t level = 0; level < levels_; ++level) {
    Stage2Level& at = stage.level[level];
    const StageTask task = task_of(share_of(level));
    const StageBound bound = relax_stage(task, effort.weighted);
    at.empty = bound.empty;
    if (bound.empty) {
      if (level + 1 == levels_) {
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

double SetBounds::share_of(std::size_t level) const {
  return static_cast<double>(level + 1) / static_cast<double>(levels_);
}

SetBound SetBounds::of(std::size_t k) const {
  if (!has_bounds(*spec_)) {
    SetBound unknown;
    unknown.infeasible = of_any_set_;
    const auto z = train::teeth_of(candidates_[k].teeth);
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      const auto& infeasible = shifts_.of(static_cast<int>(i), z[i]).infeasible;
      if (infeasible && !unknown.infeasible) unknown.infeasible = infeasible;
    }
    return unknown;
  }
  return combine(k, stage1_[stage1_of_[k]], stage2_[stage2_of_[k]]);
}

SetBound SetBounds::sharpened(std::size_t k) const {
  const SetBound usual = of(k);
  if (usual.infeasible || !usual.known) return usual;
  const train::ToothSet& z = candidates_[k].teeth;
  const bool forward = first_objective(*spec_) == Objective::kForwardEfficiency;
  const auto w =
      loss_weights(train::g1(z), train::g2(z),
                   {1.0 - usual.losses[0], 1.0 - usual.losses[1], 1.0 - usual.losses[2]}, forward);
  const int planets = candidates_[k].planets;
  const std::optional<double> weight =
      w[0] > 0.0 && w[1] > 0.0 ? std::optional(w[0] / w[1]) : std::nullopt;
  SetBound sharp = combine(k,
                           relax1({.teeth = {.S = z.S, .P1 = z.P1, .R1 = z.R1}, .planets = planets},
                                  kSharp, weight, flanks_of(0, stage1_of_[k])),
                           relax2({.teeth = {.P2 = z.P2, .R2 = z.R2}, .planets = planets}, kSharp,
                                  flanks_of(1, stage2_of_[k])));
  sharp.eta_b = std::min(sharp.eta_b, usual.eta_b);
  sharp.eta_f = std::min(sharp.eta_f, usual.eta_f);
  return sharp;
}

SetBound SetBounds::combine(std::size_t k, const Stage1& stage1, const Stage2& stage2) const {
  SetBound bound;
  bound.known = true;
  bound.infeasible = stage1.infeasible;
  if (stage2.infeasible &&
      (!stage1.infeasible || blocks_more(*stage2.infeasible, *stage1.infeasible))) {
    bound.infeasible = stage2.infeasible;
  }
  if (of_any_set_) bound.infeasible = of_any_set_;
  const bool apart = stage1.distance.hi < stage2.distance.lo - kRelaxationSlack ||
                     stage2.distance.hi < stage1.distance.lo - kRelaxationSlack;
  if (!bound.infeasible && has_same_module(*spec_) && apart) {
    bound.infeasible = Infeasibility{.check = design::CheckId::kSameModule, .alone = false};
  }
  if (!bound.infeasible) bound.infeasible = flanks_apart(stage1.reach, stage2.reach);
  if (bound.infeasible) {
    bound.eta_b = bound.eta_f = 0.0;
    return bound;
  }
  const train::ToothSet& z = candidates_[k].teeth;
  const bool forward = first_objective(*spec_) == Objective::kForwardEfficiency;
  bound.eta_b = bound.eta_f = 0.0;
  double best = -1.0;
  // Stage 1 has at most the share of its level, stage 2 what the level below leaves.
  for (std::size_t level = 0; level < levels_; ++level) {
    const Stage1Level& first = stage1.level[level];
    const Stage2Level& second = stage2.level[levels_ - 1 - level];
    if (first.empty || second.empty) continue;
    const LossRegion region{.sun = first.sun,
                            .ring = first.ring,
                            .weighted = first.weighted,
                            .sun_weight = stage1.sun_weight};
    const double eta_b = most_backward(z, region, second.ring);
    const double eta_f = most_forward(z, region, second.ring);
    bound.eta_b = std::max(bound.eta_b, eta_b);
    bound.eta_f = std::max(bound.eta_f, eta_f);
    const double value = forward ? eta_f : eta_b;
    if (value > best) {
      best = value;
      bound.stage1 = first.point;
      bound.stage2 = second.point;
      bound.losses = {first.sun,
                      std::max(first.ring, first.weighted - stage1.sun_weight * first.sun),
                      second.ring};
    }
  }
  if (best < 0.0) {
    bound.infeasible = Infeasibility{.check = design::CheckId::kOutputBacklashMax};
  }
  return bound;
}

}  // namespace gear3k::optimize
