#pragma once
// Exact Coulomb friction along the path of contact of one mesh.

#include <ceres/jet.h>

#include <limits>

#include "efficiency/mesh_loss.hpp"

namespace gear3k::efficiency {

/// Torque of friction over that of the normal force on a gear from which on flanks jam: short of 1
/// by rounding, as the integrals along the path have the difference for a divisor.
inline constexpr double kJammingFriction = 1.0 - 256.0 * std::numeric_limits<double>::epsilon();

/// Efficiency of a pair of flanks at a distance of s base pitches from the pitch point.
///
///   (1 − σ μ ρ_f/r_bf)/(1 − σ μ ρ_d/r_bd),  ρ_d/r_bd = tan α_w + 2π s/z_d,
///                                           ρ_f/r_bf = tan α_w − 2π s/z_f
///
/// d the driving, f the driven gear; s < 0 in approach (σ = +1), s > 0 in recess (σ = −1); teeth of
/// a ring negative.  Source: balance of two rigid gears with one contact point,
/// docs/theory §23; the same as eqs. 2.1-2.2 of the directional-impedance thesis.
/// Valid: positive numerator and denominator; else the flanks jam, and 0 is returned.
template <class T>
T path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu, const T& s);

/// Efficiency of a mesh under exact Coulomb friction: the mean over one base pitch, at constant
/// torque of the driving gear, of driven over driving torque with all pairs in contact at equal
/// normal forces.
///
///   η = ⟨ Σ (1 − σ_i μ ρ_fi/r_bf) / Σ (1 − σ_i μ ρ_di/r_bd) ⟩
///
/// Any e_a, e_r and ε, also ε ≤ 0, as sliding_factor().  Tends to the first-order model
/// as μ → 0 with a remainder of second order.  Integrals in closed form on pieces without kinks.
/// Source: own derivation, docs/theory §23.  Accuracy: 1e-15, for any friction.
/// @returns 0 where the flanks jam in some position
template <class T>
T coulomb_path_efficiency(const MeshContact<T>& contact, const FlankFriction<T>& mu);

/// Coefficients of friction in approach and in recess, μ times the factor of either.
template <class T>
struct SidesFriction {
  T approach, recess;
};
/// Value and derivatives by the two.
using JetSides = ceres::Jet<double, 2>;

/// The same of gears as drawn, of which nothing varies but the friction: of plain numbers or of
/// JetSides, in a part of the time of a scalar with all derivatives.
template <class T>
T drawn_path_efficiency(const MeshContact<double>& contact, const SidesFriction<T>& mu);

}  // namespace gear3k::efficiency
