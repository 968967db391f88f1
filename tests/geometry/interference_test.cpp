#include "geometry/interference.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/largest_deviation.hpp"

namespace gear3k::geometry::interference_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr double kAlpha20_rad = 20.0 * kPi / 180.0;
constexpr int kCases = 5000;

class Random {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937_64 generator_{4};
};

GearGeometry<double> gear_with(int teeth, GearKind kind, double shift,
                               double alpha_rad = kAlpha20_rad, double module_m = 1e-3) {
  return make_gear_geometry<double>({.teeth = teeth,
                                     .kind = kind,
                                     .module_m = module_m,
                                     .profile_shift = shift,
                                     .machining_allowance = 0.0,
                                     .tip_shortening = 0.0,
                                     .rack = {}},
                                    make_pressure_angle(alpha_rad));
}

/// Depth below its reference line at which a rack's straight flank passes into the root rounding:
/// where the perpendicular from the rounding's centre meets the flank.  In modules.
double straight_flank_depth(const BasicRack<double>& rack, double alpha_rad) {
  const double center_depth = rack.dedendum - rack.root_radius;  // the circle touches the root line
  // The flank's outward normal, in the space's corner, points up by alpha.
  const double touch_depth = center_depth + rack.root_radius * std::sin(alpha_rad);
  return touch_depth;
}

TEST(Undercut, MarginIsTheSignedFlankCurvatureWhereTheRackFlankEnds) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const double alpha = random.between(14.5, 28.0) * kPi / 180.0;
    const double m = random.between(0.3e-3, 5e-3);
    const int z = random.count(6, 80);
    const double x = random.between(-0.6, 1.0);
    // A rounding that fits on the rack's tip at every angle drawn.
    auto gear = gear_with(z, GearKind::kExternal, x, alpha, m).gear;
    gear.rack.root_radius = random.between(0.0, 0.2);
    const auto g = make_gear_geometry(gear, make_pressure_angle(alpha));
    // Generating with the rack's line of action from the pitch point at the top of the reference
    // circle: the flank's end, at this depth below the rolling line, touches at ...
    const double depth = m * (straight_flank_depth(g.gear.rack, alpha) - x);
    const double along = depth / std::sin(alpha);
    // ... and the tangent point of the base circle lies at the foot of the centre's perpendicular.
    const double pitch_to_tangent = m * z / 2.0 * std::sin(alpha);
    const double curvature = pitch_to_tangent - along;
    largest.see(i, undercut_margin(g) * m - curvature * std::sin(alpha), 2.0 * kEps * m * z);
  }
  largest.expect_allowed("largest");
}

TEST(Undercut, StandardRackBeginsToUndercutBetween18And17Teeth) {
  // ISO 21771 / KHK: 17 teeth at 20 degrees (17.097 exactly).
  EXPECT_LT(undercut_margin(gear_with(17, GearKind::kExternal, 0.0)), 0.0);
  EXPECT_GT(undercut_margin(gear_with(17, GearKind::kExternal, 0.01)), 0.0);
  EXPECT_GT(undercut_margin(gear_with(18, GearKind::kExternal, 0.0)), 0.0);
}

TEST(Undercut, OneModuleOfShiftIsOneModuleOfMargin) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const int z = random.count(6, 60);
    const double x = random.between(-1.0, 1.0);
    EXPECT_NEAR(undercut_margin(gear_with(z, GearKind::kExternal, x)) -
                    undercut_margin(gear_with(z, GearKind::kExternal, 0.0)),
                x, 64.0 * kEps * z);
  }
}

TEST(RingTip, OfFewTeethLiesInsideItsBaseCircle) {
  // z/2 - 1 > z/2 cos 20 deg needs z > 2/(1 - cos 20 deg) = 33.2.
  EXPECT_LT(ring_tip_above_base(gear_with(33, GearKind::kRing, 0.0)), 0.0);
  EXPECT_GT(ring_tip_above_base(gear_with(34, GearKind::kRing, 0.0)), 0.0);
}

TEST(RingTip, MarginIsInModules) {
  const auto small = gear_with(60, GearKind::kRing, 0.3, kAlpha20_rad, 1e-3);
  const auto large = gear_with(60, GearKind::kRing, 0.3, kAlpha20_rad, 4e-3);
  EXPECT_NEAR(ring_tip_above_base(small), ring_tip_above_base(large), 64.0 * kEps * 60.0);
}

TEST(InvoluteInterference, OfARingHasTheSignOfTheTangentCriterion) {
  Random random;
  int free = 0, fouled = 0;
  for (int i = 0; i < kCases; ++i) {
    const double alpha = random.between(17.0, 26.0) * kPi / 180.0;
    const int z1 = random.count(12, 60);
    const int z2 = z1 + random.count(8, 60);
    const auto planet = gear_with(z1, GearKind::kExternal, random.between(-0.2, 1.0), alpha);
    const auto ring = gear_with(z2, GearKind::kRing, random.between(-0.2, 1.5), alpha);
    if (!(ring.tip_radius_m > ring.base_radius_m)) continue;
    const double d = (ring.base_radius_m - planet.base_radius_m) * random.between(1.01, 1.2);
    const auto mesh = make_mesh_geometry(planet, ring, d);
    ASSERT_TRUE(mesh);
    const double tan_tip = std::tan(std::acos(ring.base_radius_m / ring.tip_radius_m));
    const double tan_w = std::tan(std::acos((ring.base_radius_m - planet.base_radius_m) / d));
    const double criterion = static_cast<double>(z1) / z2 - 1.0 + tan_tip / tan_w;
    if (std::abs(criterion) < 1e-9) continue;
    const double margin = involute_interference_margin(planet, ring, *mesh, 2);
    EXPECT_EQ(margin > 0.0, criterion > 0.0) << z1 << "/" << z2 << ": " << criterion;
    (margin > 0.0 ? free : fouled) += 1;
  }
  EXPECT_GT(free, 500);
  EXPECT_GT(fouled, 500);
}

