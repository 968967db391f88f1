#include "strength/train_stiffness.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace gear3k::strength {

namespace {

template <class T>
const T& positive_stiffness(const T& k, const char* name) {
  if (!(value_of(k) > 0.0)) {
    throw std::invalid_argument(
        fmt::format("train stiffness: {} = {}, allowed: above 0", name, value_of(k)));
  }
  return k;
}

/// Σ |R|² (1/k_B + 1/k_pin) of one planet at unit output torque.
template <class T>
T bearing_compliance(const train::TrainGeometry<T>& train, const PlanetBearings<T>& bearings) {
  check_planet_axis(bearings.axis);
  const MeshForces<T> unit = lossless_mesh_forces(train, constant<T>(1.0));
  const std::array<TransverseForce<T>, 2> reaction =
      support_reactions(bearings.axis, plane_forces(train, unit), constant<T>(0.0));
  T sum = constant<T>(0.0);
  for (std::size_t i = 0; i < reaction.size(); ++i) {
    T give = constant<T>(0.0);
    if (const auto& k = bearings.stiffness_N_m[i]) {
      give = give + 1.0 / positive_stiffness(*k, "stiffness of a planet bearing [N/m]");
    }
    if (const auto& k = bearings.pin_stiffness_N_m) {
      give = give + 1.0 / positive_stiffness(*k, "stiffness of a pin [N/m]");
    }
    sum = sum + give * (reaction[i].radial_N * reaction[i].radial_N +
                        reaction[i].tangential_N * reaction[i].tangential_N);
  }
  return sum;
}

}  // namespace

template <class T>
TrainStiffness<T> train_stiffness(const train::TrainGeometry<T>& train,
                                  const TrainSprings<T>& springs) {
  const double n = train.planets;
  const double i = train::ratio(train.teeth);
  const std::array<T, train::kMeshCount> a = normal_forces_per_torque(train);
  TrainStiffness<T> result;
  TrainCompliance<T>& c = result.compliance;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    c.mesh[k] =
        a[k] * a[k] / (n * positive_stiffness(springs.mesh_N_m[k], "stiffness of a mesh [N/m]"));
  }
  c.planet_torsion = c.bearings = c.sun_shaft = c.ring2 = constant<T>(0.0);
  if (const auto& k = springs.planet_torsion_Nm_rad) {
    const T lever = train.gears[train::kP2].base_radius_m / train.gears[train::kR2].base_radius_m;
    c.planet_torsion =
        lever * lever / (n * positive_stiffness(*k, "torsional stiffness of a planet [N m/rad]"));
  }
  if (springs.bearings) c.bearings = n * bearing_compliance(train, *springs.bearings);
  if (const auto& k = springs.sun_shaft_Nm_rad) {
    c.sun_shaft = 1.0 / (i * i * positive_stiffness(*k, "stiffness of the sun's shaft [N m/rad]"));
  }
  if (const auto& k = springs.ring2_Nm_rad) {
    c.ring2 = 1.0 / positive_stiffness(*k, "stiffness of ring R2 [N m/rad]");
  }
  const T sum =
      c.mesh[0] + c.mesh[1] + c.mesh[2] + c.planet_torsion + c.bearings + c.sun_shaft + c.ring2;
  result.output_Nm_rad = 1.0 / sum;
  result.input_Nm_rad = result.output_Nm_rad / (i * i);
  return result;
}

#define INSTANTIATE(T)                                                          \
  template TrainStiffness<T> train_stiffness<T>(const train::TrainGeometry<T>&, \
                                                const TrainSprings<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
