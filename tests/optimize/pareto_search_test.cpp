#include "optimize/pareto_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "io/files/specification_file.hpp"
#include "tests/optimize/least_lost_motion.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::pareto_search_test {
namespace {

TEST(Hypervolume, IsTheAreaThatPointsDominate) {
  EXPECT_EQ(hypervolume({}), 0.0);
  EXPECT_DOUBLE_EQ(hypervolume({{0.25}}), 0.75);
  EXPECT_DOUBLE_EQ(hypervolume({{0.5, 0.5}}), 0.25);
  // Two rectangles less what they share.
  EXPECT_DOUBLE_EQ(hypervolume({{0.2, 0.6}, {0.5, 0.1}}), 0.8 * 0.4 + 0.5 * 0.9 - 0.5 * 0.4);
  EXPECT_DOUBLE_EQ(hypervolume({{0.2, 0.6}, {0.2, 0.6}, {0.9, 0.9}}), 0.8 * 0.4);
  EXPECT_DOUBLE_EQ(hypervolume({{0.0, 0.0, 0.0}}), 1.0);
  EXPECT_DOUBLE_EQ(hypervolume({{1.5, -1.0}, {0.5, 0.5}}), 0.25) << "clipped to the cube";
}

TEST(Hypervolume, EqualsACountOfGridCellsInThreeDimensions) {
  std::mt19937 random(1);
  constexpr int kCells = 20;
  std::uniform_int_distribution<int> cell(0, kCells);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<std::array<int, 3>> corners(6);
    std::vector<std::vector<double>> points;
    for (auto& c : corners) {
      c = {cell(random), cell(random), cell(random)};
      points.push_back({1.0 * c[0] / kCells, 1.0 * c[1] / kCells, 1.0 * c[2] / kCells});
    }
    int dominated = 0;
    for (int i = 0; i < kCells * kCells * kCells; ++i) {
      const std::array<int, 3> at{i % kCells, i / kCells % kCells, i / kCells / kCells};
      dominated += std::ranges::any_of(
          corners, [&](const auto& c) { return c[0] <= at[0] && c[1] <= at[1] && c[2] <= at[2]; });
    }
    EXPECT_NEAR(hypervolume(points), 1.0 * dominated / (kCells * kCells * kCells), 1e-12);
  }
}

Specification few_sets() {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
  spec.teeth.S = {.min = 12, .max = sample(12, 13)};
  spec.bodies = {.density_kgm3 = 7850.0,
                 .gear_density_kgm3 = {},
                 .face_width_m = {0.01, 0.01},
                 .ring_rim_m = 0.005};
  spec.pareto_points = 5;
  return spec;
}

bool dominates(const Specification& spec, const ParetoPoint& a, const ParetoPoint& b) {
  bool better = false;
  for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
    const double gain = sense_of(spec.objectives[k]) * (a.values[k] - b.values[k]);
    if (gain < 0.0) return false;
    better = better || gain > 0.0;
  }
  return better;
}

class ParetoFrontOf : public testing::TestWithParam<std::vector<Objective>> {};

TEST_P(ParetoFrontOf, HoldsNoDominatedDesignAndKeepsToItsBox) {
  Specification spec = few_sets();
  spec.objectives = GetParam();
  Progress progress;
  const ParetoFront front = search_pareto_front(spec, progress);
  ASSERT_GT(front.points.size(), 1U);
  EXPECT_GT(front.hypervolume, 0.0);
  EXPECT_LE(front.hypervolume, 1.0);
  for (const ParetoPoint& a : front.points) {
    for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
      const Objective objective = spec.objectives[k];
      EXPECT_EQ(a.values[k], objective_of(spec, a.set, objective));
      EXPECT_LE(sense_of(objective) * a.values[k], sense_of(objective) * front.ideal[k]);
      EXPECT_GE(sense_of(objective) * a.values[k], sense_of(objective) * front.reference[k]);
    }
    for (const ParetoPoint& b : front.points) EXPECT_FALSE(dominates(spec, a, b));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Objectives, ParetoFrontOf,
    testing::Values(std::vector{Objective::kBackwardEfficiency, Objective::kLostMotion},
                    std::vector{Objective::kBackwardEfficiency, Objective::kMass,
                                Objective::kRatioError},
                    std::vector{Objective::kForwardEfficiency, Objective::kOuterDiameter},
                    std::vector{Objective::kInertia, Objective::kBackwardEfficiency}));

TEST(ParetoSearch, EveryPointIsTheBestOfAllSetsWithinItsLimit) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kLostMotion};
  Progress progress;
  const ParetoFront front = search_pareto_front(spec, progress);
  for (const ParetoPoint& point : front.points) {
    // All sets refined one by one with this much lost motion.
    Specification limited = spec;
    limited.objectives = {Objective::kBackwardEfficiency};
    limited.limits[design::CheckId::kOutputBacklashMax] = std::max(point.values[1], 1e-9);
    Progress unused;
    const OptimizeResult all = optimize(limited, unused);
    ASSERT_TRUE(all.best);
    EXPECT_NEAR(point.values[0], all.best->eta_b, 1e-5);
  }
}

