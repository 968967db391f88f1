// The proof of the best of every number of planets, against a search of all sets of each.

#include <gtest/gtest.h>

#include <set>

#include "design/evaluation.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/lattice.hpp"
#include "optimize/optimizer.hpp"
#include "tests/optimize/grid_task.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::planets_proof_test {
namespace {

/// Numbers of planets with and without a design: ten have no room.  Of 700 sets, in the long run
/// 2400, the bounds leave some tens to refine.
Specification small_spec(const std::string& objective, const std::string& more = "") {
  return io::parse_specification("planets = [3, 6, 4, 10]\nobjective = " + objective +
                                     R"(
[ratio]
target = 30.0
tolerance = )" + std::string(sample("0.001", "0.005")) +
                                     R"(
[teeth]
S = [14, 30]
P1 = [16, 40]
P2 = [16, 40]
R1_max = 110
R2_max = 110
[module]
stage1_mm = 0.5
stage2_mm = { min = 0.4, max = 0.6 }
[limits]
planet_gap = 1.0
)" + more,
                                 "a test");
}

OptimizeResult searched(const Specification& spec, const OptimizeOptions& options = {}) {
  Progress progress;
  return optimize(spec, progress, options);
}

const OptimizeOptions kProof{.best_only = true, .per_planets = true};

/// Whether each proof is what a search of all sets with that number of planets says.
/// @param within  of the merit: two searches of a grid may end in points that are alike
void expect_as_all_sets_say(const Specification& spec, double within) {
  const OptimizeResult run = searched(spec, kProof);
  const OptimizeResult once = searched(spec, {.best_only = true});
  ASSERT_EQ(run.best.has_value(), once.best.has_value());
  if (!once.best) return;
  EXPECT_EQ(run.best->index, once.best->index);
  EXPECT_EQ(merit_of(spec, *run.best), merit_of(spec, *once.best));
  ASSERT_TRUE(run.certificate);
  EXPECT_EQ(run.certificate->best, once.certificate->best);
  std::vector<int> numbers = spec.planets;
  std::ranges::sort(numbers);
  ASSERT_EQ(run.by_planets.size(), numbers.size());
  std::size_t refined = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto& [planets, proof] = run.by_planets[i];
    EXPECT_EQ(planets, numbers[i]);
    Specification alone = spec;
    alone.planets = {planets};
    const OptimizeResult all = searched(alone);
    EXPECT_EQ(proof.refined + proof.bounded + proof.infeasible, all.search.candidates.size());
    refined += proof.refined;
    const RefinedSet* best = nullptr;
    for (const RefinedSet& set : run.refined) {
      if (set.candidate.planets != planets || !has_design(set.status)) continue;
      if (best == nullptr || merit_order(spec, set) < merit_order(spec, *best)) best = &set;
    }
    ASSERT_EQ(best != nullptr, all.best.has_value()) << planets;
    EXPECT_EQ(std::isfinite(proof.best), all.best.has_value()) << planets;
    if (best == nullptr) {
      EXPECT_EQ(proof.bounded, 0U) << planets;
      continue;
    }
    EXPECT_EQ(proof.best, merit_of(spec, *best));
    EXPECT_NEAR(proof.best, merit_of(spec, *all.best), within) << planets;
    if (within == 0.0) {
      EXPECT_EQ(best->candidate, all.best->candidate) << planets;
    }
    EXPECT_GE(proof.global_bound, merit_of(spec, *all.best)) << planets;
    for (const RefinedSet& set : all.refined) {
      if (!has_design(set.status) || !proof.largest_unrefined_bound) continue;
      const bool also = std::ranges::any_of(
          run.refined, [&](const RefinedSet& other) { return other.candidate == set.candidate; });
      if (!also) {
        EXPECT_GE(*proof.largest_unrefined_bound, merit_of(spec, set));
      }
    }
  }
  EXPECT_EQ(refined, run.refined.size());
  EXPECT_EQ(run.certificate->refined, run.refined.size());
}

TEST(PlanetsProof, IsWhatASearchOfAllSetsOfEachNumberSays) {
  expect_as_all_sets_say(small_spec("\"backward_efficiency\""), 0.0);
  if (!long_samples()) return;
  expect_as_all_sets_say(small_spec("\"lost_motion\""), 0.0);
  expect_as_all_sets_say(
      small_spec("\"backward_efficiency\"", "[profile_shift]\nrange = [-0.3, 0.6]\n"), 0.0);
}

