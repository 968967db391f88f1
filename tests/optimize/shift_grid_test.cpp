// Designs whose shifts are multiples of a step against every point of the grid, and stated cutters
// against one search for each of them.

#include "optimize/shift_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <memory>

#include "io/files/specification_file.hpp"
#include "optimize/cutter_choice.hpp"
#include "optimize/lattice.hpp"
#include "optimize/limit_prices.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"
#include "tests/optimize/grid_task.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::shift_grid_test {
namespace {

using test::grid_task, test::best_distance;
constexpr double kStep = test::kGridStep;

/// The least scaled objective of all points of the grid; infinity: none is feasible.
double best_of_grid(const RefinementProblem& problem) {
  double best = kInfinity;
  const std::vector<double> gear{0.0, 0.25, 0.5}, ring{0.25, 0.5, 0.75};
  EXPECT_EQ(problem.variables, 6);
  Point v = problem.lower;
  for (const double s : gear) {
    for (const double p1 : gear) {
      for (const double r1 : ring) {
        for (const double p2 : gear) {
          for (const double r2 : ring) {
            std::ranges::copy(std::array{s, p1, r1, p2, r2}, v.begin());
            best = std::min(best, best_distance(problem, v));
          }
        }
      }
    }
  }
  return best;
}

/// The best merit of all pairs of modules; minus infinity: none has a feasible point.
double best_of_all(const Specification& spec, const Candidate& candidate) {
  double best = kInfinity;
  for (const RefinementProblem& problem : test::problems_of(spec, candidate)) {
    best = std::min(best, best_of_grid(problem));
  }
  return -best;
}

TEST(ShiftGrid, SetsAreAsGoodAsTheBestPointOfTheWholeGrid) {
  constexpr double kSame = 1e-6;
  const int wanted = sample(2, 20);
  int compared = 0, none = 0;
  for (std::uint64_t seed = 1; seed <= 400 && compared < wanted; ++seed) {
    const test::RandomTask task = grid_task(seed, 1);
    if (task.candidates.empty()) continue;
    Specification free = task.spec;
    free.shift_step.reset();
    if (refine(free, task.candidates[0]).status != Status::kOptimal) continue;
    const RefinedSet set = refine(task.spec, task.candidates[0]);
    const double best = best_of_all(task.spec, task.candidates[0]);
    ++compared;
    EXPECT_EQ(set.status == Status::kOptimal, best > -kInfinity)
        << seed << " " << kStatusNames[static_cast<std::size_t>(set.status)] << " " << best;
    if (set.status != Status::kOptimal) {
      ++none;
      EXPECT_FALSE(set.blocked_by.empty()) << seed;
      continue;
    }
    EXPECT_NEAR(merit_of(task.spec, set), best, kSame) << seed;
    for (const double x : set.train.profile_shift) {
      EXPECT_EQ(x, kStep * std::round(x / kStep)) << seed;
    }
    EXPECT_FALSE(held_back(task.spec, set, task.spec.limits).missing.empty());
  }
  EXPECT_EQ(compared, wanted);
  std::cout << compared << " grids, " << none << " without a feasible point\n";
}

/// A grid whose sums of shifts leave the meshes no common distance, though free shifts do.
TEST(ShiftGrid, AGridThatIsProvenEmptyCostsNoRelaxationAndHasNoFeasiblePoint) {
  const int wanted = sample(2, 20);
  const StopFlag stop;
  int empty = 0;
  for (std::uint64_t seed = 1; seed <= 4000 && empty < wanted; ++seed) {
    test::RandomTask task = grid_task(seed, 1);
    if (task.candidates.empty()) continue;
    task.spec.limits[design::CheckId::kOutputBacklashMax] = 1e-3;
    task.spec.limits[design::CheckId::kNormalBacklash] = 5e-6;
    const RefinementProblem problem = make_refinement_problem(
        task.spec, task.candidates[0], {0.5e-3, task.spec.module[1].series_m[0]});
    const SolveOutcome free = best_within(problem, problem.lower);
    if (free.violation > design::kFeasibilityTolerance) continue;
    const GridEnd end = best_on_grid(problem, free, kInfinity, stop);
    if (end.relaxations > 0) continue;  // asked of the rows
    ++empty;
    EXPECT_FALSE(end.found || end.cut) << seed;
    ASSERT_TRUE(end.held) << seed;
    EXPECT_GT(end.outcome.violation, design::kFeasibilityTolerance) << seed;
    EXPECT_EQ(best_of_grid(problem), kInfinity) << seed;
    const GridEnd bounded = best_on_grid(problem, free, 1.0, stop);
    EXPECT_FALSE(bounded.found || bounded.cut || bounded.held) << seed;
  }
  EXPECT_EQ(empty, wanted);
}

/// A point of the grid of this set, its distance scanned: the search has to end no worse.  From the
/// box that was cut alone, no feasible point is found in a box that holds it.
TEST(ShiftGrid, ABoxIsNotLeftWhereOneStartAloneFindsNoFeasiblePoint) {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
  spec.shift_step = 0.05;
  for (ModuleChoice& choice : spec.module) {
    choice = {.range_m = std::nullopt, .series_m = {0.5e-3, 0.6e-3, 0.8e-3, 1e-3}};
  }
  Progress progress;
  const ToothSearchResult sets = search_teeth(spec, progress);
  const auto set = std::ranges::find_if(sets.candidates, [](const Candidate& c) {
    const train::ToothSet& z = c.teeth;
    return z.S == 12 && z.P1 == 44 && z.R1 == 102 && z.P2 == 28 && z.R2 == 72;
  });
  ASSERT_NE(set, sets.candidates.end());
  const RefinementProblem problem = make_refinement_problem(spec, *set, {0.6e-3, 0.8e-3});
  Point v = problem.lower;
  std::ranges::copy(std::array{0.4, 0.75, 0.8, 0.75, 0.55}, v.begin());
  const double witness = -best_distance(problem, v);
  ASSERT_GT(witness, 0.0);
  const RefinedSet best = refine(spec, *set);
  ASSERT_EQ(best.status, Status::kOptimal);
  EXPECT_GE(merit_of(spec, best), witness - 1e-6);
}

TEST(ShiftGrid, ASearchForTheBestAloneEndsAtTheBestOfAllSets) {
  const int wanted = sample(1, 20);
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 400 && compared < wanted; ++seed) {
    const test::RandomTask task = grid_task(seed, 0);
    Progress progress;
    const OptimizeResult all = optimize(task.spec, progress);
    if (!all.best) continue;
    ++compared;
    const OptimizeResult certified = optimize(task.spec, progress, {.best_only = true});
    ASSERT_TRUE(certified.best && certified.certificate);
    EXPECT_NEAR(merit_of(task.spec, *certified.best), merit_of(task.spec, *all.best),
                2.0 * kBetterOnLattice)
        << seed;
    EXPECT_GE(certified.certificate->global_bound, merit_of(task.spec, *all.best) - 1e-12);
  }
  EXPECT_EQ(compared, wanted);
}

