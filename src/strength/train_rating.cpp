#include "strength/train_rating.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace gear3k::strength {

namespace {

/// Below a capacity with K_γ that depends on the torque: to an eighth of it.
constexpr int kMeshLoadOctaves = 3;

/// Whether S and R1 load the same flank of P1.
bool same_flank(const train::ToothSet& teeth) { return train::g2(teeth) > 1.0; }

/// Speeds relative to the carrier, and life, at the task's speed.
struct TrainMotion {
  double output_rad_s = 0.0, carrier_rad_s = 0.0;
  std::array<double, train::kMeshCount> rolling_rad_s{};  ///< of S, R1, R2 against the carrier
};
TrainMotion motion_of(const train::ToothSet& teeth, double sun_rad_s) {
  const train::SpeedRatios ratios = train::speed_ratios(teeth);
  TrainMotion motion;
  motion.output_rad_s = sun_rad_s / std::abs(ratios.sun);
  motion.carrier_rad_s = ratios.carrier * motion.output_rad_s;
  const auto rolling = train::central_rolling_speeds(teeth);
  for (std::size_t k = 0; k < rolling.size(); ++k) {
    motion.rolling_rad_s[k] = std::abs(rolling[k]) * motion.output_rad_s;
  }
  return motion;
}

/// Meetings with one mate: a flank of P1 that both its mates load shares its cycles among them.
std::optional<double> turns_with_one_mate(const std::optional<double>& cycles, int gear,
                                          const train::ToothSet& teeth) {
  const bool shared = gear == train::kP1 && same_flank(teeth);
  return cycles && shared ? std::optional(0.5 * *cycles) : cycles;
}

template <class T>
std::optional<T> rim_of(const geometry::GearGeometry<T>& gear, const RatingTask& task,
                        std::size_t index) {
  const bool ring = gear.gear.kind == geometry::GearKind::kRing;
  if (ring && task.ring_rim_m) return constant<T>(*task.ring_rim_m);
  const std::optional<double>& end_m = task.rim_radius_m[index];
  if (!end_m) return std::nullopt;
  return ring ? T(*end_m - gear.root_radius_m) : T(gear.root_radius_m - *end_m);
}

template <class T>
RatedGear<T> rated_gear(const RatedTrain<T>& train, const RatingTask& task,
                        const TrainCycles& cycles, int gear, bool root) {
  const auto i = static_cast<std::size_t>(gear);
  StatedTeeth teeth = stated_teeth(task, i);
  teeth.cycles = cycles[i];
  return {.gear = train.geometry.gears[i],
          .form = train.forms[i],
          .material = *task.material[i],
          .teeth = teeth,
          .wear_turns = turns_with_one_mate(cycles[i], gear, train.geometry.teeth),
          .loading = root_loading(teeth, is_idler(gear, train.geometry.teeth)),
          .rim_m = rim_of(train.geometry.gears[i], task, i),
          .root = root,
          .section = train.sections[i] ? &*train.sections[i] : nullptr};
}

/// A train driven in one direction: its forces; those of a held load where it locks.
template <class T>
struct DrivenTrain {
  Drive drive = Drive::kForward;
  bool locked = false;
  MeshForces<T> forces;
};
template <class T>
DrivenTrain<T> driven_train(const RatedTrain<T>& train, Drive drive, const T& torque_Nm) {
  auto forces =
      driven_mesh_forces(train.geometry, train.efficiency[static_cast<std::size_t>(drive)],
                         torque_Nm, drive == Drive::kForward);
  if (forces) return {.drive = drive, .forces = *std::move(forces)};
  return {
      .drive = drive, .locked = true, .forces = lossless_mesh_forces(train.geometry, torque_Nm)};
}

/// What the rating of a mesh does not take from the drive direction.
struct TrainLife {
  TrainMotion motion;
  TrainCycles cycles;
  MeshLoadFactors mesh_load;
};

template <class T>
MeshRating<T> rated_mesh(const RatedTrain<T>& train, const RatingTask& task, const TrainLife& life,
                         std::size_t k, const DrivenTrain<T>& driven, StiffnessPart part) {
  const auto [first, second] = train::kMeshGears[k];
  const RatedGear<T> gear1 = rated_gear(train, task, life.cycles, first, train.roots[k][0]);
  const RatedGear<T> gear2 = rated_gear(train, task, life.cycles, second, train.roots[k][1]);
  const geometry::GearGeometry<T>& central = train.geometry.gears[train::kCentralGears[k]];
  const bool forward = driven.drive == Drive::kForward;
  const auto direction = static_cast<std::size_t>(driven.drive);
  const bool below_one = !same_flank(train.geometry.teeth);
  const auto driver = static_cast<std::size_t>(
      train::gear1_drives(static_cast<train::MeshId>(k), below_one, forward) ? 0 : 1);
  const auto& loss_Nm = driven.forces.loss_Nm;
  const T housing_loss_W = (loss_Nm[0] + loss_Nm[1] + loss_Nm[2]) * (1.0 * train.geometry.planets) *
                           life.motion.output_rad_s;
  const T lost = 1.0 - train.efficiency[direction][k][driver];
  const T& friction = train.friction[direction][k];
  return rate_mesh<T>(
      gear1, gear2, train.geometry.meshes[k],
      {.normal_N = driven.forces.normal_N[k],
       .face_width_m = train.face_width_m[static_cast<std::size_t>(train::stage_of(first))],
       .speed_m_s = life.motion.rolling_rad_s[k] * central.reference_radius_m,
       .loss_W = loss_Nm[k] * life.motion.output_rad_s,
       .housing_loss_W = housing_loss_W,
       .loss_factor = value_of(friction) > 0.0 ? T(lost / friction) : constant<T>(0.0),
       .mesh_load = life.mesh_load[k]},
      task, part);
}

template <class T>
void take_smaller(std::optional<T>& mine, const std::optional<T>& other) {
  if (other && (!mine || value_of(*other) < value_of(*mine))) mine = other;
}
template <class T>
void take_larger(std::optional<T>& mine, const std::optional<T>& other) {
  if (other && (!mine || value_of(*other) > value_of(*mine))) mine = other;
}

/// Of both directions the worse one, quantity by quantity.
template <class T>
void take_worse(ToothRating<T>& mine, const ToothRating<T>& other) {
  if (value_of(other.root_safety) < value_of(mine.root_safety)) {
    mine.root = other.root;
    mine.root_strength = other.root_strength;
    mine.root_safety = other.root_safety;
  }
  if (value_of(other.flank_safety) < value_of(mine.flank_safety)) {
    mine.flank_stress_Pa = other.flank_stress_Pa;
    mine.flank_strength = other.flank_strength;
    mine.flank_safety = other.flank_safety;
  }
  mine.limit_in_range = mine.limit_in_range && other.limit_in_range;
  take_smaller(mine.overload_root_safety, other.overload_root_safety);
  take_smaller(mine.overload_flank_safety, other.overload_flank_safety);
  take_larger(mine.root_temperature_K, other.root_temperature_K);
  take_larger(mine.flank_temperature_K, other.flank_temperature_K);
  take_larger(mine.wear_m, other.wear_m);
}

/// The mesh in the worse of the directions.  Everything of metals worsens with the force; plastics
/// are heated and worn by the losses, which another direction may have more of.
template <class T>
MeshRating<T> worse_mesh(const RatedTrain<T>& train, const RatingTask& task, const TrainLife& life,
                         std::size_t k, std::span<const DrivenTrain<T>> driven,
                         StiffnessPart part) {
  const auto force = [&](const DrivenTrain<T>& d) { return value_of(d.forces.normal_N[k]); };
  const DrivenTrain<T>& most = *std::ranges::max_element(driven, {}, force);
  MeshRating<T> rating = rated_mesh(train, task, life, k, most, part);
  const auto is_plastic_gear = [&](int gear) {
    return is_plastic(task.material[static_cast<std::size_t>(gear)]->record.group);
  };
  if (std::ranges::none_of(train::kMeshGears[k], is_plastic_gear)) return rating;
  for (const DrivenTrain<T>& other : driven) {
    if (&other == &most) continue;
    const MeshRating<T> also = rated_mesh(train, task, life, k, other, part);
    for (const std::size_t i : {0U, 1U}) take_worse(rating.teeth[i], also.teeth[i]);
  }
  return rating;
}

/// A flank of P1 that both its mates load wears by both.
template <class T>
void add_wear_of_both_mates(TrainRating<T>& rating) {
  std::optional<T>& by_sun = rating.mesh[train::kMeshSP1].teeth[1].wear_m;
  std::optional<T>& by_ring = rating.mesh[train::kMeshP1R1].teeth[0].wear_m;
  if (!by_sun || !by_ring) return;
  by_sun = by_ring = T(*by_sun + *by_ring);
}

/// Loads of planets, bearings and pin: of several directions the greatest of each.
template <class T>
void rate_planet(const RatedTrain<T>& train, const RatingTask& task, const TrainLife& life,
                 std::span<const DrivenTrain<T>> driven, TrainRating<T>& rating) {
  for (const DrivenTrain<T>& d : driven) {
    const PlanetLoads<T> loads =
        planet_loads(train.geometry, d.forces, planet_axis<T>(*task.supports), train.planet_mass_kg,
                     constant<T>(life.motion.carrier_rad_s));
    if (!rating.planet) {
      rating.planet = loads;
      rating.bearing_load_N = loads.bearing_load_N;
    }
    for (const std::size_t i : {0U, 1U}) {
      rating.bearing_load_N[i] = larger(rating.bearing_load_N[i], loads.bearing_load_N[i]);
    }
    if (!task.pin_diameter_m) continue;
    take_larger(rating.pin_stress_Pa,
                std::optional(pin_bending_stress(loads.bending_moment_Nm,
                                                 constant<T>(*task.pin_diameter_m))));
  }
}

/// Springs of the train from its meshes, and what else the task states.
template <class T>
TrainSprings<T> springs_of(const TrainRating<T>& rating, const RatingTask& task) {
  const auto stated = [](const std::optional<double>& value) {
    return value ? std::optional(constant<T>(*value)) : std::nullopt;
  };
  TrainSprings<T> springs;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    springs.mesh_N_m[k] = *rating.mesh[k].mean_stiffness_Pa * rating.mesh[k].face_width_m;
  }
  springs.planet_torsion_Nm_rad = stated(task.planet_torsion_Nm_rad);
  springs.sun_shaft_Nm_rad = stated(task.sun_shaft_Nm_rad);
  springs.ring2_Nm_rad = stated(task.ring2_Nm_rad);
  if (task.supports && (task.supports->stiffness_N_m || task.supports->pin_stiffness_N_m)) {
    PlanetBearings<T> bearings;
    bearings.axis = planet_axis<T>(*task.supports);
    bearings.stiffness_N_m.fill(stated(task.supports->stiffness_N_m));
    bearings.pin_stiffness_N_m = stated(task.supports->pin_stiffness_N_m);
    springs.bearings = bearings;
  }
  return springs;
}

