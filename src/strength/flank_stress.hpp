#pragma once
// Contact stress between two flanks.

#include "geometry/mesh.hpp"
#include "strength/elasticity.hpp"
#include "strength/factor.hpp"
#include "strength/root_stress.hpp"

namespace gear3k::strength {

/// Elasticity factor Z_E = √(1/(π ((1 − ν1²)/E1 + (1 − ν2²)/E2))).  Source: IACS UR M56.
/// @returns Z_E [√Pa]
/// @throws std::invalid_argument as check_elasticity()
double elasticity_factor(const Elasticity& gear1, const Elasticity& gear2);

/// Reduced radius of curvature 1/ρ = 1/ρ1 ± 1/ρ2 of two flanks whose contact is at a distance from
/// the base circles' tangent points.
template <class T>
struct FlankCurvature {
  T length1_m{}, length2_m{};  ///< ρ1, ρ2
  T reduced_m{};               ///< ρ1 ρ2/(d sin α_w)
};
/// At the pitch point: ρ1 = rb1 tan α_w, ρ2 = rb2 tan α_w.
template <class T>
FlankCurvature<T> pitch_point_curvature(const geometry::GearGeometry<T>& gear1,
                                        const geometry::GearGeometry<T>& gear2,
                                        const geometry::MeshGeometry<T>& mesh);

/// Contact stress of a mesh.
///
///   σ_H0 = Z_H Z_E Z_ε √(F_t/b (1/d1 ± 1/d2)),  1/d1 ± 1/d2 = (u ± 1)/(u d1)
///   Z_H  = √(2 cos α_w/(cos² α sin α_w)),  Z_ε = √((4 − ε)/3)
///   Z_B  = max(1, √(ρ_C1 ρ_C2/(ρ_B1 ρ_B2))),  ρ_B1 = ρ_a1 − p_b,  ρ_B2 = d sin α_w ∓ ρ_B1
///   Z_D    the same from the tip of gear 2; 1 for a ring
///   σ_H  = Z_{B|D} σ_H0 √(K_A K_γ K_v K_Hβ K_Hα)
///
/// Identity: Z_H Z_E √(F_t/b …) = Z_E √(F_n/(b ρ_red)), Hertz at the pitch point (docs/theory §43).
/// Source: IACS UR M56.  Valid: 1 ≤ ε ≤ 2; the formula of Z_ε is conservative above and held from
/// ε = 3 on, outside it contact_ratio.in_range is false.  Kinks: Z_B = 1, Z_D = 1, ε = 3.  Where B
/// would lie within 1/1000 of the way from a tangent point it is taken there, out of range.
template <class T>
struct FlankStress {
  T zone_factor{};               ///< Z_H
  double elasticity_factor{};    ///< Z_E [√Pa]
  Factor<T> contact_ratio{};     ///< Z_ε
  Factor<T> single_contact1{};   ///< Z_B: factor on the stress of gear 1
  Factor<T> single_contact2{};   ///< Z_D: of gear 2
  T nominal_Pa{};                ///< σ_H0
  T pitch_point_Pa{};            ///< σ_H0 √K
  T stress1_Pa{}, stress2_Pa{};  ///< σ_H of gears 1 and 2
};

/// A mesh with the elastic constants of its gears.
template <class T>
struct ContactPair {
  const geometry::GearGeometry<T>& gear1;
  const geometry::GearGeometry<T>& gear2;
  const geometry::MeshGeometry<T>& mesh;
  Elasticity elasticity1, elasticity2;
};

/// @param load  F_t = F_n cos α of one planet, common face width
/// @param factors  K_A K_γ K_v K_Hβ K_Hα
/// @throws std::invalid_argument when b is not positive, F_t negative, or as elasticity_factor()
template <class T>
FlankStress<T> flank_stress(const ContactPair<T>& pair, const ToothLoad<T>& load,
                            const LoadFactorSet<T>& factors);

}  // namespace gear3k::strength
