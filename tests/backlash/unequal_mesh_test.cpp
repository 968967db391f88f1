// Gears of slightly different base pitch: by thicknesses on the working pitch circles, and by two
// rigid gears that are turned against each other point by point.

#include "backlash/unequal_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "backlash/normal_backlash.hpp"
#include "tests/geometry/generated_space.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"
#include "train/thermal_growth.hpp"

namespace gear3k::backlash::unequal_mesh_test {
namespace {

using geometry::GearGeometry, geometry::GearKind;

constexpr double kPi = std::numbers::pi;

struct Pair {
  GearGeometry<double> gear1, gear2;
  double center_distance_m = 0.0;
};

/// Meshes of random trains, of gears that have grown apart.
template <class See>
void for_random_pairs(double most_growth, See see) {
  RandomTrain random(64);
  for (int i = 0; i < 1000; ++i) {
    const auto train = random.train(i % 2 == 0);
    for (const auto [first, second] : train::kMeshGears) {
      const Pair pair{train::grown_gear(train.gears[static_cast<std::size_t>(first)],
                                        1.0 + random.between(-most_growth, most_growth)),
                      train::grown_gear(train.gears[static_cast<std::size_t>(second)],
                                        1.0 + random.between(-most_growth, most_growth)),
                      train.center_distance_m};
      const auto mesh = make_unequal_mesh(pair.gear1, pair.gear2, pair.center_distance_m);
      if (mesh.has_working_angle) see(pair, mesh);
    }
  }
}

TEST(UnequalMesh, OfEqualBasePitchesHasTheNormalBacklashEverywhere) {
  LargestDeviation mean, least;
  int number = 0;
  for_random_pairs(0.0, [&](const Pair& p, const UnequalMesh<double>& mesh) {
    const double j = normal_backlash(p.gear1, p.gear2, mesh.mesh);
    const double allowed = 64.0 * std::numeric_limits<double>::epsilon() *
                           (p.gear2.base_radius_m + p.gear1.base_radius_m);
    mean.see(number, mesh.normal_backlash_m - j, allowed);
    least.see(number++, mesh.least_backlash_m - j, allowed);
    EXPECT_EQ(mesh.base_pitch_difference_m, 0.0);
  });
  EXPECT_GT(number, 2500);
  mean.expect_allowed("mean");
  least.expect_allowed("least");
}

// s1 + s2 + j = p on the working pitch circles, whose pitches differ: their mean.
TEST(UnequalMesh, IsTheMeanPitchLessTheThicknessesOnTheWorkingPitchCircles) {
  LargestDeviation deviation;
  int number = 0;
  for_random_pairs(0.01, [&](const Pair& p, const UnequalMesh<double>& mesh) {
    const double cos_alpha_w = std::cos(mesh.mesh.alpha_w_rad);
    const double r1 = p.gear1.base_radius_m / cos_alpha_w;
    const double r2 = p.gear2.base_radius_m / cos_alpha_w;
    const double pitch = kPi * (r1 / p.gear1.gear.teeth + r2 / p.gear2.gear.teeth);
    const double s1 = geometry::tooth_thickness(p.gear1, r1);
    const double s2 = geometry::tooth_thickness(p.gear2, r2);
    deviation.see(number++, mesh.normal_backlash_m - (pitch - s1 - s2) * cos_alpha_w,
                  64.0 * std::numeric_limits<double>::epsilon() * (r1 + r2));
  });
  EXPECT_GT(number, 2500);
  deviation.expect_allowed("closed formula");
}

/// Least play of gear 2 over a pitch of gear 1, normal to the flanks: every point of gear 1's
/// flanks that lies within gear 2's has to stand in one of its spaces.
double rolled_play_m(const Pair& p) {
  const auto& [gear1, gear2, d] = p;
  const bool ring = gear2.gear.kind == GearKind::kRing;
  const double pitch1 = 2.0 * kPi / gear1.gear.teeth;
  const double pitch2 = 2.0 * kPi / gear2.gear.teeth;
  constexpr int kPoints = 250, kPositions = 60;
  std::vector<double> radius, half_tooth;
  const double from = std::max(gear1.base_radius_m, gear1.root_radius_m);
  for (int i = 0; i <= kPoints; ++i) {
    radius.push_back(from + (gear1.tip_radius_m - from) * i / kPoints);
    half_tooth.push_back(0.5 * pitch1 - test::flank_half_angle(gear1, radius.back()));
  }
  double least = std::numeric_limits<double>::infinity();
  for (int position = 0; position < kPositions; ++position) {
    const double turn1 = pitch1 * (static_cast<double>(position) / kPositions - 0.5);
    // Gear 2 about where the middle tooth of gear 1 is in the middle of a space.
    const double middle2 = (ring ? 1.0 : -1.0) * turn1 * gear1.gear.teeth / gear2.gear.teeth;
    double low = -pitch2, high = pitch2;
    for (int tooth = -2; tooth <= 2; ++tooth) {
      for (const double side : {-1.0, 1.0}) {
        for (std::size_t i = 0; i < radius.size(); ++i) {
          const double angle = turn1 + tooth * pitch1 + side * half_tooth[i];
          const double x = radius[i] * std::cos(angle), y = radius[i] * std::sin(angle);
          // Towards gear 1 an external gear 2, whose axis is at x = d, looks along -x; a ring has
          // its pinion at x = d.
          const double from_axis_x = ring ? x + d : d - x;
          const double rho = std::hypot(from_axis_x, y);
          const bool within = ring ? rho >= gear2.tip_radius_m && rho <= gear2.root_radius_m
                                   : rho <= gear2.tip_radius_m;
          if (!within || rho < gear2.base_radius_m) continue;
          const double beta = std::atan2(ring ? y : -y, from_axis_x);
          const double half_space = test::flank_half_angle(gear2, rho);
          const double in_space = std::remainder(beta - middle2, pitch2);
          low = std::max(low, in_space - half_space);
          high = std::min(high, in_space + half_space);
        }
      }
    }
    least = std::min(least, high - low);
  }
  return least * gear2.base_radius_m;
}

GearGeometry<double> gear_of(int teeth, GearKind kind, double shift, double growth) {
  return train::grown_gear(
      geometry::make_gear_geometry<double>({.teeth = teeth,
                                            .kind = kind,
                                            .module_m = 1e-3,
                                            .profile_shift = shift,
                                            .machining_allowance = 0.1,
                                            .tip_shortening = 0.0,
                                            .rack = {}},
                                           geometry::make_pressure_angle(20.0 * kPi / 180.0)),
      growth);
}

TEST(UnequalMesh, LeavesTheLeastPlayOfTwoGearsThatAreTurnedAgainstEachOther) {
  const std::vector<Pair> alike{{gear_of(20, GearKind::kExternal, 0.3, 1.0),
                                 gear_of(41, GearKind::kExternal, 0.2, 1.0), 31.05e-3},
                                {gear_of(24, GearKind::kExternal, 0.4, 1.0),
                                 gear_of(75, GearKind::kRing, 0.6, 1.0), 25.7e-3}};
  for (const Pair& p : alike) {
    const bool ring = p.gear2.gear.kind == GearKind::kRing;
    for (const double growth : {0.994, 1.0, 1.006}) {
      Pair grown = p;
      (ring ? grown.gear1 : grown.gear2) = train::grown_gear(ring ? p.gear1 : p.gear2, growth);
      const auto mesh = make_unequal_mesh(grown.gear1, grown.gear2, grown.center_distance_m);
      ASSERT_TRUE(mesh.has_working_angle);
      const double rolled_m = rolled_play_m(grown);
      constexpr double kSampling_m = 2e-8;
      const double difference_m = std::abs(mesh.base_pitch_difference_m);
      // A tip corner still comes nearer when it has just left the line of action: second order.
      const double share = difference_m / mesh.mesh.base_pitch_m;
      const double corner_m = share * share * p.gear1.reference_radius_m;
      EXPECT_GE(rolled_m, mesh.least_backlash_m - corner_m - kSampling_m) << ring << ' ' << growth;
      EXPECT_LE(rolled_m, mesh.least_backlash_m + difference_m + kSampling_m)
          << ring << ' ' << growth;
      EXPECT_GT(difference_m, growth == 1.0 ? -1.0 : 5e-6);
    }
  }
}

TEST(UnequalMesh, BeyondTheBaseCirclesGoesOnWithoutAJumpAndHasNoPlay) {
  const Pair p{gear_of(20, GearKind::kExternal, 0.3, 1.0),
               gear_of(41, GearKind::kExternal, 0.2, 1.0), 0.0};
  const double base_sum_m = geometry::base_radius_sum(p.gear1, p.gear2);
  const auto at = [&](double more_m) {
    return make_unequal_mesh(p.gear1, p.gear2, base_sum_m + more_m);
  };
  constexpr double kStep_m = 1e-9;
  EXPECT_TRUE(at(kStep_m).has_working_angle);
  EXPECT_FALSE(at(-kStep_m).has_working_angle);
  EXPECT_NEAR(at(kStep_m).normal_backlash_m, at(-kStep_m).normal_backlash_m, 1e-12);
  for (const double less_m : {1e-9, 1e-6, 1e-4}) {
    EXPECT_LE(at(-less_m).least_backlash_m, -less_m);
    EXPECT_TRUE(std::isfinite(at(-less_m).least_backlash_m));
  }
}

TEST(UnequalMesh, CountsContactOverTheLargerBasePitch) {
  for_random_pairs(0.01, [&](const Pair& p, const UnequalMesh<double>& mesh) {
    const auto path = [&](const Pair& pair) {
      const auto m = geometry::make_mesh_geometry(pair.gear1, pair.gear2, pair.center_distance_m);
      return m->contact_ratio * m->base_pitch_m;
    };
    const double module_m = std::max(p.gear1.gear.module_m, p.gear2.gear.module_m);
    EXPECT_NEAR(mesh.mesh.contact_ratio, path(p) / (kPi * module_m * p.gear1.angle.cos), 1e-12);
  });
}

}  // namespace
}  // namespace gear3k::backlash::unequal_mesh_test