TEST(ParetoSearch, TheFirstObjectiveAloneHasTheFirstPoint) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kMass};
  Progress progress;
  const ParetoFront front = search_pareto_front(spec, progress);
  spec.objectives = {Objective::kBackwardEfficiency};
  const OptimizeResult alone = optimize(spec, progress);
  // What the limit at this efficiency gives way.
  EXPECT_NEAR(front.points.front().values[0], alone.best->eta_b, 3e-6);
  EXPECT_EQ(front.points.front().set.candidate, alone.best->candidate);
}

/// What a row and a search of its tooth set may differ by: a millionth that the first objective may
/// lose, and what is feasible on either side.
constexpr double kHeld = 4e-6;

TEST(ParetoSearch, NoDesignOfARowsToothSetIsBetterInOneObjectiveAndAsGoodInTheOthers) {
  const Specification spec = test::of_least_lost_motion();
  Progress progress;
  const OptimizeResult searched = optimize(spec, progress);
  const ParetoFront front = search_pareto_front(spec, progress, {.searched = &searched});
  ASSERT_GT(front.points.size(), 2U);
  for (const ParetoPoint& point : front.points) {
    Specification efficiency = spec;
    efficiency.objectives = {Objective::kBackwardEfficiency};
    efficiency.limits[design::CheckId::kOutputBacklashMax] = point.values[0];
    const RefinedSet best = refine(efficiency, point.set.candidate);
    if (has_design(best.status)) {
      EXPECT_LE(best.eta_b, point.values[1] + kHeld) << point.values[0];
    }
    Specification lost_motion = spec;
    lost_motion.objectives = {Objective::kLostMotion};
    lost_motion.objective_limits.push_back(
        {.objective = Objective::kBackwardEfficiency, .value = point.values[1]});
    const RefinedSet least = refine(lost_motion, point.set.candidate);
    if (has_design(least.status)) {
      EXPECT_GE(least.lost_motion_rad, point.values[0] * (1.0 - kHeld)) << point.values[1];
    }
  }
}

TEST(ParetoSearch, TheFirstRowHasTheLeastLostMotionThatAnySetHasAlone) {
  const Specification spec = test::of_least_lost_motion();
  Progress progress;
  const OptimizeResult alone = optimize(spec, progress);
  ASSERT_TRUE(alone.best);
  const double least = alone.best->lost_motion_rad;
  const ParetoFront front = search_pareto_front(spec, progress, {.searched = &alone});
  EXPECT_LE(front.box_best[0], least);
  EXPECT_GE(front.box_best[0], least * (1.0 - 1e-4)) << "the same optimum";
  EXPECT_LE(front.points.front().values[0], least * (1.0 + kHeld));
}

TEST(ParetoSearch, GoesOnWhereAnEarlierRunStoppedAndFindsTheSame) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kLostMotion};
  spec.pareto_points = 8;
  Progress progress;
  std::vector<FrontStep> steps;
  const auto keep = [&](const FrontStep& step) { steps.push_back(step); };
  const ParetoFront whole = search_pareto_front(spec, progress, {.on_step = keep});
  ASSERT_EQ(steps.size(), whole.searches);
  for (const std::size_t done : {std::size_t{1}, steps.size() / 2, steps.size()}) {
    std::size_t more = 0;
    const ParetoFront resumed = search_pareto_front(
        spec, progress,
        {.steps = std::span(steps).first(done), .on_step = [&](const FrontStep&) { ++more; }});
    EXPECT_EQ(more, steps.size() - done);
    ASSERT_EQ(resumed.points.size(), whole.points.size());
    for (std::size_t k = 0; k < whole.points.size(); ++k) {
      EXPECT_EQ(resumed.points[k].values, whole.points[k].values);
      EXPECT_EQ(resumed.points[k].set.candidate, whole.points[k].set.candidate);
    }
    EXPECT_EQ(resumed.missing, whole.missing);
  }
}

TEST(ParetoSearch, IsAsGoodWithWhatASearchOfTheFirstObjectiveKnows) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kLostMotion};
  Progress progress;
  const OptimizeResult searched = optimize(spec, progress);
  const ParetoFront with = search_pareto_front(spec, progress, {.searched = &searched});
  EXPECT_EQ(with.ended, ParetoFront::Ended::kDesigns);
  for (const ParetoPoint& point : with.points) {
    Specification limited = spec;
    limited.objectives = {Objective::kBackwardEfficiency};
    limited.limits[design::CheckId::kOutputBacklashMax] = std::max(point.values[1], 1e-9);
    const OptimizeResult all = optimize(limited, progress);
    ASSERT_TRUE(all.best);
    EXPECT_NEAR(point.values[0], all.best->eta_b, 1e-5);
  }
}