template <class T>
JudgedSafeties<T> judged(const TrainRating<T>& rating, const RatingTask& task) {
  JudgedSafeties<T> list;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    add_judged_safeties(rating.mesh[k], task, k, train::kMeshGears[k], list);
  }
  return list;
}

/// Whether no factor depends on the torque: S_F ~ 1/T and S_H ~ T^(−1/2).
bool safeties_scale(const RatingTask& task) {
  for (const auto& [first, second] : train::kMeshGears) {
    const GearMaterial& one = *task.material[static_cast<std::size_t>(first)];
    const GearMaterial& other = *task.material[static_cast<std::size_t>(second)];
    if (is_plastic(one.record.group) || is_plastic(other.record.group) ||
        computes_dynamic_factor(task, one, other) || computes_stiffness_factor(task, one, other)) {
      return false;
    }
  }
  return true;
}

/// The capacity by its safeties at one torque, where they scale.
std::optional<Capacity<double>> scaled_capacity(const JudgedSafeties<double>& at,
                                                double torque_Nm) {
  std::optional<Capacity<double>> least;
  for (std::size_t i = 0; i < at.ratios.size(); ++i) {
    const double torque = torque_Nm * std::pow(at.ratios[i].ratio, at.ratios[i].exponent);
    if (!(std::isfinite(torque) && torque > 0.0)) return std::nullopt;
    if (!least || torque < least->torque_Nm) {
      least = Capacity<double>{.torque_Nm = torque, .governing = at.places[i]};
    }
  }
  return least;
}

