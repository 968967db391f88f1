#include "optimize/objective_value.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "efficiency/train_efficiency.hpp"
#include "inertia/effective_inertia.hpp"
#include "inertia/mass_properties.hpp"
#include "optimize/energy_box.hpp"
#include "optimize/refinement_problem.hpp"
#include "optimize/shift_range.hpp"

namespace gear3k::optimize {

namespace {

std::optional<double> body_density(const GearBodySizes& bodies, std::size_t gear) {
  return design::density_of(bodies.density_kgm3, bodies.gear_density_kgm3, gear);
}

template <class T>
using GearBodies = std::array<inertia::MassProperties<T>, train::kGearCount>;

template <class T>
GearBodies<T> gear_bodies(const Specification& spec, const std::array<T, 2>& face_width_m,
                          const std::array<geometry::GearGeometry<T>, train::kGearCount>& gears) {
  if (!knows_masses(spec)) {
    throw std::invalid_argument("objective mass or inertia: densities and face widths not stated");
  }
  GearBodies<T> bodies;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const int id = static_cast<int>(i);
    const bool ring = train::kind_of(id) == geometry::GearKind::kRing;
    // A search may pass gears whose bore reaches their teeth.
    const T other =
        ring ? T(gears[i].root_radius_m + spec.bodies.ring_rim_m)
             : smaller(constant<T>(spec.bodies.bore_radius_m[i]), gears[i].root_radius_m);
    const auto stage = static_cast<std::size_t>(train::stage_of(id));
    bodies[i] = inertia::gear_body<T>(gears[i], other, face_width_m[stage],
                                      constant<T>(*body_density(spec.bodies, i)));
  }
  return bodies;
}

template <class T>
T mass_of(const GearBodies<T>& bodies, int planets) {
  using train::kP1, train::kP2, train::kR1, train::kR2, train::kS;
  return bodies[kS].mass_kg + (bodies[kP1].mass_kg + bodies[kP2].mass_kg) * (1.0 * planets) +
         bodies[kR1].mass_kg + bodies[kR2].mass_kg;
}

template <class T>
inertia::InertialTrain<T> inertial_train(const GearBodies<T>& bodies, const train::ToothSet& teeth,
                                         int planets, const T& center_distance_m) {
  using train::kP1, train::kP2, train::kR2, train::kS;
  return {.teeth = teeth,
          .planets = planets,
          .center_distance_m = center_distance_m,
          .bodies = {.sun_kgm2 = bodies[kS].inertia_kgm2,
                     .planet1_kgm2 = bodies[kP1].inertia_kgm2,
                     .planet2_kgm2 = bodies[kP2].inertia_kgm2,
                     .planet_mass_kg = bodies[kP1].mass_kg + bodies[kP2].mass_kg,
                     .carrier_kgm2 = constant<T>(0.0),
                     .ring2_kgm2 = bodies[kR2].inertia_kgm2}};
}

template <class T>
T inertia_of(const GearBodies<T>& bodies, const train::ToothSet& teeth, int planets,
             const T& center_distance_m) {
  return inertia::lossless_inertia<T>(inertial_train(bodies, teeth, planets, center_distance_m));
}

template <class T>
efficiency::MeshEfficiencies<T> constant_mesh_efficiencies(const ObjectiveInput<T>& input,
                                                           bool forward) {
  return efficiency::mesh_efficiencies(
      input.train,
      efficiency::constant_friction<T>(input.spec.friction, input.train.teeth, forward),
      input.spec.friction.model, forward);
}

double ratio_error(const Specification& spec, const train::ToothSet& teeth) {
  return std::abs(train::ratio(teeth) / spec.ratio.target - 1.0);
}

}  // namespace

bool knows_masses(const Specification& spec) {
  const GearBodySizes& b = spec.bodies;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    if (!body_density(b, gear)) return false;
  }
  return b.face_width_m[0] && b.face_width_m[1];
}

bool knows_inertia(const Specification& spec) {
  return knows_masses(spec) && spec.bodies.ring_rim_m > 0.0;
}

bool has_objective_branches(Objective objective, const Specification& spec) {
  return objective == Objective::kOuterDiameter ||
         (objective == Objective::kLostMotion &&
          spec.limits.model == backlash::LostMotionModel::kPaper);
}

