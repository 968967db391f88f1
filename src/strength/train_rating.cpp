#include "strength/train_rating.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace gear3k::strength {

namespace {

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

/// P1 with G2 < 1 is loaded on both flanks in turn; every gear is where the joint works both ways.
RootLoading loading_of(int gear, const train::ToothSet& teeth, const RatingTask& task) {
  const bool idler = gear == train::kP1 && train::g2(teeth) < 1.0;
  return task.load_reversal || idler ? RootLoading::kReversed : RootLoading::kPulsating;
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
  return {.gear = train.geometry.gears[i],
          .form = train.forms[i],
          .material = *task.material[i],
          .root_cycles = cycles.root[i],
          .flank_cycles = cycles.flank[i],
          .loading = loading_of(gear, train.geometry.teeth, task),
          .rim_m = rim_of(train.geometry.gears[i], task, i),
          .root = root};
}

/// Forces of a drive direction into the rating; those of a held load where it locks.
template <class T>
MeshForces<T> driven_or_held(const RatedTrain<T>& train, Drive drive, const T& torque_Nm,
                             bool& locked) {
  const auto driven =
      driven_mesh_forces(train.geometry, train.efficiency[static_cast<std::size_t>(drive)],
                         torque_Nm, drive == Drive::kForward);
  if (driven) return *driven;
  locked = true;
  return lossless_mesh_forces(train.geometry, torque_Nm);
}

/// Normal force of a mesh and the direction that it belongs to.
template <class T>
struct DecidingForce {
  T normal_N{};
  Drive drive = Drive::kForward;
};
/// Sets the forces, of kEither those of the forward drive.
template <class T>
std::array<DecidingForce<T>, train::kMeshCount> forces_of(const RatedTrain<T>& train, Drive drive,
                                                          const T& torque_Nm,
                                                          TrainRating<T>& rating) {
  const Drive first = drive == Drive::kBackward ? drive : Drive::kForward;
  rating.forces = driven_or_held(train, first, torque_Nm, rating.locked);
  std::array<DecidingForce<T>, train::kMeshCount> deciding;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    deciding[k] = {.normal_N = rating.forces.normal_N[k], .drive = first};
  }
  if (drive != Drive::kEither) return deciding;
  const MeshForces<T> backward = driven_or_held(train, Drive::kBackward, torque_Nm, rating.locked);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (value_of(backward.normal_N[k]) <= value_of(deciding[k].normal_N)) continue;
    deciding[k] = {.normal_N = backward.normal_N[k], .drive = Drive::kBackward};
  }
  return deciding;
}

/// Springs of the train from its meshes and bearings.
template <class T>
TrainSprings<T> springs_of(const TrainRating<T>& rating, const RatingTask& task) {
  TrainSprings<T> springs;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    springs.mesh_N_m[k] = *rating.mesh[k].mean_stiffness_Pa * rating.mesh[k].face_width_m;
  }
  if (task.supports && task.supports->stiffness_N_m) {
    PlanetBearings<T> bearings;
    bearings.axis = planet_axis<T>(*task.supports);
    bearings.stiffness_N_m = {constant<T>(*task.supports->stiffness_N_m),
                              constant<T>(*task.supports->stiffness_N_m)};
    springs.bearings = bearings;
  }
  return springs;
}

/// The safeties that are judged, with where they are.
template <class T>
struct JudgedSafeties {
  std::vector<SafetyRatio<T>> ratios;
  std::vector<GoverningTooth> places;
};
template <class T>
JudgedSafeties<T> judged(const TrainRating<T>& rating, const RatingTask& task) {
  JudgedSafeties<T> list;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      const ToothRating<T>& tooth = rating.mesh[k].teeth[i];
      const auto gear = static_cast<std::size_t>(train::kMeshGears[k][i]);
      const GearMaterial& material = *task.material[gear];
      if (tooth.root_limit_stated) {
        list.ratios.push_back(
            {.ratio = tooth.root_safety / least_root_safety(task, material), .exponent = 1});
        list.places.push_back({.mesh = k, .member = i, .mode = Mode::kRoot});
      }
      if (tooth.flank_limit_stated) {
        list.ratios.push_back(
            {.ratio = tooth.flank_safety / least_flank_safety(task, material), .exponent = 2});
        list.places.push_back({.mesh = k, .member = i, .mode = Mode::kFlank});
      }
    }
  }
  return list;
}

}  // namespace

TrainCycles train_cycles(const train::ToothSet& teeth, int planets, const RatingTask& task) {
  TrainCycles cycles;
  if (task.cycles) {
    cycles.root.fill(*task.cycles);
    cycles.flank.fill(*task.cycles);
    return cycles;
  }
  if (!task.life_s || !(task.speed_rad_s > 0.0)) return cycles;
  const train::SpeedRatios ratios = train::speed_ratios(teeth);
  const double output_turns =
      task.speed_rad_s / std::abs(ratios.sun) * *task.life_s / (2.0 * std::numbers::pi);
  const LoadCycles<double> n =
      load_cycles<double>({.sun = ratios.sun * output_turns,
                           .carrier = ratios.carrier * output_turns,
                           .planet_rolling = (ratios.planet - ratios.carrier) * output_turns,
                           .output = output_turns},
                          planets, train::g2(teeth) > 1.0);
  const bool one_sided = !task.load_reversal && train::g2(teeth) > 1.0;
  cycles.root = {n.sun, one_sided ? n.planet1_flank : n.planet, n.fixed_ring, n.planet,
                 n.output_ring};
  cycles.flank = {n.sun, n.planet1_flank, n.fixed_ring, n.planet, n.output_ring};
  return cycles;
}

