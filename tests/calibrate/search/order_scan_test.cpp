#include "calibrate/search/order_scan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "calibrate/fit/screen.hpp"
#include "calibrate/measurement/measurement.hpp"
#include "numerics/linear_algebra.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::order_scan_test {
namespace {

constexpr int kRows = 90;

/// Rows at irregular angles over several turns.
class Orders : public testing::Test {
 protected:
  Orders() {
    rig::DeterministicRandom random(5);
    for (int i = 0; i < kRows; ++i) {
      angle_.push_back(random.between(0.0, 40.0));
      noise_.push_back(random.between(-1.0, 1.0));
      Observation row;
      data_.rows.push_back(row);
    }
    model_ = make_noise_model(data_);
  }
  [[nodiscard]] Eigen::VectorXd wave(double order, double amplitude) const {
    Eigen::VectorXd y(kRows);
    for (int i = 0; i < kRows; ++i) {
      const auto at = static_cast<std::size_t>(i);
      y[i] = amplitude * std::cos(order * angle_[at] - 0.7) + noise_[at];
    }
    return y;
  }
  /// What the least squares of columns leave of y, by a QR decomposition.
  static double left_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
    return (y - columns * numerics::least_squares(columns, y)).squaredNorm();
  }

  std::vector<double> angle_, noise_;
  MeasurementSet data_;
  NoiseModel model_;
};

TEST_F(Orders, TakeOffWhatLeastSquaresOfCosineAndSineTakeOff) {
  const Eigen::VectorXd y = wave(3.5, 1.0);
  const FreeResidual residual{.noise = model_, .own_basis = Eigen::MatrixXd(kRows, 0), .left = y};
  constexpr int kCount = 400;  // beyond the rows' own beginning of rotations
  const OrderScan scan = scan_orders(angle_, 0.5, 0.05, kCount, residual);
  ASSERT_EQ(scan.order.size(), static_cast<std::size_t>(kCount));
  for (const std::size_t k : {0U, 60U, 127U, 128U, 300U, 399U}) {
    Eigen::MatrixXd columns(kRows, 2);
    for (int i = 0; i < kRows; ++i) {
      columns(i, 0) = std::cos(scan.order[k] * angle_[static_cast<std::size_t>(i)]);
      columns(i, 1) = std::sin(scan.order[k] * angle_[static_cast<std::size_t>(i)]);
    }
    EXPECT_NEAR(scan.share[k], 1.0 - left_of(columns, y) / y.squaredNorm(), 1e-11) << k;
  }
  EXPECT_NEAR(scan.order[scan.best], 3.5, 1e-12);
}

TEST_F(Orders, CountOnlyWhatTheFitLeavesFree) {
  // A fit that holds the wave already leaves nothing of it to find.
  const Eigen::VectorXd y = wave(3.5, 1.0);
  const Eigen::MatrixXd own = waves(angle_, 3.5);
  const Eigen::MatrixXd basis = orthonormal_basis(own);
  const FreeResidual residual{
      .noise = model_, .own_basis = basis, .left = y - basis * (basis.transpose() * y)};
  const OrderScan scan = scan_orders(angle_, 3.5, 0.05, 1, residual);
  EXPECT_LT(scan.share[0], 1e-9);
  // Beside it another order counts by what it adds to both.
  const OrderScan other = scan_orders(angle_, 1.25, 0.05, 1, residual);
  Eigen::MatrixXd both(kRows, 4);
  both << own, waves(angle_, 1.25);
  EXPECT_NEAR(other.share[0], 1.0 - left_of(both, y) / left_of(own, y), 1e-11);
}

TEST_F(Orders, OfUnknownAnglesAreZero) {
  std::vector<double> phase = angle_;
  phase[7] = kUnknown;
  const Eigen::MatrixXd columns = waves(phase, 2.0);
  EXPECT_EQ(columns(7, 0), 0.0);
  EXPECT_EQ(columns(7, 1), 0.0);
  EXPECT_TRUE(columns.allFinite());
}

TEST_F(Orders, HaveTheChanceThatIsStated) {
  // Of pure noise the best of a few independent orders reaches an evidence of −ln p in about the
  // share p of cases.
  constexpr int kCases = 2000;
  constexpr double kChance = 0.1;
  int passed = 0;
  RandomBits random(17);
  FreeResidual residual{
      .noise = model_, .own_basis = Eigen::MatrixXd(kRows, 0), .left = Eigen::VectorXd(kRows)};
  for (int c = 0; c < kCases; ++c) {
    for (int i = 0; i < kRows; ++i) residual.left[i] = random.normal();
    const OrderScan scan = scan_orders(angle_, 1.0, 1.0, 5, residual);
    if (scan.evidence >= -std::log(kChance)) ++passed;
  }
  // Bonferroni's bound for 5 independent orders: 1 − (1 − 0.1/5)^5 = 9.6 %; four deviations are 2.6
  // %.
  EXPECT_NEAR(static_cast<double>(passed) / kCases, 0.096, 0.026);
}

}  // namespace
}  // namespace gear3k::calibrate::order_scan_test
