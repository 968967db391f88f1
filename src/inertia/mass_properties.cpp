#include "inertia/mass_properties.hpp"

#include <fmt/format.h>

#include <numbers>
#include <stdexcept>

namespace gear3k::inertia {

template <class T>
MassProperties<T> hollow_cylinder(const HollowCylinder<T>& body) {
  const double ro = value_of(body.outer_radius_m);
  const double ri = value_of(body.inner_radius_m);
  const double b = value_of(body.width_m);
  const double density = value_of(body.density_kgm3);
  if (!(ri >= 0.0 && ro >= ri && b >= 0.0 && density >= 0.0)) {
    throw std::invalid_argument(fmt::format(
        "hollow_cylinder: outer radius = {} m, inner radius = {} m, width = {} m, density = {} "
        "kg/m3, allowed: outer >= inner >= 0, width >= 0, density >= 0",
        ro, ri, b, density));
  }
  const T outer2 = body.outer_radius_m * body.outer_radius_m;
  const T inner2 = body.inner_radius_m * body.inner_radius_m;
  const T mass = std::numbers::pi * body.density_kgm3 * body.width_m * (outer2 - inner2);
  return {.mass_kg = mass, .inertia_kgm2 = 0.5 * mass * (outer2 + inner2)};
}

template <class T>
T inertia_about_parallel_axis(const MassProperties<T>& body, const T& distance_m) {
  return body.inertia_kgm2 + body.mass_kg * distance_m * distance_m;
}

template <class T>
T toothed_radius(const geometry::GearGeometry<T>& g) {
  return 0.5 * (g.tip_radius_m + g.root_radius_m);
}

template <class T>
MassProperties<T> gear_body(const geometry::GearGeometry<T>& g, const T& other_radius_m,
                            const T& width_m, const T& density_kgm3) {
  const T toothed = toothed_radius(g);
  const bool ring = g.gear.kind == geometry::GearKind::kRing;
  return hollow_cylinder(HollowCylinder<T>{.outer_radius_m = ring ? other_radius_m : toothed,
                                           .inner_radius_m = ring ? toothed : other_radius_m,
                                           .width_m = width_m,
                                           .density_kgm3 = density_kgm3});
}

#define INSTANTIATE(T)                                                                          \
  template MassProperties<T> hollow_cylinder<T>(const HollowCylinder<T>&);                      \
  template T inertia_about_parallel_axis<T>(const MassProperties<T>&, const T&);                \
  template T toothed_radius<T>(const geometry::GearGeometry<T>&);                               \
  template MassProperties<T> gear_body<T>(const geometry::GearGeometry<T>&, const T&, const T&, \
                                          const T&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::inertia
