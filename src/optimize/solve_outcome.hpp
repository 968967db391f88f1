#pragma once

#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

/// Whether every row is met to kFeasibilityTolerance.
/// @param violation  the largest, in scaled units
inline bool is_feasible(double violation) { return violation <= design::kFeasibilityTolerance; }

/// Where a solver stopped, judged by the problem itself.
struct SolveOutcome {
  Point v{};
  double objective = 0.0;  ///< to be minimised, in units of RefinementProblem::objective_scale
  double violation = 0.0;  ///< largest, in scaled units; infinite where the model is not defined,
                           ///< or lets a mesh lose more than its power
  [[nodiscard]] bool feasible() const { return is_feasible(violation); }
};

/// Whether an outcome of a problem is the better one: feasible, then by objective, else nearer to
/// it.
inline bool is_better(const SolveOutcome& a, const SolveOutcome& b) {
  if (a.feasible() != b.feasible()) return a.feasible();
  return a.feasible() ? a.objective < b.objective : a.violation < b.violation;
}

/// Values of the problem at v.
SolveOutcome outcome_at(const RefinementProblem& problem, const Point& v);
/// The same; the constraints' values are left in `constraints`, of problem.rows.size().
SolveOutcome outcome_at(const RefinementProblem& problem, const Point& v,
                        std::span<double> constraints);

}  // namespace gear3k::optimize
