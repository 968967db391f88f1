#include "optimize/set_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "efficiency/train_efficiency.hpp"
#include "optimize/parallel.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A feasible design may miss a limit by kFeasibilityTolerance of its scale; bounds allow for it.
constexpr double kFeasibilitySlack = 2.0 * design::kFeasibilityTolerance;
constexpr double kGreatestAngle_rad = 80.0 * std::numbers::pi / 180.0;

/// Least loss of a mesh over that of the first-order model with the design's coefficient.
///
/// Path models: the loss of a pair at a point is the first-order one over 1 − σ μ ρ_d/r_bd, at
/// least that over 1 + μ ρ_d/r_bd.  Factors on a first-order model add the difference of two such
/// losses, which may be negative even where no factor is below 1.
/// Source: own derivation, docs/theory.md §32.
double least_friction(const Specification& spec, bool forward) {
  const auto flank = efficiency::constant_friction<double>(spec.friction, forward);
  const double mu = std::max(0.0, flank.coefficient);
  const double approach = flank.approach_factor;
  const double recess = flank.recess_factor;
  const double least = std::min(approach, recess);
  const double most = std::max(approach, recess);
  // ρ_d/r_bd ≤ tan α_a of an external driver; on a driving ring at most tan α_w or that.
  const double lever = std::tan(65.0 * std::numbers::pi / 180.0) + 6.0 * std::numbers::pi / 5.0;
  const bool path = spec.friction.model == efficiency::LossModel::kCoulombPath ||
                    spec.friction.model == efficiency::LossModel::kDirectional;
  if (path) return mu * least / (1.0 + mu * most * lever);
  if (mu * lever * std::max(1.0, approach) >= 1.0) {
    return approach == 1.0 && recess == 1.0 ? mu : 0.0;
  }
  // Loss ≥ first order · (1 + least/u − 1/u_1), u and u_1 the driving torques with the factors and
  // without, u/u_1 ≤ 1 + change.
  const double change =
      mu * lever * std::max(std::abs(1.0 - approach), recess - 1.0) / (1.0 - mu * lever);
  const double lacking = 1.0 + change - least;
  if (lacking <= 0.0) return mu;
  return mu * std::max(0.0, 1.0 - lacking / (1.0 - mu * lever * approach));
}

/// Everything that the stages' tasks take from a specification.
class TaskMaker {
 public:
  explicit TaskMaker(const Specification& spec) : spec_(spec) {
    module_ = {module_range(spec.module[0]), module_range(spec.module[1])};
    const double forward = least_friction(spec, true);
    const double backward = least_friction(spec, false);
    friction_ = std::min(forward, backward);
    const double tolerance = spec.ratio.tolerance;
    ratio_ = {std::abs(spec.ratio.target) * (1.0 - tolerance),
              std::abs(spec.ratio.target) * (1.0 + tolerance)};
    const auto& most = spec.limits[CheckId::kOutputBacklashMax];
    if (most) budget_ = *most + kFeasibilitySlack * std::max(*most, 1e-3);
    if (budget_ < kInfinity) {
      // A mesh that may interfere gives the others room.
      const Interval j1 = backlash_floor(0);
      const Interval j2 = backlash_floor(1);
      const double cosine = std::cos(spec.pressure_angle_rad);
      const auto give = [&](double j, double base) { budget_ -= std::min(0.0, j) / base; };
      give(j1.lo, 0.5 * cosine * spec.teeth.S.min * ratio_.lo);
      give(2.0 * j1.lo, 0.5 * cosine * (spec.teeth.P1.min + spec.teeth.min_internal_difference));
      give(j2.lo, 0.5 * cosine * (spec.teeth.P2.min + spec.teeth.min_internal_difference));
    }
  }

  [[nodiscard]] bool shares_lost_motion() const {
    return budget_ < kInfinity && spec_.limits.model == backlash::LostMotionModel::kKinematic;
  }

