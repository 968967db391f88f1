#include "optimize/nonnegative_least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>
#include <random>

#include "numerics/linear_algebra.hpp"

namespace gear3k::optimize::nonnegative_least_squares_test {
namespace {

/// The least residual over all subsets of columns whose unconstrained solution is non-negative.
double best_by_enumeration(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  double best = b.norm();
  for (unsigned subset = 1; subset < (1U << a.cols()); ++subset) {
    std::vector<Eigen::Index> columns;
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      if ((subset >> j & 1U) != 0) columns.push_back(j);
    }
    const Eigen::MatrixXd part = a(Eigen::all, columns);
    const Eigen::VectorXd x = numerics::least_norm_solution(part, b);
    if (x.minCoeff() >= -1e-12) best = std::min(best, (part * x - b).norm());
  }
  return best;
}

TEST(NonnegativeLeastSquares, ResidualIsTheLeastOfAllActiveSets) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Index columns = 1 + trial % 7;
    Eigen::MatrixXd a(8, columns);
    Eigen::VectorXd b(8);
    for (double& value : a.reshaped()) value = normal(random);
    for (double& value : b) value = normal(random);
    if (trial % 5 == 0 && columns > 1) a.col(1) = 2.0 * a.col(0);  // dependent columns
    const Eigen::VectorXd x = nonnegative_least_squares(a, b);
    EXPECT_GE(x.minCoeff(), 0.0);
    const double rounding = 1e-10 * (1.0 + b.norm());
    EXPECT_NEAR((a * x - b).norm(), best_by_enumeration(a, b), rounding) << "trial " << trial;
  }
}

TEST(NonnegativeLeastSquares, NoColumnsLeaveTheRightHandSide) {
  const Eigen::MatrixXd a(8, 0);
  EXPECT_EQ(nonnegative_least_squares(a, Eigen::VectorXd::Ones(8)).size(), 0);
}

}  // namespace
}  // namespace gear3k::optimize::nonnegative_least_squares_test
