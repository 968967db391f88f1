// Limits that hold for the built gearboxes: every design that is chosen is built anew.

#include "optimize/robust.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"
#include "tests/design/redrawn.hpp"

namespace gear3k::optimize::robust_test {
namespace {

using design::CheckId;

constexpr double kArcmin = 3.14159265358979323846 / 10800.0;
/// By how much a limit may be missed: ten times what RobustResult counts as nothing.
constexpr double kNothing = 1e-7;

/// Two tooth sets of examples/ratio-96.toml with tolerances of about ISO 1328 grade 5, or `scale`
/// times as much.
Specification few_sets(double scale) {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
  spec.teeth.S = {.min = 12, .max = 12};
  spec.teeth.P1 = {.min = 64, .max = 65};
  spec.teeth.P2 = {.min = 51, .max = 53};
  spec.solver.starts = 2;
  backlash::Tolerances t;
  for (backlash::GearTolerances& gear : t.gears) {
    gear.tooth_thickness_m = {.lower = -scale * 8e-6, .upper = 0.0};
    gear.runout_m = scale * 10e-6;
    gear.cumulative_pitch_m = scale * 14e-6;
    gear.single_pitch_m = scale * 4e-6;
  }
  t.center_distance_m = {.lower = -scale * 5e-6, .upper = scale * 5e-6};
  t.pin_position_m = scale * 8e-6;
  t.planet_phase_rad = {.lower = -scale * 0.5 * kArcmin, .upper = scale * 0.5 * kArcmin};
  spec.tolerances = t;
  spec.sampling = {.samples = 40'000, .seed = 3};
  return spec;
}

SearchOutcome search(const Specification& spec) {
  Progress progress;
  OptimizeResult result = optimize(spec, progress);
  return {.best = std::move(result.best), .interrupted = result.interrupted};
}

/// A design of a pass under the limits that the specification states.
design::Design stated_design(const Specification& spec, const RobustPass& pass) {
  design::Design design = design_of(spec, *pass.best);
  design.limits = spec.limits;
  return design;
}

/// Least margin over the corners of all tolerances, in scales of the checks, but for backlash.
void expect_checks_hold_at_their_worst(const design::Design& design, bool backlash_too) {
  const auto evaluation = std::get<design::Evaluation>(design::evaluate(design));
  ASSERT_TRUE(evaluation.tolerance_limits);
  EXPECT_GT(evaluation.tolerance_limits->checks.size(), 20U);
  for (const design::CheckLimits& check : evaluation.tolerance_limits->checks) {
    const bool of_backlash = check.record->limit_key.starts_with("backlash.");
    if (of_backlash && !backlash_too) continue;
    EXPECT_TRUE(check.holds || check.margin.least > -kNothing)
        << check.record->name << ' ' << check.mesh << ' ' << check.gear << ' '
        << check.margin.least;
  }
}

TEST(RobustLimits, ForAYieldReachItWithGearboxesThatTheSearchNeverSaw) {
  Specification spec = few_sets(1.0);
  spec.robust = {.hold = Hold::kYield, .yield = 0.97};
  const RobustResult result = robust_limits(spec, search);
  ASSERT_TRUE(result.chosen);
  EXPECT_FALSE(result.interrupted);
  const RobustPass& nominal = result.passes.front();
  const RobustPass& chosen = result.passes[*result.chosen];
  ASSERT_TRUE(nominal.outcome && chosen.outcome);
  EXPECT_EQ(nominal.share, 0.0);
  EXPECT_EQ(nominal.limits[CheckId::kOutputBacklashMax], spec.limits[CheckId::kOutputBacklashMax]);
  EXPECT_GT(chosen.share, 0.0);
  EXPECT_GE(chosen.outcome->yield, spec.robust.yield);
  EXPECT_LT(nominal.outcome->yield, spec.robust.yield);
  constexpr std::uint64_t kSamples = 200'000;
  const BuiltOutcome fresh = built_outcome(stated_design(spec, chosen), kSamples, 1234567);
  const auto error = [&](std::uint64_t n) {
    return std::sqrt(0.97 * 0.03 / static_cast<double>(n));
  };
  EXPECT_NEAR(fresh.yield, chosen.outcome->yield, 4.0 * std::hypot(error(kSamples), error(40'000)));
  EXPECT_NEAR(fresh.yield + fresh.jammed + fresh.beyond_limit, 1.0, 1e-12);
  const BuiltOutcome nominal_fresh = built_outcome(stated_design(spec, nominal), kSamples, 1234567);
  EXPECT_LT(nominal_fresh.yield, 0.5);
  expect_checks_hold_at_their_worst(stated_design(spec, chosen), false);
  EXPECT_TRUE(chosen.outcome->checks_hold);
  EXPECT_LT(merit_of(spec, *chosen.best), merit_of(spec, *nominal.best));
  // No pass that holds has a better merit, and one with less tightening does not hold.
  for (const RobustPass& pass : result.passes) {
    if (!pass.outcome) continue;
    const bool holds = pass.outcome->checks_hold && pass.outcome->yield >= spec.robust.yield;
    if (holds) {
      EXPECT_LE(merit_of(spec, *pass.best), merit_of(spec, *chosen.best));
    }
    EXPECT_FALSE(holds && pass.share < chosen.share) << pass.share;
  }
}

TEST(RobustLimits, InTheWorstCaseHoldForEveryGearbox) {
  Specification spec = few_sets(0.2);
  spec.robust.hold = Hold::kWorstCase;
  const RobustResult result = robust_limits(spec, search);
  ASSERT_TRUE(result.chosen);
  EXPECT_EQ(*result.chosen + 1, result.passes.size());
  EXPECT_GT(*result.chosen, 0U);
  const RobustPass& chosen = result.passes[*result.chosen];
  ASSERT_TRUE(result.passes.front().outcome && chosen.outcome);
  const double limit = *spec.limits[CheckId::kOutputBacklashMax];
  EXPECT_GT(result.passes.front().outcome->greatest_rad, limit);
  EXPECT_LE(chosen.outcome->greatest_rad, limit + kNothing);
  EXPECT_GE(chosen.outcome->least_margin_m, -kNothing);
  const design::Design design = stated_design(spec, chosen);
  expect_checks_hold_at_their_worst(design, true);
  EXPECT_LT(merit_of(spec, *chosen.best), merit_of(spec, *result.passes.front().best));
  const auto model = design::clearance_model_of(design);
  ASSERT_TRUE(model);
  const auto series =
      backlash::monte_carlo(*model, {.samples = 500'000,
                                     .seed = 99,
                                     .scatter = {.scatter = backlash::Scatter::kUniform},
                                     .limit_rad = limit});
  EXPECT_EQ(series.yield.count, series.samples);
}

/// Least S − S_min over drawings of the corners of thickness, tips and centre distance, each with
/// all gears at their ends together or at random ones.
double least_safety_of_corners(const design::Design& design, CheckId id) {
  double least = std::numeric_limits<double>::infinity();
  std::mt19937_64 generator(5);
  for (int corner = 0; corner < 200; ++corner) {
    const auto built =
        design::built_by(*design.tolerances, [&](const backlash::DeviationLimits& l) {
          if (corner < 2) return corner == 0 ? l.lower : l.upper;
          return generator() % 2 == 0 ? l.lower : l.upper;
        });
    const auto e = std::get<design::Evaluation>(design::evaluate(design::redrawn(design, built)));
    for (const design::CheckResult& check : e.checks) {
      if (check.record->id == id) least = std::min(least, check.margin);
    }
  }
  return least;
}

TEST(RobustLimits, HoldForTheTeethUnderLoadOfEveryGearbox) {
  // So much torque that the roots or the flanks of the best design are at their limit.
  Specification spec = few_sets(0.2);
  spec.teeth.P1 = {.min = 64, .max = 64};
  spec.rating->torque_Nm = 30.0;
  spec.rating->accuracy_grade = 6;
  for (backlash::GearTolerances& gear : spec.tolerances->gears) {
    gear.tip_diameter_m = {.lower = -10e-6, .upper = 0.0};
  }
  spec.robust.hold = Hold::kWorstCase;
  const RobustResult result = robust_limits(spec, search);
  ASSERT_TRUE(result.chosen);
  const design::Design nominal = stated_design(spec, result.passes.front());
  const design::Design chosen = stated_design(spec, result.passes[*result.chosen]);
  double nominal_least = 1.0;
  for (const CheckId id : {CheckId::kRootSafety, CheckId::kFlankSafety}) {
    nominal_least = std::min(nominal_least, least_safety_of_corners(nominal, id));
    EXPECT_GE(least_safety_of_corners(chosen, id), -2.0 * design::kFeasibilityTolerance);
  }
  EXPECT_LT(nominal_least, -1e-3);
  expect_checks_hold_at_their_worst(chosen, true);
}

TEST(RobustLimits, OfTolerancesThatNoDesignBearsAreNone) {
  Specification spec = few_sets(10.0);
  for (const Hold hold : {Hold::kYield, Hold::kWorstCase}) {
    spec.robust.hold = hold;
    const RobustResult result = robust_limits(spec, search);
    EXPECT_FALSE(result.chosen);
    EXPECT_FALSE(result.interrupted);
    ASSERT_FALSE(result.passes.empty());
    ASSERT_TRUE(result.passes.front().outcome);
    EXPECT_LT(result.passes.front().outcome->yield, spec.robust.yield);
  }
}

TEST(RobustLimits, OfTolerancesThatLeaveNoMeshAreNone) {
  // The axes may come so near that P1-R1 has no working pressure angle.
  Specification spec = few_sets(1.0);
  spec.tolerances->center_distance_m = {.lower = -2e-3, .upper = 2e-3};
  for (const Hold hold : {Hold::kYield, Hold::kWorstCase}) {
    spec.robust.hold = hold;
    const RobustResult result = robust_limits(spec, search);
    EXPECT_FALSE(result.chosen);
    ASSERT_EQ(result.passes.size(), 1U);
    ASSERT_TRUE(result.passes.front().best);
    EXPECT_FALSE(result.passes.front().outcome);
    EXPECT_THROW(
        static_cast<void>(built_outcome(stated_design(spec, result.passes.front()), 1000, 1)),
        std::invalid_argument);
    EXPECT_FALSE(checks_hold(stated_design(spec, result.passes.front())));
  }
}

TEST(RobustLimits, ThatTheNominalDesignKeepsNeedOnePass) {
  // Run-out moves no corner; the lost motion is free, and every mesh keeps 40 um.
  Specification spec = few_sets(0.0);
  spec.limits[CheckId::kOutputBacklashMax].reset();
  spec.limits[CheckId::kNormalBacklash] = 40e-6;
  spec.tolerances->gears[train::kR2].runout_m = 5e-6;
  for (const Hold hold : {Hold::kYield, Hold::kWorstCase}) {
    spec.robust.hold = hold;
    const RobustResult result = robust_limits(spec, search);
    ASSERT_TRUE(result.chosen);
    EXPECT_EQ(*result.chosen, 0U);
    EXPECT_EQ(result.passes.size(), 1U);
    ASSERT_TRUE(result.passes.front().outcome);
    EXPECT_EQ(result.passes.front().outcome->yield, 1.0);
    EXPECT_EQ(result.passes.front().limits.limit, spec.limits.limit);
  }
}

TEST(RobustLimits, WithoutTolerancesThatDeviateAreTheStatedOnes) {
  Specification spec = few_sets(0.0);
  spec.robust = {.hold = Hold::kYield, .yield = 1.0};
  const RobustResult result = robust_limits(spec, search);
  ASSERT_TRUE(result.chosen);
  EXPECT_EQ(result.passes.size(), 1U);
}

TEST(RobustLimits, OfASearchThatFindsNothingAreNone) {
  const Specification spec = few_sets(1.0);
  for (const bool interrupted : {false, true}) {
    const RobustResult result = robust_limits(spec, [&](const Specification&) {
      return SearchOutcome{.best = {}, .interrupted = interrupted};
    });
    EXPECT_FALSE(result.chosen);
    EXPECT_EQ(result.interrupted, interrupted);
    EXPECT_EQ(result.passes.size(), 1U);
  }
}

TEST(RobustLimits, StopWhereTheSearchIsInterrupted) {
  Specification spec = few_sets(1.0);
  spec.robust.hold = Hold::kYield;
  int searches = 0;
  const RobustResult result = robust_limits(spec, [&](const Specification& tightened) {
    SearchOutcome found = search(tightened);
    found.interrupted = ++searches == 3;
    return found;
  });
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(searches, 3);
  EXPECT_EQ(result.passes.size(), 3U);
}

TEST(BuiltOutcome, NeedsTolerances) {
  EXPECT_THROW(static_cast<void>(built_outcome(design::Design{}, 1000, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::optimize::robust_test
