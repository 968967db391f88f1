// Jet2 against ceres::Jet nested in itself, and against central differences of gradients.

#include "geometry/jet2.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "geometry/scalar.hpp"

namespace gear3k::jet2_test {
namespace {

constexpr std::size_t kVariables = 3;
constexpr double kEps = std::numeric_limits<double>::epsilon();
using Point = std::array<double, kVariables>;
/// Ceres' own rules of first derivatives, applied twice.
using Nested = ceres::Jet<Jet1, kMaxVariables>;

/// A number in an expression of `like`: Ceres has no operators between nested Jets and numbers.
template <class T>
auto number(double x, const T& /*like*/) {
  if constexpr (std::is_same_v<T, Nested>) {
    return Nested(Jet1(x));
  } else {
    return x;
  }
}

/// Every operator and function, in curved arguments that depend on several variables.
/// @param x  each in (0.2, 0.9)
template <class T>
std::vector<T> expressions(const std::array<T, kVariables>& x) {
  using std::abs, std::sqrt, std::exp, std::log, std::sin, std::cos, std::tan, std::asin, std::acos,
      std::atan, std::atan2, std::pow;
  const auto c = [&](double value) { return number(value, x[0]); };
  const T u = x[0] * x[1] + x[2] * x[2];         // (0.08, 1.62)
  const T v = x[1] * x[2] * x[0] + x[2] / x[1];  // above 0.23
  const T s = x[0] * x[1] * x[2];                // (0.008, 0.729)
  T compound = u;
  compound += v;
  compound -= s * u;
  compound *= x[0] + v;
  compound /= u;
  return {u,
          v,
          compound,
          u + v,
          u + c(0.7),
          c(0.7) + u,
          u - v,
          u - c(0.7),
          c(0.7) - u,
          -u * v,
          u * c(1.7),
          c(1.7) * u,
          u / v,
          u / c(1.7),
          c(1.7) / u,
          abs(T(s - v)),
          abs(T(v - s)),
          sqrt(u),
          exp(u),
          log(u),
          sin(u),
          cos(u),
          tan(s),
          asin(s),
          acos(s),
          atan(v),
          atan2(u, v),
          atan2(u, T(s - v)),
          atan2(T(-u), T(s - v)),
          exp(T(v * log(u)))};
}

std::vector<Point> points() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.2, 0.9);
  std::vector<Point> result(200);
  for (Point& x : result) {
    for (double& value : x) value = unit(random);
  }
  return result;
}

template <class T>
std::array<T, kVariables> seeded(const Point& at) {
  std::array<T, kVariables> x;
  for (std::size_t k = 0; k < kVariables; ++k) {
    const int axis = static_cast<int>(k);
    if constexpr (std::is_same_v<T, Jet2>) {
      x[k] = Jet2::variable(at[k], k);
    } else if constexpr (std::is_same_v<T, Nested>) {
      x[k] = Nested(Jet1(at[k], axis), axis);
    } else {
      x[k] = T(at[k], axis);
    }
  }
  return x;
}

/// The greatest magnitude among value and derivatives.
double size_of(const Nested& f) {
  double size = std::abs(f.a.a);
  for (int i = 0; i < kMaxVariables; ++i) {
    size = std::max({size, std::abs(f.v[i].a), f.v[i].v.cwiseAbs().maxCoeff()});
  }
  return size;
}

TEST(Jet2, HasTheDerivativesOfCeresJetsOfJets) {
  for (const Point& at : points()) {
    const auto own = expressions(seeded<Jet2>(at));
    const auto other = expressions(seeded<Nested>(at));
    ASSERT_EQ(own.size(), other.size());
    for (std::size_t k = 0; k < own.size(); ++k) {
      // Some ten operations each, whose terms cancel to a hundredth at most.
      const double rounding = 1000.0 * kEps * size_of(other[k]);
      EXPECT_NEAR(own[k].value, other[k].a.a, rounding) << "expression " << k;
      for (std::size_t i = 0; i < Jet2::kCount; ++i) {
        const Jet1& row = other[k].v[static_cast<Eigen::Index>(i)];
        EXPECT_NEAR(own[k].by_row[i], row.a, rounding) << "expression " << k;
        EXPECT_NEAR(own[k].by_column[i], other[k].a.v[static_cast<Eigen::Index>(i)], rounding)
            << "expression " << k;
        for (std::size_t j = 0; j < Jet2::kCount; ++j) {
          EXPECT_NEAR(own[k].mixed[i][j], row.v[static_cast<Eigen::Index>(j)], rounding)
              << "expression " << k << ", " << i << ", " << j;
        }
      }
    }
  }
}

