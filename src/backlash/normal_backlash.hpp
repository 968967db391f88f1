#pragma once

#include "geometry/mesh.hpp"

namespace gear3k::backlash {

/// Normal backlash of a mesh at its centre distance.
///
///   external: j_bn =  2 d sin α_w − m (z1 + z2) cos α (α_w − α)
///                     − m (z1 + z2 + 2 x1 + 2 x2) sin α + m (q1 + q2)
///   ring:     j_bn = −2 d sin α_w + m (z2 − z1) cos α (α_w − α)
///                     + m (z2 − z1 + 2 x2 − 2 x1) sin α + m (q1 + q2)
///
/// Equal to (circular pitch − both tooth thicknesses) on the working pitch circles, times cos α_w.
/// Source: low-backlash paper, eqs. 13-15 with one centre distance (errata 6); docs/theory §4.
/// Accuracy: 1e-14 d (rounding; property-tested against the tooth thicknesses).
/// @returns j_bn [m]; negative = the teeth interfere by that much
template <class T>
T normal_backlash(const geometry::GearGeometry<T>& gear1, const geometry::GearGeometry<T>& gear2,
                  const geometry::MeshGeometry<T>& mesh);

}  // namespace gear3k::backlash