  [[nodiscard]] StageTask stage1(const Candidate& c, const std::array<Interval, 3>& shifts,
                                 double share) const {
    StageTask task = common(c, train::kP1, train::kR1, shifts[1], shifts[2]);
    task.sun = gear(train::kS, c.teeth.S, shifts[0]);
    task.sun_khk_tip = spec_.khk_tip[train::kS];
    task.planet_khk_tip = spec_.khk_tip[train::kP1];
    task.sun_loss = loss(1.0 / c.teeth.S + 1.0 / c.teeth.P1);
    task.sun_backlash = {backlash_floor(0).lo, kInfinity};
    if (budget_ < kInfinity) {
      // S-P1: j1/(|i| r_bS); P1-R1: (1 − 1/i) j2/r_bR1 kinematically, j2/r_bR1 in the paper's.
      const double half_cos = 0.5 * std::cos(spec_.pressure_angle_rad);
      task.sun_backlash.hi = share * budget_ * ratio_.hi * half_cos * c.teeth.S;
      const bool kinematic = spec_.limits.model == backlash::LostMotionModel::kKinematic;
      const double least_factor =
          !kinematic ? 1.0 : 1.0 + (spec_.ratio.target > 0.0 ? -1.0 / ratio_.lo : 1.0 / ratio_.hi);
      task.ring_backlash.hi =
          least_factor > 0.0 ? share * budget_ * half_cos * c.teeth.R1 / least_factor : kInfinity;
      task.lost_motion = {.sun = 1.0 / (ratio_.hi * half_cos * c.teeth.S),
                          .ring = std::max(least_factor, 1e-6) / (half_cos * c.teeth.R1),
                          .most = share * budget_};
    }
    if (const auto& gap = spec_.limits[CheckId::kPlanetGap]; gap && c.planets > 1) {
      task.planet_gap = {.half_spacing = std::sin(std::numbers::pi / c.planets),
                         .half_gap = 0.5 * (*gap - kFeasibilitySlack)};
    }
    return task;
  }

  /// @param most_distance  greatest centre distance of any stage 1, in its modules
  [[nodiscard]] StageTask stage2(const Candidate& c, const std::array<Interval, 2>& shifts,
                                 double share, double most_distance) const {
    StageTask task = common(c, train::kP2, train::kR2, shifts[0], shifts[1]);
    if (budget_ < kInfinity) {
      const double half_cos = 0.5 * std::cos(spec_.pressure_angle_rad);
      task.ring_backlash.hi = share * budget_ * half_cos * c.teeth.R2;
    }
    if (const auto& gap = spec_.limits[CheckId::kPlanetGap]; gap && c.planets > 1) {
      // The gap is in modules of stage 1: m1/m2 = d2/d1, d1 at most most_distance.
      const double spacing = std::sin(std::numbers::pi / c.planets);
      const double least = *gap - kFeasibilitySlack;
      task.planet_gap = {
          .half_spacing = least > 0.0 ? spacing - 0.5 * least / most_distance : spacing,
          .half_gap = least > 0.0 ? 0.0 : 0.5 * least * module_[0].hi / module_[1].lo};
    }
    return task;
  }

 private:
  [[nodiscard]] double loss(double teeth) const { return friction_ * std::numbers::pi * teeth; }

  [[nodiscard]] StageGear gear(int id, int teeth, const Interval& shift) const {
    const auto i = static_cast<std::size_t>(id);
    const bool ring = train::kind_of(id) == geometry::GearKind::kRing;
    const double stated = spec_.khk_tip[i] ? 0.0 : spec_.tip_shortening[i];
    const NumberRange shortening =
        spec_.free.tip_shortening.value_or(NumberRange{.min = stated, .max = stated});
    const Interval tip{spec_.rack.addendum - shortening.max, spec_.rack.addendum - shortening.min};
    return {.teeth = teeth,
            .profile_shift = shift,
            .tip_height = ring ? Interval{-tip.hi, -tip.lo} : tip,
            .root_height = ring ? spec_.rack.dedendum : -spec_.rack.dedendum,
            .machining_allowance = spec_.machining_allowance[i]};
  }

