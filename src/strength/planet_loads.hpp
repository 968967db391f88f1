#pragma once
// The forces on a planet, its bearings and its pin.

#include <array>

#include "strength/mesh_forces.hpp"

namespace gear3k::strength {

/// Places along the axis of a planet [m], from any common origin.
template <class T>
struct PlanetAxis {
  T plane1_m{}, plane2_m{};        ///< z1, z2: middle of the toothings P1, P2
  T support_a_m{}, support_b_m{};  ///< z_A, z_B: the two bearings
  T mass_center_m{};               ///< z_m: where the centrifugal force acts
};
/// @throws std::invalid_argument when both supports lie in one plane, or a place is not finite
template <class T>
void check_planet_axis(const PlanetAxis<T>& axis);

/// A force across the axis: outwards from the main axis, and tangential in the sense in which R2
/// turns.
template <class T>
struct TransverseForce {
  T radial_N{}, tangential_N{};
};
template <class T>
T magnitude_of(const TransverseForce<T>& force);

/// Forces of the teeth on a planet in the planes of P1 and P2.
///
///   plane 1: (F_1 sin α_w1 − F_2 sin α_w2, f_1 + f_2),   plane 2: (−F_3 sin α_w3, f_3)
///
/// Source: own derivation, docs/theory §54.  The radial share of friction is left out.
template <class T>
std::array<TransverseForce<T>, 2> plane_forces(const train::TrainGeometry<T>& train,
                                               const MeshForces<T>& forces);

/// Reactions of the supports A, B on the planet.
///
///   R_A = −Σ f_j (z_B − z_j)/(z_B − z_A),   R_B = −Σ f_j − R_A
template <class T>
std::array<TransverseForce<T>, 2> support_reactions(const PlanetAxis<T>& axis,
                                                    const std::array<TransverseForce<T>, 2>& plane,
                                                    const T& centrifugal_N);

/// Loads of one planet.
template <class T>
struct PlanetLoads {
  std::array<TransverseForce<T>, 2> plane{};  ///< of the teeth, in the planes of P1, P2
  T centrifugal_N{};                          ///< m_P d ω_C², outwards
  /// f_3 (z2 − z1): with no torque on the carrier the tangential forces of the two planes are equal
  /// and opposite, and tilt the planet.
  T tilting_couple_Nm{};
  std::array<TransverseForce<T>, 2> reaction{};  ///< of the supports A, B on the planet
  std::array<T, 2> bearing_load_N{};             ///< their magnitudes
  T bending_moment_Nm{};                         ///< greatest in the pin, which rests on A and B
  T bending_position_m{};
};
/// Pin as a beam on the two supports under the forces of the planes and the centrifugal force; its
/// moment is greatest at one of these five places.
///
/// Source: own derivation, docs/theory §54.
/// @param planet_mass_kg,carrier_speed_rad_s  ≥ 0 and any
/// @throws std::invalid_argument as check_planet_axis()
template <class T>
PlanetLoads<T> planet_loads(const train::TrainGeometry<T>& train, const MeshForces<T>& forces,
                            const PlanetAxis<T>& axis, const T& planet_mass_kg,
                            const T& carrier_speed_rad_s);

/// Bending stress of a solid round pin: σ = 32 M/(π d³) [Pa].
/// @throws std::invalid_argument unless d > 0
template <class T>
T pin_bending_stress(const T& bending_moment_Nm, const T& pin_diameter_m);

}  // namespace gear3k::strength
