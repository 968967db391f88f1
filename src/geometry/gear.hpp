#pragma once
// One spur gear, external or ring: what the designer gives, and the circles that follow from it.

#include "geometry/scalar.hpp"

namespace gear3k::geometry {

enum class GearKind { kExternal, kRing };

/// Basic rack tooth profile, in modules.  Defaults are those of the interface (1.0, 1.25, 0.38).
template <class T>
struct BasicRack {
  T addendum = constant<T>(1.0);      ///< haP*
  T dedendum = constant<T>(1.25);     ///< hfP*
  T root_radius = constant<T>(0.38);  ///< ρfP*
};

/// Standard pressure angle α of the basic rack with its trigonometric values, computed once.
template <class T>
struct PressureAngle {
  T alpha_rad{}, sin{}, cos{}, tan{}, involute{};
};

/// @param alpha_rad  standard pressure angle [rad], 0 < α < π/2
/// @throws std::invalid_argument outside that range or NaN
template <class T>
PressureAngle<T> make_pressure_angle(const T& alpha_rad);

/// The pinion-type cutter that shapes a ring.  Its addendum is not given: it follows from the
/// ring's root circle, docs/theory §15.
struct PinionCutter {
  int teeth = 0;               ///< z0; 0: no cutter, the ring's root is filleted by an arc
  double profile_shift = 0.0;  ///< x0, in modules
  double tip_radius = 0.0;     ///< ρ_a0*, in modules: rounding of the cutter's tip corners
};

/// What is given of one gear.  Ring teeth are counted positive; ring profile shift is positive when
/// it moves the ring's tooth space outwards (KHK convention).
template <class T>
struct Gear {
  int teeth = 0;
  GearKind kind = GearKind::kExternal;
  T module_m{};             ///< m
  T profile_shift{};        ///< x, in modules
  T machining_allowance{};  ///< q, in modules: normal thinning of the whole tooth is m q
  T tip_shortening{};       ///< k ≥ 0, in modules; shortens the tooth on rings too
  BasicRack<T> rack;
  PinionCutter cutter{};  ///< rings only
};

/// The circles of a gear.
///
///   r = m z/2,  rb = r cos α
///   external: ra = m (z/2 + haP* + x − k),  rf = m (z/2 − hfP* + x)
///   ring:     ra = m (z/2 − haP* + x + k),  rf = m (z/2 + hfP* + x)
///
/// Source: ISO 21771 with the KHK sign for rings; KHK Gear Technical Data, internal gears.
/// Thinning by q leaves every circle where it is: the tool's teeth are thicker by it
/// (docs/theory §14).
template <class T>
struct GearGeometry {
  Gear<T> gear{};
  PressureAngle<T> angle{};
  T reference_radius_m{}, base_radius_m{}, tip_radius_m{}, root_radius_m{};
};

/// @throws std::invalid_argument when teeth < 1, the module is not positive, or a shift, allowance
/// or
///         shortening is not finite
template <class T>
GearGeometry<T> make_gear_geometry(const Gear<T>& gear, const PressureAngle<T>& angle);

/// Transverse tooth thickness (arc) on the reference circle.
///
///   external: s = m (π/2 + 2 x tan α) − m q / cos α
///   ring:     s = m (π/2 − 2 x tan α) − m q / cos α
///
/// Source: ISO 21771; q is measured normal to the flank, over the whole tooth.
/// @returns s [m]
template <class T>
T reference_tooth_thickness(const GearGeometry<T>& g);

/// Transverse tooth thickness (arc) on the circle of radius r_y.
///
///   external: s_y = 2 r_y (s/(2r) + inv α − inv α_y),  cos α_y = rb/r_y
///   ring:     s_y = 2 r_y (s/(2r) − inv α + inv α_y)
///
/// Source: ISO 21771.  Inside the base circle there is no involute: the value at the base circle's
/// angle (α_y = 0) is returned, so that a table can still be printed; the check
/// `ring_tip_outside_base` then fails.
/// @returns s_y [m], negative when the flanks cross before r_y
template <class T>
T tooth_thickness(const GearGeometry<T>& g, const T& radius_m);

/// Distance of the flank's point on the tip circle from the line of action's tangent point.
///
///   ρ_a = sqrt(ra² − rb²)
///
/// @returns ρ_a [m]; 0 (without derivatives) when the tip lies inside the base circle
template <class T>
T tip_curvature_radius(const GearGeometry<T>& g);

}  // namespace gear3k::geometry
