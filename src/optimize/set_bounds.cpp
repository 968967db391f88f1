#include "optimize/set_bounds.hpp"

#include <algorithm>

#include "numerics/parallel.hpp"
#include "optimize/efficiency_bound.hpp"
#include "optimize/empty_stage.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/stage_tasks.hpp"

namespace gear3k::optimize {

namespace {

/// Whether a proof is named rather than another: what blocks without a load first, then what is
/// missed by more.
bool blocks_more(const Infeasibility& proof, const Infeasibility& other) {
  const bool loaded = is_load(proof.check);
  if (loaded != is_load(other.check)) return !loaded;
  return proof.violation > other.violation;
}

/// Proof that the length along the axis, which at the least face widths is the same for every tooth
/// set, is too much.
std::optional<Infeasibility> too_long(const Specification& spec) {
  const auto& most = spec.limits[design::CheckId::kGearboxLength];
  if (!most) return std::nullopt;
  const auto widths = least_face_widths_m(spec);
  if (!train::whole_extent(spec.axial) && !(widths[0] > 0.0 && widths[1] > 0.0)) {
    return std::nullopt;
  }
  const double length = train::whole_length_m(spec.axial, widths);
  const double scale = *most > 0.0 ? *most : length_scale_m(spec);
  const double excess = length - *most;
  if (excess <= design::kFeasibilitySlack * scale) return std::nullopt;
  return Infeasibility{
      .check = design::CheckId::kGearboxLength, .miss_si = excess, .violation = excess / scale};
}

/// Proof that the least backlash of the meshes at the greatest modules, which a limit of size
/// leaves, is more lost motion than is allowed.
std::optional<Infeasibility> too_much_lost_motion(const Specification& spec, const Candidate& set) {
  const auto& most = spec.limits[design::CheckId::kOutputBacklashMax];
  if (!most || !(*most > 0.0)) return std::nullopt;
  const double excess = best_value(Objective::kLostMotion, spec, set.teeth, set.planets) - *most;
  if (!(excess > design::kFeasibilitySlack * std::max(*most, 1e-3))) return std::nullopt;
  return Infeasibility{.check = design::CheckId::kOutputBacklashMax,
                       .miss_si = excess,
                       .violation = excess / *most,
                       .alone = false};
}

}  // namespace

SetBounds::SetBounds(const Specification& spec, std::span<const Candidate> candidates,
                     Progress& progress)
    : spec_(&spec),
      candidates_(candidates),
      keys_(stage_keys(candidates)),
      relaxer_(spec, keys_, candidates),
      of_any_set_(too_long(spec)) {
  if (!has_bounds(spec)) return;
  progress.sets = candidates.size();
  progress.first_stages = keys_.keys[0].size();
  progress.second_stages = keys_.keys[1].size();
  progress.empty_first = progress.empty_second = 0;
  progress.total = keys_.keys[0].size() + keys_.keys[1].size();
  // Nobody asks what blocks a set within the limits of a front.
  const StageRelaxer::Ask ask{.effort = kUsual, .named = spec.objective_limits.empty()};
  stage1_.resize(keys_.keys[0].size());
  numerics::parallel_for(stage1_.size(), [&](std::size_t k) {
    if (!progress.stop.load(std::memory_order_relaxed)) {
      stage1_[k] = relaxer_.relax1(k, ask);
      if (stage1_[k].infeasible) ++progress.empty_first;
    }
    ++progress.done;
  });
  for (const RelaxedStage1& stage : stage1_) {
    most_distance_ = std::max(most_distance_, stage.most_distance);
  }
  stage2_.resize(keys_.keys[1].size());
  numerics::parallel_for(stage2_.size(), [&](std::size_t k) {
    if (!progress.stop.load(std::memory_order_relaxed)) {
      stage2_[k] = relaxer_.relax2(k, ask, most_distance_);
      if (stage2_[k].infeasible) ++progress.empty_second;
    }
    ++progress.done;
  });
  if (ModulePairs::ties(spec) && !candidates.empty()) {
    pairs_ = std::make_unique<ModulePairs>(spec, candidates, keys_, stage1_, stage2_);
    tied_.resize(candidates.size());
  }
}

bool SetBounds::tie(std::span<const std::uint32_t> sets, Progress& progress, bool counted) {
  if (!pairs_) return true;
  std::vector<std::uint32_t> open;
  open.reserve(sets.size());
  for (const std::uint32_t k : sets) {
    if (!tied_[k].known && !untied(k).infeasible) open.push_back(k);
  }
  if (!pairs_->prepare(open, most_distance_, progress, counted)) return false;
  numerics::parallel_for(open.size(),
                         [&](std::size_t i) { tied_[open[i]] = pairs_->bound(open[i]); });
  return true;
}

std::optional<Infeasibility> SetBounds::loads_apart(const StageReach& stage1,
                                                    const StageReach& stage2) const {
  const bool of_roots = bounds_roots(*spec_);
  if (!of_roots && !bounds_flanks(*spec_)) return std::nullopt;
  // Distances that flanks ask for rise with the safety, those of roots with its square root.
  const double held1 = stage2.most_m / stage1.least_m;
  const double held2 = stage1.most_m / stage2.least_m;
  const double held = std::min(held1, held2);
  if (!(held < 1.0 - kRelaxationSlack)) return std::nullopt;
  const bool by_root = held1 < held2 ? stage1.by_root : stage2.by_root;
  const double miss = by_root ? least_root_safety_asked(*spec_) * (1.0 - held * held)
                              : least_flank_safety_asked(*spec_) * (1.0 - held);
  return Infeasibility{
      .check = by_root ? design::CheckId::kRootSafety : design::CheckId::kFlankSafety,
      .miss_si = miss,
      .violation = miss,
      .alone = !of_roots};
}

SetBound SetBounds::of(std::size_t k) const {
  SetBound bound = untied(k);
  if (!tied_.empty() && tied_[k].known && !bound.infeasible) {
    bound.infeasible = tied_[k].infeasible;
    bound.eta_b = std::min(bound.eta_b, tied_[k].eta_b);
    bound.eta_f = std::min(bound.eta_f, tied_[k].eta_f);
  }
  refuse_felt(k, bound);
  return bound;
}

void SetBounds::refuse_felt(std::size_t k, SetBound& bound) const {
  if (!spec_->felt || bound.infeasible) return;
  // Without the gears' inertia, which only adds to what is felt.
  const FeltGearbox<double> best{
      .ratio = train::ratio(candidates_[k].teeth), .forward = bound.eta_f, .backward = bound.eta_b};
  for (const FeltLimit& limit : spec_->felt->limits) {
    const double violation = -felt_margin(*spec_->felt, limit, best);
    if (violation <= design::kFeasibilitySlack) continue;
    if (bound.infeasible && bound.infeasible->violation >= violation) continue;
    // With efficiencies of 1 the ratio alone is too great.
    bound.infeasible = Infeasibility{.miss_si = felt_miss(*spec_->felt, limit, violation),
                                     .violation = violation,
                                     .alone = !bound.known,
                                     .felt = limit.quantity};
  }
  if (bound.infeasible) bound.eta_b = bound.eta_f = 0.0;
}

SetBound SetBounds::untied(std::size_t k) const {
  if (!has_bounds(*spec_)) {
    SetBound unknown;
    unknown.infeasible = of_any_set_;
    const auto z = train::teeth_of(candidates_[k].teeth);
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      const auto& infeasible = shifts().of(static_cast<int>(i), z[i]).infeasible;
      if (infeasible && !unknown.infeasible) unknown.infeasible = infeasible;
    }
    return unknown;
  }
  return combine(k, stage1_[keys_.of[0][k]], stage2_[keys_.of[1][k]]);
}

