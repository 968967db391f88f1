// Searches beyond ranges: as many are foreseen as are made.

#include "optimize/wider_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"

namespace gear3k::optimize::wider_search_test {
namespace {

/// Ranges and lists of modules whose ends the best set may sit at.
constexpr const char* kTask =
    "[ratio]\ntarget = 45.0\ntolerance = 0.3\n"
    "[teeth]\nS = [14, 14]\nP1 = [29, 30]\nP2 = [30, 32]\nR1_max = 90\nR2_max = 90\n"
    "[module]\nstage1_mm = { series = [0.6, 0.7] }\nstage2_mm = { series = [0.6, 0.7] }\n"
    "[backlash]\nmax_output_arcmin = 12.0\nmin_normal_um = 5.0\nmachining_allowance = 0.02\n"
    "[friction]\ncoefficient = 0.1\n";

/// Of a task with so many sets.
void expect_as_many_as_foreseen(const Specification& spec, const RefinedSet& best,
                                std::size_t sets) {
  Progress progress;
  HeldBack held = held_back(spec, best, spec.limits);
  const std::size_t foreseen = searches_again(spec, sets, held);
  search_beyond(spec, best, sets, held, progress);
  const auto tried = static_cast<std::size_t>(std::ranges::count_if(
      held.at, [](const SearchBound& bound) { return bound.wider.has_value(); }));
  EXPECT_EQ(progress.stage_total, foreseen);
  EXPECT_EQ(progress.stage_done, tried);
  EXPECT_EQ(progress.searches, tried);
  EXPECT_LT(tried, held.at.size());  // beyond lists nothing is searched
  EXPECT_GT(tried, 0U);
  search_relaxed(spec, best, sets, held, progress);
  EXPECT_EQ(progress.searches, foreseen);
}

TEST(WiderSearch, ForeseesAsManySearchesAsItMakes) {
  const Specification spec = io::parse_specification(kTask, "task.toml");
  Progress progress;
  const OptimizeResult result = optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  expect_as_many_as_foreseen(spec, *result.best, result.search.candidates.size());
  expect_as_many_as_foreseen(spec, *result.best, kMostSearchedAgain + 1);
}

TEST(WiderSearch, ThatIsStoppedIsInterruptedWhereThereWasSomethingToTry) {
  const Specification spec = io::parse_specification(kTask, "task.toml");
  Progress progress;
  const OptimizeResult result = optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  const std::size_t sets = result.search.candidates.size();
  const HeldBack found = held_back(spec, *result.best, spec.limits);
  EXPECT_FALSE(found.interrupted);
  progress.stop = true;
  HeldBack held = found;
  search_beyond(spec, *result.best, sets, held, progress);
  EXPECT_TRUE(held.interrupted);
  held = found;
  search_relaxed(spec, *result.best, sets, held, progress);
  EXPECT_TRUE(held.interrupted);
  held = found;
  held.at.clear();
  search_beyond(spec, *result.best, sets, held, progress);
  EXPECT_FALSE(held.interrupted);
}

// A tenth more of nothing is the same task.
TEST(WiderSearch, OfNoToleranceIsNone) {
  Specification spec = io::parse_specification(kTask, "task.toml");
  Progress progress;
  OptimizeResult result = optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  spec.ratio = {.target = train::ratio(result.best->candidate.teeth), .tolerance = 0.0};
  result = optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  HeldBack held = held_back(spec, *result.best, spec.limits);
  std::erase_if(held.at, [](const SearchBound& bound) { return bound.key != "ratio.tolerance"; });
  ASSERT_EQ(held.at.size(), 1U);
  held.prices.clear();
  EXPECT_EQ(searches_again(spec, result.search.candidates.size(), held), 0U);
  search_beyond(spec, *result.best, result.search.candidates.size(), held, progress);
  EXPECT_FALSE(held.at.front().wider);
  spec.ratio.tolerance = 1e-6;
  EXPECT_EQ(searches_again(spec, result.search.candidates.size(), held), 1U);
}

/// Against the task with the key itself stated otherwise.
TEST(WiderSearch, GainsAreOfTheSetRefinedAnew) {
  const Specification spec = io::parse_specification(kTask, "task.toml");
  Progress progress;
  const OptimizeResult result = optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  HeldBack held = held_back(spec, *result.best, spec.limits);
  refine_gains(spec, *result.best, held, progress);
  int compared = 0;
  for (const LimitPrice& price : held.prices) {
    if (price.key != "backlash.max_output_arcmin") continue;
    std::string task = kTask;
    const std::string stated = "max_output_arcmin = 12.0";
    task.replace(task.find(stated), stated.size(), "max_output_arcmin = 13.0");
    const RefinedSet again =
        refine(io::parse_specification(task, "task.toml"), result.best->candidate);
    ASSERT_TRUE(price.refined_gain_si);
    EXPECT_NEAR(*price.refined_gain_si, again.eta_b - result.best->eta_b, 1e-9);
    EXPECT_GT(*price.refined_gain_si, 0.0);
    ++compared;
  }
  EXPECT_EQ(compared, 1);
  const LimitPrice* const most = dearest(held);
  ASSERT_NE(most, nullptr);
  for (const LimitPrice& price : held.prices) {
    if (price.refined_gain_si) {
      EXPECT_LE(*price.refined_gain_si, *most->refined_gain_si) << price.key;
    }
  }
}

/// Of a task in which the set has no design whatever gives way.
TEST(WiderSearch, WhatCannotBeRefinedHasNoGainButThePrice) {
  Specification spec = io::parse_specification(kTask, "task.toml");
  Progress progress;
  const OptimizeResult result = optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  HeldBack held = held_back(spec, *result.best, spec.limits);
  const HeldBack unrefined = held;
  ASSERT_NE(dearest(held), nullptr);
  refine_gains(spec, *result.best, held, progress);
  spec.limits[design::CheckId::kTipThicknessLength] = 0.1;
  HeldBack without = unrefined;
  refine_gains(spec, *result.best, without, progress);
  int given_way = 0;
  for (std::size_t k = 0; k < held.prices.size(); ++k) {
    EXPECT_FALSE(without.prices[k].refined_gain_si) << held.prices[k].key;
    given_way += held.prices[k].refined_gain_si ? 1 : 0;
  }
  EXPECT_GT(given_way, 1);
  const LimitPrice* const most = dearest(without);
  ASSERT_NE(most, nullptr);
  EXPECT_EQ(most->key, dearest(unrefined)->key);
}

}  // namespace
}  // namespace gear3k::optimize::wider_search_test
