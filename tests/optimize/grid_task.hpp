#pragma once
// Random tasks with shifts on a coarse grid, and a witness for one point of it.

#include <algorithm>
#include <cmath>
#include <vector>

#include "optimize/objective_value.hpp"
#include "optimize/refinement_problem.hpp"
#include "tests/optimize/random_specification.hpp"

namespace gear3k::optimize::test {

inline constexpr double kGridStep = 0.25;

/// Two lists of modules in both stages, three shifts for every gear, and room for so coarse a grid.
inline RandomTask grid_task(std::uint64_t seed, std::size_t most) {
  using design::CheckId;
  RandomTask task = random_task(seed, most);
  Specification& spec = task.spec;
  spec.profile_shift = {.min = -0.05, .max = 0.55};
  spec.ring_shift = NumberRange{.min = 0.1, .max = 0.8};
  spec.shift_step = kGridStep;
  spec.module[0] = {.range_m = std::nullopt, .series_m = {0.5e-3, 0.6e-3}};
  spec.module[1] = spec.module[0];
  if (seed % 2 == 0) spec.module[1].series_m = {0.8e-3};
  spec.limits[CheckId::kOutputBacklashMax] = std::nullopt;
  spec.limits[CheckId::kContactRatioMin] = 1.0;
  spec.limits[CheckId::kContactRatioMax] = std::nullopt;
  spec.solver.starts = 4;
  spec.ratio.tolerance = 0.01;
  return task;
}

/// The least scaled objective over the centre distance alone, by scanning it ever finer: about the
/// best point, or while none is feasible about the one that misses least.
inline double best_distance(const RefinementProblem& problem, Point v) {
  std::vector<double> g(problem.rows.size());
  double from = problem.lower[kAngleA], to = problem.upper[kAngleA];
  double best = kInfinity, missed = kInfinity, at = from;
  constexpr int kPoints = 100, kTimes = 7;
  for (int n = 0; n < kTimes; ++n) {
    const double width = (to - from) / kPoints;
    for (int k = 0; k <= kPoints; ++k) {
      v[kAngleA] = from + k * width;
      const auto f = evaluate<double>(problem, used(problem, v), g);
      if (!f) continue;
      const double violation = worst_violation(g);
      if (violation <= design::kFeasibilityTolerance ? *f < best
                                                     : best == kInfinity && violation < missed) {
        (violation <= design::kFeasibilityTolerance ? best : missed) =
            violation <= design::kFeasibilityTolerance ? *f : violation;
        at = v[kAngleA];
      }
    }
    from = std::max(problem.lower[kAngleA], at - 2.0 * width);
    to = std::min(problem.upper[kAngleA], at + 2.0 * width);
  }
  return best;
}

}  // namespace gear3k::optimize::test
