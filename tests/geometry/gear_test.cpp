#include "geometry/gear.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/largest_deviation.hpp"

namespace gear3k::geometry::gear_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr double kAlpha20_rad = 20.0 * kPi / 180.0;
constexpr int kCases = 5000;

struct RandomGear {
  Gear<double> gear;
  double alpha_rad = 0.0;
};

class RandomGears {
 public:
  RandomGear operator()(GearKind kind) {
    RandomGear r;
    r.alpha_rad = between(14.5, 28.0) * kPi / 180.0;
    r.gear = {.teeth = std::uniform_int_distribution<int>(kind == GearKind::kRing ? 40 : 8,
                                                          140)(generator_),
              .kind = kind,
              .module_m = between(0.3e-3, 5e-3),
              .profile_shift = between(-0.3, 1.0),
              .machining_allowance = between(0.0, 0.1),
              .tip_shortening = between(0.0, 0.2),
              .rack = {}};
    return r;
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

 private:
  std::mt19937_64 generator_{2};
};

GearGeometry<double> geometry_of(const RandomGear& r) {
  return make_gear_geometry(r.gear, make_pressure_angle(r.alpha_rad));
}

Gear<double> plain_gear(int teeth, GearKind kind = GearKind::kExternal) {
  return {.teeth = teeth,
          .kind = kind,
          .module_m = 1e-3,
          .profile_shift = 0.0,
          .machining_allowance = 0.0,
          .tip_shortening = 0.0,
          .rack = {}};
}

/// Width of the space of a rack whose flanks are moved by `inset` along their normals into the
/// space, on the line at `depth` towards the gear: what rolls on the gear's reference circle.
double rack_space_width(double module_m, double alpha_rad, double inset_m, double depth_m) {
  // The right flank of a space: through (pi m/4, 0), widening towards the gear (y < 0).
  const double x0 = kPi * module_m / 4.0 - inset_m * std::cos(alpha_rad);
  const double y0 = -inset_m * std::sin(alpha_rad);
  const double t = (depth_m + y0) / std::cos(alpha_rad);
  return 2.0 * (x0 + t * std::sin(alpha_rad));
}

/// Polar angle at which an involute that starts at angle 0 on its base circle crosses radius r,
/// from the end of the string unwound in Cartesian coordinates.
double involute_polar_angle(double base_radius_m, double radius_m) {
  const double roll =
      std::sqrt((radius_m - base_radius_m) * (radius_m + base_radius_m)) / base_radius_m;
  return std::atan2(std::sin(roll) - roll * std::cos(roll), std::cos(roll) + roll * std::sin(roll));
}

TEST(PressureAngle, RefusesValuesOutsideTheFirstQuadrant) {
  for (const double alpha : {0.0, -0.1, kPi / 2.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(make_pressure_angle(alpha), std::invalid_argument) << alpha;
  }
}

TEST(GearGeometry, RefusesTeethBelowOneAndModulesNotAboveZero) {
  const auto angle = make_pressure_angle(kAlpha20_rad);
  EXPECT_THROW(make_gear_geometry(plain_gear(0), angle), std::invalid_argument);
  EXPECT_THROW(make_gear_geometry(plain_gear(-60, GearKind::kRing), angle), std::invalid_argument);
  for (const double module : {0.0, -1e-3, std::numeric_limits<double>::quiet_NaN()}) {
    Gear<double> gear = plain_gear(20);
    gear.module_m = module;
    EXPECT_THROW(make_gear_geometry(gear, angle), std::invalid_argument) << module;
  }
}

TEST(GearGeometry, RefusalNamesTheValue) {
  try {
    make_gear_geometry(plain_gear(-7), make_pressure_angle(kAlpha20_rad));
    FAIL() << "accepted -7 teeth";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("-7"), std::string::npos) << error.what();
  }
}

TEST(GearGeometry, BaseCircumferenceIsTeethTimesBasePitch) {
  RandomGears random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const RandomGear r = random(i % 2 == 0 ? GearKind::kExternal : GearKind::kRing);
    const auto g = geometry_of(r);
    const double rack_pitch = kPi * r.gear.module_m;
    const double normal_pitch = rack_pitch * std::cos(r.alpha_rad);
    largest.see(i, 2.0 * kPi * g.base_radius_m - r.gear.teeth * normal_pitch,
                8.0 * kEps * 2.0 * kPi * g.base_radius_m);
  }
  largest.expect_allowed("largest");
}

TEST(GearGeometry, ShiftMovesTipAndRootCirclesOutwardsOnGearsAndRings) {
  const auto angle = make_pressure_angle(kAlpha20_rad);
  for (const GearKind kind : {GearKind::kExternal, GearKind::kRing}) {
    Gear<double> gear = plain_gear(60, kind);
    const auto zero = make_gear_geometry(gear, angle);
    gear.profile_shift = 0.5;
    const auto shifted = make_gear_geometry(gear, angle);
    const double rounding = 8.0 * kEps * zero.tip_radius_m;
    EXPECT_NEAR(shifted.tip_radius_m - zero.tip_radius_m, 0.5e-3, rounding);
    EXPECT_NEAR(shifted.root_radius_m - zero.root_radius_m, 0.5e-3, rounding);
  }
}

