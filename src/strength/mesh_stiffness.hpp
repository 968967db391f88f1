#pragma once
// Stiffness of a mesh: by ISO 6336-1, and over the path of contact.

#include <cmath>
#include <optional>

#include "geometry/mesh.hpp"
#include "strength/tooth_stiffness.hpp"
#include "units/units.hpp"

namespace gear3k::strength {

/// What ISO's single stiffness needs of a pair; lengths over the module.
template <class T>
struct IsoPair {
  int teeth1 = 0;               ///< of the gear with fewer teeth, external
  T profile_shift1{};           ///< x1
  std::optional<int> teeth2{};  ///< of an external mate; empty: a ring
  T profile_shift2{};  ///< x2 in ISO's sense: of a ring, the negative of Gear::profile_shift
  T dedendum1{};       ///< hfP* of gear 1 and of gear 2
  T dedendum2{};
};
/// The pair of two gears, in ISO's order and sense.
/// @throws std::invalid_argument for two rings
template <class T>
IsoPair<T> iso_pair(const geometry::GearGeometry<T>& gear1, const geometry::GearGeometry<T>& gear2);

/// q, the flexibility of a pair of steel teeth per face width.
///
///   q = 0.04723 + 0.15551/z1 + 0.25791/z2 − 0.00635 x1 − 0.11654 x1/z1 − 0.00193 x2
///       − 0.24188 x2/z2 + 0.00529 x1² + 0.00182 x2²,   ring: 1/z2 = 0   [mm µm/N]
///
/// Source: ISO 6336-1 (method B) by way of gfsReboucas/Drivetrain, with x2 for its misprinted x2²
/// in the sixth term.  Valid: −0.5 ≤ x1 + x2 ≤ 2 (a check); the value stands outside.
/// @returns q [m/N · m = 1/Pa]: the number of the standard times 1e-9
template <class T>
T iso_flexibility(const IsoPair<T>& pair);
/// x1 + x2 for which q is stated, and whether they are there.
inline constexpr double kLeastShiftSum = -0.5, kGreatestShiftSum = 2.0;
template <class T>
bool iso_flexibility_in_range(const IsoPair<T>& pair);

/// Whether the pressure angle is that of the basic rack which C_B is stated for, 20°.
template <class T>
bool is_of_iso_rack(const geometry::PressureAngle<T>& angle) {
  constexpr double kIsoAngle_rad = 20.0 * units::kDegree, kSlack_rad = 1e-9;
  return std::abs(value_of(angle.alpha_rad) - kIsoAngle_rad) <= kSlack_rad;
}

/// Mesh stiffness per face width by ISO.
///
///   c'   = 0.8 C_R C_B E_r/(206000 N/mm² q),   E_r = 2 E1 E2/(E1 + E2)
///   C_B  = mean of both gears' 1 + 0.5 (1.2 − hfP*)
///   c' is multiplied by (w/100 N/mm)^¼ for w < 100 N/mm
///   c_γα = c' (0.75 ε + 0.25),   c_γβ = 0.85 c_γα
///
/// Source: ISO 6336-1 by way of gfsReboucas/Drivetrain.  C_B is that of a basic rack of 20°; no
/// source is at hand for other pressure angles, and none is corrected for.
struct IsoLoading {
  Elasticity material1{}, material2{};
  double web_factor = 1.0;  ///< C_R
};
/// All [Pa]; N/(mm µm) is 1e9 Pa.
template <class T>
struct IsoStiffness {
  T single{};             ///< c'
  T mesh_alpha{};         ///< c_γα
  T mesh_beta{};          ///< c_γβ
  bool low_load = false;  ///< w < 100 N/mm: the branch of the load factor
};
/// @param line_load_N_m  w = F_t K_A/b, ≥ 0
template <class T>
IsoStiffness<T> iso_stiffness(const IsoPair<T>& pair, const T& contact_ratio,
                              const IsoLoading& loading, const T& line_load_N_m);

/// A mesh as its elasticity sees it.
template <class T>
struct ElasticMesh {
  ElasticTooth<T> tooth1{}, tooth2{};
  double sign = 1.0;     ///< +1 external, −1 gear 2 is a ring
  T tangent_length_m{};  ///< L = d sin α_w
  T base_pitch_m{};
  T path_begin_m{}, path_end_m{};  ///< ρ of gear 1 at the ends of the path of contact
  Elasticity material1{}, material2{};
  T line_load_N_m{};  ///< w, force per face width that a pair carries: for the contact
};
/// @throws std::invalid_argument for elastic constants out of range, or unless w > 0
template <class T>
ElasticMesh<T> make_elastic_mesh(const geometry::GearGeometry<T>& gear1,
                                 const geometry::ToothForm<T>& form1,
                                 const geometry::GearGeometry<T>& gear2,
                                 const geometry::ToothForm<T>& form2,
                                 const geometry::MeshGeometry<T>& mesh, const Elasticity& material1,
                                 const Elasticity& material2, const T& line_load_N_m);

/// Stiffness of one pair of teeth in contact at ρ1: the two teeth and the two sides of the contact
/// in series.
///
///   ρ2 = L − ρ1 external, L + ρ1 ring;   ρ_red = ρ1 ρ2/L
///
/// Against ISO's 1/q see the tests: within 8 % on external pairs, 12 % on rings.
/// @param curvature1_m  ρ1 > 0, and ρ2 > 0
/// @returns k per face width [Pa]
template <class T>
T pair_stiffness(const ElasticMesh<T>& mesh, const T& curvature1_m);

/// Mean stiffness over a base pitch: k̄ = (1/p_b) ∫ k dρ1 over the path of contact.
///
/// Pairs in contact at the same time are springs side by side, for any contact ratio; the steps
/// between one and two pairs drop out of the mean, which is smooth in the design.  Where the path
/// would begin at a base circle's tangent point or beyond (interference), from 1e-3 p_b after it.
/// Truncation: tested against a fine trapezoidal rule.  Valid: ε > 0.
/// @returns k̄ per face width [Pa]; ≤ 0 where there is no path
template <class T>
T mean_mesh_stiffness(const ElasticMesh<T>& mesh);

}  // namespace gear3k::strength
