#include "optimize/stage_tasks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "efficiency/friction_law.hpp"
#include "geometry/sliding.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

constexpr double kGreatestWorkingAngle_rad = 80.0 * std::numbers::pi / 180.0;

/// least_friction() of one mesh.
double least_flank_friction(const efficiency::FlankFriction<double>& flank,
                            efficiency::LossModel model) {
  const double mu = std::max(0.0, flank.coefficient);
  const double approach = flank.approach_factor;
  const double recess = flank.recess_factor;
  const double least = std::min(approach, recess);
  const double most = std::max(approach, recess);
  // ρ_d/r_bd ≤ tan α_a of an external driver; on a driving ring at most tan α_w or that.
  const double lever = std::tan(65.0 * std::numbers::pi / 180.0) + 6.0 * std::numbers::pi / 5.0;
  const bool path =
      model == efficiency::LossModel::kCoulombPath || model == efficiency::LossModel::kDirectional;
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

}  // namespace

double least_friction(const Specification& spec, bool forward) {
  double least = kInfinity;
  for (const auto& flank : efficiency::constant_frictions(spec.friction, forward)) {
    least = std::min(least, least_flank_friction(flank, spec.friction.model));
  }
  return least;
}

StageTasks::StageTasks(const Specification& spec) : spec_(spec) {
  module_ = {module_range(spec.module[0]), module_range(spec.module[1])};
  const double forward = least_friction(spec, true);
  const double backward = least_friction(spec, false);
  friction_ = std::min(forward, backward);
  const double tolerance = spec.ratio.tolerance;
  ratio_ = {std::abs(spec.ratio.target) * (1.0 - tolerance),
            std::abs(spec.ratio.target) * (1.0 + tolerance)};
  const auto& most = spec.limits[CheckId::kOutputBacklashMax];
  if (most) budget_ = *most + design::kFeasibilitySlack * std::max(*most, 1e-3);
  if (budget_ < kInfinity) {
    // A mesh that may interfere gives the others room.
    const Interval j1 = backlash_floor(train::kMeshSP1);
    const Interval j2 = backlash_floor(train::kMeshP1R1);
    const Interval j3 = backlash_floor(train::kMeshP2R2);
    const double cosine = std::cos(spec.pressure_angle_rad);
    const auto give = [&](double j, double base) { budget_ -= std::min(0.0, j) / base; };
    give(j1.lo, 0.5 * cosine * spec.teeth.S.min * ratio_.lo);
    give(2.0 * j2.lo, 0.5 * cosine * (spec.teeth.P1.min + spec.teeth.min_internal_difference));
    give(j3.lo, 0.5 * cosine * (spec.teeth.P2.min + spec.teeth.min_internal_difference));
  }
}

bool StageTasks::shares_lost_motion() const {
  return budget_ < kInfinity && spec_.limits.model == backlash::LostMotionModel::kKinematic;
}

StageTask StageTasks::stage1(const Candidate& c, const std::array<Interval, 3>& shifts,
                             double share) const {
  StageTask task = common(c, train::kP1, train::kR1, shifts[1], shifts[2]);
  task.sun = gear(train::kS, c.teeth.S, shifts[0]);
  task.sun_khk_tip = spec_.khk_tip[train::kS];
  task.planet_khk_tip = spec_.khk_tip[train::kP1];
  task.sun_loss = loss(1.0 / c.teeth.S + 1.0 / c.teeth.P1);
  task.sun_backlash = {backlash_floor(train::kMeshSP1).lo, kInfinity};
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
                       .half_gap = 0.5 * (*gap - design::kFeasibilitySlack)};
  }
  return task;
}