Factor<double> mesh_load_of(const RatingTask& task, int planets) {
  const StatedFactors& stated = task.factors;
  if (stated.mesh_load_source == MeshLoadSource::kNumber) {
    if (!stated.mesh_load) return {.branch = "not stated", .source = sources::kNotStated};
    return {.value = *stated.mesh_load, .branch = "stated", .source = sources::kInput};
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

template <class T>
PlanetAxis<T> planet_axis(const PlanetSupports& supports) {
  return {.plane1_m = constant<T>(supports.plane_m[0]),
          .plane2_m = constant<T>(supports.plane_m[1]),
          .support_a_m = constant<T>(supports.position_m[0]),
          .support_b_m = constant<T>(supports.position_m[1]),
          .mass_center_m = constant<T>(0.5 * (supports.plane_m[0] + supports.plane_m[1]))};
}

template <class T>
TrainRating<T> rate_train(const RatedTrain<T>& train, const RatingTask& task, Drive drive,
                          const T& torque_Nm, StiffnessPart part) {
  const train::ToothSet& teeth = train.geometry.teeth;
  TrainRating<T> rating;
  rating.drive = drive;
  rating.torque_Nm = torque_Nm;
  const auto deciding = forces_of(train, drive, torque_Nm, rating);
  const TrainMotion motion = motion_of(teeth, task.speed_rad_s);
  const TrainCycles cycles = train_cycles(teeth, train.geometry.planets, task);
  const Factor<double> mesh_load = mesh_load_of(task, train.geometry.planets);
  const bool below_one = train::g2(teeth) < 1.0;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (!train.rated[k]) continue;
    const auto [first, second] = train::kMeshGears[k];
    const RatedGear<T> gear1 = rated_gear(train, task, cycles, first, train.roots[k][0]);
    const RatedGear<T> gear2 = rated_gear(train, task, cycles, second, train.roots[k][1]);
    const geometry::GearGeometry<T>& central = k == train::kMeshSP1 ? gear1.gear : gear2.gear;
    const auto& [normal_N, direction] = deciding[k];
    const bool forward = direction == Drive::kForward;
    const auto driver = static_cast<std::size_t>(
        train::gear1_drives(static_cast<train::MeshId>(k), below_one, forward) ? 0 : 1);
    const T lost = 1.0 - train.efficiency[static_cast<std::size_t>(direction)][k][driver];
    const T power_W = normal_N * central.base_radius_m * motion.rolling_rad_s[k];
    const bool rubs = value_of(train.friction) > 0.0;
    rating.mesh[k] = rate_mesh<T>(
        gear1, gear2, train.geometry.meshes[k],
        {.normal_N = normal_N,
         .face_width_m = train.face_width_m[static_cast<std::size_t>(train::stage_of(first))],
         .speed_m_s = motion.rolling_rad_s[k] * central.reference_radius_m,
         .loss_W = power_W * lost,
         .loss_factor = rubs ? T(lost / train.friction) : constant<T>(0.0),
         .mesh_load = mesh_load},
        task, part);
  }
  if (task.supports) {
    rating.planet =
        planet_loads(train.geometry, rating.forces, planet_axis<T>(*task.supports),
                     constant<T>(task.planet_mass_kg), constant<T>(motion.carrier_rad_s));
    if (task.pin_diameter_m) {
      rating.pin_stress_Pa =
          pin_bending_stress(rating.planet->bending_moment_Nm, constant<T>(*task.pin_diameter_m));
    }
  }
  const bool in_contact = std::ranges::all_of(rating.mesh, [](const MeshRating<T>& mesh) {
    return mesh.mean_stiffness_Pa && value_of(*mesh.mean_stiffness_Pa) > 0.0;
  });
  if (in_contact) {
    rating.stiffness = train_stiffness(train.geometry, springs_of(rating, task));
  }
  return rating;
}

template <class T>
std::optional<Capacity<T>> train_capacity(const RatedTrain<T>& train, const RatingTask& task,
                                          Drive drive) {
  const auto at = [&](const T& torque_Nm) {
    return judged(rate_train(train, task, drive, torque_Nm, StiffnessPart::kNone), task);
  };
  const JudgedSafeties<T> first = at(constant<T>(task.torque_Nm));
  if (first.ratios.empty()) return std::nullopt;
  const SafetyFunction<double> values = [&](const double& torque_Nm) {
    std::vector<SafetyRatio<double>> list;
    const auto ratios = at(constant<T>(torque_Nm)).ratios;
    list.reserve(ratios.size());
    for (const SafetyRatio<T>& r : ratios) {
      list.push_back({.ratio = value_of(r.ratio), .exponent = r.exponent});
    }
    return list;
  };
  const auto capacity = torque_capacity(values, {.start_Nm = task.torque_Nm});
  if (!capacity) return std::nullopt;
  const GoverningTooth governing = first.places[capacity->governing];
  if constexpr (std::is_same_v<T, double>) {
    return Capacity<T>{.torque_Nm = capacity->torque_Nm, .governing = governing};
  } else {
    const SafetyFunction<T> exact = [&](const T& torque_Nm) { return at(torque_Nm).ratios; };
    return Capacity<T>{.torque_Nm = capacity_with_derivatives(exact, *capacity).torque_Nm,
                       .governing = governing};
  }
}

#define INSTANTIATE(T)                                                                            \
  template PlanetAxis<T> planet_axis<T>(const PlanetSupports&);                                   \
  template TrainRating<T> rate_train<T>(const RatedTrain<T>&, const RatingTask&, Drive, const T&, \
                                        StiffnessPart);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

template std::optional<Capacity<double>> train_capacity<double>(const RatedTrain<double>&,
                                                                const RatingTask&, Drive);
template std::optional<Capacity<Jet1>> train_capacity<Jet1>(const RatedTrain<Jet1>&,
                                                            const RatingTask&, Drive);

}  // namespace gear3k::strength