  /// Least normal backlash of a stage's meshes, in its modules.
  [[nodiscard]] Interval backlash_floor(std::size_t stage) const {
    const auto& limit = spec_.limits[CheckId::kNormalBacklash];
    if (!limit) return {-kInfinity, kInfinity};
    // Feasible means within kFeasibilityTolerance of the scale, which is a module of stage 1.
    const double slack = design::kFeasibilityTolerance * length_scale_m(spec_);
    const double least = *limit - slack;
    return {least / (least > 0.0 ? module_[stage].hi : module_[stage].lo), kInfinity};
  }

  [[nodiscard]] StageTask common(const Candidate& c, int planet, int ring, const Interval& planet_x,
                                 const Interval& ring_x) const {
    const auto z = train::teeth_of(c.teeth);
    const int z_planet = z[static_cast<std::size_t>(planet)];
    const int z_ring = z[static_cast<std::size_t>(ring)];
    constexpr double kSlack = kFeasibilitySlack;
    const auto limit = [&](CheckId id, double none) {
      return spec_.limits[id] ? *spec_.limits[id] : none;
    };
    const auto relaxed = [&](CheckId id) -> std::optional<double> {
      if (!spec_.limits[id]) return std::nullopt;
      return *spec_.limits[id] - kSlack;
    };
    return {.planet = gear(planet, z_planet, planet_x),
            .ring = gear(ring, z_ring, ring_x),
            .sun = std::nullopt,
            .pressure_angle_rad = spec_.pressure_angle_rad,
            .greatest_angle_rad = kGreatestAngle_rad,
            .sun_backlash = {-kInfinity, kInfinity},
            .ring_backlash = backlash_floor(planet == train::kP1 ? 0 : 1),
            .lost_motion = std::nullopt,
            .contact_ratio = {limit(CheckId::kContactRatioMin, -kInfinity) - kSlack,
                              limit(CheckId::kContactRatioMax, kInfinity) + kSlack},
            .interference = relaxed(CheckId::kInvoluteInterference),
            .root_clearance = relaxed(CheckId::kRootClearance),
            .planet_gap = std::nullopt,
            .sliding = spec_.friction.model != efficiency::LossModel::kOhlendorf,
            .sun_loss = 0.0,
            .ring_loss = loss(1.0 / z_planet - 1.0 / z_ring)};
  }

  const Specification& spec_;
  std::array<Interval, 2> module_;
  Interval ratio_{};
  double friction_ = 0.0;
  double budget_ = kInfinity;  ///< of the lost motion, for the meshes of one stage [rad]
};

}  // namespace