/// Cycles of the task's life; empty without.
TrainCycles life_cycles(const train::ToothSet& teeth, int planets, const RatingTask& task) {
  if (!task.life_s || !(task.speed_rad_s > 0.0)) return {};
  const train::SpeedRatios ratios = train::speed_ratios(teeth);
  const double output_turns =
      task.speed_rad_s / std::abs(ratios.sun) * *task.life_s / (2.0 * std::numbers::pi);
  const LoadCycles<double> n =
      load_cycles<double>({.sun = ratios.sun * output_turns,
                           .carrier = ratios.carrier * output_turns,
                           .planet_rolling = (ratios.planet - ratios.carrier) * output_turns,
                           .output = output_turns},
                          planets, same_flank(teeth));
  return {n.sun, n.planet1, n.fixed_ring, n.planet2, n.output_ring};
}

}  // namespace

bool is_idler(int gear, const train::ToothSet& teeth) {
  return gear == train::kP1 && !same_flank(teeth);
}

TrainCycles train_cycles(const train::ToothSet& teeth, int planets, const RatingTask& task) {
  TrainCycles cycles = life_cycles(teeth, planets, task);
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    if (const auto stated = stated_teeth(task, gear).cycles) cycles[gear] = stated;
  }
  return cycles;
}

Factor<double> mesh_load_of(const RatingTask& task, int planets) {
  const StatedFactors& stated = task.factors;
  if (stated.mesh_load_source == MeshLoadSource::kNumber) {
    if (!stated.mesh_load) return {.branch = "not stated", .source = sources::kNotStated};
    return {.value = *stated.mesh_load, .branch = "stated", .source = sources::kInput};
  }
  if (stated.mesh_load_source == MeshLoadSource::kTolerances) {
    throw std::invalid_argument(
        "K_gamma of the tolerances is not computed, allowed: that of each mesh, or a number");
  }
  const auto factor =
      mesh_load_factor(stated.mesh_load_source == MeshLoadSource::kM56 ? MeshLoadTable::kM56
                                                                       : MeshLoadTable::kDrivetrain,
                       planets);
  if (factor) return *factor;
  return {.value = 1.0,
          .branch = "no row for so few planets",
          .source = sources::kNotStated,
          .in_range = false};
}

