#pragma once
// The section of a tooth's root that is rated: where the fillet's tangent makes a given angle with
// the tooth's axis.

#include <numbers>

#include "geometry/tooth_form.hpp"

namespace gear3k::strength {

/// Angle between the fillet's tangent and the tooth's axis at the rated section: 30° on external
/// gears, 60° on rings.  Source: IACS UR M56 (ISO 6336-3 method B).
inline constexpr double kExternalTangentAngle_rad = std::numbers::pi / 6.0;
inline constexpr double kRingTangentAngle_rad = std::numbers::pi / 3.0;
inline double root_tangent_angle(geometry::GearKind kind) {
  return kind == geometry::GearKind::kRing ? kRingTangentAngle_rad : kExternalTangentAngle_rad;
}

/// The chord across a tooth between the two fillet points of one tangent angle.
template <class T>
struct RootSection {
  T chord_m{};          ///< s_F
  T height_m{};         ///< y_F: distance of the chord from the gear's axis
  T fillet_radius_m{};  ///< ρ_F: radius of curvature of the fillet there
  double tangent_angle_rad = 0.0;
  T normal_angle_rad{};  ///< γ on the fillet (geometry::Fillet); 0 of a virtual rack
  /// False where no point of the fillet has this tangent: the section is at the fillet's end on the
  /// flank.
  bool on_fillet = true;
};

/// Section of the generated fillet.  With ψ the angle of the space's middle from the line of
/// centres (geometry::CuttingPosition) and η of the fillet point from the space's middle,
///
///   γ ∓ (ψ + π/z) = τ                          (− external, + ring)
///   s_F = 2 r sin(π/z − η),  y_F = r cos(π/z − η)
///   ρ_F = ρ + t²/(D sin γ + t),  D = r (rack), r_w r_w0/(r_w − r_w0) (cutter);  ρ_F = ρ (arc)
///
/// Newton's method within a bracket for the value; two more steps carry the derivatives.
/// Source: own derivation, docs/theory §41; for the rack equal to the form factor's section of IACS
/// UR M56.  Teeth that are thinned by q are rated as they are; reports that print a nominal shift
/// want q = 0.
/// Accuracy: 1e-12 modules against the rack formula (tests/strength/root_section_test.cpp).
/// @param tangent_angle_rad  τ, 0 < τ < π/2
/// @throws std::invalid_argument outside that range or NaN
template <class T>
RootSection<T> root_section(const geometry::GearGeometry<T>& gear,
                            const geometry::ToothForm<T>& form, double tangent_angle_rad);
template <class T>
RootSection<T> root_section(const geometry::GearGeometry<T>& gear,
                            const geometry::ToothForm<T>& form) {
  return root_section(gear, form, root_tangent_angle(gear.gear.kind));
}

/// Section of the virtual rack that ISO 6336-3:2007 puts in place of a ring's tool: the rack
/// formula with −z, −x and τ = 60°, and a tip radius that is given.
///
///   E = π/4 − hfP* tan α − (1 − sin α) ρ*/cos α     G = ρ* − hfP* + x_I     (x_I = −x, z_I = −z)
///   H = (2/z_I)(π/2 − E) − (π/2 − τ),   θ = (2G/z_I) tan θ − H,   w = G/cos θ − ρ*
///   s_F = m (z_I sin(π/2 − τ − θ) + 2 w cos τ),   y_F = m |z_I cos(π/2 − τ − θ)/2 + w sin τ|
///   ρ_F = m |ρ* + 2G²/(cos θ (z_I cos² θ − 2G))|
///
/// Source: IACS UR M56 (rack formula); that the report of stage_01 follows it for its ring with
/// ρ* = 0.380255: tests/golden/kisssoft_stage_01_strength.toml.  The standard's own formula of ρ*
/// has no readable source, so ρ* is an input; root_section() is the exact tool and the default.
/// Does not account for: the cutter.  Thinning by q is left out.
/// @param virtual_root_radius  ρ*, in modules, ≥ 0
/// @throws std::invalid_argument when the gear is external, or ρ* is negative or NaN
template <class T>
RootSection<T> virtual_rack_section(const geometry::GearGeometry<T>& ring,
                                    double virtual_root_radius);

}  // namespace gear3k::strength
