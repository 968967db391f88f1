#include "geometry/sliding.hpp"

#include <limits>

#include "geometry/interference.hpp"

namespace gear3k::geometry {

TipSliding tip_sliding(const GearGeometry<double>& gear1, const GearGeometry<double>& gear2,
                       const MeshGeometry<double>& mesh, int which) {
  // Symbols as in ISO 21771.
  const GearGeometry<double>& tip = which == 1 ? gear1 : gear2;
  const GearGeometry<double>& mate = which == 1 ? gear2 : gear1;
  const double rho_tip = tip_curvature_radius(tip);
  const double rho_mate = active_root_length(gear1, gear2, mesh, which == 1 ? 2 : 1);
  const double u = static_cast<double>(tip.gear.teeth) / mate.gear.teeth;
  const double over_cos = mesh.center_distance_m / base_radius_sum(gear1, gear2);
  const double r_w1 = gear1.base_radius_m * over_cos, r_w2 = gear2.base_radius_m * over_cos;
  const double g_a = rho_tip - tip.base_radius_m * mesh.tan_alpha_w;
  const double sign = mesh_sign(gear2.gear.kind);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {.specific_at_tip = rho_mate > 0.0 ? 1.0 - rho_mate * u / rho_tip : kNone,
          .specific_at_root = rho_mate > 0.0 ? 1.0 - rho_tip / (rho_mate * u) : kNone,
          .sliding_factor =
              (tip.gear.kind == GearKind::kRing ? -g_a : g_a) * (1.0 / r_w1 + sign / r_w2)};
}

template <class T>
T root_sliding(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
               const MeshGeometry<T>& mesh, int which) {
  const GearGeometry<T>& own = which == 1 ? gear1 : gear2;
  const GearGeometry<T>& mate = which == 1 ? gear2 : gear1;
  const double u = static_cast<double>(mate.gear.teeth) / own.gear.teeth;
  return sliding_at<T>(active_root_length(gear1, gear2, mesh, which) * u /
                       tip_curvature_radius(mate));
}

#define INSTANTIATE(T)                                                       \
  template T root_sliding<T>(const GearGeometry<T>&, const GearGeometry<T>&, \
                             const MeshGeometry<T>&, int);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::geometry
