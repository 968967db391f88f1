#include "geometry/interference.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/involute.hpp"
#include "geometry/rack_point.hpp"

namespace gear3k::geometry {

namespace {

/// Share of a fillet, in cot γ from the flank, that tip_fouling_gap() leaves to
/// form_circle_margin().  Along cot γ the rounding's centre moves evenly.
constexpr double kSkippedShare = 0.15;

/// acos, constant where its argument leaves (−1, 1).
template <class T>
T bounded_acos(const T& cosine) {
  using std::acos;
  if (value_of(cosine) >= 1.0) return constant<T>(0.0);
  if (value_of(cosine) <= -1.0) return constant<T>(std::numbers::pi);
  return acos(cosine);
}

/// A pinion (1) inside a ring (2), as far as their tips meet.
template <class T>
struct InternalTips {
  double teeth_ratio = 0.0;  ///< z1/z2
  T base_radius1_m{}, base_radius2_m{}, tip_radius1_m{}, tip_radius2_m{}, center_distance_m{};
  T working_involute{};  ///< inv α_w
};

template <class T>
InternalTips<T> internal_tips(const GearGeometry<T>& pinion, const GearGeometry<T>& ring,
                              const MeshGeometry<T>& mesh) {
  return {.teeth_ratio = static_cast<double>(pinion.gear.teeth) / ring.gear.teeth,
          .base_radius1_m = pinion.base_radius_m,
          .base_radius2_m = ring.base_radius_m,
          .tip_radius1_m = pinion.tip_radius_m,
          .tip_radius2_m = ring.tip_radius_m,
          .center_distance_m = mesh.center_distance_m,
          .working_involute = mesh.tan_alpha_w - mesh.alpha_w_rad};
}

/// Arc between the corners on the ring's tip circle, for corners at θ1 and θ2 from the line of
/// centres.
template <class T>
T corner_arc(const InternalTips<T>& p, const T& theta1, const T& theta2) {
  const T lead1 = involute_to(p.base_radius1_m, p.tip_radius1_m) - p.working_involute;
  const T lead2 = involute_to(p.base_radius2_m, p.tip_radius2_m) - p.working_involute;
  return p.tip_radius2_m * (p.teeth_ratio * (theta1 + lead1) - (theta2 + lead2));
}

template <class T>
T trochoid_arc(const InternalTips<T>& p) {
  const T& d = p.center_distance_m;
  const T squares = (p.tip_radius2_m - p.tip_radius1_m) * (p.tip_radius2_m + p.tip_radius1_m);
  const T theta1 = bounded_acos(T((squares - d * d) / (2.0 * d * p.tip_radius1_m)));
  const T theta2 = bounded_acos(T((squares + d * d) / (2.0 * d * p.tip_radius2_m)));
  return corner_arc(p, theta1, theta2);
}

template <class T>
T trimming_arc(const InternalTips<T>& p) {
  using std::asin, std::sqrt;
  const T cos1 = p.base_radius1_m / p.tip_radius1_m;
  const T cos2 = p.base_radius2_m / p.tip_radius2_m;
  const T square = (1.0 - (cos1 / cos2) * (cos1 / cos2)) / (1.0 - p.teeth_ratio * p.teeth_ratio);
  T theta1 = constant<T>(0.0), theta2 = constant<T>(0.0);
  if (value_of(square) > 0.0) {
    const T sin1 = value_of(square) < 1.0 ? T(sqrt(square)) : constant<T>(1.0);
    theta1 = value_of(square) < 1.0 ? T(asin(sin1)) : constant<T>(std::numbers::pi / 2.0);
    const T sin2 = sin1 * p.tip_radius1_m / p.tip_radius2_m;
    theta2 = value_of(sin2) < 1.0 ? T(asin(sin2)) : constant<T>(std::numbers::pi / 2.0);
  }
  return corner_arc(p, theta1, theta2);
}

/// A tip corner on its way through the mate's tooth space; lengths in metres.
template <class T>
struct TipPassage {
  bool inside_ring = false;  ///< the root belongs to a ring
  bool from_ring = false;    ///< the tip belongs to a ring
  double teeth_ratio = 0.0;  ///< teeth of the tip's gear over those of the root's
  T center_distance_m{}, tip_radius_m{};
  T tip_lead_rad{};        ///< half tooth at the pitch circle less that at the tip
  T space_at_pitch_rad{};  ///< half space of the root's gear on its working pitch circle
  /// +1 and −1: on one side of the line of centres or the other; the corner of a tip that reaches
  /// beyond the pitch point makes contact on side +1.
  double side = 1.0;
};

/// Gap at the fillet's radius, and its derivative by γ.
template <class T>
struct Gap {
  bool reached = false;  ///< the corner comes to this radius
  T arc_m{}, slope_m{};
};

template <class T>
Gap<T> gap_at(const TipPassage<T>& p, const FilletPoint<T>& point) {
  using std::atan2, std::sqrt;
  const T& d = p.center_distance_m;
  const T& r = point.radius_m;
  // Corner and fillet at equal radius r about the root's centre; h along the line of centres.
  const T h = (r * r + (d - p.tip_radius_m) * (d + p.tip_radius_m)) / (2.0 * d);
  const double side_root = p.from_ring ? -1.0 : 1.0;
  const double side_tip = p.inside_ring ? -1.0 : 1.0;
  const T square = (r - h) * (r + h);
  Gap<T> gap;
  gap.reached = value_of(square) > 0.0;
  if (!gap.reached) return gap;
  const T lateral = p.side * sqrt(square);
  const T phi = atan2(lateral, T(side_tip * (d - h)));
  const T theta = atan2(lateral, T(side_root * h));
  const T angle =
      p.teeth_ratio * (phi + p.tip_lead_rad) + point.angle_rad - p.space_at_pitch_rad - theta;
  gap.arc_m = r * angle;
  const T h_slope = r / d;
  const T lateral_slope = (r - h * h_slope) / lateral;
  const T phi_slope =
      side_tip * (lateral_slope * (d - h) + lateral * h_slope) / (p.tip_radius_m * p.tip_radius_m);
  const T theta_slope = side_root * (lateral_slope * h - lateral * h_slope) / (r * r);
  gap.slope_m = point.radius_slope_m * (angle + r * (p.teeth_ratio * phi_slope - theta_slope)) +
                r * point.angle_slope;
  return gap;
}

/// The same in another scalar type, without derivatives.
template <class To, class T>
TipPassage<To> passage_values(const TipPassage<T>& p) {
  const auto to = [](const T& x) { return constant<To>(value_of(x)); };
  return {.inside_ring = p.inside_ring,
          .from_ring = p.from_ring,
          .teeth_ratio = p.teeth_ratio,
          .center_distance_m = to(p.center_distance_m),
          .tip_radius_m = to(p.tip_radius_m),
          .tip_lead_rad = to(p.tip_lead_rad),
          .space_at_pitch_rad = to(p.space_at_pitch_rad),
          .side = p.side};
}

/// A place on a fillet, and the gap there.
struct LeastGap {
  double normal_angle_rad = 0.0;
  Gap<double> gap;
};

/// The least gap between `begin` and the root circle: at `begin` itself or at a stationary point.
LeastGap least_gap_on_side(const TipPassage<double>& passage, const Fillet<double>& fillet,
                           double begin) {
  constexpr int kSamples = 5;
  constexpr int kSteps = 60;
  constexpr double kAngleTolerance = 1e-14;
  const auto gap = [&](double gamma) { return gap_at(passage, fillet_point(fillet, gamma)); };
  // Evenly in cot γ, from cot(begin) to 0.
  const auto gamma_of = [&](int i) {
    if (i == 0) return begin;
    return std::atan2(std::sin(begin), std::cos(begin) * (kSamples - 1 - i) / (kSamples - 1));
  };
  int best = 0;
  std::array<Gap<double>, kSamples> gaps;
  for (int i = 0; i < kSamples; ++i) {
    auto& at = gaps[static_cast<std::size_t>(i)];
    at = gap(gamma_of(i));
    if (!at.reached) break;
    if (at.arc_m < gaps[static_cast<std::size_t>(best)].arc_m) best = i;
  }
  const Gap<double>& least = gaps[static_cast<std::size_t>(best)];
  if (!least.reached) return {.normal_angle_rad = begin, .gap = least};
  // The slope changes its sign from − to + at the minimum: between the best sample and one of its
  // neighbours.
  const bool falls = least.slope_m < 0.0;
  if (falls ? best == kSamples - 1 : best == 0)
    return {.normal_angle_rad = gamma_of(best), .gap = least};
  double low = gamma_of(falls ? best : best - 1), high = gamma_of(falls ? best + 1 : best);
  const auto slope = [&](double gamma) {
    const Gap<double> at = gap(gamma);
    return at.reached ? at.slope_m : std::numeric_limits<double>::infinity();
  };
  double slope_low = slope(low), slope_high = slope(high);
  // Regula falsi that halves the weight of an end that stays (Illinois), bisecting where it cannot.
  int stayed = 0;
  for (int i = 0; i < kSteps && high - low > kAngleTolerance; ++i) {
    const double secant = high - slope_high * (high - low) / (slope_high - slope_low);
    const double middle = secant > low && secant < high ? secant : 0.5 * (low + high);
    const double slope_middle = slope(middle);
    if (slope_middle == 0.0) return {.normal_angle_rad = middle, .gap = gap(middle)};
    if (slope_middle < 0.0) {
      low = middle;
      slope_low = slope_middle;
      if (stayed == 1) slope_high *= 0.5;
      stayed = 1;
    } else {
      high = middle;
      slope_high = slope_middle;
      if (stayed == -1) slope_low *= 0.5;
      stayed = -1;
    }
  }
  const double gamma = std::abs(slope_low) < std::abs(slope_high) ? low : high;
  return {.normal_angle_rad = gamma, .gap = gap(gamma)};
}

/// The least gap on the whole way.  A corner whose tip circle reaches beyond the pitch point moves
/// away from the flank that it touched as it crosses the line of centres.  Else contact, and the
/// minimum, may lie on the other side: the passage is then set to that side.
LeastGap least_gap(TipPassage<double>& passage, const Fillet<double>& fillet, double begin,
                   bool beyond_pitch_point) {
  const LeastGap before = least_gap_on_side(passage, fillet, begin);
  if (beyond_pitch_point || !before.gap.reached) return before;
  passage.side = -1.0;
  const LeastGap past = least_gap_on_side(passage, fillet, begin);
  if (past.gap.arc_m < before.gap.arc_m) return past;
  passage.side = 1.0;
  return before;
}

}  // namespace

template <class T>
T undercut_margin(const GearGeometry<T>& external) {
  const T& sin_alpha = external.angle.sin;
  const T form_depth = rack_depth(external) - rack_rounding(external) * (1.0 - sin_alpha);
  return external.gear.profile_shift -
         (form_depth - 0.5 * external.gear.teeth * sin_alpha * sin_alpha);
}

template <class T>
T ring_tip_above_base(const GearGeometry<T>& ring) {
  return (ring.tip_radius_m - ring.base_radius_m) / ring.gear.module_m;
}

template <class T>
T involute_interference_margin(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                               const MeshGeometry<T>& mesh, int which) {
  const GearGeometry<T>& tip_gear = which == 1 ? gear1 : gear2;
  const double sign = mesh_sign(gear2.gear.kind);
  return sign * (mesh.tangent_length_m - tip_curvature_radius(tip_gear)) / tip_gear.gear.module_m;
}

template <class T>
T active_root_length(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                     const MeshGeometry<T>& mesh, int which) {
  const T mate_tip = tip_curvature_radius(which == 1 ? gear2 : gear1);
  if (gear2.gear.kind == GearKind::kExternal) return mesh.tangent_length_m - mate_tip;
  return which == 1 ? T(mate_tip - mesh.tangent_length_m) : T(mate_tip + mesh.tangent_length_m);
}

template <class T>
T form_circle_margin(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                     const MeshGeometry<T>& mesh, const ToothForm<T>& form, int which) {
  const GearGeometry<T>& gear = which == 1 ? gear1 : gear2;
  const double sign = gear.gear.kind == GearKind::kRing ? -1.0 : 1.0;
  return sign * (active_root_length(gear1, gear2, mesh, which) - form.form_length_m) /
         gear.gear.module_m;
}

template <class T>
T root_clearance(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                 const MeshGeometry<T>& mesh, int which) {
  const T& d = mesh.center_distance_m;
  const T& m = gear1.gear.module_m;
  if (gear2.gear.kind == GearKind::kExternal) {
    return which == 1 ? T((d - gear1.tip_radius_m - gear2.root_radius_m) / m)
                      : T((d - gear2.tip_radius_m - gear1.root_radius_m) / m);
  }
  return which == 1 ? T((gear2.root_radius_m - d - gear1.tip_radius_m) / m)
                    : T((gear2.tip_radius_m - d - gear1.root_radius_m) / m);
}

template <class T>
T trochoid_margin(const GearGeometry<T>& pinion, const GearGeometry<T>& ring,
                  const MeshGeometry<T>& mesh) {
  return trochoid_arc(internal_tips(pinion, ring, mesh)) / ring.gear.module_m;
}

template <class T>
T trimming_margin(const GearGeometry<T>& pinion, const GearGeometry<T>& ring,
                  const MeshGeometry<T>& mesh) {
  return trimming_arc(internal_tips(pinion, ring, mesh)) / ring.gear.module_m;
}

template <class T>
T ring_cutter_margin(const GearGeometry<T>& ring, const ToothForm<T>& form) {
  const T& angle = form.fillet.normal_angle_rad;
  if (form.fillet.tool != RootTool::kCutter) return form.cutter_room;
  const double teeth_ratio = form.fillet.tool_teeth_ratio;
  const InternalTips<T> tips{.teeth_ratio = teeth_ratio,
                             .base_radius1_m = ring.base_radius_m * teeth_ratio,
                             .base_radius2_m = ring.base_radius_m,
                             .tip_radius1_m = form.cutter_tip_radius_m,
                             .tip_radius2_m = ring.tip_radius_m,
                             .center_distance_m = form.cutter_center_distance_m,
                             .working_involute = involute(angle)};
  const T reach = tip_curvature_radius(ring) - form.generated_length_m;
  return smaller(
      form.cutter_room,
      T(smaller(reach, smaller(trochoid_arc(tips), trimming_arc(tips))) / ring.gear.module_m));
}

template <class T>
T tip_fouling_gap(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                  const MeshGeometry<T>& mesh, const ToothForm<T>& form, int which) {
  using std::atan2, std::cos, std::sin;
  const GearGeometry<T>& tip = which == 1 ? gear1 : gear2;
  const GearGeometry<T>& root = which == 1 ? gear2 : gear1;
  const T working_involute = mesh.tan_alpha_w - mesh.alpha_w_rad;
  const bool from_ring = tip.gear.kind == GearKind::kRing;
  const double sign = from_ring ? -1.0 : 1.0;
  const T lead = sign * (involute_to(tip.base_radius_m, tip.tip_radius_m) - working_involute);
  const T pitch_radius =
      root.base_radius_m * mesh.center_distance_m / base_radius_sum(gear1, gear2);
  TipPassage<T> passage{.inside_ring = root.gear.kind == GearKind::kRing,
                        .from_ring = from_ring,
                        .teeth_ratio = static_cast<double>(tip.gear.teeth) / root.gear.teeth,
                        .center_distance_m = mesh.center_distance_m,
                        .tip_radius_m = tip.tip_radius_m,
                        .tip_lead_rad = lead,
                        .space_at_pitch_rad = space_half_angle(root, pitch_radius)};
  // Where flank and fillet meet, the gap has a minimum of zero whenever the mate's tip just reaches
  // that point: form_circle_margin() says so.  The search begins below.
  const T first = atan2(sin(form.form_normal_angle_rad),
                        T((1.0 - kSkippedShare) * cos(form.form_normal_angle_rad)));
  const double begin = value_of(first);
  TipPassage<double> values = passage_values<double>(passage);
  const bool beyond_pitch_point =
      value_of(which == 1 ? mesh.addendum_contact_ratio1 : mesh.addendum_contact_ratio2) > 0.0;
  const double gamma =
      least_gap(values, fillet_values<double>(form.fillet), begin, beyond_pitch_point)
          .normal_angle_rad;
  passage.side = values.side;
  const T& m = tip.gear.module_m;
  if (gamma == begin) {
    const FilletPoint<T> point = fillet_point(form.fillet, first);
    const Gap<T> gap = gap_at(passage, point);
    if (gap.reached) return gap.arc_m / m;
    // The corner turns back before: its gap on the line of centres, to flank or fillet.
    const T& d = mesh.center_distance_m;
    const T deepest = passage.inside_ring ? T(d + tip.tip_radius_m)
                      : from_ring         ? T(tip.tip_radius_m - d)
                                          : T(d - tip.tip_radius_m);
    return deepest *
           (passage.teeth_ratio * passage.tip_lead_rad + contour_half_angle(root, form, deepest) -
            passage.space_at_pitch_rad) /
           m;
  }
  const Gap<T> gap = gap_at(passage, fillet_point(form.fillet, constant<T>(gamma)));
  if constexpr (std::is_floating_point_v<T>) {
    return gap.arc_m / m;
  } else {
    // The minimum moves with the design: g(γ*) = g − g_γ²/(2 g_γγ) to second order, where g_γ is 0
    // but its derivatives are not.
    using Slope = ceres::Jet<double, 1>;
    const Slope curvature = gap_at(passage_values<Slope>(passage),
                                   fillet_point(fillet_values<Slope>(form.fillet), Slope(gamma, 0)))
                                .slope_m;
    // At the root circle the minimum is no stationary point and stays.
    if (gamma >= std::numbers::pi / 2.0 || !(curvature.v[0] > 0.0)) return gap.arc_m / m;
    return (gap.arc_m - gap.slope_m * gap.slope_m / (2.0 * curvature.v[0])) / m;
  }
}

#define INSTANTIATE(T)                                                                       \
  template T undercut_margin<T>(const GearGeometry<T>&);                                     \
  template T ring_tip_above_base<T>(const GearGeometry<T>&);                                 \
  template T involute_interference_margin<T>(const GearGeometry<T>&, const GearGeometry<T>&, \
                                             const MeshGeometry<T>&, int);                   \
  template T active_root_length<T>(const GearGeometry<T>&, const GearGeometry<T>&,           \
                                   const MeshGeometry<T>&, int);                             \
  template T form_circle_margin<T>(const GearGeometry<T>&, const GearGeometry<T>&,           \
                                   const MeshGeometry<T>&, const ToothForm<T>&, int);        \
  template T root_clearance<T>(const GearGeometry<T>&, const GearGeometry<T>&,               \
                               const MeshGeometry<T>&, int);                                 \
  template T trochoid_margin<T>(const GearGeometry<T>&, const GearGeometry<T>&,              \
                                const MeshGeometry<T>&);                                     \
  template T trimming_margin<T>(const GearGeometry<T>&, const GearGeometry<T>&,              \
                                const MeshGeometry<T>&);                                     \
  template T ring_cutter_margin<T>(const GearGeometry<T>&, const ToothForm<T>&);             \
  template T tip_fouling_gap<T>(const GearGeometry<T>&, const GearGeometry<T>&,              \
                                const MeshGeometry<T>&, const ToothForm<T>&, int);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::geometry
