// The best along one variable against a scan of it.

#include "optimize/one_variable.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "optimize/refine.hpp"
#include "tests/optimize/grid_task.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::one_variable_test {
namespace {

TEST(OneVariable, IsTheOnlyOneThatIsNotHeld) {
  const test::RandomTask task = test::grid_task(1, 1);
  ASSERT_FALSE(task.candidates.empty());
  RefinementProblem problem = test::problems_of(task.spec, task.candidates[0]).front();
  EXPECT_FALSE(only_free_variable(problem));
  std::copy_n(problem.lower.begin(), train::kGearCount, problem.upper.begin());
  EXPECT_EQ(only_free_variable(problem), kAngleA);
  problem.upper[kAngleA] = problem.lower[kAngleA];
  EXPECT_FALSE(only_free_variable(problem));
}

struct Count {
  int feasible = 0, none = 0;
};

/// The best point of a grid of shifts and its neighbours, from two distances: as good as the best
/// distance by scanning.
void expect_best_ends(std::uint64_t seed, Count& count) {
  constexpr double kSame = 1e-6;
  test::RandomTask task = test::grid_task(seed, 1);
  if (task.candidates.empty()) return;
  task.spec.module[0].series_m = {0.5e-3};
  const RefinedSet set = refine(task.spec, task.candidates[0]);
  if (set.status != Status::kOptimal) return;
  const RefinementProblem problem = test::problems_of(task.spec, task.candidates[0]).front();
  for (int n = 0; n <= 2 * train::kGearCount; ++n) {
    RefinementProblem held = problem;
    std::ranges::copy(set.train.profile_shift, held.lower.begin());
    if (n > 0) {
      held.lower[static_cast<std::size_t>((n - 1) / 2)] += (n % 2 - 0.5) * 2.0 * test::kGridStep;
    }
    std::copy_n(held.lower.begin(), train::kGearCount, held.upper.begin());
    Point v = held.lower;
    const double best = test::best_distance(held, v);
    for (const double from : {0.42, 0.36}) {
      v[kAngleA] = from;
      const SolveOutcome end = solve_one_variable(held, kAngleA, v);
      EXPECT_EQ(end.violation <= design::kFeasibilityTolerance, best < kInfinity)
          << seed << ' ' << n << ' ' << from;
      if (best < kInfinity) {
        EXPECT_NEAR(end.objective, best, kSame) << seed << ' ' << n << ' ' << from;
      }
    }
    ++(best < kInfinity ? count.feasible : count.none);
  }
}

TEST(OneVariable, EndsAtTheBestDistanceOfPointsOfTheGrid) {
  const int wanted = sample(4, 400);
  Count count;
  for (std::uint64_t seed = 2; seed <= 4000 && count.feasible < wanted; ++seed) {
    expect_best_ends(seed, count);
  }
  EXPECT_GE(count.feasible, wanted);
  EXPECT_GT(count.none, 0);
  std::cout << count.feasible << " points with a best distance, " << count.none << " without\n";
}

TEST(OneVariable, LosesNoPointByAStepThatGoesTooFar) {
  Count count;
  for (const std::uint64_t seed : {209U, 817U}) expect_best_ends(seed, count);
  EXPECT_GT(count.feasible, 0);
}

TEST(OneVariable, LooksFromTheLimitOfARowInwards) {
  Count count;
  for (const std::uint64_t seed : {457U, 1303U}) expect_best_ends(seed, count);
  EXPECT_GT(count.feasible, 0);
}

TEST(OneVariable, GoesOnWhereARowDoesNotChange) {
  Count count;
  expect_best_ends(633, count);
  EXPECT_GT(count.feasible, 0);
}

}  // namespace
}  // namespace gear3k::optimize::one_variable_test
