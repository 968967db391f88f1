#include "geometry/interference.hpp"

namespace gear3k::geometry {

template <class T>
T undercut_margin(const GearGeometry<T>& external) {
  const T& sin_alpha = external.angle.sin;
  const BasicRack<T>& rack = external.gear.rack;
  const T form_depth = rack.dedendum - rack.root_radius * (1.0 - sin_alpha);
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

#define INSTANTIATE(T)                                                                       \
  template T undercut_margin<T>(const GearGeometry<T>&);                                     \
  template T ring_tip_above_base<T>(const GearGeometry<T>&);                                 \
  template T involute_interference_margin<T>(const GearGeometry<T>&, const GearGeometry<T>&, \
                                             const MeshGeometry<T>&, int);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)

}  // namespace gear3k::geometry
