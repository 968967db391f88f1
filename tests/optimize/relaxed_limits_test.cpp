// Limits that have to give way against searches of all tooth sets without each of them, and against
// bisection of a limit by refining one set.

#include "optimize/relaxed_limits.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "io/files/specification_file.hpp"
#include "optimize/refine.hpp"
#include "tests/optimize/small_task.hpp"

namespace gear3k::optimize::relaxed_limits_test {
namespace {

using design::CheckId;

/// 23 tooth sets, without limits.
const std::string kTask = "preset = \"machined\"\nplanets = 3\n" +
                          test::small_task({.S = {14, 15}, .P1 = {24, 28}, .P2 = {18, 22}});

Specification specification(const std::string& limits) {
  return io::parse_specification(kTask + limits, "spec.toml", kMostRefinedSets);
}

bool has_design(const Specification& spec) {
  Progress progress;
  return optimize(spec, progress).best.has_value();
}

struct Blocked {
  const char* name;
  const char* limits;
  bool alone;  ///< one limit by itself frees a design
};
class BlockedTask : public testing::TestWithParam<Blocked> {};

std::optional<double>& limit_in(Specification& spec, const LimitOf& limit) {
  if (limit.place < 0) return spec.limits[limit.check.value()];
  return spec.limits.mesh_backlash_m.at(static_cast<std::size_t>(limit.place));
}

/// A set that misses one limit alone has a design where that gives way by as much: no limit is told
/// to have to give way further, but by three digits.
void expect_as_near_as_blocked(const OptimizeResult& blocked, const RelaxedLimits& relaxed) {
  for (const Freed& freed : relaxed.freed) {
    if (freed.limits.size() > 1) continue;
    const RelaxedLimit& limit = freed.limits.front();
    const design::CheckRecord& record = design::check_record(*limit.of.check);
    const double told = std::abs(*limit.relaxed_si - limit.stated_si);
    for (const RefinedSet& set : blocked.refined) {
      if (set.status != Status::kNoFeasibleFound || set.blocked_together) continue;
      for (const Miss& miss : set.blocked_by) {
        if (miss.name != record.name || !(miss.amount > 0.0)) continue;
        EXPECT_LE(told, miss.amount * units::si_per(record.unit) + 0.01 * std::abs(limit.stated_si))
            << record.name;
      }
    }
  }
}

TEST_P(BlockedTask, IsFreedByTheLimitsWithoutWhichSearchesOfAllSetsFindADesign) {
  const Specification spec = specification(GetParam().limits);
  Progress progress;
  const OptimizeResult blocked = optimize(spec, progress, {.best_only = true});
  ASSERT_FALSE(blocked.best);
  ASSERT_FALSE(blocked.search.candidates.empty());
  const RelaxedLimits relaxed = relax_limits(spec, blocked, progress);
  EXPECT_EQ(relaxed.alone, limits_that_may_give_way(spec));
  const bool alone = std::ranges::any_of(
      relaxed.freed, [](const Freed& freed) { return freed.limits.size() == 1; });
  EXPECT_EQ(alone, GetParam().alone);
  EXPECT_EQ(relaxed.paired.empty(), alone);
  EXPECT_FALSE(relaxed.freed.empty()) << "or this case shows nothing";
  for (const LimitOf& limit : relaxed.alone) {
    Specification without = spec;
    limit_in(without, limit) = design::default_limits()[*limit.check];
    const bool told = std::ranges::any_of(relaxed.freed, [&](const Freed& freed) {
      return freed.limits.size() == 1 && freed.limits.front().of == limit;
    });
    EXPECT_EQ(has_design(without), told) << key_of_limit(limit);
  }
  for (const Freed& freed : relaxed.freed) {
    Specification with = spec;
    for (const RelaxedLimit& limit : freed.limits) {
      const bool at_least = design::check_record(*limit.of.check).at_least;
      ASSERT_TRUE(limit.relaxed_si);
      // Three digits in the unit of files, as one would type them.
      const double told =
          units::decimal_from_si(*limit.relaxed_si, design::check_record(*limit.of.check).unit);
      EXPECT_EQ(told, std::stod(fmt::format("{:.3g}", told)));
      EXPECT_EQ(limit.stated_si, *limit_in(with, limit.of));
      if (at_least) {
        EXPECT_LT(*limit.relaxed_si, limit.stated_si);
      } else {
        EXPECT_GT(*limit.relaxed_si, limit.stated_si);
      }
      limit_in(with, limit.of) = limit.relaxed_si;
    }
    const RefinedSet again = refine(with, freed.set.candidate);
    EXPECT_EQ(again.status, Status::kOptimal);
    EXPECT_NEAR(again.eta_b, freed.set.eta_b, 1e-9);
  }
  expect_as_near_as_blocked(blocked, relaxed);
}

INSTANTIATE_TEST_SUITE_P(
    Limits, BlockedTask,
    testing::Values(
        Blocked{"Tip", "[limits]\ntip_thickness_mm = 0.7\n", true},
        Blocked{"Diameter", "[size]\nmax_ring_root_diameter_mm = 30.0\n", true},
        Blocked{"TipInADiameter",
                "[limits]\ntip_thickness_mm = 0.45\n[size]\nring_rim_mm = 2.0\n"
                "max_outer_diameter_mm = 50.0\n",
                true},
        Blocked{"Contact", "[contact_ratio]\nrange = [1.55, 3.0]\n", true},
        Blocked{"BacklashOfOneMesh", "[backlash.P2-R2]\nmin_normal_um = 400.0\n", true},
        Blocked{"BacklashOfEveryMesh",
                "[backlash.S-P1]\nmin_normal_um = 20.0\n[backlash.P1-R1]\nmin_normal_um = 20.0\n"
                "[backlash.P2-R2]\nmin_normal_um = 400.0\n",
                true},
        Blocked{"Two", "[limits]\ntip_thickness_mm = 0.7\n[contact_ratio]\nrange = [1.55, 3.0]\n",
                false}),
    [](const auto& blocked) { return std::string(blocked.param.name); });

TEST(RelaxedLimit, OfOneSetIsWhatBisectionFindsToThreeDigits) {
  const std::string one = "[allowed_teeth]\nS = 14\nP1 = 28\nP2 = 20\nR1 = 70\nR2 = 59\n";
  const auto at = [&](double tip_mm) {
    return specification(one + "[limits]\ntip_thickness_mm = " + std::to_string(tip_mm) + "\n");
  };
  const Specification spec = at(0.9);
  Progress progress;
  const OptimizeResult blocked = optimize(spec, progress, {.best_only = true});
  ASSERT_FALSE(blocked.best);
  ASSERT_EQ(blocked.search.candidates.size(), 1U);
  const RelaxedLimits relaxed = relax_limits(spec, blocked, progress);
  const auto tip = std::ranges::find_if(relaxed.freed, [](const Freed& freed) {
    return freed.limits.front().of.check == CheckId::kTipThicknessLength;
  });
  ASSERT_NE(tip, relaxed.freed.end());
  double least = 0.15, greatest = 0.9;
  while (greatest - least > 1e-4) {
    const double middle = 0.5 * (least + greatest);
    const RefinedSet set = refine(at(middle), blocked.search.candidates.front());
    (set.status == Status::kOptimal ? least : greatest) = middle;
  }
  EXPECT_LE(1e3 * *tip->limits.front().relaxed_si, greatest);
  EXPECT_GE(1e3 * *tip->limits.front().relaxed_si, least - 0.002);
}

/// Where few sets are blocked by a limit it is left out together with others first.  Where that
/// search ends without a design, here as it refines nothing, the set that misses it alone is told.
TEST(RelaxedLimits, AreThoseThatABlockedSetMissesAloneWhereSearchesFindNone) {
  const Specification spec = specification(
      "[size]\nmax_ring_root_diameter_mm = 39.0\n[limits]\ntip_thickness_mm = 0.45\n");
  Progress progress;
  OptimizeResult blocked = optimize(spec, progress, {.best_only = true});
  ASSERT_FALSE(blocked.best);
  const design::CheckRecord& tip = design::check_record(CheckId::kTipThicknessLength);
  const auto misses_tip = [&](const RefinedSet& set) {
    return set.status == Status::kNoFeasibleFound && !set.blocked_together &&
           !set.blocked_by.empty() && set.blocked_by.front().name == tip.name;
  };
  const auto one = std::ranges::find_if(blocked.refined, misses_tip);
  ASSERT_NE(one, blocked.refined.end());
  const RefinedSet alone = *one;
  // As if all other sets missed contact ratios.
  std::vector<RefinedSet> sets;
  for_each_set(blocked, [&](std::size_t k, const std::optional<RefinedSet>& set) {
    sets.push_back(k == alone.index ? alone : set.value());
    if (k == alone.index) return;
    sets.back().status = Status::kNoFeasibleFound;
    sets.back().blocked_together = true;
    sets.back().blocked_by = {{.name = design::check_record(CheckId::kContactRatioMin).name,
                               .violation = 1.0,
                               .amount = 0.1,
                               .unit = ""}};
  });
  ASSERT_GT(sets.size(), 21U) << "one of them is no twentieth";
  blocked.refined = std::move(sets);
  const RelaxedLimits relaxed = relax_limits(spec, blocked, progress, 0);
  const auto freed = std::ranges::find_if(
      relaxed.freed, [&](const Freed& each) { return each.limits.front().of.check == tip.id; });
  ASSERT_NE(freed, relaxed.freed.end());
  EXPECT_EQ(freed->set.candidate.teeth, alone.candidate.teeth);
  const double miss_mm = alone.blocked_by.front().amount;
  EXPECT_NEAR(1e3 * *freed->limits.front().relaxed_si, 0.45 - miss_mm, 1.001e-3);
  Specification with = spec;
  with.limits[tip.id] = freed->limits.front().relaxed_si;
  EXPECT_EQ(refine(with, alone.candidate).status, Status::kOptimal);
}

}  // namespace
}  // namespace gear3k::optimize::relaxed_limits_test