std::vector<ModuleBound> SetBounds::by_modules(std::size_t k) const {
  const SetBound bound = of(k);
  if (!pairs_ || !tied_[k].known || bound.infeasible)
    return {{.pair = std::nullopt, .bound = bound}};
  std::vector<ModuleBound> pairs = pairs_->in_order(k);
  for (ModuleBound& pair : pairs) {
    pair.bound.eta_b = std::min(pair.bound.eta_b, bound.eta_b);
    pair.bound.eta_f = std::min(pair.bound.eta_f, bound.eta_f);
  }
  return pairs;
}

SetBound SetBounds::sharpened(std::size_t k, double enough) const {
  const SetBound usual = of(k);
  if (usual.infeasible || !usual.known) return usual;
  SetBound sharp = pairs_ ? pairs_->sharpened(k, enough) : sharpened_untied(k, usual);
  sharp.eta_b = std::min(sharp.eta_b, usual.eta_b);
  sharp.eta_f = std::min(sharp.eta_f, usual.eta_f);
  return sharp;
}

SetBound SetBounds::sharpened_untied(std::size_t k, const SetBound& usual) const {
  const train::ToothSet& z = candidates_[k].teeth;
  const bool forward = first_objective(*spec_) == Objective::kForwardEfficiency;
  const auto w =
      loss_weights(train::g1(z), train::g2(z),
                   {1.0 - usual.losses[0], 1.0 - usual.losses[1], 1.0 - usual.losses[2]}, forward);
  const std::optional<double> weight =
      w[0] > 0.0 && w[1] > 0.0 ? std::optional(w[0] / w[1]) : std::nullopt;
  return combine(k, relaxer_.relax1(keys_.of[0][k], {.effort = kSharp, .sun_weight = weight}),
                 relaxer_.relax2(keys_.of[1][k], {.effort = kSharp}, most_distance_));
}

SetBound SetBounds::combine(std::size_t k, const RelaxedStage1& stage1,
                            const RelaxedStage2& stage2) const {
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
  if (!bound.infeasible) bound.infeasible = loads_apart(stage1.reach, stage2.reach);
  if (!bound.infeasible) bound.infeasible = too_much_lost_motion(*spec_, candidates_[k]);
  if (bound.infeasible) {
    bound.eta_b = bound.eta_f = 0.0;
    return bound;
  }
  const bool forward = first_objective(*spec_) == Objective::kForwardEfficiency;
  if (!take_best_level(candidates_[k].teeth, stage1, stage2, relaxer_.levels(), forward, bound)) {
    bound.infeasible = Infeasibility{.check = design::CheckId::kOutputBacklashMax};
  }
  return bound;
}

}  // namespace gear3k::optimize
