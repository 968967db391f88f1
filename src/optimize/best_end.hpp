#pragma once
// The best end of several starts of one tooth set, and how it is made stationary.

#include <cmath>
#include <optional>

#include "optimize/refinement_problem.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/solve_outcome.hpp"

namespace gear3k::optimize {

/// By the solver that the specification names.
SolveOutcome solve(const RefinementProblem& problem, const Point& start,
                   const SlsqpOptions& options = {});

/// The best end of all starts, or the one that violates least.
struct BestEnd {
  std::optional<RefinementProblem> problem;
  SolveOutcome outcome;
  bool found = false;  ///< feasible

  void offer(const RefinementProblem& p, const SolveOutcome& o) {
    if (!std::isfinite(o.violation)) return;
    const bool ok = o.feasible();
    const bool better =
        !problem || (ok && !found) ||
        (ok == found && (ok ? o.objective < outcome.objective : o.violation < outcome.violation));
    if (!better) return;
    problem = p;
    outcome = o;
    found = ok;
  }
};

/// Goes on from the best end until it is stationary: by SLSQP, whose picture of the curvature
/// starts afresh, then by Ipopt, which `both` asks for in any case.
/// @returns the KKT residual
double polish(BestEnd& best);

/// Objectives of two ends, scaled to order 1, that are one optimum.
inline constexpr double kSameObjective = 1e-9;

}  // namespace gear3k::optimize
