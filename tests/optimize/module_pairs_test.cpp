// Modules chosen from lists: bounds of pairs of modules against designs found without them, and
// refined sets against one search for each pair.

#include "optimize/module_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/set_bounds.hpp"
#include "tests/optimize/random_specification.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::module_pairs_test {
namespace {

using rig::DeterministicRandom;
using test::random_task;
using test::random_workshop_task;
using test::RandomTask;

/// Two lists of two to four modules, the same ones in both where `same`.
void draw_lists(DeterministicRandom& random, Specification& spec) {
  const auto list = [&] {
    std::vector<double> modules{0.4e-3, 0.5e-3, 0.6e-3, 0.8e-3, 1.0e-3};
    random.shuffle(modules);
    modules.resize(2 + random.index(3));
    std::ranges::sort(modules);
    return modules;
  };
  spec.module[0] = {.range_m = std::nullopt, .series_m = list()};
  spec.module[1] = spec.module[0];
  if (!has_same_module(spec) && test::with_chance(random, 0.5)) spec.module[1].series_m = list();
}

RandomTask task_with_lists(std::uint64_t seed, std::size_t most) {
  DeterministicRandom random(seed + 90'000);
  RandomTask task = seed % 2 == 0 ? random_task(seed, most) : random_workshop_task(seed, most);
  draw_lists(random, task.spec);
  return task;
}

double decides(const Specification& spec, const SetBound& bound) {
  return first_objective(spec) == Objective::kForwardEfficiency ? bound.eta_f : bound.eta_b;
}

TEST(ModulePairs, NoDesignThatIsFoundLiesAboveTheBoundOfItsPair) {
  constexpr double kRounding = 1e-12;
  int found = 0, ruled_out = 0, pairs = 0;
  for (std::uint64_t seed = 1; seed <= sample(60U, 1000U); ++seed) {
    const RandomTask task = task_with_lists(seed, 2);
    if (task.candidates.empty()) continue;
    Progress progress;
    const SetBounds apart(task.spec, task.candidates, progress);
    SetBounds bounds(task.spec, task.candidates, progress);
    std::vector<std::uint32_t> all(task.candidates.size());
    std::iota(all.begin(), all.end(), 0U);
    bounds.tie(all, progress);
    ASSERT_TRUE(bounds.ties());
    const std::vector<FixedModules> combinations = module_combinations(task.spec);
    for (std::size_t k = 0; k < task.candidates.size(); ++k) {
      if (apart.of(k).infeasible) continue;
      const SetBound whole = bounds.of(k);
      const std::vector<ModuleBound> by_modules =
          whole.infeasible ? std::vector<ModuleBound>{} : bounds.by_modules(k);
      double greatest = -kInfinity;
      pairs += static_cast<int>(combinations.size());
      ruled_out += static_cast<int>(combinations.size() - by_modules.size());
      for (std::size_t pair = 0; pair < combinations.size(); ++pair) {
        const std::string what = "seed " + std::to_string(seed) + " set " + std::to_string(k) +
                                 " pair " + std::to_string(pair);
        const RefinementProblem problem =
            make_refinement_problem(task.spec, task.candidates[k], combinations[pair]);
        const auto best = test::search_designs(
            {problem}, 2, seed, [](const RefinementProblem&, const SolveOutcome&) {});
        if (!best) continue;
        ++found;
        greatest = std::max(greatest, best->objective);
        const auto bound = std::ranges::find(by_modules, std::optional(pair), &ModuleBound::pair);
        ASSERT_NE(bound, by_modules.end()) << what << " is ruled out";
        EXPECT_LE(best->objective, decides(task.spec, bound->bound) + kRounding) << what;
        EXPECT_LE(best->objective, decides(task.spec, whole) + kRounding) << what;
      }
      if (greatest > -kInfinity) {
        EXPECT_LE(greatest, decides(task.spec, bounds.sharpened(k, greatest)) + kRounding)
            << "seed " << seed << " set " << k;
      }
    }
  }
  EXPECT_GT(found, 10);
  EXPECT_GT(ruled_out, pairs / 2);
}

/// A small task of which a good part can be made.
RandomTask small_task(std::uint64_t seed) {
  using design::CheckId;
  RandomTask task = task_with_lists(seed, 0);
  Specification& spec = task.spec;
  for (const CheckId id : {CheckId::kOutputBacklashMax, CheckId::kPlanetGap,
                           CheckId::kInvoluteInterference, CheckId::kSunRootDiameter}) {
    spec.limits[id] = std::nullopt;
  }
  spec.limits[CheckId::kContactRatioMin] = 1.1;
  spec.limits[CheckId::kContactRatioMax] = std::nullopt;
  spec.solver.starts = 4;
  spec.teeth.S.max = spec.teeth.S.min + 1;
  spec.teeth.P1.max = spec.teeth.P1.min + 2;
  spec.teeth.P2.max = spec.teeth.P2.min + 2;
  spec.ratio.tolerance = 0.02;
  return task;
}

/// The 96:1 example with modules of a list.
Specification rp96_of_list() {
  Specification spec = io::read_specification(GEAR3K_SOURCE_DIR "/examples/rp96.toml");
  spec.teeth.S = {.min = 12, .max = 13};
  for (ModuleChoice& module : spec.module) {
    module = {.range_m = std::nullopt, .series_m = {0.4e-3, 0.5e-3, 0.6e-3}};
  }
  return spec;
}

TEST(ModulePairs, SetsThatAreNotTiedHaveOneBoundForAnyModules) {
  const Specification spec = rp96_of_list();
  Progress progress;
  const ToothSearchResult search = search_teeth(spec, progress);
  SetBounds bounds(spec, search.candidates, progress);
  std::vector<std::uint32_t> all(search.candidates.size());
  std::iota(all.begin(), all.end(), 0U);
  progress.stop = true;
  EXPECT_FALSE(bounds.tie(all, progress));
  int sets = 0;
  for (const std::uint32_t k : all) {
    if (bounds.of(k).infeasible) continue;
    const std::vector<ModuleBound> any = bounds.by_modules(k);
    ASSERT_EQ(any.size(), 1U) << k;
    EXPECT_FALSE(any.front().pair);
    ++sets;
  }
  EXPECT_GT(sets, 10);
  progress.stop = false;
  EXPECT_TRUE(bounds.tie(all, progress));
}

/// A run that another thread stops so long after its refinement began, while its stages are bound
/// by pairs and later: it ends, and what it refined before is of modules of the lists.
TEST(ModulePairs, RunsThatAreStoppedWhileStagesAreBoundByPairsEnd) {
  const Specification spec = rp96_of_list();
  int stopped = 0;
  for (int after_us = 0; after_us <= 50'000; after_us = 2 * after_us + 10) {
    Progress progress;
    std::thread other([&] {
      while (progress.phase.load() != Progress::Phase::kRefinement) {
      }
      std::this_thread::sleep_for(std::chrono::microseconds(after_us));
      progress.stop = true;
    });
    const OptimizeResult result = optimize(spec, progress, {.best_only = true, .certify = false});
    progress.phase = Progress::Phase::kRefinement;
    other.join();
    stopped += result.interrupted ? 1 : 0;
    for (const RefinedSet& set : result.refined) {
      if (set.status != Status::kOptimal) continue;
      for (std::size_t stage = 0; stage < 2; ++stage) {
        EXPECT_EQ(std::ranges::count(spec.module[stage].series_m, set.train.module_m[stage]), 1);
      }
    }
  }
  EXPECT_GT(stopped, 3);
}

/// Small tasks, every tooth set refined once with the lists and once for each pair alone.
TEST(ModulePairs, SetsAreAsGoodAsTheBestOfOneSearchForEachPair) {
  constexpr double kSame = 1e-8;
  int compared = 0;
  std::size_t sets = 0, worse = 0;
  for (std::uint64_t seed = 1; compared < sample(4, 40); ++seed) {
    ASSERT_LT(seed, 2000U);
    const RandomTask task = small_task(seed);
    Progress progress;
    const std::size_t candidates = search_teeth(task.spec, progress).candidates.size();
    if (candidates == 0 || candidates > 30) continue;
    const OptimizeResult whole = optimize(task.spec, progress);
    if (!whole.best) continue;
    ++compared;
    std::vector<double> best(whole.search.candidates.size(), -kInfinity);
    for (const FixedModules& modules : module_combinations(task.spec)) {
      Specification one = task.spec;
      for (std::size_t stage = 0; stage < 2; ++stage) {
        one.module[stage] = {.range_m = std::nullopt, .series_m = {*modules[stage]}};
      }
      const OptimizeResult alone = optimize(one, progress);
      ASSERT_EQ(alone.search.candidates.size(), best.size());
      for (const RefinedSet& set : alone.refined) {
        if (set.status == Status::kOptimal) {
          best[set.index] = std::max(best[set.index], merit_of(task.spec, set));
        }
      }
    }
    const double greatest = *std::ranges::max_element(best);
    EXPECT_NEAR(merit_of(task.spec, *whole.best), greatest, kSame) << "seed " << seed;
    for (std::size_t k = 0; k < best.size(); ++k) {
      const auto set = set_at(whole, k);
      ASSERT_TRUE(set);
      if (best[k] == -kInfinity) continue;
      ++sets;
      EXPECT_EQ(set->status, Status::kOptimal) << "seed " << seed << " set " << k;
      if (merit_of(task.spec, *set) < best[k] - kSame) ++worse;
    }
    const OptimizeResult certified = optimize(task.spec, progress, {.best_only = true});
    ASSERT_TRUE(certified.best && certified.certificate);
    EXPECT_NEAR(merit_of(task.spec, *certified.best), greatest, kSame) << "seed " << seed;
    EXPECT_LE(certified.refined.size(), whole.refined.size());
    EXPECT_EQ(certified.certificate->refined + certified.certificate->bounded +
                  certified.certificate->infeasible,
              best.size());
  }
  // Other starts of a set may end in another basin.
  EXPECT_LE(worse, 1 + sets / 100) << "of " << sets;
}

}  // namespace
}  // namespace gear3k::optimize::module_pairs_test
