// The KKT residual of functions whose optima are known, smooth and on kinks.

#include "optimize/kkt_residual.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "optimize/refined_set.hpp"

namespace gear3k::optimize::kkt_residual_test {
namespace {

constexpr double kFar = 10.0;

/// A plane f = c + d·v.
struct Plane {
  double c = 0.0;
  std::vector<double> d;
};

double value_of_plane(const Plane& plane, std::span<const double> v) {
  double f = plane.c;
  for (std::size_t k = 0; k < v.size(); ++k) f += plane.d[k] * v[k];
  return f;
}

/// The plane that is greatest (sign +1) or least (−1) at v: the gradient of one side of the kink.
const Plane& uppermost(const std::vector<Plane>& planes, std::span<const double> v, double sign) {
  const Plane* best = &planes.front();
  for (const Plane& plane : planes) {
    if (sign * value_of_plane(plane, v) > sign * value_of_plane(*best, v)) best = &plane;
  }
  return *best;
}

/// f = max or min of planes, rows g_k = max or min of planes.
struct Kinked {
  std::vector<Plane> objective;
  double objective_sign = 1.0;
  std::vector<std::vector<Plane>> rows{};
  double row_sign = 1.0;

  [[nodiscard]] double residual(const std::vector<double>& v) const {
    const std::vector<double> lower(v.size(), -kFar), upper(v.size(), kFar);
    return kkt_residual(
        [&](std::span<const double> at, Gradients& result) {
          const Plane& f = uppermost(objective, at, objective_sign);
          result.f = value_of_plane(f, at);
          result.df = f.d;
          result.g.clear();
          result.dg.clear();
          for (const std::vector<Plane>& row : rows) {
            const Plane& g = uppermost(row, at, row_sign);
            result.g.push_back(value_of_plane(g, at));
            result.dg.insert(result.dg.end(), g.d.begin(), g.d.end());
          }
          return true;
        },
        v, lower, upper);
  }
};

TEST(KktResidual, OfASmoothFunctionIsItsProjectedGradient) {
  const Kinked slope{.objective = {{.c = 0.0, .d = {3.0, 4.0}}}};
  EXPECT_DOUBLE_EQ(slope.residual({0.5, 0.5}), 5.0);
  // A row takes the part along its gradient; one that pushes the wrong way takes nothing.
  Kinked held = slope;
  held.rows = {{{.c = -0.5, .d = {1.0, 0.0}}}};
  EXPECT_NEAR(held.residual({0.5, 0.5}), 4.0, 1e-12);
  held.rows = {{{.c = 0.5, .d = {-1.0, 0.0}}}};
  EXPECT_NEAR(held.residual({0.5, 0.5}), 5.0, 1e-12);
}

TEST(KktResidual, VanishesInTheCornerOfAnAbsoluteValue) {
  // |x| + |y| = max of four planes; beside the corner by less than the reach, and off it.
  const Kinked corner{.objective = {{.c = 0.0, .d = {1.0, 1.0}},
                                    {.c = 0.0, .d = {1.0, -1.0}},
                                    {.c = 0.0, .d = {-1.0, 1.0}},
                                    {.c = 0.0, .d = {-1.0, -1.0}}}};
  EXPECT_LE(corner.residual({3e-8, 1e-9}), 1e-12);
  // On one of its edges it falls along the edge: (0, ±1) is left.
  EXPECT_NEAR(corner.residual({1e-8, 0.3}), 1.0, 1e-12);
  EXPECT_NEAR(corner.residual({0.2, 0.3}), std::numbers::sqrt2, 1e-12);
}

TEST(KktResidual, IsTheDistanceToTheHullOfTheSidesNotToTheirDirections) {
  // Gradients (1, 1) and (−1, 3): the nearest point of their segment to 0 is (1, 1) itself, whose
  // slope the kink does not take; f falls there.
  const Kinked valley{.objective = {{.c = 0.0, .d = {1.0, 1.0}}, {.c = 0.0, .d = {-1.0, 3.0}}}};
  EXPECT_NEAR(valley.residual({0.0, 0.0}), std::numbers::sqrt2, 1e-9);
  // (2, 1) and (−2, 1): their mean (0, 1), which a row y ≥ 0 takes.
  Kinked held{.objective = {{.c = 0.0, .d = {2.0, 1.0}}, {.c = 0.0, .d = {-2.0, 1.0}}}};
  EXPECT_GE(held.residual({0.0, 0.0}), 1.0 - 1e-12);
  held.rows = {{{.c = 0.0, .d = {0.0, 1.0}}}};
  EXPECT_LE(held.residual({0.0, 0.0}), 1e-12);
}

TEST(KktResidual, OfAKinkThatPointsUpwardsIsThatOfItsSides) {
  // −|x|: 0 is a mean of its gradients, and the greatest value.
  const Kinked ridge{.objective = {{.c = 0.0, .d = {1.0}}, {.c = 0.0, .d = {-1.0}}},
                     .objective_sign = -1.0};
  EXPECT_DOUBLE_EQ(ridge.residual({1e-9}), 1.0);
}

TEST(KktResidual, TakesARowOnItsKinkByAllItsSides) {
  // Least −x with g = min(1 − x − y, 1 − x + y) ≥ 0: the optimum (1, 0) is the kink of the row.
  const Kinked wedge{.objective = {{.c = 0.0, .d = {-1.0, 0.0}}},
                     .rows = {{{.c = 1.0, .d = {-1.0, -1.0}}, {.c = 1.0, .d = {-1.0, 1.0}}}},
                     .row_sign = -1.0};
  EXPECT_LE(wedge.residual({1.0, 0.0}), 1e-12);
  EXPECT_NEAR(wedge.residual({0.9, 0.1}), std::sqrt(0.5), 1e-9);
}

TEST(KktResidual, IsNoNumberWhereTheModelIsNotDefined) {
  const std::vector<double> v{0.0}, lower{-1.0}, upper{1.0};
  EXPECT_TRUE(std::isnan(
      kkt_residual([](std::span<const double> /*at*/, Gradients& /*result*/) { return false; }, v,
                   lower, upper)));
}

}  // namespace
}  // namespace gear3k::optimize::kkt_residual_test
