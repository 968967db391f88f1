#pragma once
// The best design of one problem whose profile shifts are multiples of a step.

#include <cstddef>
#include <optional>

#include "optimize/refinement_problem.hpp"
#include "optimize/solve_outcome.hpp"
#include "optimize/stop_flag.hpp"

namespace gear3k::optimize {

/// What was found on the grid of Specification::shift_step; all other values are free.
struct GridEnd {
  /// The problem of the end, with its shifts held where it is a point of the grid; may be
  /// empty where nothing better than what was to be beaten is found.
  std::optional<RefinementProblem> held;
  SolveOutcome outcome;  ///< the best feasible point, else the one that violates least
  bool found = false;    ///< feasible, and better than what was to be beaten
  int relaxations = 0;   ///< none where the whole grid is proven empty
  /// grid_relaxations, or a stopped run, ended it: a better point may be left.  False: no box is
  /// left to be searched, as far as local searches tell (below).
  bool cut = false;
};

/// Branch and bound over the multiples that the problem's box has of each shift: the problem with
/// the shifts of a box free bounds what its points can have; a box is cut in two at the shift whose
/// halves promise most by the cuts so far (CutGains), until its points are no better than the best.
///
/// What limits of backlash leave no distance is proven empty (GridDistances).  The other
/// relaxations are solved locally, from the end of the box that was cut and, where no feasible
/// point is found, from the middle: a box whose best point neither run finds is lost, the whole
/// grid too.  After Solver::grid_relaxations of them the best point so far is taken.
/// Source: own derivation, docs/theory §12.
/// @param free  an end of the problem, from which the search begins
/// @param to_beat  only points of a lower (scaled) objective count
/// @param stop  ends the search with the best point so far
GridEnd best_on_grid(const RefinementProblem& problem, const SolveOutcome& free, double to_beat,
                     const StopFlag& stop);

}  // namespace gear3k::optimize
