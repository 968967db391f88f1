#include "backlash/normal_backlash.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/largest_deviation.hpp"

namespace gear3k::backlash::normal_backlash_test {
namespace {

using geometry::GearKind;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr int kCases = 10000;

/// One pair as numbers, for the test's own derivation.
struct PairNumbers {
  bool ring = false;
  double m = 0.0, alpha = 0.0, z1 = 0.0, z2 = 0.0, x1 = 0.0, x2 = 0.0, q1 = 0.0, q2 = 0.0, d = 0.0;
};

double library_backlash(const PairNumbers& n) {
  const auto angle = geometry::make_pressure_angle(n.alpha);
  const auto gear = [&](double z, GearKind kind, double x, double q) {
    return geometry::make_gear_geometry<double>({.teeth = static_cast<int>(z),
                                                 .kind = kind,
                                                 .module_m = n.m,
                                                 .profile_shift = x,
                                                 .machining_allowance = q,
                                                 .tip_shortening = 0.0,
                                                 .rack = {}},
                                                angle);
  };
  const auto gear1 = gear(n.z1, GearKind::kExternal, n.x1, n.q1);
  const auto gear2 = gear(n.z2, n.ring ? GearKind::kRing : GearKind::kExternal, n.x2, n.q2);
  return normal_backlash(gear1, gear2, geometry::make_mesh_geometry(gear1, gear2, n.d).value());
}

/// Half the angle that a tooth (or the space of a ring) of a gear cut by a rack fills on its base
/// circle: half the rack's space where it rolls on the reference circle, and the polar angle of
/// the involute there.  `widened` is added to the width normal to both flanks together.
double half_angle_on_base(double m, double alpha, double z, double x, double widened) {
  const double width = kPi * m / 2.0 + 2.0 * x * m * std::tan(alpha) + widened / std::cos(alpha);
  const double roll = std::tan(alpha);  // string length over base radius at the reference circle
  const double polar =
      std::atan2(std::sin(roll) - roll * std::cos(roll), std::cos(roll) + roll * std::sin(roll));
  return width / (m * z) + polar;
}

/// Circular pitch less both tooth thicknesses on the working pitch circles.
double circumferential_gap(const PairNumbers& n) {
  const double rb1 = n.m * n.z1 / 2.0 * std::cos(n.alpha);
  const double rw1 = n.d * n.z1 / (n.ring ? n.z2 - n.z1 : n.z2 + n.z1);
  const double rw2 = rw1 * n.z2 / n.z1;
  const double roll = std::sqrt((rw1 - rb1) * (rw1 + rb1)) / rb1;
  const double polar =
      std::atan2(std::sin(roll) - roll * std::cos(roll), std::cos(roll) + roll * std::sin(roll));
  const double tooth1 =
      2.0 * rw1 * (half_angle_on_base(n.m, n.alpha, n.z1, n.x1, -n.m * n.q1) - polar);
  const double pitch = 2.0 * kPi * rw1 / n.z1;
  if (n.ring) {
    // The ring's space is shaped as the tooth of an external gear, widened by its allowance.
    const double space2 =
        2.0 * rw2 * (half_angle_on_base(n.m, n.alpha, n.z2, n.x2, n.m * n.q2) - polar);
    return space2 - tooth1;
  }
  const double tooth2 =
      2.0 * rw2 * (half_angle_on_base(n.m, n.alpha, n.z2, n.x2, -n.m * n.q2) - polar);
  return pitch - tooth1 - tooth2;
}

double cos_working_angle(const PairNumbers& n) {
  // Base radius over working pitch radius of either gear.
  const double rw1 = n.d * n.z1 / (n.ring ? n.z2 - n.z1 : n.z2 + n.z1);
  return n.m * n.z1 / 2.0 * std::cos(n.alpha) / rw1;
}

class RandomPairs {
 public:
  PairNumbers operator()(bool ring) {
    PairNumbers n{.ring = ring,
                  .m = between(0.3e-3, 5e-3),
                  .alpha = between(14.5, 28.0) * kPi / 180.0,
                  .z1 = static_cast<double>(count(10, 60)),
                  .z2 = 0.0,
                  .x1 = between(-0.5, 1.0),
                  .x2 = between(-0.5, 2.0),
                  .q1 = between(0.0, 0.1),
                  .q2 = between(0.0, 0.1)};
    n.z2 = ring ? n.z1 + count(8, 80) : count(10, 120);
    const double base = n.m / 2.0 * (ring ? n.z2 - n.z1 : n.z2 + n.z1) * std::cos(n.alpha);
    n.d = base * between(1.0005, 1.25);
    return n;
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937_64 generator_{7};
};

class BacklashOfBothKinds : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Kinds, BacklashOfBothKinds, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& ring) {
                           return ring.param ? "Internal" : "External";
                         });

TEST_P(BacklashOfBothKinds, IsTheGapOnTheWorkingPitchCirclesAlongTheLineOfAction) {
  RandomPairs random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const PairNumbers n = random(GetParam());
    const double size =
        n.m * (n.z1 + n.z2);  // arcs are differences of angles times radii of this order
    largest.see(i, library_backlash(n) - circumferential_gap(n) * cos_working_angle(n),
                16.0 * kEps * size);
  }
  largest.expect_allowed("gap");
}

