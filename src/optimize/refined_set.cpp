#include "optimize/refined_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "design/rating_inputs.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/refinement_problem.hpp"
#include "units/units.hpp"

namespace gear3k::optimize {

namespace {

/// Tip shortenings that a DESIGN may state: where one is longer, the rack's addendum becomes that
/// of the longest tooth, and every gear keeps its own.
void state_addenda(train::TrainParameters<double>& train) {
  const auto [least, most] = std::ranges::minmax(train.tip_shortening);
  if (most <= design::kGreatestTipShortening) return;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    for (double* const length : {&train.rack[i].addendum, &train.tip_shortening[i]}) {
      *length = units::meant_si(*length - least, units::Unit::kModules);
    }
  }
}

}  // namespace

train::TrainParameters<double> train_of(const Specification& spec, const RefinedSet& set) {
  train::TrainParameters<double> train = unrefined_train(spec, set.candidate);
  train.profile_shift = set.train.profile_shift;
  train.module_m = set.train.module_m;
  train.center_distance_m = set.train.center_distance_m;
  train.tip_shortening = set.train.tip_shortening;
  train.pressure_angle_rad = set.train.pressure_angle_rad;
  train.cutter = cutters_of(spec, set.train.cutter_teeth);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const auto stage = static_cast<std::size_t>(train::stage_of(static_cast<int>(i)));
    train.machining_allowance[i] =
        machining_allowance(spec, i, train.pressure_angle_rad, train.module_m[stage]);
  }
  return train;
}

design::Design design_of(const Specification& spec, const RefinedSet& set) {
  const auto& z = set.candidate.teeth;
  design::Design design;
  design.name = fmt::format("{}{}/{}/{}/{}/{}", spec.name.empty() ? "" : spec.name + " ", z.S, z.P1,
                            z.R1, z.P2, z.R2);
  design.train = train_of(spec, set);
  state_addenda(design.train);
  design.center_distance_given = true;
  design.friction = spec.friction;
  design.friction.extension = {};
  design.axial = spec.axial;
  design.masses.density_kgm3 = spec.bodies.density_kgm3;
  design.masses.gear_density_kgm3 = spec.bodies.gear_density_kgm3;
  design.masses.face_width_m = spec.bodies.face_width_m;
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const double width_m = set.train.face_width_m[stage];
    if (width_m > 0.0) design.masses.face_width_m[stage] = width_m;
  }
  design.masses.bore_radius_m = spec.bodies.bore_radius_m;
  if (spec.bodies.ring_rim_m > 0.0) {
    const auto gears = train::make_train_gears(design.train);
    const auto outer_radius_m = [&](std::size_t ring) {
      return units::meant_si(gears[ring].root_radius_m + spec.bodies.ring_rim_m,
                             units::Unit::kDiameterMillimetre);
    };
    design.masses.ring1_outer_radius_m = outer_radius_m(train::kR1);
    design.masses.ring2_outer_radius_m = outer_radius_m(train::kR2);
  }
  design.limits = spec.limits;
  design.tolerances = spec.tolerances;
  design.thickness_allowance_m = spec.thickness_allowance_m;
  design.thermal = spec.thermal;
  design.sampling = spec.sampling;
  if (spec.rating) {
    design.operating_point = spec.operating_point;
    design.rating = design::rating_of(*spec.rating, design);
    design.rating->ring_rim_m.reset();  // the rings have their outer surfaces now
    design.rating->factors.held_mesh_load.reset();
  }
  return design;
}

EnergyAt energy_of(const Specification& spec, const RefinedSet& set) {
  if (set.cycle_energy_J) {
    return {.energy_J = *set.cycle_energy_J,
            .motor = set.motor,
            .within_limits = std::isfinite(*set.cycle_energy_J)};
  }
  return spec.cycle_energy->at(
      {.ratio = train::ratio(set.candidate.teeth), .forward = set.eta_f, .backward = set.eta_b});
}

double objective_of(const Specification& spec, const RefinedSet& set, Objective objective) {
  switch (objective) {
    case Objective::kBackwardEfficiency:
      return set.eta_b;
    case Objective::kForwardEfficiency:
      return set.eta_f;
    case Objective::kLostMotion:
      return set.lost_motion_rad;
    case Objective::kOuterDiameter:
      return set.ring_root_diameter_m + 2.0 * spec.bodies.ring_rim_m;
    case Objective::kInertia:
      return set.inertia_kgm2;
    case Objective::kMass:
      return set.mass_kg;
    case Objective::kRatioError:
      return std::abs(train::ratio(set.candidate.teeth) / spec.ratio.target - 1.0);
    case Objective::kTorqueCapacity:
      return set.torque_capacity_Nm.value_or(0.0);
    case Objective::kTorqueDensity:
      return set.torque_capacity_Nm.value_or(0.0) / set.mass_kg;
    case Objective::kTorsionalStiffness:
      return set.torsional_stiffness_Nm_rad.value_or(0.0);
    case Objective::kCycleEnergy: {
      if (!(set.eta_b > 0.0)) break;
      const EnergyAt at = energy_of(spec, set);
      return at.within_limits ? at.energy_J : std::numeric_limits<double>::infinity();
    }
  }
  return std::numeric_limits<double>::infinity();
}

bool judged_by_model(const Specification& spec) {
  const Objective first = first_objective(spec);
  return spec.model.has_value() && spec.operating_point.has_value() && is_efficiency(first);
}

double merit_of(const Specification& spec, const RefinedSet& set) {
  const Objective first = first_objective(spec);
  if (!judged_by_model(spec)) return sense_of(first) * objective_of(spec, set, first);
  const auto& eta = first == Objective::kForwardEfficiency ? set.eta_f_model : set.eta_b_model;
  return eta.value_or(-std::numeric_limits<double>::infinity());
}

std::pair<double, std::uint32_t> merit_order(const Specification& spec, const RefinedSet& set) {
  const Objective first = first_objective(spec);
  return {cost_in_steps(first, sense_of(first) * merit_of(spec, set)), set.index};
}

}  // namespace gear3k::optimize
