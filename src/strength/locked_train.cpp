#include "strength/locked_train.hpp"

#include <cmath>

namespace gear3k::strength {

namespace {

constexpr std::size_t kTorque = 0;
constexpr std::size_t kLoads = 1 + train::kMeshCount;

/// Adds the compliance of a spring that takes these forces.
void add_spring(LockedCompliance& c, const LockedLoads& force, double compliance) {
  for (std::size_t i = 0; i < kLoads; ++i) {
    for (std::size_t j = 0; j < kLoads; ++j) c[i][j] += force[i] * force[j] * compliance;
  }
}

/// t_k under each load by itself.
std::array<LockedLoads, train::kMeshCount> mesh_torques(const train::ToothSet& teeth) {
  const std::array<double, train::kMeshCount> lever = train::planet_levers(teeth);
  std::array<LockedLoads, train::kMeshCount> result{};
  for (std::size_t load = 0; load < kLoads; ++load) {
    LockedLoads y{};
    y[load] = 1.0;
    const double t3 = y[3] - y[kTorque];
    const double sum = y[kTorque] + y[1] + y[2];
    const double moment = -lever[2] * t3 - y[1] - y[2] - y[3];
    const double t1 = (moment - lever[1] * sum) / (lever[0] - lever[1]);
    result[0][load] = t1;
    result[1][load] = sum - t1;
    result[2][load] = t3;
  }
  return result;
}

/// What bearings and pins give: on either side the reactions to unit loads.
void add_bearings(const train::TrainGeometry<double>& train, const PlanetBearings<double>& bearings,
                  LockedTrain& locked) {
  check_planet_axis(bearings.axis);
  const std::array<double, train::kMeshCount> lever = train::planet_levers(train.teeth);
  std::array<LockedLoads, 4> reaction{};  // A radial, A tangential, B radial, B tangential
  for (std::size_t load = 0; load < kLoads; ++load) {
    MeshForces<double> unit{};
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const double t = locked.mesh_torque[k][load];
      const double sense = locked.mesh_torque[k][kTorque] < 0.0 ? -1.0 : 1.0;
      unit.normal_N[k] = sense * t * locked.normal_N_per_Nm[k];
      unit.tangential_N[k] = -t * (1.0 + lever[k]) / (train.planets * train.center_distance_m);
    }
    const auto both = support_reactions(bearings.axis, plane_forces(train, unit), 0.0);
    for (std::size_t i = 0; i < 2; ++i) {
      reaction[2 * i][load] = both[i].radial_N;
      reaction[2 * i + 1][load] = both[i].tangential_N;
    }
  }
  for (std::size_t i = 0; i < 2; ++i) {
    double give = 0.0;
    if (const auto& k = bearings.stiffness_N_m[i]) give += 1.0 / *k;
    if (const auto& k = bearings.pin_stiffness_N_m) give += 1.0 / *k;
    add_spring(locked.other, reaction[2 * i], train.planets * give);
    add_spring(locked.other, reaction[2 * i + 1], train.planets * give);
  }
}

}  // namespace

LockedTrain locked_train(const train::TrainGeometry<double>& train,
                         const TrainSprings<double>& springs) {
  // Refuses what is no stiffness.
  train_stiffness(train, springs);
  LockedTrain locked;
  locked.planets = train.planets;
  locked.mesh_torque = mesh_torques(train.teeth);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    locked.normal_N_per_Nm[k] = 1.0 / (train.planets * train::central_base_radius(train, k));
  }
  if (const auto& k = springs.planet_torsion_Nm_rad) {
    // Between P1 and P2, all planets together: the moment of mesh 3, λ t + m.
    LockedLoads moment{};
    const double lever = train::planet_levers(train.teeth)[train::kMeshP2R2];
    for (std::size_t j = 0; j < kLoads; ++j) moment[j] = lever * locked.mesh_torque[2][j];
    moment[3] += 1.0;
    add_spring(locked.other, moment, 1.0 / (train.planets * *k));
  }
  if (springs.bearings) add_bearings(train, *springs.bearings, locked);
  if (const auto& k = springs.sun_shaft_Nm_rad) {
    LockedLoads torque = locked.mesh_torque[0];
    torque[1] -= 1.0;
    add_spring(locked.other, torque, 1.0 / *k);
  }
  if (const auto& k = springs.ring2_Nm_rad)
    add_spring(locked.other, {1.0, 0.0, 0.0, 0.0}, 1.0 / *k);
  return locked;
}

LockedCompliance locked_compliance(
    const LockedTrain& train, const std::array<double, train::kMeshCount>& mesh_compliance_m_N) {
  LockedCompliance c = train.other;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    LockedLoads force = train.mesh_torque[k];
    for (double& f : force) f *= train.normal_N_per_Nm[k];
    add_spring(c, force, train.planets * mesh_compliance_m_N[k]);
  }
  return c;
}

std::optional<SlidingCouple> sliding_couple(const train::ToothSet& teeth, std::size_t mesh,
                                            const train::DriverEfficiencies<double>& efficiency) {
  const std::size_t central = train::central_is_gear1(mesh) ? 0 : 1;
  const double eta_central = efficiency[central];
  const double eta_planet = efficiency[1 - central];
  const double lever = train::planet_levers(teeth)[mesh];
  if (!(eta_central > 0.0 && eta_planet + std::min(lever, 0.0) > 0.0)) return std::nullopt;
  return SlidingCouple{.central_drives = lever * (eta_central - 1.0) / (1.0 + lever * eta_central),
                       .planet_drives = lever * (1.0 - eta_planet) / (eta_planet + lever)};
}

}  // namespace gear3k::strength
