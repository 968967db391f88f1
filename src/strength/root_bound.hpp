#pragma once
// What the root of a rack-cut tooth asks of its module at least, over ranges of profile shift and
// tip: for bounds.

#include <array>
#include <vector>

#include "geometry/gear.hpp"
#include "strength/flank_bound.hpp"

namespace gear3k::strength {

/// Rated sections of rack-cut teeth over the profile shift, in modules.
///
/// With G = ρ − h_f + x, a the distance of the rounding's centre from the axis of the rack's tooth
/// and τ = 30°:
///
///   θ = (2G/z) tan θ + π/2 − τ − (π − 2a)/z,   γ = π/2 − θ
///   s = z sin(π/3 − θ) + √3 (G/cos θ − ρ),   y = (z cos(π/3 − θ) + G/cos θ − ρ)/2
///
/// chord s and height y rise with x, and ρ_F falls as long as G ≤ 0: between two shifts each lies
/// between its values there, ρ_F not below ρ.
/// Source: the rack formula of root_section(); own derivation of the slopes, docs/theory §36.
struct RootTable {
  struct Knot {
    double chord = 0.0, height = 0.0, curvature_radius = 0.0;  ///< s_F, y_F, ρ_F
  };
  double least_shift = 0.0, step = 0.0;  ///< of the knots
  std::vector<Knot> knots;               ///< empty: nothing is known
  double rounding = 0.0;                 ///< ρ
  double least_center = 0.0;             ///< G of the first knot
  double base_radius = 0.0;
  /// ψ_b = opening + opening_slope x: half the tooth's angle on the base circle.
  double opening = 0.0, opening_slope = 0.0;
  double cosine = 1.0;  ///< cos α
};

/// @param gear  external, any module; its profile shift is the least of the table
/// @param greatest_shift  the table ends there, or where its proofs do
/// @returns no knots where the flank may end beyond the section: undercut to 30°
RootTable make_root_table(const geometry::GearGeometry<double>& gear, double greatest_shift);

/// What root_safety asks of the module m of a mesh for one of its gears:
///
///   m² ≥ load · Y_F Y_S/Y_δ,    load = (T c_k cos α/(N b r_k)) K S/(2 σ_Flim Y_NT Y_R Y_M)
///
/// with (36.2) and the greatest width, K = K_A K_γ K_v K_Fβ K_Fα at their stated values or 1, Y_X
/// and Y_B at 1.  Plastics: loaded at the tip, with Y_ε, and Y_δ = Y_R = 1. Source: own derivation,
/// docs/theory §36.
struct RootNeed {
  double load_m2 = 0.0;        ///< 0: nothing is asked
  double slip_layer_mm = 0.0;  ///< ρ' of Y_δ; 0: Y_δ = 1
  bool plastic = false;
};
/// By mesh and member; nothing is asked of rings.
std::array<std::array<RootNeed, 2>, train::kMeshCount> root_needs(const RatingTask& task,
                                                                  const FlankExtremes& extremes);

/// Least and greatest of a gear in a mesh.
struct RootRange {
  double least_shift = 0.0, greatest_shift = 0.0;
  double least_tip = 0.0, greatest_tip = 0.0;  ///< ρ_a in modules
  /// Of the outer point of single contact, from the mate's tip and the distance: with 1 ≤ ε ≤ 2 it
  /// lies in this, with ε > 2 above its least.
  double least_by_mate = 0.0, greatest_by_mate = 0.0;
  double least_contact_ratio = 0.0, greatest_contact_ratio = 0.0;
};
/// Least m² [m²] that root_safety asks for; 0 where the table does not reach, or where it is below
/// a value that matters.
double least_root_module2(const RootTable& table, const RootNeed& need, const RootRange& range,
                          double least_of_interest_m2 = 0.0);

}  // namespace gear3k::strength