StageTask StageTasks::stage2(const Candidate& c, const std::array<Interval, 2>& shifts,
                             double share, double most_distance) const {
  StageTask task = common(c, train::kP2, train::kR2, shifts[0], shifts[1]);
  if (budget_ < kInfinity) {
    const double half_cos = 0.5 * std::cos(spec_.pressure_angle_rad);
    task.ring_backlash.hi = share * budget_ * half_cos * c.teeth.R2;
  }
  if (const auto& gap = spec_.limits[CheckId::kPlanetGap]; gap && c.planets > 1) {
    // The gap is in modules of stage 1: m1/m2 = d2/d1, d1 at most most_distance.
    const double spacing = std::sin(std::numbers::pi / c.planets);
    const double least = *gap - design::kFeasibilitySlack;
    task.planet_gap = {
        .half_spacing = least > 0.0 ? spacing - 0.5 * least / most_distance : spacing,
        .half_gap = least > 0.0 ? 0.0 : 0.5 * least * module_[0].hi / module_[1].lo};
  }
  return task;
}

double StageTasks::loss(double teeth) const { return friction_ * std::numbers::pi * teeth; }

StageGear StageTasks::gear(int id, int teeth, const Interval& shift) const {
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

Interval StageTasks::backlash_floor(std::size_t mesh) const {
  const auto limit = design::least_backlash_m(spec_.limits, mesh);
  const std::size_t stage = mesh == train::kMeshP2R2 ? 1 : 0;
  if (!limit) return {-kInfinity, kInfinity};
  // Feasible means within kFeasibilityTolerance of the scale, which is a module of stage 1.
  const double slack = design::kFeasibilityTolerance * length_scale_m(spec_);
  const double least = *limit - slack;
  return {least / (least > 0.0 ? module_[stage].hi : module_[stage].lo), kInfinity};
}

std::optional<double> StageTasks::rolling_share() const {
  const auto& most = spec_.limits[CheckId::kSpecificSliding];
  if (!most) return std::nullopt;
  return geometry::rolling_share(*most + design::kFeasibilitySlack * (1.0 + *most));
}

std::optional<double> StageTasks::root_clearance(std::size_t stage) const {
  std::optional<double> least = spec_.limits[CheckId::kRootClearance];
  if (const auto& length = spec_.limits[CheckId::kRootClearanceLength]) {
    const double greatest = module_[stage].hi + design::kFeasibilitySlack * length_scale_m(spec_);
    const double modules = *length / (*length > 0.0 ? greatest : module_[stage].lo);
    least = std::max(least.value_or(modules), modules);
  }
  if (!least) return std::nullopt;
  return *least - design::kFeasibilitySlack;
}

StageTask StageTasks::common(const Candidate& c, int planet, int ring, const Interval& planet_x,
                             const Interval& ring_x) const {
  const auto z = train::teeth_of(c.teeth);
  const int z_planet = z[static_cast<std::size_t>(planet)];
  const int z_ring = z[static_cast<std::size_t>(ring)];
  constexpr double kSlack = design::kFeasibilitySlack;
  const auto limit = [&](CheckId id, double none) {
    return spec_.limits[id] ? *spec_.limits[id] : none;
  };
  const auto relaxed = [&](CheckId id) -> std::optional<double> {
    if (!spec_.limits[id]) return std::nullopt;
    return *spec_.limits[id] - kSlack;
  };
  return {
      .planet = gear(planet, z_planet, planet_x),
      .ring = gear(ring, z_ring, ring_x),
      .sun = std::nullopt,
      .pressure_angle_rad = spec_.pressure_angle_rad,
      .greatest_angle_rad = kGreatestWorkingAngle_rad,
      .distance = {0.0, kInfinity},
      .sun_backlash = {-kInfinity, kInfinity},
      .ring_backlash = backlash_floor(planet == train::kP1 ? train::kMeshP1R1 : train::kMeshP2R2),
      .lost_motion = std::nullopt,
      .contact_ratio = {limit(CheckId::kContactRatioMin, -kInfinity) - kSlack,
                        limit(CheckId::kContactRatioMax, kInfinity) + kSlack},
      .interference = relaxed(CheckId::kInvoluteInterference),
      .rolling_share = rolling_share(),
      .root_clearance = root_clearance(planet == train::kP1 ? 0 : 1),
      .planet_gap = std::nullopt,
      .sliding = spec_.friction.model != efficiency::LossModel::kOhlendorf,
      .sun_loss = 0.0,
      .ring_loss = loss(1.0 / z_planet - 1.0 / z_ring)};
}

}  // namespace gear3k::optimize
