#pragma once
// Two gears in mesh at a given centre distance.

#include <optional>

#include "geometry/gear.hpp"

namespace gear3k::geometry {

/// Sign of gear 2's tooth number in formulas that hold for both kinds: +1 external, −1 ring.
inline double mesh_sign(GearKind gear2) { return gear2 == GearKind::kRing ? -1.0 : 1.0; }

/// Sum of the base radii, rb2 ± rb1 (− for a ring): the least centre distance of the mesh is above
/// it.
template <class T>
T base_radius_sum(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2);

/// A mesh of gear 1 (external) with gear 2 (external or ring) at centre distance d.
///
///   cos α_w = (rb2 ± rb1)/d                (+ external, − ring)
///   e1 = ( ρ_a1 − rb1 tan α_w)/p_b         share of the contact ratio on gear 1's addendum
///   e2 = ( ρ_a2 − rb2 tan α_w)/p_b  external,  (rb2 tan α_w − ρ_a2)/p_b  ring
///   ε  = e1 + e2,  p_b = π m cos α
///
/// The addendum of the driving gear is swept in recess, that of the driven gear in approach:
/// e_a is that of the driven and e_r that of the driving gear.  A share may be negative (the whole
/// path lies on one side of the pitch point) or exceed 1.
/// Source: ISO 21771 (path of contact), docs/theory §3.
/// Valid: equal module and pressure angle; tips outside their base circles.
template <class T>
struct MeshGeometry {
  T center_distance_m{};  ///< d
  T alpha_w_rad{};        ///< working pressure angle
  T tan_alpha_w{};
  T tangent_length_m{};         ///< d sin α_w: distance of the two base circles' tangent points
  T base_pitch_m{};             ///< p_b
  T addendum_contact_ratio1{};  ///< e1
  T addendum_contact_ratio2{};  ///< e2
  T contact_ratio{};            ///< ε
};

/// The geometry of a mesh; empty where the base circles leave no real working angle
/// (cos α_w ≥ 1, or a ring not larger than its pinion).
template <class T>
std::optional<MeshGeometry<T>> make_mesh_geometry(const GearGeometry<T>& gear1,
                                                  const GearGeometry<T>& gear2,
                                                  const T& center_distance_m);

/// Working pressure angle at which the full (not thinned: q = 0) teeth mesh without backlash.
///
///   external: inv α_w = inv α + 2 tan α (x1 + x2)/(z1 + z2)
///   ring:     inv α_w = inv α + 2 tan α (x2 − x1)/(z2 − z1)
///
/// Machining allowances do not enter: they open backlash at this distance.
/// Source: ISO 21771 (working pressure angle); KHK Gear Technical Data (internal gears).
/// @returns α_w [rad]; empty where inv α_w would not be positive: no such distance exists
template <class T>
std::optional<T> zero_backlash_angle(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2);

/// Centre distance without backlash for given shifts: d = (rb2 ± rb1)/cos α_w.
/// @returns d [m]; empty where zero_backlash_angle() is
template <class T>
std::optional<T> zero_backlash_center_distance(const GearGeometry<T>& gear1,
                                               const GearGeometry<T>& gear2);

/// What the KHK tip rule needs of an external mesh.
template <class T>
struct ExternalShifts {
  int teeth_sum = 0;  ///< z1 + z2
  T module_m{};
  T shift_sum{};  ///< x1 + x2
  T center_distance_m{};
};

/// Tip shortening by the KHK rule, equal on both gears of an external mesh: it keeps the root
/// clearance of the basic rack where the shifts bring the gears closer than x1 + x2 says.
///
///   k = x1 + x2 − y,  y = d/m − (z1 + z2)/2,  so that h_a1 = (1 + y − x2) m;  k ≥ 0
///
/// Source: KHK Gear Technical Data (profile-shifted spur gears; h_a1, h_a2).
/// @returns k in modules; 0 where the rule would lengthen the teeth
template <class T>
T khk_tip_shortening(const ExternalShifts<T>& mesh);

}  // namespace gear3k::geometry
