#pragma once
// How far a loaded tooth gives way: bending, shear and compression of the tooth, its body, contact.
//
// Plane strain: compliances are per unit face width, [1/Pa] = displacement along the line of action
// over force per width.

#include <array>
#include <span>

#include "geometry/tooth_form.hpp"
#include "strength/elasticity.hpp"
#include "strength/root_section.hpp"

namespace gear3k::strength {

/// A slice of a tooth across its axis.
template <class T>
struct BeamSlice {
  T height_m{};     ///< above the base section, towards the tip
  T thickness_m{};  ///< chord
  T length_m{};     ///< along the axis: the quadrature's weight
};

/// A normal force on the flank, as the tooth's beam sees it.
template <class T>
struct BeamLoad {
  T crossing_height_m{};  ///< h_c above the base section, where the load's line crosses the axis
  T tan_angle{};  ///< tan α_F, α_F between the load's line and the perpendicular to the axis
};

/// Moduli of a beam: for normal stress E (plane stress) or E' (plane strain), for shear G.
struct BeamModuli {
  double normal_Pa = 0.0, shear_Pa = 0.0;
};

/// Compliance of a tooth as a beam by strain energy.
///
///   12 cos² α_F ∫ (h − h_c)²/s³ dh/E_n + 1.2 cos² α_F ∫ dh/s/G + sin² α_F ∫ dh/s/E_n
///
/// Source: Weber's and Ishikawa's formulas as in a public `tooth_stiffness.py`; docs/theory §52.
/// Checked with ROSS's tooth against ROSS's published numbers (tests).
template <class T>
T beam_compliance(std::span<const BeamSlice<T>> slices, const BeamLoad<T>& load,
                  const BeamModuli& moduli);

/// Compliance of the half plane in which a tooth is clamped.
///
///   cos² α_F/E' (5.306 p² + 2 (1 − ν − 2ν²)/(1 − ν²) p + 1.534 (1 + 0.4167 tan² α_F/(1 + ν))),
///   p = h_c/s_base
///
/// Source: as beam_compliance().
template <class T>
T body_compliance(const BeamLoad<T>& load, const T& base_chord_m, const Elasticity& material);

/// Approach of a cylinder's surface and the tooth's axis by the pressure of a Hertzian line
/// contact.
///
///   2/(πE') (asinh(h/b_H) − ν/(1 − ν) (h/b_H) (√(1 + (h/b_H)²) − h/b_H))
///   → 2/(πE') (ln(2h/b_H) − ν/(2(1 − ν)))  for h ≫ b_H
///
/// Source: own derivation, docs/theory §52 (strain along the normal under a half ellipse of
/// pressure); the limit: gearcalc.  Positive for any h and b_H > 0.
/// @param depth_m       h, from the contact to the axis along the load's line
/// @param half_width_m  b_H
template <class T>
T contact_compliance(const T& depth_m, const T& half_width_m, const Elasticity& material);

/// Half width of a Hertzian line contact: b_H = √(4 w ρ_red Σ(1/E')/π).
/// @param line_load_N_m  w, force per width
template <class T>
T contact_half_width(const T& line_load_N_m, const T& reduced_radius_m, const Elasticity& material1,
                     const Elasticity& material2);

/// What of a tooth does not depend on where it is loaded.
template <class T>
struct ElasticTooth {
  double outwards = 1.0;  ///< +1 external, −1 ring: sense of the tooth along its axis
  T base_radius_m{};
  T base_half_angle_rad{};  ///< of the tooth, on the base circle
  T form_length_m{};        ///< ρ_F: the flank begins here
  T form_height_m{};        ///< of the flank's beginning above the base section
  T form_normal_angle_rad{};
  RootSection<T> base;
  geometry::Fillet<T> fillet;
  double pitch_half_rad = 0.0;  ///< π/z
  static constexpr std::size_t kFilletSlices = 8;
  std::array<BeamSlice<T>, kFilletSlices> fillet_slices{};
};

/// The generated tooth: contour of geometry::ToothForm between base section and flank.
template <class T>
ElasticTooth<T> make_elastic_tooth(const geometry::GearGeometry<T>& gear,
                                   const geometry::ToothForm<T>& form);

/// Load on a tooth's flank at a distance ρ along the line of action.
///
///   tan α_e = ρ/rb,   α_F = α_e ∓ ψ_e,   h_c = ± (rb/cos α_F − y_base)     (− + external, + −
///   ring)
template <class T>
struct FlankLoad {
  BeamLoad<T> beam;
  T depth_m{};  ///< from the flank to the axis along the load's line
};
/// @param curvature_m  ρ, from the base circle's tangent point
template <class T>
FlankLoad<T> flank_load(const ElasticTooth<T>& tooth, const T& curvature_m);

/// Beam and body of a tooth loaded at ρ, in plane strain.
///
/// The beam reaches from the base section to h_c.  Where h_c < 0 (a contact near the root of a
/// tooth with many teeth) its integrals and p go on with the base section's thickness and are
/// negative, so that the compliance stays smooth.
/// Truncation: 1e-6 of the compliance (Gauss-Legendre; tested).  Own plane-strain finite elements
/// found one tooth of this kind within −18 % … +21 %; the gears' teeth and bodies beside it, rims
/// and face-width effects are not in it.
/// @returns [1/Pa]
template <class T>
T tooth_compliance(const ElasticTooth<T>& tooth, const FlankLoad<T>& load,
                   const Elasticity& material);

}  // namespace gear3k::strength