TEST(InvoluteInterference, MarginIsTheDistanceFromTheTipsContactPointToTheMatesTangentPoint) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const bool internal = i % 2 == 1;
    const double alpha = random.between(17.0, 26.0) * kPi / 180.0;
    const double m = random.between(0.3e-3, 5e-3);
    const int z1 = random.count(12, 60);
    const int z2 = internal ? z1 + random.count(8, 60) : random.count(12, 90);
    const auto first = gear_with(z1, GearKind::kExternal, random.between(-0.2, 1.0), alpha, m);
    const auto second = gear_with(z2, internal ? GearKind::kRing : GearKind::kExternal,
                                  random.between(0.0, 1.5), alpha, m);
    if (!(second.tip_radius_m > 1.002 * second.base_radius_m)) continue;
    const double base_sum = internal ? second.base_radius_m - first.base_radius_m
                                     : second.base_radius_m + first.base_radius_m;
    const double d = base_sum * random.between(1.01, 1.2);
    const auto mesh = make_mesh_geometry(first, second, d);
    ASSERT_TRUE(mesh);
    // Coordinates with the line of action as x axis and T2 (gear 2) at the origin: both centres
    // lie below it by their base radii, or gear 1's above it when the gears are external.
    const double t1 = std::sqrt(d * d - base_sum * base_sum);
    for (const int which : {1, 2}) {
      if (internal && which == 1) continue;
      const auto& tip_gear = which == 1 ? first : second;
      const double own = which == 1 ? t1 : 0.0;
      const double mate = which == 1 ? 0.0 : t1;
      // The tip's contact point, from its own tangent point towards the mate's.
      const double reach = std::sqrt(tip_gear.tip_radius_m * tip_gear.tip_radius_m -
                                     tip_gear.base_radius_m * tip_gear.base_radius_m);
      const double contact = own + (mate > own ? reach : -reach);
      // External: contact must stay on the near side of the mate's point.  Ring: both tangent
      // points lie on one side of the path, so it must stay beyond the mate's.
      const double toward = mate > own ? 1.0 : -1.0;
      const double room = internal ? contact - mate : toward * (mate - contact);
      largest.see(i, involute_interference_margin(first, second, *mesh, which) * m - room,
                  32.0 * kEps * second.tip_radius_m);
    }
  }
  largest.expect_allowed("largest");
}

TEST(InvoluteInterference, BeginsAtThePublishedTeethOfTheMatingPinion) {
  const toml::table file =
      toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/internal_interference_limits.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const double alpha = file["pressure_angle_deg"].value<double>().value() * kPi / 180.0;
  int rows = 0;
  for (const toml::node& node : *file["row"].as_array()) {
    const toml::table& row = *node.as_table();
    const int z2 = row["ring_teeth"].value<int>().value();
    const int z_min = row["pinion_min"].value<int>().value();
    const auto ring = gear_with(z2, GearKind::kRing, 0.0, alpha);
    for (int z1 = 12; z1 <= z2 - 12; ++z1) {
      const auto pinion = gear_with(z1, GearKind::kExternal, 0.0, alpha);
      const auto mesh = make_mesh_geometry(pinion, ring, 0.5e-3 * (z2 - z1));
      ASSERT_TRUE(mesh);
      EXPECT_EQ(involute_interference_margin(pinion, ring, *mesh, 2) >= 0.0, z1 >= z_min)
          << z1 << "/" << z2;
    }
    ++rows;
  }
  EXPECT_EQ(rows, 6);
}

TEST(InvoluteInterference, FullTeethOf20In60Interfere) {
  const auto planet = gear_with(20, GearKind::kExternal, 0.0);
  const auto ring = gear_with(60, GearKind::kRing, 0.0);
  const auto mesh = make_mesh_geometry(planet, ring, 20e-3);
  ASSERT_TRUE(mesh);
  EXPECT_LT(involute_interference_margin(planet, ring, *mesh, 2), 0.0);
}

TEST(InvoluteInterference, TextbookPairOf16In24MissesItsLimitSlightly) {
  // KHK Gear Technical Data, internal gear example (x2 = 0.5): z1/z2 = 0.66667 against 0.66809.
  const auto planet = gear_with(16, GearKind::kExternal, 0.0);
  const auto ring = gear_with(24, GearKind::kRing, 0.5);
  const auto mesh =
      make_mesh_geometry(planet, ring, zero_backlash_center_distance(planet, ring).value());
  ASSERT_TRUE(mesh);
  EXPECT_LT(involute_interference_margin(planet, ring, *mesh, 2), 0.0);
  // Re-implementations of the example use x2 = 0.516, which clears it.
  const auto wider = gear_with(24, GearKind::kRing, 0.516);
  const auto clear =
      make_mesh_geometry(planet, wider, zero_backlash_center_distance(planet, wider).value());
  ASSERT_TRUE(clear);
  EXPECT_GT(involute_interference_margin(planet, wider, *clear, 2), 0.0);
}

}  // namespace
}  // namespace gear3k::geometry::interference_test