/// A task whose grids are searched with one relaxation only.
Specification cut_short(Specification spec) {
  spec.solver.grid_relaxations = 1;
  return spec;
}

TEST(ShiftGrid, ASetWhoseGridIsCutShortIsNeitherProvenEmptyNorBounded) {
  const test::RandomTask task = grid_task(9, 3);
  const RefinedSet whole = refine(task.spec, task.candidates.at(0));
  ASSERT_EQ(whole.status, Status::kOptimal);
  EXPECT_FALSE(whole.grid_cut);
  const RefinedSet part = refine(cut_short(task.spec), task.candidates.at(0));
  EXPECT_TRUE(part.grid_cut);
  EXPECT_EQ(part.status, Status::kNoFeasibleFound);
  EXPECT_TRUE(part.blocked_by.empty());
}

TEST(ShiftGrid, ACertificateTellsOfGridsThatWereCutShortAndBoundsTheWholeOnes) {
  const test::RandomTask task = grid_task(11, 3);
  const Specification few = cut_short(task.spec);
  Progress progress;
  const OptimizeResult part = optimize(few, progress, {.best_only = true});
  const OptimizeResult whole = optimize(task.spec, progress, {.best_only = true});
  ASSERT_TRUE(part.certificate && whole.certificate);
  EXPECT_GT(part.certificate->grid_cut, 0U);
  EXPECT_EQ(whole.certificate->grid_cut, 0U);
  EXPECT_GE(merit_of(task.spec, *whole.best), merit_of(few, *part.best));
  EXPECT_GE(part.certificate->global_bound, merit_of(task.spec, *whole.best));
  for (const RefinedSet& set : part.refined) {
    if (set.grid_cut) {
      EXPECT_NE(set.status, Status::kBounded);
    }
  }
}