bool asks_for(const Specification& spec, Objective objective) {
  return std::ranges::find(spec.objectives, objective) != spec.objectives.end() ||
         std::ranges::find(spec.objective_limits, objective, &ObjectiveLimit::objective) !=
             spec.objective_limits.end();
}

template <class T>
T planet_mass_kg(const Specification& spec, const train::TrainGeometry<T>& train,
                 const std::array<T, 2>& face_width_m) {
  const auto bodies = gear_bodies(spec, face_width_m, train.gears);
  return bodies[train::kP1].mass_kg + bodies[train::kP2].mass_kg;
}

template <class T>
T objective_value(Objective objective, const ObjectiveInput<T>& input, int branch) {
  const Specification& spec = input.spec;
  const train::TrainGeometry<T>& train = input.train;
  const auto& normal_backlash_m = input.normal_backlash_m;
  const auto mesh_efficiencies = [&](bool forward) {
    return constant_mesh_efficiencies(input, forward);
  };
  switch (objective) {
    case Objective::kBackwardEfficiency:
      return efficiency::backward_efficiency(train.teeth, mesh_efficiencies(false));
    case Objective::kForwardEfficiency:
      return efficiency::forward_efficiency(train.teeth, mesh_efficiencies(true));
    case Objective::kLostMotion: {
      if (branch == 0) {
        return backlash::output_lost_motion(train, normal_backlash_m, spec.limits.model);
      }
      const auto phi = backlash::paper_lost_motion(train, normal_backlash_m);
      return phi[0] + phi[static_cast<std::size_t>(branch)];
    }
    case Objective::kOuterDiameter: {
      const T& first = train.gears[train::kR1].root_radius_m;
      const T& second = train.gears[train::kR2].root_radius_m;
      const T radius = branch == 0 ? larger(first, second) : branch == 1 ? first : second;
      return 2.0 * radius + 2.0 * spec.bodies.ring_rim_m;
    }
    case Objective::kInertia:
      return inertia_of(gear_bodies(spec, input.face_width_m, train.gears), train.teeth,
                        train.planets, train.center_distance_m);
    case Objective::kMass:
      return mass_of(gear_bodies(spec, input.face_width_m, train.gears), train.planets);
    case Objective::kRatioError:
      return constant<T>(ratio_error(spec, train.teeth));
    case Objective::kTorqueCapacity:
      return input.torque_Nm;
    case Objective::kTorqueDensity:
      return input.torque_Nm /
             mass_of(gear_bodies(spec, input.face_width_m, train.gears), train.planets);
    case Objective::kTorsionalStiffness:
      if (input.rating == nullptr || !input.rating->stiffness) {
        throw std::invalid_argument("objective torsional_stiffness: train not rated");
      }
      return input.rating->stiffness->output_Nm_rad;
    case Objective::kCycleEnergy:
      return cycle_energy<T>(
          *spec.cycle_energy,
          {.ratio = train::ratio(train.teeth),
           .forward = efficiency::forward_efficiency(train.teeth, mesh_efficiencies(true)),
           .backward = efficiency::backward_efficiency(train.teeth, mesh_efficiencies(false)),
           .inertia_kgm2 = knows_inertia(spec)
                               ? inertia_of(gear_bodies(spec, input.face_width_m, train.gears),
                                            train.teeth, train.planets, train.center_distance_m)
                               : constant<T>(0.0)});
  }
  throw std::invalid_argument("objective_value: objective unknown");
}

template <class T>
T objective_value(Objective objective, const Specification& spec,
                  const train::TrainGeometry<T>& train,
                  const std::array<T, train::kMeshCount>& normal_backlash_m, int branch) {
  const auto& widths = spec.bodies.face_width_m;
  return objective_value<T>(
      objective,
      {.spec = spec,
       .train = train,
       .normal_backlash_m = normal_backlash_m,
       .face_width_m = {constant<T>(widths[0].value_or(0.0)), constant<T>(widths[1].value_or(0.0))},
       .torque_Nm = {},
       .rating = nullptr},
      branch);
}

