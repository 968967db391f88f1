#include "optimize/solve_outcome.hpp"

#include <limits>

#include "efficiency/train_efficiency.hpp"

namespace gear3k::optimize {

namespace {

/// Whether the loss model leaves every mesh a part of its power: far outside its range the closed
/// form of Ohlendorf takes more than there is, and efficiencies of the train are then without
/// bound.
bool leaves_power(const RefinementProblem& problem, const Point& v) {
  const efficiency::Friction<double>& friction = problem.spec->friction;
  if (friction.model != efficiency::LossModel::kOhlendorf) return true;
  const auto train = train::make_train_geometry(parameters_at(problem, used(problem, v)));
  if (!train) return false;
  for (const bool forward : {true, false}) {
    const auto flanks = efficiency::constant_friction<double>(friction, train->teeth, forward);
    for (const double eta :
         efficiency::mesh_efficiencies(*train, flanks, friction.model, forward)) {
      if (!(eta > 0.0)) return false;
    }
  }
  return true;
}

}  // namespace

SolveOutcome outcome_at(const RefinementProblem& problem, const Point& v,
                        std::span<double> constraints) {
  const auto objective = evaluate<double>(problem, used(problem, v), constraints);
  if (!objective || !leaves_power(problem, v)) {
    return {.v = v, .objective = 0.0, .violation = std::numeric_limits<double>::infinity()};
  }
  return {.v = v, .objective = *objective, .violation = worst_violation(constraints)};
}

SolveOutcome outcome_at(const RefinementProblem& problem, const Point& v) {
  std::vector<double> g(problem.rows.size());
  return outcome_at(problem, v, g);
}

}  // namespace gear3k::optimize
