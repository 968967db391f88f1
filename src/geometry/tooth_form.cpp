#include "geometry/tooth_form.hpp"

#include <cmath>
#include <numbers>

#include "geometry/involute.hpp"
#include "geometry/rack_point.hpp"

namespace gear3k::geometry {

namespace {

constexpr double kRightAngle = std::numbers::pi / 2.0;
/// Least involute of the cutting angle: below it a cutter has no working angle in the ring.
constexpr double kLeastCuttingInvolute = 1e-9;
constexpr int kFilletBisections = 60;
/// Missing flank up to this length [modules] is within what the undercut check lets pass.
constexpr double kUndercutTolerance = 1e-5;
/// Slopes dr/dγ below this share of the radius are those of the root circle's end, where no step is
/// taken.
constexpr double kLeastSlope = 1e-9;
/// Below this share of the reference radius, an undercut flank's end is taken from its series at
/// the onset: the crossing itself is lost in rounding there.  The two differ by 1e-7 of it.
constexpr double kOnsetShare = 1e-4;

/// sqrt(hypotenuse² − leg²); 0 without derivatives where it has no real value.
template <class T>
T other_leg(const T& hypotenuse, const T& leg) {
  using std::sqrt;
  if (!(value_of(hypotenuse) > value_of(leg))) return constant<T>(0.0);
  return sqrt((hypotenuse - leg) * (hypotenuse + leg));
}

/// The involute that bounds a tooth space: half angle on the base circle and how it goes on.
template <class T>
struct SpaceFlank {
  double sign = 1.0;  ///< +1 external: the space widens outwards; −1 ring
  T base_radius_m{}, base_angle_rad{};