TEST_P(BacklashOfBothKinds, IsZeroAtTheZeroBacklashDistanceOfFullTeeth) {
  RandomPairs random;
  LargestDeviation largest;
  int seen = 0;
  for (int i = 0; i < kCases; ++i) {
    PairNumbers n = random(GetParam());
    n.q1 = n.q2 = 0.0;
    // Distance at which the test's own gap vanishes: the gap of an external mesh grows with the
    // distance, that of an internal one shrinks.
    const double base = n.d * cos_working_angle(n);
    double low = base * (1.0 + 1e-12), high = base * 1.5;
    const auto gap_at = [&](double d) {
      n.d = d;
      return GetParam() ? -circumferential_gap(n) : circumferential_gap(n);
    };
    if (!(gap_at(low) < 0.0 && gap_at(high) > 0.0)) continue;
    for (int k = 0; k < 100; ++k) {
      const double middle = 0.5 * (low + high);
      (gap_at(middle) < 0.0 ? low : high) = middle;
    }
    n.d = 0.5 * (low + high);
    largest.see(i, library_backlash(n), 16.0 * kEps * n.m * (n.z1 + n.z2));
    ++seen;
  }
  EXPECT_GT(seen, kCases / 2);
  largest.expect_allowed("backlash");
}

TEST_P(BacklashOfBothKinds, GrowsByTheModuleTimesTheAllowancesOfBothGears) {
  RandomPairs random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    PairNumbers n = random(GetParam());
    const double thinned = library_backlash(n);
    const double thinning = n.m * (n.q1 + n.q2);
    n.q1 = n.q2 = 0.0;
    largest.see(i, thinned - library_backlash(n) - thinning, 2.0 * kEps * n.m * (n.z1 + n.z2));
  }
  largest.expect_allowed("thinning");
}

TEST_P(BacklashOfBothKinds, IsProportionalToSize) {
  RandomPairs random;
  for (int i = 0; i < 500; ++i) {
    PairNumbers n = random(GetParam());
    const double small = library_backlash(n);
    const double rounding = 2.0 * kEps * n.m * (n.z1 + n.z2);
    n.m *= 2.0;
    n.d *= 2.0;
    EXPECT_NEAR(library_backlash(n), 2.0 * small, 2.0 * rounding);
  }
}

TEST(NormalBacklash, LargerDistanceOpensExternalAndClosesInternalMeshes) {
  RandomPairs random;
  for (int i = 0; i < 1000; ++i) {
    for (const bool ring : {false, true}) {
      PairNumbers n = random(ring);
      const double before = library_backlash(n);
      n.d += 0.02 * n.m;
      const double change = library_backlash(n) - before;
      EXPECT_TRUE(ring ? change < 0.0 : change > 0.0) << i << ": " << change;
    }
  }
}

TEST(NormalBacklash, OfAPublishedStageIsReproducedToItsPrintedDigits) {
  const toml::table file = toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/normal_backlash.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const double half_unit = 0.5 * std::pow(10.0, -file["decimals"].value<int>().value());
  int cases = 0;
  for (const toml::node& node : *file["case"].as_array()) {
    const toml::table& c = *node.as_table();
    const auto number = [&](const char* key) { return c[key].value<double>().value(); };
    const auto thinning = [&](std::size_t i) {
      return (*c["thinning"].as_array())[i].value<double>().value();
    };
    const double m = file["module"].value<double>().value();
    const double alpha = file["alpha"].value<double>().value() * kPi / 180.0;
    // The allowance is an arc on the reference circle; q is measured normal to the flank.
    const PairNumbers n{.ring = std::string(c["kind"].value_or("")) == "internal",
                        .m = m * 1e-3,
                        .alpha = alpha,
                        .z1 = number("z1"),
                        .z2 = number("z2"),
                        .x1 = number("x1"),
                        .x2 = number("x2"),
                        .q1 = thinning(0) * std::cos(alpha) / m,
                        .q2 = thinning(1) * std::cos(alpha) / m,
                        .d = number("distance") * 1e-3};
    // The report measures on the working pitch circles of the nominal distance.
    PairNumbers nominal = n;
    nominal.d = file["nominal_distance"].value<double>().value() * 1e-3;
    const double circumferential_mm = library_backlash(n) / cos_working_angle(nominal) * 1e3;
    EXPECT_NEAR(circumferential_mm, number("circumferential_backlash"), half_unit)
        << c["id"].value_or("");
    ++cases;
  }
  EXPECT_EQ(cases, 4);
}

}  // namespace
}  // namespace gear3k::backlash::normal_backlash_test