TEST(ParetoSearch, OfThreeObjectivesHasNoOptimumOfASingleSetThatAnotherSetDominates) {
  Specification spec = few_sets();
  spec.teeth.S = {.min = 12, .max = sample(14, 20)};
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kLostMotion,
                     Objective::kOuterDiameter};
  spec.pareto_points = sample(8, 20);
  Progress progress;
  const OptimizeResult searched = optimize(spec, progress);
  const auto designs = std::ranges::count_if(
      searched.refined, [](const RefinedSet& set) { return has_design(set.status); });
  EXPECT_GT(designs, spec.pareto_points) << "or this case shows nothing";
  const ParetoFront front = search_pareto_front(spec, progress, {.searched = &searched});
  EXPECT_GT(front.searches, 9U) << "its ends are 9 searches, and gaps are to be cut";
  EXPECT_LE(front.hypervolume + front.missing, 1.0 + 1e-12);
  for (const ParetoPoint& point : front.points) {
    // All sets searched within the limits that this design keeps.
    Specification corner = spec;
    corner.objectives = {Objective::kBackwardEfficiency};
    corner.limits[design::CheckId::kOutputBacklashMax] = std::max(point.values[1], 1e-9);
    corner.limits[design::CheckId::kRingRootDiameter] =
        point.values[2] - 2.0 * spec.bodies.ring_rim_m;
    const OptimizeResult all = optimize(corner, progress, {.best_only = true});
    ASSERT_TRUE(all.best);
    EXPECT_LE(all.best->eta_b, point.values[0] + 1e-5);
  }
}

TEST(ParetoSearch, IsLeftAsItIsWhenItsTimeIsSpentAndTheRunGoesOn) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kLostMotion};
  Progress progress;
  std::size_t steps = 0;
  const auto spend = [&](const FrontStep&) {
    if (++steps < 5) return;
    progress.stop.end_part();
  };
  const ParetoFront front = search_pareto_front(spec, progress, {.on_step = spend});
  EXPECT_EQ(front.ended, ParetoFront::Ended::kBudget);
  EXPECT_FALSE(front.interrupted);
  EXPECT_FALSE(progress.stop);
  EXPECT_EQ(front.searches, 5U);
  EXPECT_FALSE(front.points.empty());
}

TEST(ParetoSearch, InterruptedAsItsTimeIsSpentIsInterrupted) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kLostMotion};
  for (const bool budget_first : {true, false}) {
    Progress progress;
    const auto end = [&](const FrontStep&) {
      if (budget_first) progress.stop.end_part();
      progress.stop = true;
      if (!budget_first) progress.stop.end_part();
    };
    const ParetoFront front = search_pareto_front(spec, progress, {.on_step = end});
    EXPECT_TRUE(front.interrupted);
    EXPECT_TRUE(progress.stop);
    EXPECT_EQ(front.searches, 1U);
  }
}

TEST(ParetoSearch, NoDesignOfAnySetIsOutsideWhatItSaysMayBeMissing) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kLostMotion,
                     Objective::kOuterDiameter};
  spec.pareto_points = sample(10, 30);
  Progress progress;
  const ParetoFront front = search_pareto_front(spec, progress);
  EXPECT_LE(front.hypervolume + front.missing, 1.0 + 1e-9);
  // Designs of all sets, each refined within limits of their own.
  std::vector<std::vector<double>> unit;
  const auto place = [&](const std::vector<double>& values) {
    std::vector<double> at;
    for (std::size_t k = 0; k < values.size(); ++k) {
      at.push_back((values[k] - front.box_best[k]) / (front.box_worst[k] - front.box_best[k]));
    }
    return at;
  };
  for (const ParetoPoint& point : front.points) unit.push_back(place(point.values));
  EXPECT_NEAR(hypervolume(unit), front.hypervolume, 1e-9) << "of one box with what is missing";
  for (const double lost_motion : {0.2, 0.45, 0.8}) {
    for (const double diameter : {0.3, 0.7}) {
      Specification limited = spec;
      limited.objectives = {Objective::kBackwardEfficiency};
      const auto between = [&](std::size_t k, double share) {
        return front.box_best[k] + share * (front.box_worst[k] - front.box_best[k]);
      };
      limited.limits[design::CheckId::kOutputBacklashMax] = between(1, lost_motion);
      limited.limits[design::CheckId::kRingRootDiameter] =
          between(2, diameter) - 2.0 * spec.bodies.ring_rim_m;
      const OptimizeResult all = optimize(limited, progress);
      for (const RefinedSet& set : all.refined) {
        if (set.status != Status::kOptimal) continue;
        std::vector<double> values;
        for (const Objective objective : spec.objectives) {
          values.push_back(objective_of(spec, set, objective));
        }
        unit.push_back(place(values));
      }
    }
  }
  EXPECT_LE(hypervolume(unit), front.hypervolume + front.missing + 1e-4);
}

TEST(ParetoSearch, StoppedAtOnceHasNoPoints) {
  Specification spec = few_sets();
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kMass};
  Progress progress;
  progress.stop = true;
  const ParetoFront front = search_pareto_front(spec, progress);
  EXPECT_TRUE(front.interrupted);
  EXPECT_TRUE(front.points.empty());
  EXPECT_EQ(front.hypervolume, 0.0);
}

}  // namespace
}  // namespace gear3k::optimize::pareto_search_test
