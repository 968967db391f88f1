#pragma once

#include <limits>
#include <string_view>

#include "optimize/solve_outcome.hpp"

namespace gear3k::optimize {

struct SlsqpOptions {
  int max_evaluations = 200;  ///< of a run
  /// Stops when a step changes every variable by less than this, relatively.
  double x_tolerance = 1e-11;
  double f_tolerance = 1e-13;  ///< or the objective by less than this, relatively
  /// Rows that are farther from their limits at the start (in units of their scales) are left out
  /// until the solver violates them: worth it where the start is near the end.
  double working_margin = std::numeric_limits<double>::infinity();
  /// Ends as soon as a run misses rows that it saw: no more rows would help, but another run from
  /// its end might.
  bool give_up = false;
};

/// Refines from a start by NLopt's SLSQP with exact gradients.  Thread-safe.
///
/// Rows that were left out and that its end violates are added, and it goes on from there.  A run
/// that has used up its evaluations within 1e-2 of feasible is taken up again, twice at most; the
/// better end counts.  The outcome is judged by all rows.
SolveOutcome solve_slsqp(const RefinementProblem& problem, const Point& start,
                         const SlsqpOptions& options);

/// The least t with g_k + t ≥ 0 for the rows of one name and g_k ≥ 0 for the others, from a start;
/// with an empty name g_k + t ≥ 0 for all rows: the point that violates the constraints least
/// (locally), or a feasible one.  `objective` of the outcome is that of the problem there.
SolveOutcome least_violation(const RefinementProblem& problem, const Point& start,
                             const SlsqpOptions& options, std::string_view elastic_name = {});

}  // namespace gear3k::optimize