// Sets whose grids were given up for the best of all are searched again.
TEST(PlanetsProof, HoldsOnGridsOfShifts) {
  const int wanted = sample(1, 12);
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 400 && compared < wanted; ++seed) {
    Specification spec = test::grid_task(seed, 0).spec;
    spec.planets = {2, 3, 4};
    if (!searched(spec, {.best_only = true}).best) continue;
    ++compared;
    expect_as_all_sets_say(spec, 2.0 * kBetterOnLattice);
  }
  EXPECT_EQ(compared, wanted);
}

// What progress foresees of a certificate is what it takes.
TEST(PlanetsProof, TakesTheBoundsThatProgressForesees) {
  const Specification spec = small_spec("\"backward_efficiency\"");
  Progress progress;
  OptimizeOptions options{.best_only = true};
  const OptimizeResult once = optimize(spec, progress, options);
  ASSERT_TRUE(once.certificate);
  EXPECT_EQ(progress.phase, Progress::Phase::kCertificate);
  EXPECT_EQ(progress.to_sharpen, progress.total);
  EXPECT_GT(progress.total, 0U);
  EXPECT_EQ(progress.later_sets, 0U);
  // Of the numbers of planets: the sets of their first waves, and at the end none.
  options.per_planets = true;
  Progress proven;
  std::size_t foreseen = 0, first_waves = 0;
  std::set<std::size_t> numbers;
  options.on_wave = [&](std::span<const RefinedSet> wave) {
    if (proven.stage != Progress::Stage::kPlanets) {
      foreseen = proven.later_sets;
    } else if (numbers.insert(proven.stage_done).second) {
      first_waves += wave.size();
    }
  };
  const OptimizeResult run = optimize(spec, proven, options);
  EXPECT_GT(run.refined.size(), once.refined.size());
  EXPECT_GT(first_waves, 0U);
  EXPECT_EQ(first_waves, foreseen);
  EXPECT_EQ(proven.later_sets, 0U);
  EXPECT_EQ(proven.later_bounds, 0U);
}

TEST(PlanetsProof, IsLeftWhereItIsStoppedAndThatOfAllStays) {
  const Specification spec = small_spec("\"backward_efficiency\"");
  const OptimizeResult once = searched(spec, {.best_only = true});
  Progress progress;
  OptimizeOptions options = kProof;
  options.on_wave = [&](std::span<const RefinedSet>) {
    if (progress.stage == Progress::Stage::kPlanets) progress.stop = true;
  };
  const OptimizeResult part = optimize(spec, progress, options);
  EXPECT_TRUE(part.interrupted);
  EXPECT_LT(part.by_planets.size(), spec.planets.size());
  ASSERT_TRUE(part.certificate);
  EXPECT_EQ(part.certificate->best, once.certificate->best);
  EXPECT_EQ(part.certificate->global_bound, once.certificate->global_bound);
}

TEST(PlanetsProof, GoesOnWithTheSetsOfAnEarlierRun) {
  Specification spec = test::grid_task(2, 0).spec;
  spec.planets = {2, 3, 4};
  OptimizeOptions options = kProof;
  std::vector<RefinedSet> kept;
  options.on_wave = [&](std::span<const RefinedSet> sets) {
    kept.insert(kept.end(), sets.begin(), sets.end());
  };
  const OptimizeResult whole = searched(spec, options);
  std::ranges::stable_sort(kept, {}, &RefinedSet::index);
  options.on_wave = nullptr;
  options.known = kept;
  const OptimizeResult again = searched(spec, options);
  ASSERT_EQ(again.refined.size(), whole.refined.size());
  for (std::size_t k = 0; k < whole.refined.size(); ++k) {
    EXPECT_EQ(again.refined[k].index, whole.refined[k].index);
    EXPECT_EQ(again.refined[k].status, whole.refined[k].status);
    EXPECT_EQ(again.refined[k].eta_b, whole.refined[k].eta_b);
  }
  ASSERT_EQ(again.by_planets.size(), whole.by_planets.size());
  for (std::size_t k = 0; k < whole.by_planets.size(); ++k) {
    EXPECT_EQ(again.by_planets[k].proof.best, whole.by_planets[k].proof.best);
    EXPECT_EQ(again.by_planets[k].proof.global_bound, whole.by_planets[k].proof.global_bound);
  }
}

}  // namespace
}  // namespace gear3k::optimize::planets_proof_test
