#pragma once
// What limits of backlash leave of a grid of profile shifts.

#include <array>
#include <optional>
#include <vector>

#include "optimize/lattice.hpp"
#include "optimize/refinement_problem.hpp"
#include "optimize/shift_range.hpp"

namespace gear3k::optimize {

/// The centre distances at which shifts on a grid leave every mesh its least normal backlash and
/// the output no more than its greatest lost motion.
///
/// At given modules the backlash of mesh k depends on the distance and on one sum of two shifts,
/// Σ = x_S + x_P1, x_R1 − x_P1 or x_R2 − x_P2, which is a whole number of steps too:
///   j_k = ± [2 rb_Σ (inv α_k − inv α) − 2 m sin α Σ] + m q        + external, − ring
/// rises (− falls) with the distance.  It is at least its limit, and at most what the limit of the
/// lost motion leaves where the other meshes have their least.  So each three sums leave an
/// interval of distances, most of them none: what is ruled out here has no feasible point. Source:
/// own derivation, docs/theory §12.
class GridDistances {
 public:
  /// @returns empty unless both modules and the pressure angle are given, every backlash and the
  ///          lost motion limited, and few enough sums left to look through
  static std::optional<GridDistances> of(const RefinementProblem& problem, const Multiples& shifts);

  /// Takes off a box what has no feasible point, by the three sums that it still has.
  /// @param box  multiples of the five shifts, in the order of train::GearId
  /// @returns angles v[kAngleA] that hold all feasible points; empty: proven, there is none
  [[nodiscard]] std::optional<Interval> confine(LatticeBox& box) const;

 private:
  struct Sums {
    std::array<long, train::kMeshCount> steps{};
    Interval angle_rad;
  };
  std::vector<Sums> left_;
};

}  // namespace gear3k::optimize
