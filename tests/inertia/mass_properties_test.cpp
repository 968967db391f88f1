#include "inertia/mass_properties.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/largest_deviation.hpp"

namespace gear3k::inertia::mass_properties_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr int kCases = 2000;

class Random {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  HollowCylinder<double> cylinder() {
    const double outer = between(5e-3, 80e-3);
    return {.outer_radius_m = outer,
            .inner_radius_m = between(0.0, 0.95) * outer,
            .width_m = between(3e-3, 20e-3),
            .density_kgm3 = between(1000.0, 8000.0)};
  }
  geometry::Gear<double> gear(bool ring) {
    return {.teeth = std::uniform_int_distribution<int>(ring ? 60 : 12, 120)(generator_),
            .kind = ring ? geometry::GearKind::kRing : geometry::GearKind::kExternal,
            .module_m = between(0.4e-3, 2e-3),
            .profile_shift = between(-0.2, 1.0),
            .machining_allowance = 0.0,
            .tip_shortening = between(0.0, 0.2),
            .rack = {}};
  }

 private:
  std::mt19937_64 generator_{11};
};

TEST(HollowCylinder, SumsUpThinTubes) {
  Random random;
  LargestDeviation mass, inertia;
  for (int i = 0; i < kCases; ++i) {
    const auto c = random.cylinder();
    // Simpson's rule is exact for the integrands 2 pi r and 2 pi r^3.
    const double ri = c.inner_radius_m;
    const double ro = c.outer_radius_m;
    const double middle = 0.5 * (ri + ro);
    const auto integral = [&](auto power) {
      return (ro - ri) / 6.0 * (power(ri) + 4.0 * power(middle) + power(ro));
    };
    const double per_area = c.density_kgm3 * c.width_m * 2.0 * kPi;
    const double m = per_area * integral([](double r) { return r; });
    const double j = per_area * integral([](double r) { return r * r * r; });
    const auto result = hollow_cylinder(c);
    // Differences of squares of the radii, of the size of the full cylinder.
    const double full = per_area * 0.5 * ro * ro;
    mass.see(i, result.mass_kg - m, 8.0 * kEps * full);
    inertia.see(i, result.inertia_kgm2 - j, 8.0 * kEps * full * ro * ro);
  }
  mass.expect_allowed("mass");
  inertia.expect_allowed("inertia");
}

TEST(HollowCylinder, OfNoWidthOrNoWallHasNoMass) {
  const auto flat = hollow_cylinder<double>(
      {.outer_radius_m = 1e-2, .inner_radius_m = 0.0, .width_m = 0.0, .density_kgm3 = 7800.0});
  EXPECT_EQ(flat.mass_kg, 0.0);
  const auto thin = hollow_cylinder<double>(
      {.outer_radius_m = 1e-2, .inner_radius_m = 1e-2, .width_m = 1e-2, .density_kgm3 = 7800.0});
  EXPECT_EQ(thin.mass_kg, 0.0);
  EXPECT_EQ(thin.inertia_kgm2, 0.0);
}

TEST(HollowCylinder, RefusesNegativeSizesAndABoreBeyondTheOuterRadius) {
  const HollowCylinder<double> good{
      .outer_radius_m = 1e-2, .inner_radius_m = 5e-3, .width_m = 1e-2, .density_kgm3 = 7800.0};
  EXPECT_NO_THROW(hollow_cylinder(good));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1e-3, nan}) {
    auto c = good;
    c.outer_radius_m = bad;
    EXPECT_THROW(hollow_cylinder(c), std::invalid_argument);
    c = good;
    c.inner_radius_m = bad;
    EXPECT_THROW(hollow_cylinder(c), std::invalid_argument);
    c = good;
    c.width_m = bad;
    EXPECT_THROW(hollow_cylinder(c), std::invalid_argument);
    c = good;
    c.density_kgm3 = bad;
    EXPECT_THROW(hollow_cylinder(c), std::invalid_argument);
  }
  auto c = good;
  c.inner_radius_m = 1.1e-2;
  EXPECT_THROW(hollow_cylinder(c), std::invalid_argument);
}

TEST(GearBody, ReachesHalfWayFromTipToRootCircle) {
  Random random;
  for (int i = 0; i < kCases; ++i) {
    const bool ring = i % 2 == 1;
    const auto g = geometry::make_gear_geometry(random.gear(ring),
                                                geometry::make_pressure_angle(20.0 * kPi / 180.0));
    const double middle = 0.5 * (g.tip_radius_m + g.root_radius_m);
    const double other = ring ? 1.2 * g.root_radius_m : 0.3 * g.root_radius_m;
    const auto body = gear_body(g, other, 8e-3, 7800.0);
    const auto tube = hollow_cylinder<double>({.outer_radius_m = ring ? other : middle,
                                               .inner_radius_m = ring ? middle : other,
                                               .width_m = 8e-3,
                                               .density_kgm3 = 7800.0});
    EXPECT_EQ(body.mass_kg, tube.mass_kg);
    EXPECT_EQ(body.inertia_kgm2, tube.inertia_kgm2);
  }
}

