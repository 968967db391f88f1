#include "geometry/mesh.hpp"

#include <cmath>
#include <numbers>

#include "geometry/involute.hpp"

namespace gear3k::geometry {

template <class T>
T base_radius_sum(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2) {
  return gear2.base_radius_m + mesh_sign(gear2.gear.kind) * gear1.base_radius_m;
}

template <class T>
std::optional<MeshGeometry<T>> make_mesh_geometry(const GearGeometry<T>& gear1,
                                                  const GearGeometry<T>& gear2,
                                                  const T& center_distance_m) {
  using std::acos, std::sqrt;
  // Symbols as in ISO 21771.
  const double sign = mesh_sign(gear2.gear.kind);
  const T& d = center_distance_m;
  const T rb_sum = base_radius_sum(gear1, gear2);
  if (!(value_of(rb_sum) > 0.0 && value_of(d) > value_of(rb_sum))) return std::nullopt;
  MeshGeometry<T> mesh;
  mesh.center_distance_m = d;
  mesh.tangent_length_m = sqrt((d - rb_sum) * (d + rb_sum));
  mesh.tan_alpha_w = mesh.tangent_length_m / rb_sum;
  mesh.alpha_w_rad = acos(rb_sum / d);
  mesh.base_pitch_m = std::numbers::pi * gear1.gear.module_m * gear1.angle.cos;
  mesh.addendum_contact_ratio1 =
      (tip_curvature_radius(gear1) - gear1.base_radius_m * mesh.tan_alpha_w) / mesh.base_pitch_m;
  mesh.addendum_contact_ratio2 =
      sign * (tip_curvature_radius(gear2) - gear2.base_radius_m * mesh.tan_alpha_w) /
      mesh.base_pitch_m;
  mesh.contact_ratio = mesh.addendum_contact_ratio1 + mesh.addendum_contact_ratio2;
  return mesh;
}

template <class T>
std::optional<T> zero_backlash_angle(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2) {
  const double sign = mesh_sign(gear2.gear.kind);
  const double z_sum = gear2.gear.teeth + sign * gear1.gear.teeth;
  const T& tan_alpha = gear1.angle.tan;
  const T inv_alpha_w =
      gear1.angle.involute +
      2.0 * tan_alpha * (gear2.gear.profile_shift + sign * gear1.gear.profile_shift) / z_sum;
  if (!(z_sum > 0.0 && value_of(inv_alpha_w) > 0.0)) return std::nullopt;
  return inverse_involute(inv_alpha_w);
}

template <class T>
std::optional<T> zero_backlash_center_distance(const GearGeometry<T>& gear1,
                                               const GearGeometry<T>& gear2) {
  using std::cos;
  const std::optional<T> alpha_w = zero_backlash_angle(gear1, gear2);
  if (!alpha_w) return std::nullopt;
  return T(base_radius_sum(gear1, gear2) / cos(*alpha_w));
}

template <class T>
T khk_tip_shortening(const ExternalShifts<T>& mesh) {
  const T y = mesh.center_distance_m / mesh.module_m - 0.5 * mesh.teeth_sum;
  return larger(T(mesh.shift_sum - y), constant<T>(0.0));
}

#define INSTANTIATE(T)                                                                             \
  template T base_radius_sum<T>(const GearGeometry<T>&, const GearGeometry<T>&);                   \
  template std::optional<MeshGeometry<T>> make_mesh_geometry<T>(const GearGeometry<T>&,            \
                                                                const GearGeometry<T>&, const T&); \
  template std::optional<T> zero_backlash_angle<T>(const GearGeometry<T>&,                         \
                                                   const GearGeometry<T>&);                        \
  template std::optional<T> zero_backlash_center_distance<T>(const GearGeometry<T>&,               \
                                                             const GearGeometry<T>&);              \
  template T khk_tip_shortening<T>(const ExternalShifts<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::geometry
