#include "optimize/solve_outcome.hpp"

#include <limits>

namespace gear3k::optimize {

SolveOutcome outcome_at(const RefinementProblem& problem, const Point& v) {
  std::vector<double> g(problem.rows.size());
  const auto objective = evaluate<double>(problem, used(problem, v), g);
  if (!objective) {
    return {.v = v, .objective = 0.0, .violation = std::numeric_limits<double>::infinity()};
  }
  return {.v = v, .objective = *objective, .violation = worst_violation(g)};
}

}  // namespace gear3k::optimize
