#include "strength/planet_loads.hpp"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <stdexcept>

namespace gear3k::strength {

namespace {

/// A force at a place of the axis.
template <class T>
struct PlacedForce {
  T position_m{};
  TransverseForce<T> force{};
};

}  // namespace

template <class T>
void check_planet_axis(const PlanetAxis<T>& axis) {
  for (const T& place :
       {axis.plane1_m, axis.plane2_m, axis.support_a_m, axis.support_b_m, axis.mass_center_m}) {
    if (!std::isfinite(value_of(place))) {
      throw std::invalid_argument(
          fmt::format("planet: place on the axis = {} m, allowed: a number", value_of(place)));
    }
  }
  if (value_of(axis.support_a_m) == value_of(axis.support_b_m)) {
    throw std::invalid_argument(
        fmt::format("planet: both bearings at {} m, allowed: two places on the axis",
                    value_of(axis.support_a_m)));
  }
}

template <class T>
T magnitude_of(const TransverseForce<T>& force) {
  using std::sqrt;
  const T square = force.radial_N * force.radial_N + force.tangential_N * force.tangential_N;
  return value_of(square) > 0.0 ? T(sqrt(square)) : constant<T>(0.0);
}

template <class T>
std::array<TransverseForce<T>, 2> plane_forces(const train::TrainGeometry<T>& train,
                                               const MeshForces<T>& forces) {
  using std::sin;
  std::array<T, train::kMeshCount> radial{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    // The sun presses the planet outwards, the rings press it inwards.
    const double outwards = k == train::kMeshSP1 ? 1.0 : -1.0;
    radial[k] = outwards * forces.normal_N[k] * sin(train.meshes[k].alpha_w_rad);
  }
  return {{{.radial_N = radial[train::kMeshSP1] + radial[train::kMeshP1R1],
            .tangential_N =
                forces.tangential_N[train::kMeshSP1] + forces.tangential_N[train::kMeshP1R1]},
           {.radial_N = radial[train::kMeshP2R2],
            .tangential_N = forces.tangential_N[train::kMeshP2R2]}}};
}

template <class T>
std::array<TransverseForce<T>, 2> support_reactions(const PlanetAxis<T>& axis,
                                                    const std::array<TransverseForce<T>, 2>& plane,
                                                    const T& centrifugal_N) {
  const T span = axis.support_b_m - axis.support_a_m;
  const T share1 = (axis.support_b_m - axis.plane1_m) / span;
  const T share2 = (axis.support_b_m - axis.plane2_m) / span;
  const T share_m = (axis.support_b_m - axis.mass_center_m) / span;
  TransverseForce<T> a;
  a.radial_N = -(share1 * plane[0].radial_N + share2 * plane[1].radial_N + share_m * centrifugal_N);
  a.tangential_N = -(share1 * plane[0].tangential_N + share2 * plane[1].tangential_N);
  TransverseForce<T> b;
  b.radial_N = -(plane[0].radial_N + plane[1].radial_N + centrifugal_N) - a.radial_N;
  b.tangential_N = -(plane[0].tangential_N + plane[1].tangential_N) - a.tangential_N;
  return {a, b};
}

template <class T>
PlanetLoads<T> planet_loads(const train::TrainGeometry<T>& train, const MeshForces<T>& forces,
                            const PlanetAxis<T>& axis, const T& planet_mass_kg,
                            const T& carrier_speed_rad_s) {
  check_planet_axis(axis);
  PlanetLoads<T> loads;
  loads.plane = plane_forces(train, forces);
  loads.centrifugal_N =
      planet_mass_kg * train.center_distance_m * carrier_speed_rad_s * carrier_speed_rad_s;
  loads.tilting_couple_Nm = loads.plane[1].tangential_N * (axis.plane2_m - axis.plane1_m);
  loads.reaction = support_reactions(axis, loads.plane, loads.centrifugal_N);
  const std::array<PlacedForce<T>, 5> placed{
      {{axis.support_a_m, loads.reaction[0]},
       {axis.plane1_m, loads.plane[0]},
       {axis.mass_center_m, {loads.centrifugal_N, constant<T>(0.0)}},
       {axis.plane2_m, loads.plane[1]},
       {axis.support_b_m, loads.reaction[1]}}};
  loads.bending_moment_Nm = constant<T>(0.0);
  loads.bending_position_m = axis.support_a_m;
  for (const PlacedForce<T>& at : placed) {
    // Moment of the forces on one side of the section.
    TransverseForce<T> moment{.radial_N = constant<T>(0.0), .tangential_N = constant<T>(0.0)};
    for (const PlacedForce<T>& p : placed) {
      const T arm = at.position_m - p.position_m;
      if (!(value_of(arm) > 0.0)) continue;
      moment.radial_N = moment.radial_N + p.force.radial_N * arm;
      moment.tangential_N = moment.tangential_N + p.force.tangential_N * arm;
    }
    const T size = magnitude_of(moment);
    if (value_of(size) > value_of(loads.bending_moment_Nm)) {
      loads.bending_moment_Nm = size;
      loads.bending_position_m = at.position_m;
    }
  }
  for (std::size_t i = 0; i < 2; ++i) loads.bearing_load_N[i] = magnitude_of(loads.reaction[i]);
  return loads;
}

template <class T>
T pin_bending_stress(const T& bending_moment_Nm, const T& pin_diameter_m) {
  if (!(value_of(pin_diameter_m) > 0.0)) {
    throw std::invalid_argument(fmt::format("planet: diameter of the pin = {} m, allowed: above 0",
                                            value_of(pin_diameter_m)));
  }
  return (32.0 / std::numbers::pi) * bending_moment_Nm /
         (pin_diameter_m * pin_diameter_m * pin_diameter_m);
}

#define INSTANTIATE(T)                                                                          \
  template void check_planet_axis<T>(const PlanetAxis<T>&);                                     \
  template T magnitude_of<T>(const TransverseForce<T>&);                                        \
  template std::array<TransverseForce<T>, 2> plane_forces<T>(const train::TrainGeometry<T>&,    \
                                                             const MeshForces<T>&);             \
  template std::array<TransverseForce<T>, 2> support_reactions<T>(                              \
      const PlanetAxis<T>&, const std::array<TransverseForce<T>, 2>&, const T&);                \
  template PlanetLoads<T> planet_loads<T>(const train::TrainGeometry<T>&, const MeshForces<T>&, \
                                          const PlanetAxis<T>&, const T&, const T&);            \
  template T pin_bending_stress<T>(const T&, const T&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
