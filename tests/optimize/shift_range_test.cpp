#include "optimize/shift_range.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "geometry/interference.hpp"
#include "optimize/refinement_problem.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::optimize::shift_range_test {
namespace {

using design::CheckId;
using rig::DeterministicRandom;

Specification random_specification(DeterministicRandom& random) {
  const auto chance = [&](double p) { return random.uniform() < p; };
  Specification spec;
  spec.pressure_angle_rad = random.between(14.5, 28.0) * 3.14159265358979 / 180.0;
  spec.module = {ModuleChoice{.range_m = NumberRange{0.4e-3, 1e-3}, .series_m = {}},
                 ModuleChoice{.range_m = std::nullopt, .series_m = {0.8e-3, 0.5e-3}}};
  spec.profile_shift = {.min = random.between(-1.0, 0.3), .max = random.between(0.4, 2.0)};
  spec.rack.addendum = random.between(0.7, 1.3);
  spec.rack.dedendum = spec.rack.addendum + 0.25;
  spec.rack.root_radius = random.between(0.0, 0.3);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    if (chance(0.4)) spec.tip_shortening[i] = random.between(0.0, 0.4);
    if (chance(0.4)) spec.machining_allowance[i] = random.between(0.0, 0.08);
  }
  const auto draw = [&](CheckId id, double low, double high) {
    spec.limits[id] = chance(0.8) ? std::optional(random.between(low, high)) : std::nullopt;
  };
  draw(CheckId::kUndercut, -0.3, 0.3);
  draw(CheckId::kTipThickness, 0.0, 0.9);
  draw(CheckId::kRingTipOutsideBase, -0.2, 0.4);
  draw(CheckId::kRingRootDiameter, 0.01, 0.2);
  return spec;
}

/// What one gear alone has to meet at a shift, by the checks' own functions.
struct Scan {
  const Specification& spec;
  int gear, teeth;

  [[nodiscard]] geometry::GearGeometry<double> at(double shift) const {
    const auto i = static_cast<std::size_t>(gear);
    return geometry::make_gear_geometry<double>(
        {.teeth = teeth,
         .kind = train::kind_of(gear),
         .module_m = 1.0,
         .profile_shift = shift,
         .machining_allowance = spec.machining_allowance[i],
         .tip_shortening = spec.tip_shortening[i],
         .rack = spec.rack,
         .cutter = {}},
        geometry::make_pressure_angle(spec.pressure_angle_rad));
  }
  [[nodiscard]] bool is_ring() const { return train::kind_of(gear) == geometry::GearKind::kRing; }
  /// Least margin of undercut, tip thickness or ring tip.
  [[nodiscard]] double margin(double shift) const {
    const auto g = at(shift);
    double least = 1e9;
    const auto look = [&](CheckId id, double value) {
      if (spec.limits[id]) least = std::min(least, value - *spec.limits[id]);
    };
    if (is_ring()) {
      look(CheckId::kRingTipOutsideBase, geometry::ring_tip_above_base(g));
      return least;
    }
    look(CheckId::kUndercut, geometry::undercut_margin(g));
    if (!spec.khk_tip[static_cast<std::size_t>(gear)]) {
      look(CheckId::kTipThickness, geometry::tooth_thickness(g, g.tip_radius_m));
    }
    return least;
  }
  [[nodiscard]] double diameter_margin_m(double shift) const {
    const auto& limit = spec.limits[CheckId::kRingRootDiameter];
    if (!is_ring() || !limit) return 1e9;
    const double module = train::stage_of(gear) == 0 ? 0.4e-3 : 0.5e-3;
    return *limit - 2.0 * module * at(shift).root_radius_m;
  }
};

constexpr int kNodes = 400;

struct Hull {
  double lo = 1e9, hi = -1e9;
  void add(double x) {
    lo = std::min(lo, x);
    hi = std::max(hi, x);
  }
  [[nodiscard]] bool empty() const { return lo > hi; }
};

