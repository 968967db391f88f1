#include "backlash/unequal_mesh.hpp"

#include <numbers>

namespace gear3k::backlash {

namespace {

template <class T>
T base_pitch_of(const geometry::GearGeometry<T>& gear) {
  return std::numbers::pi * gear.gear.module_m * gear.angle.cos;
}

/// The mesh as if the working angle were 0.
template <class T>
geometry::MeshGeometry<T> mesh_without_angle(const geometry::GearGeometry<T>& gear1,
                                             const geometry::GearGeometry<T>& gear2,
                                             const T& center_distance_m) {
  geometry::MeshGeometry<T> mesh;
  mesh.center_distance_m = center_distance_m;
  mesh.base_pitch_m = base_pitch_of(gear1);
  mesh.addendum_contact_ratio1 = geometry::tip_curvature_radius(gear1) / mesh.base_pitch_m;
  mesh.addendum_contact_ratio2 = geometry::mesh_sign(gear2.gear.kind) *
                                 geometry::tip_curvature_radius(gear2) / mesh.base_pitch_m;
  mesh.contact_ratio = mesh.addendum_contact_ratio1 + mesh.addendum_contact_ratio2;
  return mesh;
}

}  // namespace

template <class T>
UnequalMesh<T> make_unequal_mesh(const geometry::GearGeometry<T>& gear1,
                                 const geometry::GearGeometry<T>& gear2,
                                 const T& center_distance_m) {
  // Symbols as in docs/theory §64.
  const auto working = geometry::make_mesh_geometry(gear1, gear2, center_distance_m);
  UnequalMesh<T> result;
  result.mesh = working ? *working : mesh_without_angle(gear1, gear2, center_distance_m);
  result.has_working_angle = working.has_value();
  geometry::MeshGeometry<T>& mesh = result.mesh;
  const T rb_sum = geometry::base_radius_sum(gear1, gear2);
  const T& cos_alpha = gear1.angle.cos;
  const T& inv_alpha = gear1.angle.involute;
  const T inv_alpha_w = mesh.tan_alpha_w - mesh.alpha_w_rad;
  const T p_b1 = base_pitch_of(gear1);
  const T p_b2 = base_pitch_of(gear2);
  const T s1 = geometry::reference_tooth_thickness(gear1);
  const T s2 = geometry::reference_tooth_thickness(gear2);
  T& delta = result.base_pitch_difference_m;
  delta = p_b2 - p_b1;
  const T opening = 2.0 * rb_sum * (inv_alpha_w - inv_alpha);
  result.normal_backlash_m =
      geometry::mesh_sign(gear2.gear.kind) * opening + 0.5 * (p_b1 + p_b2) - (s1 + s2) * cos_alpha;

  const T s_w1 = s1 * cos_alpha + 2.0 * gear1.base_radius_m * (inv_alpha - inv_alpha_w);
  const bool gear2_is_coarser = gear3k::value_of(delta) > 0.0;
  const T end =
      gear2_is_coarser ? T(-1.0 * mesh.addendum_contact_ratio2) : mesh.addendum_contact_ratio1;
  result.least_backlash_m = result.normal_backlash_m + delta * (0.5 + 2.0 * end - s_w1 / p_b1);
  if (!working) {
    result.least_backlash_m =
        gear3k::smaller(result.least_backlash_m, constant<T>(0.0)) + (center_distance_m - rb_sum);
  }
  if (!gear2_is_coarser) return result;
  const T share = p_b1 / p_b2;
  mesh.base_pitch_m = p_b2;
  for (T* ratio :
       {&mesh.addendum_contact_ratio1, &mesh.addendum_contact_ratio2, &mesh.contact_ratio}) {
    *ratio *= share;
  }
  return result;
}

#define INSTANTIATE(T)                                                           \
  template UnequalMesh<T> make_unequal_mesh<T>(const geometry::GearGeometry<T>&, \
                                               const geometry::GearGeometry<T>&, const T&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::backlash
