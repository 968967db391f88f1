#include "optimize/energy_box.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>

#include "design/checks.hpp"
#include "design/design.hpp"
#include "efficiency/friction_law.hpp"
#include "inertia/effective_inertia.hpp"
#include "inertia/mass_properties.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/shift_range.hpp"
#include "optimize/stage_relaxer.hpp"
#include "optimize/stage_tasks.hpp"

namespace gear3k::optimize {

namespace {

/// The longest addendum of the rack, in modules.
double longest_addendum(const Specification& spec) {
  const auto& shortening = spec.free.tip_shortening;
  return spec.rack.addendum + (shortening ? std::max(0.0, -shortening->min) : 0.0);
}

/// Friction of the flanks at most, without and with the factors of approach and recess.
struct MostFriction {
  double plain = 0.0, with_factors = 0.0;
  bool has_factors = false;
};
MostFriction most_friction(const design::Friction& friction) {
  MostFriction most;
  for (const bool forward : {false, true}) {
    for (const auto& flank : efficiency::constant_frictions(friction, forward)) {
      const double factor = std::max(flank.approach_factor, flank.recess_factor);
      most.plain = std::max(most.plain, flank.coefficient);
      most.with_factors = std::max(most.with_factors, flank.coefficient * std::max(1.0, factor));
      if (flank.approach_factor != 1.0 || flank.recess_factor != 1.0) most.has_factors = true;
    }
  }
  return most;
}

/// Least efficiency of a mesh, whichever gear drives; 0 where its flanks may jam.
/// @param second  teeth, of a ring negative
double least_efficiency(const design::Friction& friction, const MeshReach& reach, double first,
                        double second) {
  using efficiency::LossModel;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const MostFriction mu = most_friction(friction);
  const double teeth = 1.0 / first + 1.0 / second;
  const double along_ring = second < 0.0 ? kTurn * reach.farthest / -second : 0.0;
  const double left = 1.0 - mu.with_factors * (reach.tan_alpha_w + along_ring);
  // Of the pair farthest out.
  if (!(left - mu.with_factors * kTurn * reach.farthest * teeth > 1e-9)) return 0.0;
  const double per_friction = 0.5 * kTurn * teeth * reach.loss_factor;
  const double path = mu.with_factors * per_friction / left;
  if (friction.model == LossModel::kCoulombPath || friction.model == LossModel::kDirectional) {
    return std::max(0.0, 1.0 - path);
  }
  const double first_order = mu.plain * per_friction;
  if (!mu.has_factors) return std::max(0.0, 1.0 - first_order);
  // First order and what factors add to the path: the latter's own loss is less by so much.
  const double smaller = second > 0.0 ? std::min(first, second) : first;
  const double lever = mu.plain * (reach.tan_alpha_w + kTurn * reach.farthest / smaller);
  const double lacking = friction.model == LossModel::kOhlendorf ? 1.0 : lever / (1.0 + lever);
  return std::max(0.0, 1.0 - path - lacking * first_order);
}

struct MostInertia {
  double total_kgm2 = 0.0, ring2_kgm2 = 0.0;
};

/// @param distance  greatest centre distances of the stages, in modules
MostInertia most_inertia(const Specification& spec, const train::ToothSet& z, int planets,
                         const std::array<double, 2>& distance) {
  using train::kP1, train::kP2, train::kR1, train::kR2, train::kS;
  constexpr double kMore = 1.0 + 4.0 * design::kFeasibilityTolerance;
  std::array<double, 2> module{module_range(spec.module[0]).hi, module_range(spec.module[1]).hi};
  if (const auto limit = most_ring_root_diameter_m(spec)) {
    for (const std::size_t ring : {kR1, kR2}) {
      const double least_shift = std::min(0.0, shift_limits(spec, static_cast<int>(ring)).min);
      double& most = module[ring == kR1 ? 0 : 1];
      most = std::min(most, kMore * *limit / (train::teeth_of(z)[ring] + 2.0 * least_shift));
    }
  }
  const auto cylinder = [&](std::size_t gear, double teeth_m) {
    const auto stage = static_cast<std::size_t>(train::stage_of(static_cast<int>(gear)));
    const auto& free = spec.free.face_width_m[stage];
    const double width = free ? free->max : spec.bodies.face_width_m[stage].value_or(0.0);
    const auto density =
        design::density_of(spec.bodies.density_kgm3, spec.bodies.gear_density_kgm3, gear);
    return inertia::hollow_cylinder<double>({.outer_radius_m = teeth_m,
                                             .inner_radius_m = 0.0,
                                             .width_m = width * kMore,
                                             .density_kgm3 = density.value_or(0.0)});
  };
  const auto reach = [&](std::size_t gear, double depth) {
    const auto stage = static_cast<std::size_t>(train::stage_of(static_cast<int>(gear)));
    return kMore * module[stage] *
           (0.5 * train::teeth_of(z)[gear] + shift_limits(spec, static_cast<int>(gear)).max +
            depth);
  };
  const double addendum = longest_addendum(spec);
  const auto sun = cylinder(kS, reach(kS, addendum));
  const auto planet1 = cylinder(kP1, reach(kP1, addendum));
  const auto planet2 = cylinder(kP2, reach(kP2, addendum));
  const auto ring2 = cylinder(kR2, reach(kR2, spec.rack.dedendum) + spec.bodies.ring_rim_m);
  const double orbit = kMore * std::min(module[0] * distance[0], module[1] * distance[1]);
  return {.total_kgm2 = inertia::lossless_inertia<double>(
              {.teeth = z,
               .planets = planets,
               .center_distance_m = orbit,
               .bodies = {.sun_kgm2 = sun.inertia_kgm2,
                          .planet1_kgm2 = planet1.inertia_kgm2,
                          .planet2_kgm2 = planet2.inertia_kgm2,
                          .planet_mass_kg = planet1.mass_kg + planet2.mass_kg,
                          .carrier_kgm2 = 0.0,
                          .ring2_kgm2 = ring2.inertia_kgm2}}),
          .ring2_kgm2 = ring2.inertia_kgm2};
}

using SetReach = std::array<TeethReach, 2>;
SetReach reach_of(const Specification& spec, const train::ToothSet& z, int planets) {
  const auto shifts = [&](int gear) {
    return shift_range(spec, gear, train::teeth_of(z)[static_cast<std::size_t>(gear)]).widest;
  };
  const StageTasks tasks(spec);
  const Candidate set{.teeth = z, .planets = planets};
  StageTask stage1 =
      tasks.stage1(set, {shifts(train::kS), shifts(train::kP1), shifts(train::kR1)}, 1.0);
  StageTask stage2 = tasks.stage2(set, {shifts(train::kP2), shifts(train::kR2)}, 1.0, kInfinity);
  stage1.least = stage2.least = StageTask::Least::kDistance;  // no least loss
  return {teeth_reach(stage1), teeth_reach(stage2)};
}

/// Where a stage has no design, 1.
std::array<double, train::kMeshCount> efficiencies_at(const design::Friction& friction,
                                                      const train::ToothSet& z,
                                                      const SetReach& reach) {
  const auto& [stage1, stage2] = reach;
  const double r1 = -z.R1;
  const double r2 = -z.R2;
  return {stage1.empty ? 1.0 : least_efficiency(friction, stage1.sun, z.S, z.P1),
          stage1.empty ? 1.0 : least_efficiency(friction, stage1.ring, z.P1, r1),
          stage2.empty ? 1.0 : least_efficiency(friction, stage2.ring, z.P2, r2)};
}

}  // namespace

std::array<double, train::kMeshCount> least_mesh_efficiencies(const Specification& spec,
                                                              const train::ToothSet& z,
                                                              int planets) {
  if (!has_bounds(spec)) return {0.0, 0.0, 0.0};
  return efficiencies_at(spec.friction, z, reach_of(spec, z, planets));
}

EnergyBox energy_box(const Specification& spec, const train::ToothSet& z, int planets,
                     double most_forward, double most_backward) {
  EnergyBox box{
      .ratio = train::ratio(z), .most_forward = most_forward, .most_backward = most_backward};
  if (!knows_inertia(spec)) return box;
  box.least_inertia_kgm2 = best_value(Objective::kInertia, spec, z, planets);
  if (!has_bounds(spec)) {
    box.known = false;
    return box;
  }
  const SetReach reach = reach_of(spec, z, planets);
  const MostInertia most = most_inertia(spec, z, planets, {reach[0].distance, reach[1].distance});
  box.most_inertia_kgm2 = std::max(most.total_kgm2, box.least_inertia_kgm2);
  const auto [eta1, eta2, eta3] = efficiencies_at(spec.friction, z, reach);
  if (!(eta1 > 0.0 && eta2 > 0.0 && eta3 > 0.0)) {
    box.known = false;
    return box;
  }
  const double l1 = static_cast<double>(z.P1) / z.S;
  const double l2 = static_cast<double>(z.P1) / z.R1;
  const double l3 = static_cast<double>(z.P2) / z.R2;
  const auto planet = [&](double f1, double f2) {
    return (l1 + l2) * (1.0 - l2 * f2) / ((1.0 - l2) * (l1 * f1 + l2 * f2));
  };
  const auto carrier = [&](double f1, double f2) { return (l1 + l2) * f2 / (l1 * f1 + l2 * f2); };
  const auto ring2 = [&](double f1, double f2, double f3) {
    return (l3 * f3 - l2 * f2) / (l3 - l2) * (l1 + l2) / (l1 * f1 + l2 * f2);
  };
  // Each is monotonic in each f: its ends are among the corners.
  double low = 1.0;
  double high = 1.0;
  double ring_low = 1.0;
  double ring_high = 1.0;
  for (const double f1 : {eta1, 1.0 / eta1}) {
    for (const double f2 : {eta2, 1.0 / eta2}) {
      for (const double a : {planet(f1, f2), carrier(f1, f2)}) {
        low = std::min(low, a);
        high = std::max(high, a);
      }
      for (const double f3 : {eta3, 1.0 / eta3}) {
        ring_low = std::min(ring_low, ring2(f1, f2, f3));
        ring_high = std::max(ring_high, ring2(f1, f2, f3));
      }
    }
  }
  const double share = std::min(1.0, most.ring2_kgm2 / box.least_inertia_kgm2);
  box.inertia_factor = {low - share * (low - std::min(low, ring_low)),
                        high + share * (std::max(high, ring_high) - high)};
  return box;
}

}  // namespace gear3k::optimize
