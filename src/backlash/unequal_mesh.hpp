#pragma once
// Two gears whose base pitches differ a little, as parts of different materials have them at
// another temperature than that of the drawing.

#include "geometry/mesh.hpp"

namespace gear3k::backlash {

template <class T>
struct UnequalMesh {
  /// Working angle and path of contact; contact ratios over the larger base pitch.
  geometry::MeshGeometry<T> mesh;
  bool has_working_angle = true;
  T base_pitch_difference_m{};  ///< p_b2 − p_b1
  /// j_bn: mean of a tooth of gear 1 in a space of gear 2 and of a tooth of 2 in a space of 1.
  T normal_backlash_m{};
  /// Least play in any position, with a tooth of gear 1 at either end of the path of contact.
  T least_backlash_m{};
};

/// A mesh of gear 1 (external) with gear 2 (external or ring) of nearly the same base pitch.
///
///   cos α_w = (rb2 ± rb1)/d                                        (+ external, − ring)
///   j_bn = ±2 (rb2 ± rb1) (inv α_w − inv α) + (p_b1 + p_b2)/2 − (s1 + s2) cos α
///
/// s1, s2: tooth thicknesses on the reference circles.  It equals the mean of both circular
/// pitches less both thicknesses on the working pitch circles, times cos α_w.
///
/// A pair of flanks at x from the pitch point, on the left line of action, and one at x' on the
/// right one leave the play
///
///   j(x, x') = j_bn + δ/2 + (x + x' − s_w1 cos α_w) δ/p_b1,   δ = p_b2 − p_b1
///
/// s_w1: thickness of gear 1 on its working pitch circle; x counts from −e2 p_b1, where the tip of
/// gear 2 touches, to e1 p_b1, where that of gear 1 does.  The least is at x = x' = −e2 p_b1 for
/// δ > 0 and at e1 p_b1 for δ < 0.
/// Source: own derivation, docs/theory §64.
/// Accuracy: the least of the positions that teeth do take is at most |δ| above least_backlash_m
/// (x and x' are a whole number of pitches apart), and below it by no more than (δ/p_b)² r1, as a
/// tip corner that has just left the line of action still comes nearer; where δ = 0 it is
/// normal_backlash().
/// Without a working angle (d ≤ rb2 ± rb1) α_w counts as 0, which continues j_bn with its slope,
/// and the least play is below 0 by at least rb2 ± rb1 − d, for solvers that come there.
/// Does not cover: flanks pressed together, which let more teeth share; a gear that does not grow
/// alike in all directions.
/// Requires rb2 ± rb1 > 0.
template <class T>
UnequalMesh<T> make_unequal_mesh(const geometry::GearGeometry<T>& gear1,
                                 const geometry::GearGeometry<T>& gear2,
                                 const T& center_distance_m);

}  // namespace gear3k::backlash