template <class T>
FeltGearbox<T> felt_gearbox(const ObjectiveInput<T>& input) {
  const Specification& spec = input.spec;
  const train::TrainGeometry<T>& t = input.train;
  const auto forward = constant_mesh_efficiencies(input, true);
  const auto backward = constant_mesh_efficiencies(input, false);
  FeltGearbox<T> felt{.ratio = train::ratio(t.teeth),
                      .forward = efficiency::forward_efficiency(t.teeth, forward),
                      .backward = efficiency::backward_efficiency(t.teeth, backward)};
  if (!knows_inertia(spec) || !(value_of(felt.backward) > 0.0)) return felt;
  auto moving = inertial_train<T>(gear_bodies(spec, input.face_width_m, t.gears), t.teeth,
                                  t.planets, t.center_distance_m);
  moving.bodies.sun_kgm2 = moving.bodies.sun_kgm2 + spec.felt->rotor_inertia_kgm2;
  felt.inertia_kgm2 =
      inertia::effective_inertia<T>(moving, {.forward = forward, .backward = backward}, false);
  return felt;
}

double best_value(Objective objective, const Specification& spec, const train::ToothSet& teeth,
                  int planets) {
  // Sizes grow with module and shift; kFeasibilityTolerance of either is allowed for.
  constexpr double kSlack = 1.0 - 4.0 * design::kFeasibilityTolerance;
  const auto smallest = [&] {
    auto train =
        unrefined_train(spec, {.teeth = teeth, .planets = planets}, spec.profile_shift.min);
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      train.profile_shift[i] = shift_limits(spec, static_cast<int>(i)).min;
      if (spec.free.tip_shortening) train.tip_shortening[i] = spec.free.tip_shortening->max;
    }
    // How far the KHK rule shortens a tip is not known; no tip lies inside its root circle.
    for (const std::size_t gear : {train::kS, train::kP1}) {
      if (spec.khk_tip[gear]) train.tip_shortening[gear] = spec.rack.addendum + spec.rack.dedendum;
    }
    return train::make_train_gears(train);
  };
  const auto least_widths = [&] {
    std::array<double, 2> widths{};
    for (std::size_t stage = 0; stage < 2; ++stage) {
      const auto& range = spec.free.face_width_m[stage];
      widths[stage] = range ? range->min : spec.bodies.face_width_m[stage].value_or(0.0);
    }
    return widths;
  };
  // A ring's root circle, a multiple of its module, is no larger than the size allows.
  const auto most_modules = [&] {
    std::array<double, 2> most{module_range(spec.module[0]).hi, module_range(spec.module[1]).hi};
    const auto limit = most_ring_root_diameter_m(spec);
    if (!limit) return most;
    const auto gears = smallest();
    for (const std::size_t ring : {train::kR1, train::kR2}) {
      double& module = most[ring == train::kR1 ? 0 : 1];
      const double used = 2.0 * gears[ring].reference_radius_m / train::teeth_of(teeth)[ring];
      module = std::min(module, used * *limit / (2.0 * kSlack * gears[ring].root_radius_m));
    }
    return most;
  };
  const double greatest_angle =
      spec.free.pressure_angle_rad ? spec.free.pressure_angle_rad->max : spec.pressure_angle_rad;
  switch (objective) {
    case Objective::kBackwardEfficiency:
    case Objective::kForwardEfficiency:
      return 1.0;
    case Objective::kLostMotion: {
      std::array<double, train::kMeshCount> limit{};
      for (std::size_t k = 0; k < limit.size(); ++k) {
        const auto least = design::least_backlash_m(spec.limits, k);
        if (!least) return -std::numeric_limits<double>::infinity();
        limit[k] = *least;
      }
      // Each mesh has at least this; a negative share is greatest on the smallest circle.
      const double least_angle = spec.free.pressure_angle_rad ? spec.free.pressure_angle_rad->min
                                                              : spec.pressure_angle_rad;
      const double slack = design::kFeasibilityTolerance * length_scale_m(spec);
      const bool kinematic = spec.limits.model == backlash::LostMotionModel::kKinematic;
      const double ratio = train::ratio(teeth);
      const std::array<double, 2> most_module = most_modules();
      const auto share = [&](std::size_t mesh, double base_teeth) {
        const std::size_t stage = mesh == train::kMeshP2R2 ? 1 : 0;
        const Interval module{module_range(spec.module[stage]).lo, most_module[stage]};
        const double half_cos = 0.5 * std::cos(limit[mesh] > 0.0 ? least_angle : greatest_angle);
        const double least = limit[mesh] - slack;
        return least / ((least > 0.0 ? module.hi : module.lo) * half_cos * base_teeth);
      };
      const double sun = share(train::kMeshSP1, std::abs(ratio) * teeth.S);
      const double first =
          share(train::kMeshP1R1, teeth.R1) * (kinematic ? 1.0 - 1.0 / ratio : 1.0);
      const double second = share(train::kMeshP2R2, teeth.R2);
      return kinematic ? sun + first + second : sun + std::max(first, second);
    }
    case Objective::kOuterDiameter: {
      const auto gears = smallest();
      return kSlack *
             (2.0 * std::max(gears[train::kR1].root_radius_m, gears[train::kR2].root_radius_m) +
              2.0 * spec.bodies.ring_rim_m);
    }
    case Objective::kInertia:
      // Base circles part at no less than their radii's difference.
      return kSlack * kSlack *
             inertia_of<double>(gear_bodies(spec, least_widths(), smallest()), teeth, planets,
                                0.5 * least_module(spec.module[0]) * std::cos(greatest_angle) *
                                    (teeth.R1 - teeth.P1));
    case Objective::kMass:
      return kSlack * mass_of(gear_bodies(spec, least_widths(), smallest()), planets);
    case Objective::kRatioError:
      return ratio_error(spec, teeth);
    case Objective::kTorqueCapacity:
    case Objective::kTorqueDensity:
    case Objective::kTorsionalStiffness:
      return std::numeric_limits<double>::infinity();
    case Objective::kCycleEnergy:
      return spec.cycle_energy->least(energy_box(spec, teeth, planets, 1.0, 1.0));
  }
  throw std::invalid_argument("best_value: objective unknown");
}

