#include "optimize/solve_outcome.hpp"

#include <limits>

namespace gear3k::optimize {

SolveOutcome outcome_at(const RefinementProblem& problem, const Point& v,
                        std::span<double> constraints) {
  const auto objective = evaluate<double>(problem, used(problem, v), constraints);
  if (!objective) {
    return {.v = v, .objective = 0.0, .violation = std::numeric_limits<double>::infinity()};
  }
  return {.v = v, .objective = *objective, .violation = worst_violation(constraints)};
}

SolveOutcome outcome_at(const RefinementProblem& problem, const Point& v) {
  std::vector<double> g(problem.rows.size());
  return outcome_at(problem, v, g);
}

}  // namespace gear3k::optimize
