#include "optimize/best_end.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "optimize/ipopt.hpp"
#include "optimize/kkt_residual.hpp"
#include "optimize/refined_set.hpp"
#include "optimize/uniform.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

/// Where one end is stationary and the other is not, they are alike within what the tolerance of
/// feasibility is worth.
constexpr double kWorthOfTolerance = 10.0 * design::kFeasibilityTolerance;

/// Takes another end in place of the best one if it is better, or as good and nearer to a
/// stationary point.
/// @param residual  of the best end; kept up to date
/// @returns whether it took it
bool take_polished(BestEnd& best, const SolveOutcome& polished, double& residual) {
  if (!polished.feasible()) return false;
  const double gain = best.outcome.objective - polished.objective;
  const double own = kkt_residual(*best.problem, polished.v);
  const bool makes_stationary = own <= kStationary && !(residual <= kStationary);
  const double loss =
      makes_stationary ? kWorthOfTolerance * (1.0 + std::abs(polished.objective)) : kSameObjective;
  if (!(gain > kSameObjective || (gain > -loss && own < residual))) return false;
  best.outcome = polished;
  residual = own;
  return true;
}

/// Whether a gap of tip corners is near its limit.
bool has_fouling_near(const RefinementProblem& problem, const Point& v) {
  constexpr double kNear = 0.01;
  std::vector<double> g(problem.rows.size());
  if (!evaluate<double>(problem, used(problem, v), g)) return false;
  for (std::size_t k = 0; k < g.size(); ++k) {
    const auto& check = problem.rows[k].check;
    if (check && check->record->id == CheckId::kTipFouling && g[k] < kNear) return true;
  }
  return false;
}

/// Goes on from points about the best end until one leads to a stationary point: at a kink of a gap
/// of tip corners a run stays where it first meets it.
void leave_kink(BestEnd& best, double& residual) {
  constexpr int kRuns = 24;
  constexpr std::array<double, 4> kReach{0.05, 0.02, 0.1, 0.01};
  constexpr double kAngles = 0.3;  // of it
  const RefinementProblem& problem = *best.problem;
  if (!has_fouling_near(problem, best.outcome.v)) return;
  Uniform uniform(stream_of(problem.candidate, problem.spec->solver.seed));
  for (int n = 0; n < kRuns && !(residual <= kStationary); ++n) {
    Point start = best.outcome.v;
    for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
      const bool angle = k == kAngleA || k == kAngleB;
      const double reach = kReach[static_cast<std::size_t>(n) % kReach.size()];
      start[k] += reach * (angle ? kAngles : 1.0) * (2.0 * uniform.next() - 1.0);
      start[k] = std::clamp(start[k], problem.lower[k], problem.upper[k]);
    }
    take_polished(best, solve_slsqp(problem, start, {}), residual);
  }
}

}  // namespace

SolveOutcome solve(const RefinementProblem& problem, const Point& start,
                   const SlsqpOptions& options) {
  return problem.spec->solver.refine == Refine::kIpopt ? solve_ipopt(problem, start)
                                                       : solve_slsqp(problem, start, options);
}

double polish(BestEnd& best) {
  constexpr int kAgain = 2;
  double residual = kkt_residual(*best.problem, best.outcome.v);
  for (int i = 0; i < kAgain && !(residual <= kStationary); ++i) {
    if (!take_polished(best, solve_slsqp(*best.problem, best.outcome.v, {}), residual)) break;
  }
  if (best.problem->spec->solver.refine == Refine::kBoth || !(residual <= kStationary)) {
    take_polished(best, solve_ipopt(*best.problem, best.outcome.v), residual);
  }
  if (!(residual <= kStationary)) leave_kink(best, residual);
  return residual;
}

}  // namespace gear3k::optimize