/// Rings that are shaped, with what their cutters leave as limits.
test::RandomTask cutter_task(std::uint64_t seed) {
  using design::CheckId;
  test::RandomTask task = test::random_task(seed, 1);
  Specification& spec = task.spec;
  spec.limits[CheckId::kRingCutter] = 0.0;
  spec.limits[CheckId::kFormCircle] = 0.12;
  spec.limits[CheckId::kTipFouling] = 0.01;
  spec.limits[CheckId::kOutputBacklashMax] = std::nullopt;
  spec.limits[CheckId::kContactRatioMax] = std::nullopt;
  for (const std::size_t ring : {train::kR1, train::kR2}) {
    if (task.candidates.empty()) break;
    const train::ToothSet& z = task.candidates[0].teeth;
    const int teeth = ring == train::kR1 ? z.R1 : z.R2;
    spec.cutter_teeth[ring] = {13, std::max(14, teeth - 6)};  // the larger one trims tips
    spec.cutter[ring] = {.teeth = 13, .profile_shift = 0.1, .tip_radius = 0.2};
  }
  if (seed % 2 == 0) spec.cutter_teeth[train::kR2] = {};
  spec.solver.starts = 4;
  return task;
}

/// The best and the worst of one search for each choice of cutters.
struct OneByOne {
  double best = -kInfinity, worst = kInfinity;
};
OneByOne one_by_one(const test::RandomTask& task) {
  OneByOne all;
  for (const auto& choice : cutter_choices(task.spec)) {
    Specification one = task.spec;
    one.cutter = cutters_of(task.spec, choice);
    one.cutter_teeth = {};
    const RefinedSet alone = refine(one, task.candidates[0]);
    const double merit = alone.status == Status::kOptimal ? merit_of(one, alone) : -kInfinity;
    all.best = std::max(all.best, merit);
    all.worst = std::min(all.worst, merit);
  }
  return all;
}

constexpr double kSameMerit = 1e-7;

TEST(StatedCutters, AreChosenAsWellAsByOneSearchForEach) {
  const int wanted = sample(3, 100);
  int compared = 0, better = 0, worse = 0, differ = 0;
  for (std::uint64_t seed = 1; seed <= 1000 && compared < wanted; ++seed) {
    const test::RandomTask task = cutter_task(seed);
    if (task.candidates.empty()) continue;
    const RefinedSet set = refine(task.spec, task.candidates[0]);
    EXPECT_EQ(cutter_choices(task.spec).size(), seed % 2 == 0 ? 2U : 4U);
    const OneByOne alone = one_by_one(task);
    if (alone.best == -kInfinity) continue;
    ++compared;
    if (alone.best > alone.worst + kSameMerit) ++differ;
    ASSERT_EQ(set.status, Status::kOptimal) << seed;
    const double merit = merit_of(task.spec, set);
    if (merit < alone.best - kSameMerit) {  // another basin, as below
      ++worse;
      std::cout << "seed " << seed << ": " << merit << " against " << alone.best << '\n';
    }
    if (merit > alone.best + kSameMerit) ++better;
    // What is written is what was found, with its cutters.
    Specification found = task.spec;
    found.cutter = train_of(task.spec, set).cutter;
    found.cutter_teeth = {};
    const auto problem = problem_of(found, set);
    ASSERT_TRUE(problem) << seed;
    EXPECT_LE(outcome_at(problem->problem, problem->v).violation,
              2.0 * design::kFeasibilityTolerance);
  }
  EXPECT_EQ(compared, wanted);
  std::cout << compared << " sets, the cutter matters in " << differ << '\n';
  EXPECT_GT(differ, 0);
  EXPECT_LE(worse, compared / 100);
  EXPECT_LE(better, 1 + compared / 10);
}

