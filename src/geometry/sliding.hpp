#pragma once
// How fast the flanks of a mesh slide on each other.

#include "geometry/mesh.hpp"

namespace gear3k::geometry {

/// Sliding at the end of the path of contact that one gear's tip makes.
struct TipSliding {
  /// ζ = 1 − ρ_mate z/(ρ z_mate): sliding over rolling speed of the flank itself.
  double specific_at_tip = 0.0;   ///< of the gear, at its tip
  double specific_at_root = 0.0;  ///< of the mate, where that tip touches it
  /// K_g = v_g/v_t = g_a (1/r_w1 ± 1/r_w2), over the speed of the pitch circles; g_a from the pitch
  /// point to the tip's contact.
  double sliding_factor = 0.0;
};

/// @param which  1 or 2: the gear whose tip it is
/// NaN where the tip reaches the mate's base circle or beyond (involute interference).
/// Source: ISO 21771 (specific sliding, sliding factor), docs/theory §20.  Valid: meshes with ρ
/// > 0 at both flanks.
TipSliding tip_sliding(const GearGeometry<double>& gear1, const GearGeometry<double>& gear2,
                       const MeshGeometry<double>& mesh, int which);

/// −ζ of a gear where the mate's tip touches it: how fast its flank slides there over how fast it
/// rolls.  No point of a flank that meshes through the pitch point has more.
///
///   −ζ = w − 1,   w = ρ_mate z/(ρ z_mate)      (20.3)
///
/// grows without end where the mate's tip comes near to the base circle's tangent point.  Below
/// 1/w = kLeastRollingShare its tangent in 1/w goes on, so that it is finite, smooth and rises
/// beyond that point too.
/// Source: ISO 21771 (specific sliding); docs/theory §20.
/// @param which  1 or 2: the gear whose root it is
template <class T>
T root_sliding(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
               const MeshGeometry<T>& mesh, int which);

/// Below this 1/w the sliding at a root is continued.
inline constexpr double kLeastRollingShare = 1e-2;

/// The value of root_sliding() for 1/w, and 1/w for its value: linear in the flank's radius of
/// curvature, negative where the mate's tip is beyond the tangent point.
template <class T>
T sliding_at(const T& rolling_share) {
  if (value_of(rolling_share) >= kLeastRollingShare) return 1.0 / rolling_share - 1.0;
  return (2.0 - rolling_share / kLeastRollingShare) / kLeastRollingShare - 1.0;
}
template <class T>
T rolling_share(const T& sliding) {
  const T w = sliding + 1.0;
  if (value_of(w) <= 1.0 / kLeastRollingShare) return 1.0 / w;
  return kLeastRollingShare * (2.0 - kLeastRollingShare * w);
}

}  // namespace gear3k::geometry