double objective_scale(Objective objective, const Specification& spec) {
  switch (objective) {
    case Objective::kLostMotion: {
      const auto& most = spec.limits[design::CheckId::kOutputBacklashMax];
      constexpr double kTypical_rad = 10.0 * std::numbers::pi / 180.0 / 60.0;
      return most && *most > 0.0 ? *most : kTypical_rad;
    }
    case Objective::kOuterDiameter:
    case Objective::kInertia:
    case Objective::kMass: {
      const train::ToothSet least{.S = spec.teeth.S.min,
                                  .P1 = spec.teeth.P1.min,
                                  .R1 = spec.teeth.S.min + 2 * spec.teeth.P1.min,
                                  .P2 = spec.teeth.P2.min,
                                  .R2 = spec.teeth.S.min + 2 * spec.teeth.P2.min + 1};
      return best_value(objective, spec, least, spec.planets.front());
    }
    case Objective::kTorqueCapacity:
      return spec.rating->torque_Nm;
    case Objective::kTorqueDensity:
      return spec.rating->torque_Nm / objective_scale(Objective::kMass, spec);
    case Objective::kTorsionalStiffness: {
      // A spring of half the modulus per face width, at R1's least reference radius.
      const auto& rating = *spec.rating;
      const double radius_m =
          0.5 * least_module(spec.module[0]) * (spec.teeth.S.min + 2 * spec.teeth.P1.min);
      const double least_width_m = std::min(rating.face_width_m[0], rating.face_width_m[1]);
      return 0.5 * strength::elasticity_of(*rating.material[train::kP1]).youngs_modulus_Pa *
             least_width_m * radius_m * radius_m;
    }
    case Objective::kCycleEnergy:
      return spec.cycle_energy->scale_j();
    default:
      return 1.0;
  }
}

#define INSTANTIATE(T)                                                                           \
  template T planet_mass_kg<T>(const Specification&, const train::TrainGeometry<T>&,             \
                               const std::array<T, 2>&);                                         \
  template T objective_value<T>(Objective, const ObjectiveInput<T>&, int);                       \
  template FeltGearbox<T> felt_gearbox<T>(const ObjectiveInput<T>&);                             \
  template T objective_value<T>(Objective, const Specification&, const train::TrainGeometry<T>&, \
                                const std::array<T, train::kMeshCount>&, int);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::optimize
