#include "strength/root_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gear3k::strength {

using geometry::Fillet;
using geometry::GearGeometry;
using geometry::GearKind;
using geometry::RootTool;
using geometry::ToothForm;

namespace {

constexpr double kRootCircleAngle = std::numbers::pi / 2.0;
constexpr int kSectionIterations = 60;
/// Newton steps of the value end where they no longer move the angle.
constexpr double kSectionRounding_rad = 1e-15;
constexpr int kVirtualRackIterations = 200;

/// Angle of the fillet's tangent with the tooth's axis, less τ, and its slope by γ.
template <class T>
struct TangentAngle {
  T excess{}, slope{};
};
template <class T>
TangentAngle<T> tangent_angle(const Fillet<T>& fillet, double pitch_half, double tau,
                              const T& gamma) {
  const geometry::CuttingPosition<T> position = geometry::cutting_position(fillet, gamma);
  const double sign = fillet.tool == RootTool::kRack ? -1.0 : 1.0;
  return {.excess = gamma + sign * (position.space_angle_rad + pitch_half) - tau,
          .slope = 1.0 + sign * position.space_angle_slope};
}

/// γ between low and π/2 at which the tangent has its angle: Newton, halving where it would leave
/// the bracket.
double section_angle(const Fillet<double>& fillet, double pitch_half, double tau, double low) {
  double high = kRootCircleAngle;
  double gamma = std::min(std::max(tau, low), high);
  for (int i = 0; i < kSectionIterations; ++i) {
    const TangentAngle<double> at = tangent_angle(fillet, pitch_half, tau, gamma);
    (at.excess > 0.0 ? high : low) = gamma;
    double next = gamma - at.excess / at.slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double moved = std::abs(next - gamma);
    gamma = next;
    if (moved <= kSectionRounding_rad) break;
  }
  return gamma;
}

/// ρ_F of the fillet at γ.
template <class T>
T fillet_curvature_radius(const Fillet<T>& f, const T& gamma) {
  using std::sin;
  if (f.tool == RootTool::kArc) return f.rounding_radius_m;
  const T& t = geometry::cutting_position(f, gamma).center_distance_m;
  const T rolling = f.tool == RootTool::kRack ? f.pitch_radius_m
                                              : T(f.pitch_radius_m * f.cutter_pitch_radius_m /
                                                  (f.pitch_radius_m - f.cutter_pitch_radius_m));
  return f.rounding_radius_m + t * t / (rolling * sin(gamma) + t);
}

}  // namespace

template <class T>
RootSection<T> root_section(const GearGeometry<T>& gear, const ToothForm<T>& form,
                            double tangent_angle_rad) {
  using std::cos, std::sin;
  if (!(tangent_angle_rad > 0.0 && tangent_angle_rad < kRootCircleAngle)) {
    throw std::invalid_argument(fmt::format(
        "root section: tangent angle = {} rad, allowed: 0 < angle < pi/2", tangent_angle_rad));
  }
  const double pitch_half = std::numbers::pi / gear.gear.teeth;
  RootSection<T> section{.tangent_angle_rad = tangent_angle_rad};
  const Fillet<double> values = fillet_values<double>(form.fillet);
  const double low = value_of(form.form_normal_angle_rad);
  T gamma = form.form_normal_angle_rad;
  section.on_fillet =
      tangent_angle(values, pitch_half, tangent_angle_rad, low).excess < 0.0 &&
      tangent_angle(values, pitch_half, tangent_angle_rad, kRootCircleAngle).excess > 0.0;
  if (section.on_fillet) {
    gamma = constant<T>(section_angle(values, pitch_half, tangent_angle_rad, low));
    if constexpr (!std::is_floating_point_v<T>) {
      for (int step = 0; step < 2; ++step) {
        const TangentAngle<T> at = tangent_angle(form.fillet, pitch_half, tangent_angle_rad, gamma);
        gamma = gamma - at.excess / at.slope;
      }
    }
  }
  const geometry::FilletPoint<T> point = geometry::fillet_point(form.fillet, gamma);
  const T from_axis = pitch_half - point.angle_rad;
  section.normal_angle_rad = gamma;
  section.chord_m = 2.0 * point.radius_m * sin(from_axis);
  section.height_m = point.radius_m * cos(from_axis);
  section.fillet_radius_m = fillet_curvature_radius(form.fillet, gamma);
  return section;
}

template <class T>
RootSection<T> virtual_rack_section(const GearGeometry<T>& ring, double virtual_root_radius) {
  using std::abs, std::cos, std::sin, std::tan;
  if (ring.gear.kind != GearKind::kRing) {
    throw std::invalid_argument("virtual rack section: the gear is external, allowed: a ring");
  }
  if (!(virtual_root_radius >= 0.0)) {
    throw std::invalid_argument(fmt::format(
        "virtual rack section: root radius = {} modules, allowed: 0 or more", virtual_root_radius));
  }
  // Symbols as in IACS UR M56, in modules; teeth and shift of the ring negative.
  const double tau = kRingTangentAngle_rad;
  const double z = -ring.gear.teeth;
  const T& m = ring.gear.module_m;
  const T& h_f = ring.gear.rack.dedendum;
  const double rho = virtual_root_radius;
  const T E =
      std::numbers::pi / 4.0 - h_f * ring.angle.tan - (1.0 - ring.angle.sin) * rho / ring.angle.cos;
  const T G = rho - h_f - ring.gear.profile_shift;
  const T H = (2.0 / z) * (kRootCircleAngle - E) - (kRootCircleAngle - tau);
  T theta = constant<T>(-value_of(H));
  const auto newton = [&](const T& at) {
    const T c = cos(at);
    return T(at - (at - (2.0 * G / z) * tan(at) + H) / (1.0 - (2.0 * G / z) / (c * c)));
  };
  for (int i = 0; i < kVirtualRackIterations; ++i) {
    const T next = newton(theta);
    const double moved = abs(value_of(next) - value_of(theta));
    theta = next;
    if (moved <= kSectionRounding_rad) break;
  }
  if constexpr (!std::is_floating_point_v<T>) theta = newton(newton(theta));
  const T c = cos(theta);
  const T w = G / c - rho;
  RootSection<T> section{.tangent_angle_rad = tau};
  const T rest = kRootCircleAngle - tau - theta;
  section.chord_m = m * (z * sin(rest) + 2.0 * w * std::cos(tau));
  section.height_m = -m * (0.5 * z * cos(rest) + w * std::sin(tau));
  section.fillet_radius_m = m * (rho + 2.0 * G * G / (c * (-z * c * c - 2.0 * G)));
  return section;
}

#define INSTANTIATE(T)                                                            \
  template RootSection<T> root_section<T>(const geometry::GearGeometry<T>&,       \
                                          const geometry::ToothForm<T>&, double); \
  template RootSection<T> virtual_rack_section<T>(const geometry::GearGeometry<T>&, double);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