TEST(GearBody, InertiaGrowsWithTheFifthPowerOfSizeAndMassWithTheThird) {
  Random random;
  LargestDeviation mass, inertia;
  for (int i = 0; i < kCases; ++i) {
    const bool ring = i % 2 == 1;
    auto gear = random.gear(ring);
    const auto angle = geometry::make_pressure_angle(20.0 * kPi / 180.0);
    const double scale = random.between(0.2, 5.0);
    const auto small = geometry::make_gear_geometry(gear, angle);
    gear.module_m *= scale;
    const auto large = geometry::make_gear_geometry(gear, angle);
    const double other = ring ? 1.3 * small.root_radius_m : 0.3 * small.root_radius_m;
    const auto a = gear_body(small, other, 8e-3, 7800.0);
    const auto b = gear_body(large, other * scale, 8e-3 * scale, 7800.0);
    const double rounding = 64.0 * kEps;
    mass.see(i, b.mass_kg / a.mass_kg / std::pow(scale, 3) - 1.0, rounding);
    inertia.see(i, b.inertia_kgm2 / a.inertia_kgm2 / std::pow(scale, 5) - 1.0, rounding);
  }
  mass.expect_allowed("mass");
  inertia.expect_allowed("inertia");
}

TEST(ParallelAxis, InertiaIsThatOfPointMassesOnTheShiftedBody) {
  // A ring of n >= 3 equal points has the inertia of a thin tube about every axis along it.
  Random random;
  LargestDeviation inertia;
  for (int i = 0; i < kCases; ++i) {
    const int points = 3 + i % 20;
    const double radius = random.between(1e-3, 20e-3);
    const double mass = random.between(1e-3, 1.0);
    const double distance = random.between(0.0, 60e-3);
    const double start = random.between(0.0, 2.0 * kPi);
    double sum = 0.0;
    for (int k = 0; k < points; ++k) {
      const double angle = start + 2.0 * kPi * k / points;
      const double x = distance + radius * std::cos(angle);
      const double y = radius * std::sin(angle);
      sum += mass / points * (x * x + y * y);
    }
    const MassProperties<double> tube{.mass_kg = mass, .inertia_kgm2 = mass * radius * radius};
    inertia.see(i, inertia_about_parallel_axis(tube, distance) - sum, 16.0 * kEps * sum);
  }
  inertia.expect_allowed("inertia");
}

const toml::table& published_stages() {
  static const toml::table kFile =
      toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/gear_masses.toml");
  return kFile;
}

double given(const toml::table& table, const char* key) {
  return table[key].value<double>().value();
}

/// A published gear as a body.
MassProperties<double> published_body(const toml::table& stage, const toml::table& c) {
  const bool ring = c["ring"].value<bool>().value();
  const auto angle = geometry::make_pressure_angle(given(stage, "alpha") * kPi / 180.0);
  geometry::Gear<double> gear{
      .teeth = c["teeth"].value<int>().value(),
      .kind = ring ? geometry::GearKind::kRing : geometry::GearKind::kExternal,
      .module_m = given(stage, "module") * 1e-3,
      .profile_shift = given(c, "shift"),
      .machining_allowance = 0.0,
      .tip_shortening = 0.0,
      .rack = {}};
  const double full = geometry::make_gear_geometry(gear, angle).tip_radius_m;
  gear.tip_shortening = std::abs(full - 0.5e-3 * given(c, "tip_diameter")) / gear.module_m;
  return gear_body(geometry::make_gear_geometry(gear, angle), 0.5e-3 * given(c, "other_diameter"),
                   given(stage, "width") * 1e-3, given(published_stages(), "density"));
}

TEST(GearBody, PublishedMassesAreReproducedToTheDigitsOfTheDensity) {
  const toml::table& file = published_stages();
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const double half_unit = 0.5 * given(file, "density_unit") / given(file, "density");
  int gears = 0;
  for (const toml::node& stage_node : *file["stage"].as_array()) {
    const toml::table& stage = *stage_node.as_table();
    for (const toml::node& node : *stage["gear"].as_array()) {
      const toml::table& c = *node.as_table();
      SCOPED_TRACE(fmt::format("{} {}", stage["id"].value_or(""), c["id"].value_or("")));
      const auto body = published_body(stage, c);
      EXPECT_NEAR(body.mass_kg / given(c, "mass_kg"), 1.0, half_unit);
      EXPECT_NEAR(body.inertia_kgm2 / given(c, "inertia_kgm2"), 1.0, half_unit);
      ++gears;
    }
  }
  EXPECT_EQ(gears, 6);
}

TEST(GearBody, PublishedTotalMassCountsEveryPlanetAndTheRing) {
  const toml::table& file = published_stages();
  const double half_digit = 0.5 * std::pow(10.0, -given(file, "decimals"));
  const double half_unit = 0.5 * given(file, "density_unit") / given(file, "density");
  for (const toml::node& stage_node : *file["stage"].as_array()) {
    const toml::table& stage = *stage_node.as_table();
    SCOPED_TRACE(stage["id"].value_or(""));
    double printed = 0.0, computed = 0.0, parts = 0.0;
    for (const toml::node& node : *stage["gear"].as_array()) {
      const toml::table& c = *node.as_table();
      const double count =
          c["id"].value_or("") == std::string("planet") ? given(stage, "planets") : 1;
      printed += count * given(c, "mass_kg");
      computed += count * published_body(stage, c).mass_kg;
      parts += count;
    }
    const double total = given(stage, "total_mass_kg");
    EXPECT_NEAR(printed, total, half_digit * (parts + 1.0));
    EXPECT_NEAR(computed / total, 1.0, half_unit);
  }
}

}  // namespace
}  // namespace gear3k::inertia::mass_properties_test