namespace {

/// Losses of S-P1, P1-R1, P2-R2.
using Losses = std::array<double, train::kMeshCount>;

double efficiency_at(const train::ToothSet& z, const Losses& loss, bool forward) {
  const efficiency::MeshEfficiencies<double> eta{1.0 - loss[0], 1.0 - loss[1], 1.0 - loss[2]};
  if (std::ranges::any_of(eta, [](double e) { return !(e > 0.0); })) return 0.0;
  if (forward) return std::max(0.0, efficiency::forward_efficiency(z, eta));
  if (efficiency::backdriving_margin(z, eta) <= 0.0) return 0.0;
  return std::max(0.0, efficiency::backward_efficiency(z, eta));
}

/// −∂ ln η/∂(loss of S-P1) and of P1-R1, for mesh efficiencies.
std::array<double, 2> loss_weights(double g1, double g2,
                                   const efficiency::MeshEfficiencies<double>& eta, bool forward) {
  const auto& [e1, e2, e3] = eta;
  if (forward && g2 < 1.0) {
    const double top = 1.0 + g1 * e1 * e2;
    return {g1 * e2 / top, g1 * e1 / top + g2 * e3 / (1.0 - g2 * e2 * e3)};
  }
  if (forward) {
    const double top = e2 + g1 * e1;
    return {g1 / top, 1.0 / top + e3 / (g2 - e2 * e3)};
  }
  if (g2 < 1.0) {
    const double bottom = g1 + e1 * e2;
    return {1.0 / e1 - e2 / bottom, 1.0 / (e2 - g2 / e3) - e1 / bottom};
  }
  const double bottom = e1 + g1 * e2;
  return {1.0 / e1 - 1.0 / bottom, g2 * e3 / (g2 * e2 * e3 - 1.0) - g1 / bottom};
}

/// The losses of stage 1's meshes: each at least so much, and sun_weight · sun + ring ≥ weighted.
struct LossRegion {
  double sun = 0.0, ring = 0.0, weighted = 0.0, sun_weight = 1.0;
};

/// Greatest backward efficiency over a region: 1/η_b is convex in the losses (docs/theory.md §32),
/// so that tangents bound it along the edge.
double most_backward(const train::ToothSet& z, const LossRegion& r, double stage2) {
  const double corner_ring = r.weighted - r.sun_weight * r.sun;
  if (corner_ring <= r.ring) return efficiency_at(z, {r.sun, r.ring, stage2}, false);
  const auto at = [&](double sun) { return Losses{sun, r.weighted - r.sun_weight * sun, stage2}; };
  struct Tangent {
    double sun, value, slope;  // 1/η and its derivative along the edge
  };
  const auto tangent = [&](double sun) -> std::optional<Tangent> {
    const double eta = efficiency_at(z, at(sun), false);
    if (!(eta > 0.0)) return std::nullopt;
    const Losses loss = at(sun);
    const auto w = loss_weights(train::g1(z), train::g2(z),
                                {1.0 - loss[0], 1.0 - loss[1], 1.0 - loss[2]}, false);
    return Tangent{sun, 1.0 / eta, (w[0] - r.sun_weight * w[1]) / eta};
  };
  const double last = (r.weighted - r.ring) / r.sun_weight;
  auto a = tangent(r.sun);
  auto b = tangent(last);
  // Off the region where the train runs backwards, the corner of both.
  if (!a || !b) return efficiency_at(z, {r.sun, r.ring, stage2}, false);
  if (a->slope >= 0.0) return 1.0 / a->value;
  if (b->slope <= 0.0) return 1.0 / b->value;
  for (int k = 0; k < 6; ++k) {
    const auto middle = tangent(0.5 * (a->sun + b->sun));
    if (!middle) break;
    (middle->slope < 0.0 ? a : b) = middle;
  }
  const double crossing =
      (b->value - a->value - b->slope * b->sun + a->slope * a->sun) / (a->slope - b->slope);
  return 1.0 / (a->value + a->slope * (crossing - a->sun));
}

/// Greatest forward efficiency over a region: ln η_f is convex in λ = −ln(1 − loss), in which the
/// region's cuts hold too, so that it is greatest in a corner.
double most_forward(const train::ToothSet& z, const LossRegion& r, double stage2) {
  const auto log_of = [](double loss) { return -std::log1p(-std::min(loss, 1.0 - 1e-12)); };
  const auto loss_of = [](double lambda) { return -std::expm1(-lambda); };
  const double sun = log_of(r.sun), ring = log_of(r.ring);
  if (r.weighted <= r.sun_weight * sun + ring) {
    return efficiency_at(z, {r.sun, r.ring, stage2}, true);
  }
  const double other_ring = loss_of(r.weighted - r.sun_weight * sun);
  const double other_sun = loss_of((r.weighted - ring) / r.sun_weight);
  return std::max(efficiency_at(z, {r.sun, other_ring, stage2}, true),
                  efficiency_at(z, {other_sun, r.ring, stage2}, true));
}

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

/// Checks that an empty stage may be owed to, in the order in which they are tried.
constexpr std::array<CheckId, 7> kStageChecks{
    CheckId::kContactRatioMin,      CheckId::kOutputBacklashMax, CheckId::kNormalBacklash,
    CheckId::kInvoluteInterference, CheckId::kPlanetGap,         CheckId::kRootClearance,
    CheckId::kContactRatioMax};

/// The task with a check's limit given way by an amount, in its own unit but for the backlash:
/// normal backlash in modules, lost motion in modules of the ring mesh's backlash.
StageTask without(StageTask task, CheckId check, double amount) {
  switch (check) {
    case CheckId::kContactRatioMin:
      task.contact_ratio.lo -= amount;
      break;
    case CheckId::kContactRatioMax:
      task.contact_ratio.hi += amount;
      break;
    case CheckId::kOutputBacklashMax:
      task.ring_backlash.hi += amount;
      if (task.lost_motion) {
        task.lost_motion->most += amount * task.lost_motion->ring;
        task.sun_backlash.hi += amount * task.lost_motion->ring / task.lost_motion->sun;
      }
      break;
    case CheckId::kNormalBacklash:
      task.ring_backlash.lo -= amount;
      task.sun_backlash.lo -= amount;
      break;
    case CheckId::kInvoluteInterference:
      if (task.interference) *task.interference -= amount;
      break;
    case CheckId::kRootClearance:
      if (task.root_clearance) *task.root_clearance -= amount;
      break;
    case CheckId::kPlanetGap:
      if (task.planet_gap) task.planet_gap->half_gap -= 0.5 * amount;
      break;
    default:
      break;
  }
  return task;
}

/// An amount in SI and scaled to order 1.
struct Amount {
  double si, scaled;
};

/// @param stage  0 or 1
Amount amount_of(const Specification& spec, const StageTask& task, CheckId check, double amount,
                 std::size_t stage) {
  switch (check) {
    case CheckId::kNormalBacklash: {
      const double length = amount * module_range(spec.module[stage]).lo;
      return {length, length / length_scale_m(spec)};
    }
    case CheckId::kOutputBacklashMax: {
      const double half_cos = 0.5 * std::cos(spec.pressure_angle_rad);
      // The shares of the ring meshes are at most 1/r_b of their rings, §8.
      const double angle =
          amount * (task.lost_motion ? task.lost_motion->ring : 1.0 / (half_cos * task.ring.teeth));
      const double limit = spec.limits[check].value_or(0.0);
      return {angle, limit > 0.0 ? angle / limit : angle};
    }
    case CheckId::kPlanetGap: {
      // In modules of stage 1.
      const double gap =
          stage == 0 ? amount
                     : amount * module_range(spec.module[1]).lo / module_range(spec.module[0]).hi;
      return {gap, gap};
    }
    default:
      return {amount, amount};
  }
}

/// Names the check that empties a stage alone, the first of kStageChecks, and the amount that it
/// has to give way at least; else the last of those that empty it together.
/// @param amount_of  of an amount as without() takes it
template <class AmountOf>
Infeasibility name_empty_stage(const StageTask& task, const StageEffort& effort,
                               AmountOf amount_of) {
  constexpr double kDropped = 1e3;
  const auto empty_without = [&](const StageTask& t, CheckId check, double amount) {
    return relax_stage(without(t, check, amount), effort).empty;
  };
  for (const CheckId check : kStageChecks) {
    if (empty_without(task, check, kDropped)) continue;
    double proven = 0.0;  // still empty with so much
    for (double step = 0.5; step > 1e-4; step *= 0.5) {
      if (empty_without(task, check, proven + step)) proven += step;
    }
    const Amount amount = amount_of(check, proven);
    return {.check = check, .miss_si = amount.si, .violation = amount.scaled};
  }
  StageTask rest = task;
  for (const CheckId check : kStageChecks) {
    rest = without(rest, check, kDropped);
    if (!relax_stage(rest, effort).empty) return {.check = check, .alone = false};
  }
  // The shifts' range itself: undercut, thin tips and the stated range.
  return {.check = CheckId::kUndercut, .alone = false};
}

}  // namespace

