#include "geometry/involute.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "geometry/scalar.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::geometry::involute_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kInverseAccuracy_rad = 1e-14;  // stated by inverse_involute()
constexpr int kCases = 20000;

class RandomAngle {
 public:
  double operator()() { return std::uniform_real_distribution<double>(0.02, 1.3)(generator_); }

 private:
  std::mt19937_64 generator_{1};
};

/// inv a with the rounding of the result only.
double exact_involute(double a) {
  const long double wide = a;
  return static_cast<double>(std::tan(wide) - wide);
}

TEST(Involute, IsTangentMinusAngleWithinTwoRoundings) {
  RandomAngle angle;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const double a = angle();
    largest.see(i, involute(a) - exact_involute(a), 2.0 * kEps * std::tan(a));
  }
  largest.expect_allowed("largest");
}

TEST(Involute, IsOdd) {
  for (const double a : {0.1, 0.35, 1.2}) EXPECT_EQ(involute(-a), -involute(a));
}

TEST(Involute, OfTwentyDegreesIsTheTabulatedValue) {
  // KHK Gear Technical Data: inv 20 deg = 0.014904, inv 26.0888 deg = 0.034317 (half a unit each,
  // and for the second the half unit of the printed angle, whose derivative is tan^2).
  const double degree = std::numbers::pi / 180.0;
  EXPECT_NEAR(involute(20.0 * degree), 0.014904, 0.5e-6);
  EXPECT_NEAR(involute(26.0888 * degree), 0.034317,
              0.5e-6 + 0.5e-4 * degree * std::pow(std::tan(26.0888 * degree), 2));
}

TEST(InverseInvolute, RoundTripRestoresTheAngle) {
  RandomAngle angle;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const double a = angle();
    largest.see(i, inverse_involute(exact_involute(a)) - a, kInverseAccuracy_rad);
  }
  largest.expect_allowed("largest");
}

TEST(InverseInvolute, SolvesTheInvoluteEquationFarOutsideTheGearRange) {
  for (const double value : {1e-12, 1e-9, 1e-6, 10.0, 1e3}) {
    const long double a = inverse_involute(value);
    const long double residual = std::tan(a) - a - static_cast<long double>(value);
    // One rounding of a moves inv a by tan^2 a.
    const double slope = static_cast<double>(std::tan(a) * std::tan(a));
    EXPECT_NEAR(static_cast<double>(residual), 0.0,
                8.0 * kEps * (static_cast<double>(a) * slope + value) +
                    8.0 * kEps * static_cast<double>(std::tan(a)))
        << value;
  }
}

TEST(InverseInvolute, IsZeroAtZero) { EXPECT_EQ(inverse_involute(0.0), 0.0); }

TEST(InverseInvolute, FirstAndSecondDerivativeAreThoseOfTheImplicitFunction) {
  RandomAngle angle;
  LargestDeviation first, second;
  for (int i = 0; i < kCases / 10; ++i) {
    const double a = angle();
    const double value = exact_involute(a);
    const Jet2 result = inverse_involute(Jet2::variable(value, 3));
    const Jet1 result1 = inverse_involute(Jet1(value, 3));
    const double t = std::tan(a);
    const double slope = 1.0 / (t * t);
    const double curvature = -2.0 * (1.0 + t * t) / std::pow(t, 5);
    // An error of 1e-14 rad in a changes tan a by this share.
    const double share = kInverseAccuracy_rad * (1.0 + t * t) / t;
    first.see(i, result1.v[3] - slope, (2.0 * share + 8.0 * kEps) * slope);
    first.see(i, result.by_row[3] - slope, (2.0 * share + 8.0 * kEps) * slope);
    first.see(i, result.by_column[3] - slope, (2.0 * share + 8.0 * kEps) * slope);
    second.see(i, result.mixed[3][3] - curvature, (5.0 * share + 64.0 * kEps) * -curvature);
    EXPECT_EQ(result1.v[0], 0.0);
    EXPECT_EQ(result.mixed[3][0], 0.0);
  }
  first.expect_allowed("first");
  second.expect_allowed("second");
}

TEST(InverseInvolute, RefusesNegativeValuesAndNan) {
  EXPECT_THROW(inverse_involute(-1e-9), std::invalid_argument);
  EXPECT_THROW(inverse_involute(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::geometry::involute_test