TEST(GearGeometry, TipShorteningShortensTheToothOfGearsAndRings) {
  const auto angle = make_pressure_angle(kAlpha20_rad);
  for (const GearKind kind : {GearKind::kExternal, GearKind::kRing}) {
    Gear<double> gear = plain_gear(60, kind);
    const auto full = make_gear_geometry(gear, angle);
    gear.tip_shortening = 0.2;
    const auto cut = make_gear_geometry(gear, angle);
    const double height = std::abs(full.tip_radius_m - full.root_radius_m);
    EXPECT_NEAR(std::abs(cut.tip_radius_m - cut.root_radius_m), height - 0.2e-3,
                8.0 * kEps * full.tip_radius_m);
    EXPECT_EQ(cut.root_radius_m, full.root_radius_m);
  }
}

TEST(ToothThickness, OnTheReferenceCircleIsTheRackSpaceThatRollsOnIt) {
  RandomGears random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const bool ring = i % 2 == 1;
    const RandomGear r = random(ring ? GearKind::kRing : GearKind::kExternal);
    const double m = r.gear.module_m;
    const double depth = r.gear.profile_shift * m;
    const double inset = 0.5 * m * r.gear.machining_allowance;
    // A ring's space is shaped like the tooth of an external gear; thinning its tooth widens it.
    const double expected = ring ? kPi * m - rack_space_width(m, r.alpha_rad, -inset, depth)
                                 : rack_space_width(m, r.alpha_rad, inset, depth);
    largest.see(i, reference_tooth_thickness(geometry_of(r)) - expected, 8.0 * kEps * kPi * m);
  }
  largest.expect_allowed("largest");
}

TEST(ToothThickness, FollowsTheUnwoundStringToAnyCircle) {
  RandomGears random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const bool ring = i % 2 == 1;
    const auto g = geometry_of(random(ring ? GearKind::kRing : GearKind::kExternal));
    const double r = g.reference_radius_m;
    const double ry = random.between(1.0005 * g.base_radius_m, 1.2 * r);
    const double half_angle = reference_tooth_thickness(g) / (2.0 * r);
    const double flank =
        involute_polar_angle(g.base_radius_m, ry) - involute_polar_angle(g.base_radius_m, r);
    const double expected = 2.0 * ry * (ring ? half_angle + flank : half_angle - flank);
    largest.see(i, tooth_thickness(g, ry) - expected, 8.0 * kEps * ry);
  }
  largest.expect_allowed("largest");
}

TEST(ToothThickness, OnTheReferenceCircleEqualsTheReferenceThickness) {
  RandomGears random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto g = geometry_of(random(i % 2 == 1 ? GearKind::kRing : GearKind::kExternal));
    largest.see(i, tooth_thickness(g, g.reference_radius_m) - reference_tooth_thickness(g),
                8.0 * kEps * g.reference_radius_m);
  }
  largest.expect_allowed("largest");
}

TEST(ToothThickness, InsideTheBaseCircleKeepsTheAngleOfTheBaseCircle) {
  const auto g = make_gear_geometry(plain_gear(12), make_pressure_angle(kAlpha20_rad));
  const double rb = g.base_radius_m;
  EXPECT_NEAR(tooth_thickness(g, 0.9 * rb) / 0.9, tooth_thickness(g, rb), 8.0 * kEps * rb);
}

TEST(ToothThickness, IsNegativeBeyondThePointWhereFlanksCross) {
  // A tooth of 10 teeth and shift 1 is pointed well below 1.4 r.
  Gear<double> gear = plain_gear(10);
  gear.profile_shift = 1.0;
  const auto g = make_gear_geometry(gear, make_pressure_angle(kAlpha20_rad));
  EXPECT_LT(tooth_thickness(g, 1.4 * g.reference_radius_m), 0.0);
}

TEST(ToothThickness, MachiningAllowanceThinsEveryCircleByTheSameNormalAmount) {
  // The flanks are parallel curves: m q measured along the line of action on any circle.
  RandomGears random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    RandomGear r = random(i % 2 == 1 ? GearKind::kRing : GearKind::kExternal);
    const auto thinned = geometry_of(r);
    r.gear.machining_allowance = 0.0;
    const auto full = geometry_of(r);
    const double ry = random.between(1.001, 1.15) * full.base_radius_m;
    const double arc_m = tooth_thickness(full, ry) - tooth_thickness(thinned, ry);
    const double normal_m = arc_m * full.base_radius_m / ry;
    largest.see(i, normal_m - r.gear.module_m * thinned.gear.machining_allowance, 8.0 * kEps * ry);
  }
  largest.expect_allowed("largest");
}

TEST(TipCurvatureRadius, IsTheLengthOfTheStringToTheTip) {
  RandomGears random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto g = geometry_of(random(GearKind::kExternal));
    if (!(g.tip_radius_m > 1.001 * g.base_radius_m)) continue;
    // Tangent of length rho at right angles to the base radius reaches the tip circle.
    const double rho = tip_curvature_radius(g);
    largest.see(i, std::hypot(g.base_radius_m, rho) - g.tip_radius_m, 8.0 * kEps * g.tip_radius_m);
  }
  largest.expect_allowed("largest");
}

TEST(TipCurvatureRadius, IsZeroWhenTheTipLiesInsideTheBaseCircle) {
  const auto g =
      make_gear_geometry(plain_gear(20, GearKind::kRing), make_pressure_angle(kAlpha20_rad));
  ASSERT_LT(g.tip_radius_m, g.base_radius_m);
  EXPECT_EQ(tip_curvature_radius(g), 0.0);
}

}  // namespace
}  // namespace gear3k::geometry::gear_test