/// Without what cutters have a say in, all starts of this set end in worse basins.
TEST(StatedCutters, AreAllSoughtWhereTheStartsOfOneLeadFartherThanWhatBoundsThem) {
  const test::RandomTask task = cutter_task(130);
  const RefinedSet set = refine(task.spec, task.candidates.at(0));
  ASSERT_EQ(set.status, Status::kOptimal);
  EXPECT_GE(merit_of(task.spec, set), one_by_one(task).best - kSameMerit);
}

/// An energy that ends the run at one of its evaluations.
class StoppingEnergy final : public CycleEnergy {
 public:
  StoppingEnergy(StopFlag& stop, int last) : stop_(stop), last_(last) {}
  [[nodiscard]] EnergyAt at(const EnergyGearbox& g) const override {
    if (++calls_ == last_) stop_ = true;
    const double inverse = 1.0 / g.forward;
    return {.energy_J = inverse - g.backward, .slope = {1.0, -1.0}};
  }
  [[nodiscard]] EnergyAt of(const design::Design& /*design*/) const override { return {}; }
  [[nodiscard]] double least(const EnergyBox& box) const override {
    return 1.0 / box.most_forward - box.most_backward;
  }
  [[nodiscard]] double scale_j() const override { return 1.0; }
  [[nodiscard]] int calls() const { return calls_; }

 private:
  StopFlag& stop_;
  int last_;
  mutable int calls_ = 0;
};

/// Wherever a run ends: what it has of a set is all of it, or nothing.
TEST(StatedCutters, ASetWhoseSearchIsEndedAmongThemIsNotDone) {
  test::RandomTask task = cutter_task(22);
  Specification& spec = task.spec;
  spec.shift_step = 0.05;
  spec.objectives = {Objective::kCycleEnergy};
  const auto refined = [&](StoppingEnergy& energy, const StopFlag& stop) {
    spec.cycle_energy = std::shared_ptr<const CycleEnergy>(&energy, [](const CycleEnergy*) {});
    return refine(spec, task.candidates.at(0), stop);
  };
  StopFlag never;
  StoppingEnergy counting(never, 0);
  const auto whole = refined(counting, never);
  ASSERT_TRUE(whole && has_design(whole->status));
  constexpr int kEnds = 20;
  int unfinished = 0;
  for (int k = 1; k <= kEnds; ++k) {
    StopFlag stop;
    StoppingEnergy ending(stop, counting.calls() * k / kEnds);
    const auto part = refined(ending, stop);
    ASSERT_TRUE(stop.load()) << k;
    if (!part) {
      ++unfinished;
      continue;
    }
    EXPECT_EQ(part->grid_cut, whole->grid_cut) << k;
    EXPECT_EQ(part->train.profile_shift, whole->train.profile_shift) << k;
    EXPECT_EQ(part->train.cutter_teeth, whole->train.cutter_teeth) << k;
  }
  std::cout << unfinished << " of " << kEnds << " ends leave the set open\n";
  EXPECT_GT(unfinished, kEnds / 2);
}

}  // namespace
}  // namespace gear3k::optimize::shift_grid_test
