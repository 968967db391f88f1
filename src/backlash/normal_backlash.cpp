#include "backlash/normal_backlash.hpp"

namespace gear3k::backlash {

template <class T>
T normal_backlash(const geometry::GearGeometry<T>& gear1, const geometry::GearGeometry<T>& gear2,
                  const geometry::MeshGeometry<T>& mesh) {
  // Symbols as in the low-backlash paper.
  const double sign = geometry::mesh_sign(gear2.gear.kind);
  const T& m = gear1.gear.module_m;
  const double z = gear2.gear.teeth + sign * gear1.gear.teeth;
  const T x = gear2.gear.profile_shift + sign * gear1.gear.profile_shift;
  const T& alpha = gear1.angle.alpha_rad;
  const T opening =
      2.0 * mesh.tangent_length_m -
      m * (z * gear1.angle.cos * (mesh.alpha_w_rad - alpha) + (2.0 * x + z) * gear1.angle.sin);
  return sign * opening + m * (gear1.gear.machining_allowance + gear2.gear.machining_allowance);
}

#define INSTANTIATE(T)                                            \
  template T normal_backlash<T>(const geometry::GearGeometry<T>&, \
                                const geometry::GearGeometry<T>&, \
                                const geometry::MeshGeometry<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::backlash