TEST(Jet2, HasTheCentralDifferencesOfGradients) {
  constexpr double kStep = 1e-3;
  for (const Point& at : points()) {
    const auto own = expressions(seeded<Jet2>(at));
    for (std::size_t i = 0; i < kVariables; ++i) {
      const auto gradients = [&](double steps) {
        Point moved = at;
        moved[i] += steps * kStep;
        return expressions(seeded<Jet1>(moved));
      };
      const auto far_below = gradients(-2.0), below = gradients(-1.0);
      const auto above = gradients(1.0), far_above = gradients(2.0);
      for (std::size_t k = 0; k < own.size(); ++k) {
        for (std::size_t j = 0; j < kVariables; ++j) {
          const auto slope = [&](const std::vector<Jet1>& f) {
            return f[k].v[static_cast<Eigen::Index>(j)];
          };
          const double difference =
              (8.0 * (slope(above) - slope(below)) - (slope(far_above) - slope(far_below))) /
              (12.0 * kStep);
          // Truncation: h⁴/30 times the fifth derivative of the slope.
          EXPECT_NEAR(own[k].mixed[i][j], difference, 1e-5 * (1.0 + std::abs(difference)))
              << "expression " << k << ", " << i << ", " << j;
        }
      }
    }
  }
}

TEST(Jet2, PowersHaveTheDerivativesOfExponentials) {
  for (const Point& at : points()) {
    const auto x = seeded<Jet2>(at);
    const Jet2 u = x[0] * x[1] + x[2] * x[2];
    for (const double p : {-0.05, 0.2, 0.25, 2.0, 3.5}) {
      const Jet2 power = pow(u, p);
      const Jet2 witness = exp(p * log(u));
      for (std::size_t i = 0; i < kVariables; ++i) {
        const double rounding = 1000.0 * kEps * (1.0 + std::abs(witness.mixed[i][i]));
        EXPECT_NEAR(power.by_row[i], witness.by_row[i], rounding);
        for (std::size_t j = 0; j < kVariables; ++j) {
          EXPECT_NEAR(power.mixed[i][j], witness.mixed[i][j],
                      1000.0 * kEps * (1.0 + std::abs(witness.mixed[i][j])));
        }
      }
    }
  }
}

TEST(Jet2, BlocksOfOtherRowsThanColumnsAreThoseOfTheWholeHessian) {
  // Rows by the first variable, columns by the other two.
  for (const Point& at : points()) {
    std::array<Jet2, kVariables> x{Jet2(at[0]), Jet2(at[1]), Jet2(at[2])};
    x[0].by_row[4] = 1.0;
    x[1].by_column[0] = x[2].by_column[1] = 1.0;
    const auto block = expressions(x);
    const auto whole = expressions(seeded<Jet2>(at));
    for (std::size_t k = 0; k < block.size(); ++k) {
      EXPECT_EQ(block[k].by_row[4], whole[k].by_row[0]);
      EXPECT_EQ(block[k].by_column[0], whole[k].by_column[1]);
      EXPECT_EQ(block[k].by_column[1], whole[k].by_column[2]);
      EXPECT_EQ(block[k].mixed[4][0], whole[k].mixed[0][1]);
      EXPECT_EQ(block[k].mixed[4][1], whole[k].mixed[0][2]);
      EXPECT_EQ(block[k].mixed[0][0], 0.0);
    }
  }
}

TEST(Jet2, HasAtZeroTheMagnitudesSlopeOnTheSideOfItsSign) {
  for (const double zero : {0.0, -0.0}) {
    const double slope = std::copysign(1.0, zero);
    const Jet2 x = Jet2::variable(zero, 2);
    EXPECT_FALSE(std::signbit(abs(x).value));
    EXPECT_EQ(abs(x).by_row[2], slope);
    EXPECT_EQ(abs(x).by_column[2], slope);
    EXPECT_EQ(abs(x).mixed[2][2], 0.0);
  }
}

TEST(Jet2, IsNeutralWithoutDerivativesOnly) {
  EXPECT_TRUE(is_neutral(Jet2(1.0), 1.0));
  EXPECT_FALSE(is_neutral(Jet2(1.0), 0.0));
  EXPECT_FALSE(is_neutral(Jet2::variable(1.0, 7), 1.0));
  Jet2 curved(1.0);
  curved.mixed[7][0] = 1e-300;
  EXPECT_FALSE(is_neutral(curved, 1.0));
}

TEST(Jet2, IsFiniteWithEveryDerivative) {
  EXPECT_TRUE(all_finite(Jet2::variable(1.0, 7)));
  EXPECT_FALSE(all_finite(sqrt(Jet2::variable(0.0, 0))));
  EXPECT_FALSE(all_finite(acos(Jet2::variable(1.0, 0))));
  Jet2 curved(1.0);
  curved.mixed[0][7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(all_finite(curved));
}

}  // namespace
}  // namespace gear3k::jet2_test