SetBounds::SetBounds(const Specification& spec, std::span<const Candidate> candidates,
                     Progress& progress)
    : spec_(&spec), candidates_(candidates), shifts_(spec, candidates) {
  if (!has_bounds(spec)) return;
  levels_ = TaskMaker(spec).shares_lost_motion() ? kMostLevels : 1;
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
  progress.total = keys1.size() + keys2.size();
  stage1_.resize(keys1.size());
  parallel_for(keys1.size(), [&](std::size_t k) {
    if (!progress.stop.load(std::memory_order_relaxed)) stage1_[k] = relax1(keys1[k], kUsual, {});
    ++progress.done;
  });
  for (const Stage1& stage : stage1_) {
    most_distance_ = std::max(most_distance_, stage.most_distance);
  }
  stage2_.resize(keys2.size());
  parallel_for(keys2.size(), [&](std::size_t k) {
    if (!progress.stop.load(std::memory_order_relaxed)) stage2_[k] = relax2(keys2[k], kUsual);
    ++progress.done;
  });
}

SetBounds::Stage1 SetBounds::relax1(const Candidate& key, const Effort& effort,
                                    std::optional<double> sun_weight) const {
  const Specification& spec = *spec_;
  const TaskMaker maker(spec);
  Stage1 stage;
  const train::ToothSet& z = key.teeth;
  const std::array ranges{&shifts_.of(train::kS, z.S), &shifts_.of(train::kP1, z.P1),
                          &shifts_.of(train::kR1, z.R1)};
  stage.infeasible = worst_of(ranges);
  if (stage.infeasible) return stage;
  const std::array<Interval, 3> shifts{ranges[0]->widest, ranges[1]->widest, ranges[2]->widest};
  StageTask task = maker.stage1(key, shifts, 1.0);
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
    task = maker.stage1(key, shifts, share_of(level));
    task.sun_weight = stage.sun_weight;
    task.ring_weight = 1.0;
    const StageBound bound = relax_stage(task, effort.weighted);
    at.empty = bound.empty;
    if (bound.empty) {
      if (level + 1 == levels_)
        stage.infeasible = name_empty_stage(
            task, effort.weighted,
            [&](CheckId check, double amount) { return amount_of(spec, task, check, amount, 0); });
      continue;
    }
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
  return stage;
}