MeshLoadFactors mesh_loads_of(const RatingTask& task, int planets) {
  MeshLoadFactors factors;
  const StatedFactors& stated = task.factors;
  if (stated.mesh_load_source == MeshLoadSource::kTolerances && stated.held_mesh_load) {
    for (std::size_t k = 0; k < factors.size(); ++k) {
      factors[k] = {.value = (*stated.held_mesh_load)[k],
                    .branch = "held by a search",
                    .source = sources::kTolerances};
    }
    return factors;
  }
  factors.fill(mesh_load_of(task, planets));
  return factors;
}

MeshLoadFactors even_mesh_loads() {
  MeshLoadFactors factors;
  factors.fill({.branch = "even", .source = sources::kNotStated});
  return factors;
}

template <class T>
PlanetAxis<T> planet_axis(const PlanetSupports& supports) {
  return {.plane1_m = constant<T>(supports.plane_m[0]),
          .plane2_m = constant<T>(supports.plane_m[1]),
          .support_a_m = constant<T>(supports.position_m[0]),
          .support_b_m = constant<T>(supports.position_m[1]),
          .mass_center_m = constant<T>(0.5 * (supports.plane_m[0] + supports.plane_m[1]))};
}

template <class T>
bool has_rims(const RatedTrain<T>& train, const RatingTask& task) {
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    const auto rim_m = rim_of(train.geometry.gears[gear], task, gear);
    if (rim_m && !(value_of(*rim_m) > 0.0)) return false;
  }
  return true;
}

template <class T>
RatedTrain<T> with_sections(RatedTrain<T> train, const RatingTask& task) {
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    for (std::size_t i = 0; i < 2 && train.rated[k]; ++i) {
      const auto gear = static_cast<std::size_t>(train::kMeshGears[k][i]);
      if (train.sections[gear]) continue;
      if (!train.roots[k][i] && !is_plastic(task.material[gear]->record.group)) continue;
      train.sections[gear] = root_section_of(train.geometry.gears[gear], train.forms[gear], task);
    }
  }
  return train;
}

