// Tooth numbers at which the interference of internal gears begins, and what they look like from a
// designer's side.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "backlash/normal_backlash.hpp"
#include "geometry/interference.hpp"

namespace gear3k::geometry::interference_limits_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAlpha20_rad = 20.0 * kPi / 180.0;
constexpr double kModule_m = 1e-3;

GearGeometry<double> full_gear(int teeth, GearKind kind, double alpha_rad = kAlpha20_rad) {
  return make_gear_geometry<double>({.teeth = teeth,
                                     .kind = kind,
                                     .module_m = kModule_m,
                                     .profile_shift = 0.0,
                                     .machining_allowance = 0.0,
                                     .tip_shortening = 0.0,
                                     .rack = {},
                                     .cutter = {}},
                                    make_pressure_angle(alpha_rad));
}

struct Margins {
  double involute, trochoid, trimming;
};

/// A pinion in a ring, both of full teeth without shift, at the reference centre distance.
Margins margins_of(int pinion_teeth, int ring_teeth, double alpha_rad = kAlpha20_rad) {
  const auto pinion = full_gear(pinion_teeth, GearKind::kExternal, alpha_rad);
  const auto ring = full_gear(ring_teeth, GearKind::kRing, alpha_rad);
  const auto mesh =
      make_mesh_geometry(pinion, ring, 0.5 * kModule_m * (ring_teeth - pinion_teeth)).value();
  return {.involute = involute_interference_margin(pinion, ring, mesh, 2),
          .trochoid = trochoid_margin(pinion, ring, mesh),
          .trimming = trimming_margin(pinion, ring, mesh)};
}

TEST(InterferenceLimits, TrochoidAndTrimmingBeginAtThePublishedTeethOfTheMatingPinion) {
  const toml::table file =
      toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/internal_gear_tooth_limits.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const double alpha = file["pressure_angle_deg"].value<double>().value() * kPi / 180.0;
  int rows = 0;
  for (const toml::node& node : *file["row"].as_array()) {
    const toml::table& row = *node.as_table();
    const int ring = row["ring_teeth"].value<int>().value();
    const int max_trochoid = row["pinion_max_trochoid"].value<int>().value();
    const int max_trimming = row["pinion_max_trimming"].value<int>().value();
    for (int pinion = 18; pinion <= ring - 4; ++pinion) {
      const Margins m = margins_of(pinion, ring, alpha);
      EXPECT_EQ(m.trochoid >= 0.0, pinion <= max_trochoid) << pinion << "/" << ring;
      EXPECT_EQ(m.trimming >= 0.0, pinion <= max_trimming) << pinion << "/" << ring;
    }
    ++rows;
  }
  EXPECT_EQ(rows, 6);
}

TEST(InterferenceLimits, PlanetOf20FailsInARingOf60AndPassesInARingOf64) {
  EXPECT_LT(margins_of(20, 60).involute, 0.0);
  EXPECT_GT(margins_of(20, 64).involute, 0.0);
}

TEST(InterferenceLimits, ToothDifferenceOf8FailsTrochoidInterferenceAnd9Passes) {
  for (int planet = 30; planet <= 60; ++planet) {
    EXPECT_LT(margins_of(planet, planet + 8).trochoid, 0.0) << planet;
    EXPECT_GT(margins_of(planet, planet + 9).trochoid, 0.0) << planet;
  }
}

/// Least lateral room that a tip corner of the ring leaves to that of a pinion which moves in along
/// the line of centres: tooth and space turned through every position, flanks in contact.
double lateral_room_m(int pinion_teeth, int ring_teeth) {
  const auto pinion = full_gear(pinion_teeth, GearKind::kExternal);
  const auto ring = full_gear(ring_teeth, GearKind::kRing);
  const auto involute_angle = [](double base_m, double radius_m) {
    const double roll = std::sqrt(radius_m * radius_m - base_m * base_m) / base_m;
    return roll - std::atan(roll);
  };
  const double working = std::tan(kAlpha20_rad) - kAlpha20_rad;
  const double corner1 = involute_angle(pinion.base_radius_m, pinion.tip_radius_m) - working;
  const double corner2 = involute_angle(ring.base_radius_m, ring.tip_radius_m) - working;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 20000; ++i) {
    const double turn1 = i * 1e-4;
    if (turn1 - corner1 > kPi / 2.0) break;
    const double turn2 = turn1 * pinion_teeth / ring_teeth;
    least = std::min(least, ring.tip_radius_m * std::sin(turn2 - corner2) -
                                pinion.tip_radius_m * std::sin(turn1 - corner1));
  }
  return least;
}