SetBounds::Stage2 SetBounds::relax2(const Candidate& key, const Effort& effort) const {
  const TaskMaker maker(*spec_);
  Stage2 stage;
  const train::ToothSet& z = key.teeth;
  const std::array ranges{&shifts_.of(train::kP2, z.P2), &shifts_.of(train::kR2, z.R2)};
  stage.infeasible = worst_of(ranges);
  if (stage.infeasible) return stage;
  const std::array<Interval, 2> shifts{ranges[0]->widest, ranges[1]->widest};
  for (std::size_t level = 0; level < levels_; ++level) {
    Stage2Level& at = stage.level[level];
    const StageTask task = maker.stage2(key, shifts, share_of(level), most_distance_);
    const StageBound bound = relax_stage(task, effort.weighted);
    at.empty = bound.empty;
    if (bound.empty) {
      if (level + 1 == levels_)
        stage.infeasible =
            name_empty_stage(task, effort.weighted, [&](CheckId check, double amount) {
              return amount_of(*spec_, task, check, amount, 1);
            });
      continue;
    }
    at.ring = bound.least;
    at.point = bound.point;
  }
  return stage;
}

double SetBounds::share_of(std::size_t level) const {
  return static_cast<double>(level + 1) / static_cast<double>(levels_);
}

SetBound SetBounds::of(std::size_t k) const {
  if (!has_bounds(*spec_)) {
    SetBound unknown;
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
  SetBound sharp = combine(
      k, relax1({.teeth = {.S = z.S, .P1 = z.P1, .R1 = z.R1}, .planets = planets}, kSharp, weight),
      relax2({.teeth = {.P2 = z.P2, .R2 = z.R2}, .planets = planets}, kSharp));
  sharp.eta_b = std::min(sharp.eta_b, usual.eta_b);
  sharp.eta_f = std::min(sharp.eta_f, usual.eta_f);
  return sharp;
}

SetBound SetBounds::combine(std::size_t k, const Stage1& stage1, const Stage2& stage2) const {
  SetBound bound;
  bound.known = true;
  bound.infeasible = stage1.infeasible;
  if (stage2.infeasible &&
      (!stage1.infeasible || stage2.infeasible->violation > stage1.infeasible->violation)) {
    bound.infeasible = stage2.infeasible;
  }
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