  [[nodiscard]] T angle(const T& radius_m) const {
    return base_angle_rad + sign * involute_to(base_radius_m, radius_m);
  }
  /// dη/dr = ± tan α_y/r
  [[nodiscard]] T slope(const T& radius_m) const {
    return sign * other_leg(radius_m, base_radius_m) / (base_radius_m * radius_m);
  }
};

template <class T>
SpaceFlank<T> space_flank(const GearGeometry<T>& g) {
  const double sign = g.gear.kind == GearKind::kExternal ? 1.0 : -1.0;
  const T half_tooth = reference_tooth_thickness(g) / (2.0 * g.reference_radius_m);
  return {.sign = sign,
          .base_radius_m = g.base_radius_m,
          .base_angle_rad = std::numbers::pi / g.gear.teeth - half_tooth - sign * g.angle.involute};
}

/// γ at which the fillet of an undercut gear crosses the flank.  At the flank's own γ the fillet
/// runs along the involute's other branch and lies inside the space; from the base circle inwards
/// it has cut beyond it.
template <class T>
T undercut_normal_angle(const GearGeometry<T>& g, const Fillet<T>& fillet) {
  const SpaceFlank<T> flank = space_flank(g);
  const SpaceFlank<double> flank_value{.sign = flank.sign,
                                       .base_radius_m = value_of(flank.base_radius_m),
                                       .base_angle_rad = value_of(flank.base_angle_rad)};
  const Fillet<double> fillet_value = fillet_values<double>(fillet);
  double low = fillet_value.normal_angle_rad;
  double high = kRightAngle;
  for (int i = 0; i < kFilletBisections; ++i) {
    const double middle = 0.5 * (low + high);
    const FilletPoint<double> point = fillet_point(fillet_value, middle);
    const bool cut = point.radius_m <= flank_value.base_radius_m ||
                     point.angle_rad > flank_value.angle(point.radius_m);
    (cut ? high : low) = middle;
  }
  // The root is exact to rounding; each Newton step doubles the order of exact derivatives.
  T gamma = constant<T>(low);
  if constexpr (!std::is_floating_point_v<T>) {
    for (int step = 0; step < 2; ++step) {
      const FilletPoint<T> point = fillet_point(fillet, gamma);
      const T f = point.angle_rad - flank.angle(point.radius_m);
      const T slope = point.angle_slope - flank.slope(point.radius_m) * point.radius_slope_m;
      if (!(std::abs(value_of(slope)) > 0.0)) break;
      gamma = gamma - f / slope;
    }
  }
  return gamma;
}

template <class T>
ToothForm<T> rack_form(const GearGeometry<T>& g) {
  using std::sqrt;
  // Symbols as in ISO 21771; lengths in metres.
  const T& m = g.gear.module_m;
  const T& x = g.gear.profile_shift;
  const BasicRack<T>& rack = g.gear.rack;
  const T depth = rack_depth(g), rounding = rack_rounding(g);
  const T form_depth = depth - rounding * (1.0 - g.angle.sin);
  ToothForm<T> form;
  form.fillet = {
      .tool = RootTool::kRack,
      .rounding_radius_m = m * rounding,
      .pitch_radius_m = g.reference_radius_m,
      .rounding_depth_m = m * (depth - rounding - x),
      .center_offset = m * (half_rack_tooth(g) - form_depth * g.angle.tan - rounding * g.angle.cos),
      .normal_angle_rad = g.angle.alpha_rad};
  form.form_normal_angle_rad = form.fillet.normal_angle_rad;
  form.form_length_m = g.reference_radius_m * g.angle.sin - m * (form_depth - x) / g.angle.sin;
  form.full_round = value_of(rounding) < value_of(rack.root_radius);
  form.undercut = value_of(form.form_length_m) < -kUndercutTolerance * value_of(m);
  if (form.undercut &&
      value_of(form.form_length_m) > -kOnsetShare * value_of(g.reference_radius_m)) {
    form.form_length_m = -0.5 * form.form_length_m;
    form.form_radius_m =
        sqrt(g.base_radius_m * g.base_radius_m + form.form_length_m * form.form_length_m);
  } else if (form.undercut) {
    form.form_normal_angle_rad = undercut_normal_angle(g, form.fillet);
    form.form_radius_m = fillet_point(form.fillet, form.form_normal_angle_rad).radius_m;
    form.form_length_m = other_leg(form.form_radius_m, g.base_radius_m);
  } else {
    form.form_radius_m =
        sqrt(g.base_radius_m * g.base_radius_m + form.form_length_m * form.form_length_m);
  }
  return form;
}

/// The rounding of a corner between an involute and a circle outside it: a ring's root, a cutter's
/// tip.
template <class T>
struct CornerRounding {
  T radius_m{};         ///< ρ as asked for, or less
  T center_radius_m{};  ///< of its centre
  T center_angle{};     ///< of its centre, from the middle of the space or of the cutter's tooth
  T to_center_m{};      ///< sqrt(center_radius² − rb²)
  bool full_round = false;
};

/// Rounds a corner by ρ.  Its neighbour on the other flank is as large: where both do not fit, they
/// become the one arc with its centre on the middle, ρ(δ = 0), with
///   δ(ρ) = ψ_b − ρ/rb − inv(acos(rb/(r − ρ)))
/// @param base_angle  ψ_b: half angle of the space or tooth on the base circle
/// @param circle_radius_m  r: root circle of the ring, tip circle of the cutter
template <class T>
CornerRounding<T> round_corner(const T& base_radius_m, const T& base_angle,
                               const T& circle_radius_m, const T& asked_m) {
  constexpr int kNewtonSteps = 12;
  const auto center_angle = [&](const T& rho) {
    return T(base_angle - rho / base_radius_m -
             involute_to(base_radius_m, T(circle_radius_m - rho)));
  };
  CornerRounding<T> corner{.radius_m = asked_m, .center_angle = center_angle(asked_m)};
  if (value_of(corner.center_angle) < 0.0) {
    // δ falls with ρ, and is concave: Newton descends monotonically from above.
    T& rho = corner.radius_m;
    for (int i = 0; i < kNewtonSteps && value_of(rho) > 0.0; ++i) {
      const T radius = circle_radius_m - rho;
      const T slope = (other_leg(radius, base_radius_m) / radius - 1.0) / base_radius_m;
      rho = rho - center_angle(rho) / slope;
    }
    corner.center_angle = constant<T>(0.0);
    corner.full_round = true;
    // The flanks cross inside the circle: no corner is left to round.
    if (!(value_of(rho) > 0.0)) rho = constant<T>(0.0);
  }
  corner.center_radius_m = larger(T(circle_radius_m - corner.radius_m), base_radius_m);
  corner.to_center_m = other_leg(corner.center_radius_m, base_radius_m);
  return corner;
}

template <class T>
ToothForm<T> arc_form(const GearGeometry<T>& g);

template <class T>
ToothForm<T> cutter_form(const GearGeometry<T>& g) {
  using std::cos, std::sqrt, std::tan;
  // Index 0: the cutter.
  const PinionCutter& cutter = g.gear.cutter;
  const T& m = g.gear.module_m;
  const double z = g.gear.teeth;
  const double z0 = cutter.teeth;
  if (z0 >= z) {
    ToothForm<T> form = arc_form(g);
    form.cutter_room = constant<T>(z - z0 - 1.0);
    return form;
  }
  const T cutting_involute = g.angle.involute + 2.0 * g.angle.tan *
                                                    (g.gear.profile_shift - cutter.profile_shift) /
                                                    (z - z0);
  const T angle = inverse_involute(larger(cutting_involute, constant<T>(kLeastCuttingInvolute)));
  const T cos_angle = cos(angle);
  const T rb0 = g.base_radius_m * (z0 / z);
  ToothForm<T> form;
  form.cutter_room = (cutting_involute - kLeastCuttingInvolute) * (z - z0) / (2.0 * g.angle.tan);
  form.cutter_center_distance_m = (g.base_radius_m - rb0) / cos_angle;
  form.cutter_tip_radius_m = g.root_radius_m - form.cutter_center_distance_m;
  form.generated_length_m = (g.base_radius_m - rb0) * tan(angle);
  const T half_tooth = (std::numbers::pi / 2.0 + 2.0 * cutter.profile_shift * g.angle.tan +
                        g.gear.machining_allowance / g.angle.cos) /
                       z0;
  const auto corner = round_corner(rb0, T(half_tooth + g.angle.involute), form.cutter_tip_radius_m,
                                   T(m * cutter.tip_radius));
  form.fillet = {.tool = RootTool::kCutter,
                 .rounding_radius_m = corner.radius_m,
                 .pitch_radius_m = g.base_radius_m / cos_angle,
                 .cutter_pitch_radius_m = rb0 / cos_angle,
                 .rounding_center_radius_m = corner.center_radius_m,
                 .center_offset = corner.center_angle,
                 .tool_teeth_ratio = z0 / z,
                 .normal_angle_rad = angle};
  form.form_normal_angle_rad = angle;
  form.full_round = corner.full_round;
  form.form_length_m = form.generated_length_m + corner.radius_m + corner.to_center_m;
  form.form_radius_m =
      sqrt(g.base_radius_m * g.base_radius_m + form.form_length_m * form.form_length_m);
  return form;
}

template <class T>
ToothForm<T> arc_form(const GearGeometry<T>& g) {
  using std::atan2, std::sqrt;
  const auto corner = round_corner(g.base_radius_m, space_flank(g).base_angle_rad, g.root_radius_m,
                                   T(g.gear.module_m * g.gear.rack.root_radius));
  ToothForm<T> form;
  form.fillet = {.tool = RootTool::kArc,
                 .rounding_radius_m = corner.radius_m,
                 .pitch_radius_m = corner.center_radius_m,
                 .center_offset = corner.center_angle,
                 .normal_angle_rad = atan2(corner.to_center_m, g.base_radius_m)};
  form.full_round = corner.full_round;
  form.form_normal_angle_rad = form.fillet.normal_angle_rad;
  form.form_length_m = corner.radius_m + corner.to_center_m;
  form.form_radius_m =
      sqrt(g.base_radius_m * g.base_radius_m + form.form_length_m * form.form_length_m);
  return form;
}

}  // namespace

template <class T>
CuttingPosition<T> cutting_position(const Fillet<T>& f, const T& normal_angle_rad) {
  using std::atan2, std::cos, std::sin, std::sqrt;
  const T c = cos(normal_angle_rad);
  const T s = sin(normal_angle_rad);
  CuttingPosition<T> position{.center_distance_m = constant<T>(0.0),
                              .space_angle_rad = constant<T>(0.0),
                              .center_distance_slope_m = constant<T>(0.0),
                              .space_angle_slope = constant<T>(0.0)};
  T& t = position.center_distance_m;
  T& t_slope = position.center_distance_slope_m;
  T& turned = position.space_angle_rad;
  T& turned_slope = position.space_angle_slope;
  switch (f.tool) {
    case RootTool::kRack: {
      const T& r = f.pitch_radius_m;
      t = f.rounding_depth_m / s;
      t_slope = -t * c / s;
      turned = (t * c - f.center_offset) / r;
      turned_slope = (t_slope * c - t * s) / r;
      break;
    }
    case RootTool::kCutter: {
      const T& r_w0 = f.cutter_pitch_radius_m;
      const T root = other_leg(f.rounding_center_radius_m, T(r_w0 * c));
      t = root - r_w0 * s;
      t_slope = r_w0 * c * (r_w0 * s / root - 1.0);
      const T lateral0 = t * c;
      const T height0 = r_w0 + t * s;
      turned = f.tool_teeth_ratio * (atan2(lateral0, height0) - f.center_offset);
      turned_slope = f.tool_teeth_ratio *
                     ((t_slope * c - t * s) * height0 - lateral0 * (t_slope * s + t * c)) /
                     (lateral0 * lateral0 + height0 * height0);
      break;
    }
    case RootTool::kArc:
      turned = -f.center_offset;
      break;
  }
  return position;
}

template <class T>
FilletPoint<T> fillet_point(const Fillet<T>& f, const T& normal_angle_rad) {
  using std::atan2, std::cos, std::sin, std::sqrt;
  const T c = cos(normal_angle_rad);
  const T s = sin(normal_angle_rad);
  const T& r = f.pitch_radius_m;
  const auto [t, turned, t_slope, turned_slope] = cutting_position(f, normal_angle_rad);
  const double outwards = f.tool == RootTool::kRack ? -1.0 : 1.0;
  const T reach = t + f.rounding_radius_m;
  const T lateral = reach * c;
  const T height = r + outwards * (reach * s);
  const T lateral_slope = t_slope * c - reach * s;
  const T height_slope = outwards * (t_slope * s + reach * c);
  const T square = lateral * lateral + height * height;
  FilletPoint<T> point;
  point.radius_m = sqrt(square);
  point.angle_rad = atan2(lateral, height) - turned;
  point.radius_slope_m = (lateral * lateral_slope + height * height_slope) / point.radius_m;
  point.angle_slope = (lateral_slope * height - lateral * height_slope) / square - turned_slope;
  return point;
}

template <class T>
T space_half_angle(const GearGeometry<T>& g, const T& radius_m) {
  return space_flank(g).angle(radius_m);
}

template <class T>
ToothForm<T> make_tooth_form(const GearGeometry<T>& g) {
  if (g.gear.kind == GearKind::kExternal) return rack_form(g);
  return g.gear.cutter.teeth > 0 ? cutter_form(g) : arc_form(g);
}

template <class T>
T contour_half_angle(const GearGeometry<T>& g, const ToothForm<T>& form, const T& radius_m) {
  const double outwards = g.gear.kind == GearKind::kExternal ? 1.0 : -1.0;
  const double radius = value_of(radius_m);
  if (outwards * (radius - value_of(form.form_radius_m)) >= 0.0) {
    return space_half_angle(g, radius_m);
  }
  const FilletPoint<T> root = fillet_point(form.fillet, constant<T>(kRightAngle));
  if (outwards * (radius - value_of(root.radius_m)) <= 0.0) return root.angle_rad;
  const Fillet<double> fillet = fillet_values<double>(form.fillet);
  // The fillet's radius falls towards the root of an external gear, and rises on a ring.
  double low = value_of(form.form_normal_angle_rad), high = kRightAngle;
  for (int i = 0; i < kFilletBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (outwards * (fillet_point(fillet, middle).radius_m - radius) > 0.0 ? low : high) = middle;
  }
  T gamma = constant<T>(low);
  if constexpr (!std::is_floating_point_v<T>) {
    for (int step = 0; step < 2; ++step) {
      const FilletPoint<T> point = fillet_point(form.fillet, gamma);
      if (!(std::abs(value_of(point.radius_slope_m)) > kLeastSlope * radius)) break;
      gamma = gamma - (point.radius_m - radius_m) / point.radius_slope_m;
    }
  }
  return fillet_point(form.fillet, gamma).angle_rad;
}

template <class T>
T rack_rounding(const GearGeometry<T>& g) {
  const T greatest =
      (half_rack_tooth(g) - g.gear.rack.dedendum * g.angle.tan) * g.angle.cos / (1.0 - g.angle.sin);
  if (value_of(greatest) < 0.0) return constant<T>(0.0);  // pointed
  return smaller(g.gear.rack.root_radius, greatest);
}

#define INSTANTIATE(T)                                                                     \
  template CuttingPosition<T> cutting_position<T>(const Fillet<T>&, const T&);             \
  template FilletPoint<T> fillet_point<T>(const Fillet<T>&, const T&);                     \
  template T space_half_angle<T>(const GearGeometry<T>&, const T&);                        \
  template T contour_half_angle<T>(const GearGeometry<T>&, const ToothForm<T>&, const T&); \
  template T rack_rounding<T>(const GearGeometry<T>&);                                     \
  template ToothForm<T> make_tooth_form<T>(const GearGeometry<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE
// For curvatures along the fillet.
template FilletPoint<ceres::Jet<double, 1>> fillet_point(const Fillet<ceres::Jet<double, 1>>&,
                                                         const ceres::Jet<double, 1>&);

}  // namespace gear3k::geometry
