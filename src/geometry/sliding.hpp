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

}  // namespace gear3k::geometry
