#include "geometry/gear.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "geometry/involute.hpp"

namespace gear3k::geometry {

template <class T>
PressureAngle<T> make_pressure_angle(const T& alpha_rad) {
  using std::cos, std::sin;
  const double alpha = value_of(alpha_rad);
  if (!(alpha > 0.0 && alpha < std::numbers::pi / 2.0)) {
    throw std::invalid_argument(
        fmt::format("pressure angle = {} rad, allowed: between 0 and pi/2", alpha));
  }
  PressureAngle<T> result;
  result.alpha_rad = alpha_rad;
  result.sin = sin(alpha_rad);
  result.cos = cos(alpha_rad);
  result.tan = result.sin / result.cos;
  result.involute = result.tan - alpha_rad;
  return result;
}

template <class T>
GearGeometry<T> make_gear_geometry(const Gear<T>& gear, const PressureAngle<T>& angle) {
  if (gear.teeth < 1) {
    throw std::invalid_argument(
        fmt::format("gear: teeth = {}, allowed: at least 1 (ring teeth are positive)", gear.teeth));
  }
  if (!(value_of(gear.module_m) > 0.0)) {
    throw std::invalid_argument(
        fmt::format("gear: module = {} m, allowed: above 0", value_of(gear.module_m)));
  }
  for (const T& x : {gear.profile_shift, gear.machining_allowance, gear.tip_shortening}) {
    if (!std::isfinite(value_of(x))) {
      throw std::invalid_argument(fmt::format(
          "gear: profile shift, machining allowance or tip shortening = {}, allowed: finite",
          value_of(x)));
    }
  }
  // Symbols as in ISO 21771.
  const T& m = gear.module_m;
  const double z_half = 0.5 * gear.teeth;
  GearGeometry<T> g;
  g.gear = gear;
  g.angle = angle;
  g.reference_radius_m = m * z_half;
  g.base_radius_m = g.reference_radius_m * angle.cos;
  if (gear.kind == GearKind::kExternal) {
    g.tip_radius_m = m * (gear.rack.addendum + gear.profile_shift - gear.tip_shortening + z_half);
    g.root_radius_m = m * (gear.profile_shift - gear.rack.dedendum + z_half);
  } else {
    g.tip_radius_m = m * (gear.profile_shift + gear.tip_shortening - gear.rack.addendum + z_half);
    g.root_radius_m = m * (gear.rack.dedendum + gear.profile_shift + z_half);
  }
  return g;
}

template <class T>
T reference_tooth_thickness(const GearGeometry<T>& g) {
  const double sign = g.gear.kind == GearKind::kExternal ? 1.0 : -1.0;
  return g.gear.module_m * (2.0 * sign * g.gear.profile_shift * g.angle.tan +
                            std::numbers::pi / 2.0 - g.gear.machining_allowance / g.angle.cos);
}

template <class T>
T tooth_thickness(const GearGeometry<T>& g, const T& radius_m) {
  using std::acos;
  const double sign = g.gear.kind == GearKind::kExternal ? 1.0 : -1.0;
  T involute_y = constant<T>(0.0);
  if (value_of(radius_m) > value_of(g.base_radius_m)) {
    involute_y = involute<T>(acos(g.base_radius_m / radius_m));
  }
  return 2.0 * radius_m *
         (reference_tooth_thickness(g) / (2.0 * g.reference_radius_m) +
          sign * (g.angle.involute - involute_y));
}

template <class T>
T tip_curvature_radius(const GearGeometry<T>& g) {
  using std::sqrt;
  const T square = (g.tip_radius_m - g.base_radius_m) * (g.tip_radius_m + g.base_radius_m);
  if (!(value_of(g.tip_radius_m) > value_of(g.base_radius_m))) return constant<T>(0.0);
  return sqrt(square);
}

#define INSTANTIATE(T)                                                                     \
  template PressureAngle<T> make_pressure_angle<T>(const T&);                              \
  template GearGeometry<T> make_gear_geometry<T>(const Gear<T>&, const PressureAngle<T>&); \
  template T reference_tooth_thickness<T>(const GearGeometry<T>&);                         \
  template T tooth_thickness<T>(const GearGeometry<T>&, const T&);                         \
  template T tip_curvature_radius<T>(const GearGeometry<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::geometry