class ShiftRangeOf : public testing::TestWithParam<int> {
 protected:
  template <class Visit>
  void for_each_case(const Visit& visit) const {
    DeterministicRandom random(static_cast<std::uint64_t>(40 + GetParam()));
    for (int n = 0; n < 250; ++n) {
      Specification spec = random_specification(random);
      const bool ring = train::kind_of(GetParam()) == geometry::GearKind::kRing;
      const int teeth =
          ring ? 30 + static_cast<int>(random.index(190)) : 5 + static_cast<int>(random.index(90));
      visit(n, spec, Scan{spec, GetParam(), teeth}, shift_range(spec, GetParam(), teeth));
    }
  }
  static double shift_at(const Specification& spec, int node) {
    return spec.profile_shift.min +
           (spec.profile_shift.max - spec.profile_shift.min) * node / kNodes;
  }
};

TEST_P(ShiftRangeOf, HoldsEveryShiftThatMeetsTheLimits) {
  for_each_case([&](int n, const Specification& spec, const Scan& scan, const ShiftRange& range) {
    EXPECT_FALSE(range.range.empty());
    EXPECT_FALSE(range.widest.empty());
    EXPECT_GE(range.range.lo, spec.profile_shift.min);
    EXPECT_LE(range.range.hi, spec.profile_shift.max);
    for (int node = 0; node <= kNodes; ++node) {
      const double x = shift_at(spec, node);
      // Ring tips keep off their base circles by a millionth.
      if (scan.is_ring() && geometry::ring_tip_above_base(scan.at(x)) < 1e-6) continue;
      if (scan.margin(x) < 0.0) continue;
      EXPECT_GE(x, range.range.lo - 1e-12) << "case " << n << " teeth " << scan.teeth;
      EXPECT_LE(x, range.range.hi + 1e-12) << "case " << n << " teeth " << scan.teeth;
      if (scan.diameter_margin_m(x) < 0.0) continue;
      EXPECT_GE(x, range.widest.lo - 1e-12) << "case " << n;
      EXPECT_LE(x, range.widest.hi + 1e-12) << "case " << n;
      EXPECT_FALSE(range.infeasible) << "case " << n << " teeth " << scan.teeth << " x " << x << " "
                                     << design::check_record(range.infeasible->check).name;
    }
  });
}

TEST_P(ShiftRangeOf, EndsWhereTheLimitsDo) {
  int compared = 0;
  for_each_case([&](int n, const Specification& spec, const Scan& scan, const ShiftRange& range) {
    if (range.infeasible) return;
    Hull found;
    for (int node = 0; node <= kNodes; ++node) {
      const double x = shift_at(spec, node);
      if (scan.is_ring() && geometry::ring_tip_above_base(scan.at(x)) < 1e-6) continue;
      if (scan.margin(x) >= 0.0) found.add(x);
    }
    const double step = (spec.profile_shift.max - spec.profile_shift.min) / kNodes;
    if (found.empty()) return;
    ++compared;
    // Within one step: the range is no wider than what meets the limits.
    EXPECT_LE(found.lo, range.range.lo + step * 1.001) << "case " << n << " teeth " << scan.teeth;
    EXPECT_GE(found.hi, range.range.hi - step * 1.001) << "case " << n << " teeth " << scan.teeth;
  });
  EXPECT_GT(compared, 60);
}

TEST_P(ShiftRangeOf, IsInfeasibleWhereNoShiftMeetsTheLimits) {
  int infeasible = 0;
  for_each_case([&](int n, const Specification& spec, const Scan& scan, const ShiftRange& range) {
    double best = -1e9;
    for (int node = 0; node <= kNodes; ++node) {
      const double x = shift_at(spec, node);
      best = std::max(best, std::min(scan.margin(x), 1e3 * scan.diameter_margin_m(x)));
    }
    infeasible += range.infeasible ? 1 : 0;
    if (range.infeasible) {
      EXPECT_LT(best, 0.0) << "case " << n;
      EXPECT_GT(range.infeasible->violation, design::kFeasibilityTolerance);
      EXPECT_TRUE(range.infeasible->alone);
    }
  });
  EXPECT_GT(infeasible, 3);
}