template <class T>
TrainRating<T> rate_train(const RatedTrain<T>& stated, const RatingTask& task, Drive drive,
                          const T& torque_Nm, StiffnessPart part) {
  const RatedTrain<T> train = with_sections(stated, task);
  const train::ToothSet& teeth = train.geometry.teeth;
  std::vector<DrivenTrain<T>> driven;
  if (drive != Drive::kBackward) driven.push_back(driven_train(train, Drive::kForward, torque_Nm));
  if (drive != Drive::kForward) driven.push_back(driven_train(train, Drive::kBackward, torque_Nm));
  TrainRating<T> rating;
  rating.drive = drive;
  rating.torque_Nm = torque_Nm;
  rating.forces = driven.front().forces;
  rating.locked = std::ranges::any_of(driven, &DrivenTrain<T>::locked);
  TrainLife life{.motion = motion_of(teeth, task.speed_rad_s),
                 .cycles = train_cycles(teeth, train.geometry.planets, task),
                 .mesh_load = {}};
  life.mesh_load = train.mesh_load ? *train.mesh_load : mesh_loads_of(task, train.geometry.planets);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (train.rated[k]) rating.mesh[k] = worse_mesh<T>(train, task, life, k, driven, part);
  }
  if (same_flank(teeth)) add_wear_of_both_mates(rating);
  if (task.supports) rate_planet<T>(train, task, life, driven, rating);
  const bool in_contact = std::ranges::all_of(rating.mesh, [](const MeshRating<T>& mesh) {
    return mesh.mean_stiffness_Pa && value_of(*mesh.mean_stiffness_Pa) > 0.0;
  });
  if (in_contact) {
    rating.springs = springs_of(rating, task);
    rating.stiffness = train_stiffness(train.geometry, *rating.springs);
  }
  return rating;
}

template <class T>
std::optional<Capacity<T>> train_capacity(const RatedTrain<T>& train, const RatingTask& task,
                                          Drive drive, const MeshLoadFunction& mesh_load) {
  RatedTrain<T> loaded = with_sections(train, task);
  const auto at = [&](const T& torque_Nm) {
    if (mesh_load) loaded.mesh_load = mesh_load(value_of(torque_Nm));
    return judged(rate_train(loaded, task, drive, torque_Nm, StiffnessPart::kIso), task);
  };
  const auto values = [&](double torque_Nm) {
    JudgedSafeties<T> list = at(constant<T>(torque_Nm));
    if constexpr (std::is_same_v<T, double>) {
      return list;
    } else {
      JudgedSafeties<double> plain{.ratios = {}, .places = std::move(list.places)};
      plain.ratios.reserve(list.ratios.size());
      for (const SafetyRatio<T>& r : list.ratios) {
        plain.ratios.push_back({.ratio = value_of(r.ratio), .exponent = r.exponent});
      }
      return plain;
    }
  };
  const auto capacity =
      !mesh_load && safeties_scale(task)
          ? scaled_capacity(values(task.torque_Nm), task.torque_Nm)
          : governed_capacity(values, {.start_Nm = task.torque_Nm,
                                       .scanned_octaves = mesh_load ? kMeshLoadOctaves : 0});
  if constexpr (std::is_same_v<T, double>) {
    return capacity;
  } else {
    if (!capacity) return std::nullopt;
    const auto& places = at(constant<T>(task.torque_Nm)).places;
    const auto item =
        static_cast<std::size_t>(std::ranges::find(places, capacity->governing) - places.begin());
    const SafetyFunction<T> exact = [&](const T& torque_Nm) { return at(torque_Nm).ratios; };
    return Capacity<T>{
        .torque_Nm =
            capacity_with_derivatives(exact, {.torque_Nm = capacity->torque_Nm, .governing = item})
                .torque_Nm,
        .governing = capacity->governing};
  }
}

std::optional<DrivenCapacity> least_capacity(const std::optional<Capacity<double>>& forward,
                                             const std::optional<Capacity<double>>& backward) {
  if (!forward || !backward) return std::nullopt;
  if (backward->torque_Nm < forward->torque_Nm) {
    return DrivenCapacity{.capacity = *backward, .drive = Drive::kBackward};
  }
  return DrivenCapacity{.capacity = *forward, .drive = Drive::kForward};
}

#define INSTANTIATE(T)                                                                            \
  template PlanetAxis<T> planet_axis<T>(const PlanetSupports&);                                   \
  template bool has_rims<T>(const RatedTrain<T>&, const RatingTask&);                             \
  template RatedTrain<T> with_sections<T>(RatedTrain<T>, const RatingTask&);                      \
  template TrainRating<T> rate_train<T>(const RatedTrain<T>&, const RatingTask&, Drive, const T&, \
                                        StiffnessPart);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

template std::optional<Capacity<double>> train_capacity<double>(const RatedTrain<double>&,
                                                                const RatingTask&, Drive,
                                                                const MeshLoadFunction&);
template std::optional<Capacity<Jet1>> train_capacity<Jet1>(const RatedTrain<Jet1>&,
                                                            const RatingTask&, Drive,
                                                            const MeshLoadFunction&);

}  // namespace gear3k::strength
