#pragma once
// The root of a tooth as its tool leaves it: form circle, undercut, fillet.

#include "geometry/gear.hpp"

namespace gear3k::geometry {

/// What shapes the root of a gear.
///
///   kRack    external gears: the basic rack itself, tip corners rounded by ρfP*, rolls on the
///            reference circle; where the two roundings do not fit side by side, they are one arc
///   kCutter  rings: a pinion cutter rolls inside; its tip radius is r_f − a0, so that the root
///            circle is the basic rack's; its tip corners are rounded by ρ_a0*, or by one arc
///   kArc     rings without a cutter (broached, wire-cut, printed): an arc of radius ρfP* m joins
///            flank and root circle; where two such arcs do not fit side by side, one arc that
///            touches both flanks and the root circle
enum class RootTool { kRack, kCutter, kArc };

/// A root fillet: the curve that the tool's rounded corner envelops, over the angle γ that its
/// normal makes with the tangent of the pitch circle, from γ at the flank (normal_angle_rad) to π/2
/// on the root circle.
///
/// The centre C of the rounding lies on the normal through the pitch point P, at the signed
/// distance t from it, and the fillet point is P + (t + ρ) n:
///   rack    t = b/sin γ
///   cutter  t = sqrt(r_C0² − r_w0² cos² γ) − r_w0 sin γ
///   arc     t = 0, P = C
/// Source: own derivation, docs/theory §14, §15.
template <class T>
struct Fillet {
  RootTool tool = RootTool::kRack;
  T rounding_radius_m{};         ///< ρ
  T pitch_radius_m{};            ///< of the gear in cutting: r, r_w; kArc: radius of C
  T rounding_depth_m{};          ///< kRack: b, of C below the pitch line, negative above it
  T cutter_pitch_radius_m{};     ///< kCutter: r_w0
  T rounding_center_radius_m{};  ///< kCutter: r_C0, of C about the cutter's centre
  /// kRack: distance [m] of C from the axis of the tool's tooth; kCutter, kArc: angle [rad] of C
  /// from the axis of the cutter's tooth or of the ring's space.
  T center_offset{};
  double tool_teeth_ratio = 0.0;  ///< kCutter: z0/z
  T normal_angle_rad{};           ///< γ where the flank's envelope and the fillet's meet
};

/// A fillet's values as constants of another scalar.
template <class To, class T>
Fillet<To> fillet_values(const Fillet<T>& f) {
  const auto to = [](const T& x) { return constant<To>(value_of(x)); };
  return {.tool = f.tool,
          .rounding_radius_m = to(f.rounding_radius_m),
          .pitch_radius_m = to(f.pitch_radius_m),
          .rounding_depth_m = to(f.rounding_depth_m),
          .cutter_pitch_radius_m = to(f.cutter_pitch_radius_m),
          .rounding_center_radius_m = to(f.rounding_center_radius_m),
          .center_offset = to(f.center_offset),
          .tool_teeth_ratio = f.tool_teeth_ratio,
          .normal_angle_rad = to(f.normal_angle_rad)};
}

/// Gear and tool as they stand while the fillet point of γ is cut: the distance t of the rounding's
/// centre from the pitch point, the angle from the line of centres to the middle of the tooth
/// space, and their derivatives by γ.
///
///   rack    (t cos γ − m a)/r
///   cutter  (z0/z) (atan2(t cos γ, r_w0 + t sin γ) − η_C0)
///   arc     −η_C
///
/// Source: own derivation, docs/theory §14, §15.
template <class T>
struct CuttingPosition {
  T center_distance_m{}, space_angle_rad{};
  T center_distance_slope_m{}, space_angle_slope{};
};

/// @param normal_angle_rad  γ in (0, π/2]
template <class T>
CuttingPosition<T> cutting_position(const Fillet<T>& fillet, const T& normal_angle_rad);

/// A point of a fillet: radius r, angle η from the middle of the tooth space, and their derivatives
/// by γ.
template <class T>
struct FilletPoint {
  T radius_m{}, angle_rad{};
  T radius_slope_m{}, angle_slope{};
};

/// @param normal_angle_rad  γ in (0, π/2]
template <class T>
FilletPoint<T> fillet_point(const Fillet<T>& fillet, const T& normal_angle_rad);

/// Angle from the middle of the tooth space to the involute flank at a radius.
///
///   external: η_y = π/z − s_y/(2 r_y),  ring: the same with its own tooth thickness s_y
///
/// Inside the base circle, the value on it.  @returns η_y [rad]
template <class T>
T space_half_angle(const GearGeometry<T>& g, const T& radius_m);

/// The generated root of a gear.
template <class T>
struct ToothForm {
  Fillet<T> fillet;
  /// γ at which the fillet leaves the flank: fillet.normal_angle_rad, more when undercut.
  T form_normal_angle_rad{};
  T form_radius_m{};  ///< r_F: the involute flank begins (external) or ends (ring) here
  /// ρ_F = sqrt(r_F² − rb²): the same as a distance along the line of action from the base circle's
  /// tangent point.
  T form_length_m{};
  bool undercut = false;  ///< ρ_F of the rack below −1e-5 modules
  /// kCutter: least distance along the line of action at which the cutter generates involute flank,
  /// a0 sin α_w0: from its base circle on.  Else 0.
  T generated_length_m{};
  /// The rounding is less than asked for: both neighbours have become one arc.
  bool full_round = false;
  /// kCutter: profile shift [modules] that the ring has above the one at which it and its cutter
  /// lose their generating distance (inv α_w0 = 0); at most z − z0 − 1 < 0 for a cutter with too
  /// many teeth, for which the root is that of kArc.
  T cutter_room{};
  /// kCutter: generating centre distance a0, radius of the cutter's tip circle.  Else 0.
  T cutter_center_distance_m{}, cutter_tip_radius_m{};
};

/// Form of the root.
///
///   rack    ρ_F = r sin α − h_F/sin α,  h_F = m (hfP* − ρfP* (1 − sin α) − x); where that is
///           negative the rack undercuts: r_F is where fillet and involute cross, near the onset
///           ρ_F = −ρ_F,rack/2
///   cutter  ρ_F = a0 sin α_w0 + ρ_F0,   ρ_F0 = ρ0 + sqrt((r_a0 − ρ0)² − rb0²)
///   arc     ρ_F = ρ + sqrt((r_f − ρ)² − rb²)
///
/// Source: ISO 21771 (root form diameter); own derivation of the arc and of undercut,
/// docs/theory §14, §15.  Against KISSsoft's root form diameters: tests/golden.
/// Valid: rack with 0 ≤ ρfP*, cutter with fewer teeth than the ring.  Where a tool's rounding would
/// reach inside the base circle, the form circle is taken where it touches it.
template <class T>
ToothForm<T> make_tooth_form(const GearGeometry<T>& g);

/// Angle from the middle of the tooth space to the contour at a radius: the flank as far as the
/// form circle, then the fillet. Valid: radii from the root circle to the tip circle; beyond the
/// root circle, the value on it.
/// @returns [rad]
template <class T>
T contour_half_angle(const GearGeometry<T>& g, const ToothForm<T>& form, const T& radius_m);

/// Rounding radius of the rack's tip corners, in modules: ρfP*, or the radius at which both
/// roundings become one arc where that is less:
///   0 ≤ ρ ≤ (π/4 + q/(2 cos α) − h tan α) cos α/(1 − sin α),  h = rack_depth()
/// Source: own derivation, docs/theory §14.
template <class T>
T rack_rounding(const GearGeometry<T>& external);

}  // namespace gear3k::geometry