TEST_P(ShiftRangeOf, WidestHoldsShiftsThatMissLimitsByTheFeasibilityTolerance) {
  // Large gears with thick tips have thicknesses that hardly change with the shift.
  DeterministicRandom random(static_cast<std::uint64_t>(60 + GetParam()));
  for (int n = 0; n < 1000; ++n) {
    Specification spec = random_specification(random);
    if (spec.limits[CheckId::kTipThickness]) {
      *spec.limits[CheckId::kTipThickness] = random.between(0.2, 1.4);
    }
    const int teeth = 30 + static_cast<int>(random.index(470));
    const ShiftRange range = shift_range(spec, GetParam(), teeth);
    const Scan scan{spec, GetParam(), teeth};
    // Beyond the shifts that meet all limits, just as far as the tolerance reaches.
    for (const double end : {range.range.lo, range.range.hi}) {
      for (int step = -60; step <= 60; ++step) {
        const double x = end + 1e-6 * step;
        if (x < spec.profile_shift.min || x > spec.profile_shift.max) continue;
        const auto& diameter = spec.limits[CheckId::kRingRootDiameter];
        const double tolerance = 0.999 * design::kFeasibilityTolerance;
        if (scan.margin(x) < -tolerance ||
            scan.diameter_margin_m(x) < -tolerance * diameter.value_or(1.0)) {
          continue;
        }
        if (scan.is_ring() && geometry::ring_tip_above_base(scan.at(x)) < 1e-6) continue;
        EXPECT_FALSE(range.infeasible) << "case " << n << " teeth " << teeth;
        EXPECT_GE(x, range.widest.lo) << "case " << n << " teeth " << teeth;
        EXPECT_LE(x, range.widest.hi) << "case " << n << " teeth " << teeth;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Gears, ShiftRangeOf,
                         testing::Range(0, static_cast<int>(train::kGearCount)),
                         [](const auto& gear) {
                           return std::string(
                               train::kGearNames[static_cast<std::size_t>(gear.param)]);
                         });

TEST(ShiftRange, OfAKhkTipDoesNotLookAtItsThickness) {
  Specification spec;
  spec.pressure_angle_rad = 0.349;
  spec.module.fill(ModuleChoice{.range_m = NumberRange{0.5e-3, 1e-3}, .series_m = {}});
  spec.limits[CheckId::kUndercut] = std::nullopt;
  spec.limits[CheckId::kTipThickness] = 0.6;
  const double without_rule = shift_range(spec, train::kS, 12).range.hi;
  spec.khk_tip[train::kS] = true;
  EXPECT_LT(without_rule, 0.9);
  EXPECT_EQ(shift_range(spec, train::kS, 12).range.hi, spec.profile_shift.max);
}

TEST(ShiftTable, HoldsTheRangesOfItsToothSets) {
  DeterministicRandom random(51);
  const Specification spec = random_specification(random);
  const std::vector<Candidate> candidates{
      {.teeth = {.S = 12, .P1 = 40, .R1 = 92, .P2 = 36, .R2 = 90}, .planets = 3},
      {.teeth = {.S = 17, .P1 = 33, .R1 = 83, .P2 = 30, .R2 = 81}, .planets = 3}};
  const ShiftTable table(spec, candidates);
  for (const Candidate& candidate : candidates) {
    const auto teeth = train::teeth_of(candidate.teeth);
    const ShiftRanges ranges = table.of(candidate.teeth);
    for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
      const ShiftRange alone = shift_range(spec, static_cast<int>(gear), teeth[gear]);
      EXPECT_EQ(ranges[gear].range.lo, alone.range.lo);
      EXPECT_EQ(ranges[gear].range.hi, alone.range.hi);
      EXPECT_EQ(ranges[gear].widest.hi, alone.widest.hi);
      EXPECT_EQ(ranges[gear].infeasible.has_value(), alone.infeasible.has_value());
    }
  }
}

}  // namespace
}  // namespace gear3k::optimize::shift_range_test