TEST(InterferenceLimits, TrimmingFirstPassesAtADifferenceOf17UpTo44TeethAnd16From45) {
  // 45 in 61 passes by 1.4e-5 modules of arc, 44 in 60 fails by 1.2e-4; the KHK table (43 in 60, 64
  // in 80) has the same step between them.
  for (int planet = 18; planet <= 120; ++planet) {
    const int first = planet <= 44 ? 17 : 16;
    for (int difference = 12; difference <= 20; ++difference) {
      EXPECT_EQ(margins_of(planet, planet + difference).trimming >= 0.0, difference >= first)
          << planet << " and " << difference;
    }
  }
}

TEST(InterferenceLimits, TrimmingMarginHasTheSignOfTheLateralRoomOfTheTipCorners) {
  for (int planet = 18; planet <= 120; ++planet) {
    for (int difference = 12; difference <= 20; ++difference) {
      if (planet + difference < 34) continue;  // the tips lie inside the base circle
      const double margin = margins_of(planet, planet + difference).trimming;
      EXPECT_EQ(margin >= 0.0, lateral_room_m(planet, planet + difference) >= 0.0)
          << planet << " and " << difference << ": " << margin;
    }
  }
}

TEST(InterferenceLimits, TrimmingIsStricterThanTrochoidInterference) {
  for (int planet = 18; planet <= 120; ++planet) {
    for (int difference = 4; difference <= 30; ++difference) {
      const Margins m = margins_of(planet, planet + difference);
      EXPECT_LE(m.trimming, m.trochoid) << planet << " and " << difference;
    }
  }
}

TEST(RunningClearance, OpensExternalMeshesAndClosesInternalOnes) {
  std::mt19937_64 generator(21);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  };
  const auto angle = make_pressure_angle(kAlpha20_rad);
  for (int i = 0; i < 1000; ++i) {
    for (const GearKind kind : {GearKind::kExternal, GearKind::kRing}) {
      const bool ring = kind == GearKind::kRing;
      const int teeth1 = std::uniform_int_distribution<int>(12, 60)(generator);
      const int teeth2 = teeth1 + std::uniform_int_distribution<int>(ring ? 9 : 0, 60)(generator);
      const auto gear = [&](int teeth, GearKind gear_kind, double shift) {
        return make_gear_geometry<double>({.teeth = teeth,
                                           .kind = gear_kind,
                                           .module_m = kModule_m,
                                           .profile_shift = shift,
                                           .machining_allowance = 0.0,
                                           .tip_shortening = 0.0,
                                           .rack = {},
                                           .cutter = {}},
                                          angle);
      };
      const auto g1 = gear(teeth1, GearKind::kExternal, between(0.0, 0.6));
      const auto g2 = gear(teeth2, kind, between(0.0, 0.6) + (ring ? g1.gear.profile_shift : 0.0));
      const double clearance_m = between(0.01, 0.05) * kModule_m;
      const double d = zero_backlash_center_distance(g1, g2).value() + clearance_m;
      const auto mesh = make_mesh_geometry(g1, g2, d).value();
      const double j = backlash::normal_backlash(g1, g2, mesh);
      // First order: 2 sin(alpha_w) of the change; the rest is below a tenth of it.
      const double expected = (ring ? -2.0 : 2.0) * clearance_m * std::sin(mesh.alpha_w_rad);
      EXPECT_NEAR(j, expected, 0.1 * std::abs(expected)) << teeth1 << "/" << teeth2;
    }
  }
}

}  // namespace
}  // namespace gear3k::geometry::interference_limits_test
