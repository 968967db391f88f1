// The interference checks against gears that are cut and rolled point by point; the full run is
// benchmarks/rolling_truth.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "design/evaluation.hpp"
#include "tests/geometry/rolling_simulation.hpp"

namespace gear3k::test::rolling_truth_test {
namespace {

constexpr double kModule_m = 1e-3;
constexpr double kAlpha_rad = std::numbers::pi / 9.0;
// Truncation of the simulated profiles: linear interpolation between 360 radii.
constexpr double kProfileTolerance = 2e-5;

geometry::Gear<double> gear(int teeth, geometry::GearKind kind, double root_radius) {
  geometry::Gear<double> g;
  g.teeth = teeth;
  g.kind = kind;
  g.module_m = 1.0;
  g.rack.root_radius = root_radius;
  return g;
}

/// Zero-shift pinion in a ring at the reference distance; the pinion's small root radius keeps its
/// fillet out of the way of the ring's tip, as catalogues assume.
SimulatedPair catalogue_pair(int pinion, int ring) {
  return {.pressure_angle_rad = kAlpha_rad,
          .center_distance = 0.5 * (ring - pinion),
          .gear1 = gear(pinion, geometry::GearKind::kExternal, 0.05),
          .gear2 = gear(ring, geometry::GearKind::kRing, 0.05)};
}

struct Rolled {
  RollingResult result;
  double assembly_overlap;
};
Rolled rolled(const SimulatedPair& pair) {
  const CutProfile pinion = cut_gear(pair.gear1, pair.pressure_angle_rad).value();
  const CutProfile ring = cut_gear(pair.gear2, pair.pressure_angle_rad).value();
  return {roll(pair, pinion, ring).value(), radial_assembly_overlap(pair, pinion, ring, 8)};
}

TEST(RollingSimulation, CutFlanksAreInvolutesWhereNothingIsUndercut) {
  for (int teeth : {18, 25, 40, 100}) {
    const CutProfile cut =
        cut_gear(gear(teeth, geometry::GearKind::kExternal, 0.38), kAlpha_rad).value();
    for (double r = 0.5 * teeth - 0.5; r < cut.tip_radius; r += 0.01) {
      EXPECT_NEAR(cut.missing_at(r), 0.0, kProfileTolerance) << teeth << " teeth, r = " << r;
    }
  }
  // Rings by a pinion cutter: the planing motion has the same conjugate flank.
  geometry::Gear<double> ring = gear(72, geometry::GearKind::kRing, 0.0);
  ring.cutter = {.teeth = 25, .profile_shift = 0.1, .tip_radius = 0.15};
  const CutProfile cut = cut_gear(ring, kAlpha_rad).value();
  for (double r = cut.tip_radius; r < 36.8; r += 0.01) {
    EXPECT_NEAR(cut.missing_at(r), 0.0, kProfileTolerance) << "ring, r = " << r;
  }
}

TEST(RollingSimulation, StandardRackUndercutsTwelveTeethAndNotEighteen) {
  const auto most_missing = [](int teeth) {
    const CutProfile cut =
        cut_gear(gear(teeth, geometry::GearKind::kExternal, 0.38), kAlpha_rad).value();
    double most = 0.0;
    for (double r = cut.base_radius; r < cut.tip_radius; r += 1e-3) {
      most = std::max(most, cut.missing_at(r));
    }
    return most;
  };
  EXPECT_GT(most_missing(12), 1e-3);
  EXPECT_LT(most_missing(18), kPlain.missing);
}

// KHK Gear Technical Data, internal gears: limits at 20°, zero shift, addenda of one module.
struct CatalogueLimit {
  int ring, smallest_pinion, largest_free_of_tips, largest_assembled;
};

TEST(RollingSimulation, SeesTheCataloguesLimitsOfInternalGears) {
  // Ring 60 with pinion 44 misses assembly by 5.5e-6 rad (1.2e-4 modules) in the formula that the
  // catalogue's 43 follows from: less than can be seen as an overlap of 1e-3 modules.
  for (const CatalogueLimit& limit :
       {CatalogueLimit{60, 21, 51, 44}, CatalogueLimit{80, 20, 72, 64},
        CatalogueLimit{100, 19, 92, 84}, CatalogueLimit{120, 19, 112, 104},
        CatalogueLimit{160, 19, 152, 144}}) {
    SCOPED_TRACE("ring " + std::to_string(limit.ring));
    const auto at = [&](int pinion) { return rolled(catalogue_pair(pinion, limit.ring)); };
    EXPECT_TRUE(std::isinf(at(limit.smallest_pinion - 1).result.missing[0]));
    EXPECT_EQ(seen(at(limit.smallest_pinion).result), "");
    EXPECT_EQ(seen(at(limit.largest_free_of_tips).result), "");
    EXPECT_EQ(seen(at(limit.largest_free_of_tips + 1).result), "tips");
    EXPECT_LT(at(limit.largest_assembled).assembly_overlap, kPlain.overlap);
    EXPECT_GT(at(limit.largest_assembled + 1).assembly_overlap, kPlain.overlap);
  }
}

TEST(RollingSimulation, RingTipReachesThePinionFilletOfTheFullRootRadius) {
  // Addendum 1.0 and rack 1.0/1.25/0.38: the rack's straight flank ends at depth 1.0, but a ring's
  // tip wants contact deeper than a rack's.
  SimulatedPair pair = catalogue_pair(40, 80);
  EXPECT_EQ(seen(rolled(pair).result), "");
  pair.gear1.rack.root_radius = 0.38;
  EXPECT_EQ(seen(rolled(pair).result), "mesh");
}

std::vector<NamedMargin> margins_of(const SimulatedPair& pair) {
  design::PairDesign p;
  p.name = "pair";
  p.pressure_angle_rad = pair.pressure_angle_rad;
  p.center_distance_m = pair.center_distance * kModule_m;
  p.gear1 = pair.gear1;
  p.gear2 = pair.gear2;
  p.gear1.module_m = p.gear2.module_m = kModule_m;
  const auto result = design::evaluate(p);
  std::vector<NamedMargin> margins;
  for (const design::CheckResult& check : std::get<design::PairEvaluation>(result).checks) {
    // The interference checks are all in modules.
    if (check.record->unit == units::Unit::kModule) {
      margins.push_back({.name = check.record->name, .gear = 0, .margin = check.margin});
    }
  }
  return margins;
}

TEST(RollingTruth, ChecksMissNoInterferenceAndRaiseFewFalseAlarms) {
  constexpr std::uint64_t kPairs = 300, kSeed = 20;
  int away = 0, false_alarms = 0;
  for (std::uint64_t number = 0; number < kPairs; ++number) {
    RandomPair random(kSeed, number);
    SimulatedPair pair = random.pair();
    if (number % 3 == 0) {
      const std::vector<NamedMargin> margins = margins_of(pair);
      for (int attempt = 0; attempt < 6; ++attempt) {
        const NamedMargin& check = margins[number / 3 % margins.size()];
        const auto moved = random.move_near_limit(pair, check, margins_of);
        if (!moved) continue;
        pair = *moved;
        break;
      }
    }
    const auto gear1 = cut_gear(pair.gear1, pair.pressure_angle_rad);
    const auto gear2 = cut_gear(pair.gear2, pair.pressure_angle_rad);
    ASSERT_TRUE(gear1 && gear2) << number;
    const auto result = roll(pair, *gear1, *gear2);
    ASSERT_TRUE(result) << number;
    const Comparison comparison = compare(*result, margins_of(pair));
    EXPECT_NE(comparison.agreement, Agreement::kMissed)
        << "pair " << number << ": saw " << seen(*result) << ", smallest margin "
        << (comparison.worst ? comparison.worst->name : "none");
    if (!comparison.away_from_limits) continue;
    ++away;
    false_alarms += comparison.agreement == Agreement::kFalseAlarm ? 1 : 0;
  }
  EXPECT_GT(away, 100);
  EXPECT_LE(false_alarms, away / 100);
}

}  // namespace
}  // namespace gear3k::test::rolling_truth_test
