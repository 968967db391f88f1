#include "calibrate/order_scan.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace gear3k::calibrate {

namespace {

double share_of(const Eigen::MatrixXd& wave, const FreeResidual& residual) {
  const Eigen::MatrixXd columns = free_columns(wave, residual);
  const Eigen::Matrix2d gram = columns.transpose() * columns;
  const Eigen::Vector2d moment = columns.transpose() * residual.left;
  constexpr double kDependent = 1e-9;
  if (!(gram.determinant() > kDependent * gram(0, 0) * gram(1, 1))) return 0.0;
  return moment.dot(gram.inverse() * moment) / residual.left.squaredNorm();
}

}  // namespace

Eigen::MatrixXd waves(const std::vector<double>& phase, double order) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(phase.size()), 2);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double angle = order * phase[static_cast<std::size_t>(i)];
    columns(i, 0) = std::isfinite(angle) ? std::cos(angle) : 0.0;
    columns(i, 1) = std::isfinite(angle) ? std::sin(angle) : 0.0;
  }
  return columns;
}

Eigen::MatrixXd free_columns(Eigen::MatrixXd columns, const FreeResidual& residual) {
  residual.noise.whiten(columns);
  if (residual.own_basis.cols() == 0) return columns;
  constexpr double kLeast = 1e-6;
  const Eigen::VectorXd whole = columns.colwise().norm();
  columns -= residual.own_basis * (residual.own_basis.transpose() * columns);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    if (columns.col(k).norm() <= kLeast * whole[k]) columns.col(k).setZero();
  }
  return columns;
}

OrderScan scan_orders(const std::vector<double>& phase, double first, double step, int count,
                      const FreeResidual& residual) {
  OrderScan scan;
  if (count < 1) return scan;
  scan.order.resize(static_cast<std::size_t>(count));
  scan.share.resize(scan.order.size());
  // Neighbouring orders follow from one another by a rotation; begun afresh every so often.
  constexpr int kFresh = 128;
  const Eigen::MatrixXd turn = waves(phase, step);
#pragma omp parallel for schedule(static) if (residual.left.size() > 2000)
  for (int start = 0; start < count; start += kFresh) {
    Eigen::MatrixXd now = waves(phase, first + step * start);
    for (int k = start; k < std::min(count, start + kFresh); ++k) {
      const auto at = static_cast<std::size_t>(k);
      scan.order[at] = first + step * k;
      scan.share[at] = share_of(now, residual);
      const Eigen::ArrayXd cosine =
          now.col(0).array() * turn.col(0).array() - now.col(1).array() * turn.col(1).array();
      now.col(1) =
          now.col(1).array() * turn.col(0).array() + now.col(0).array() * turn.col(1).array();
      now.col(0) = cosine;
    }
  }
  scan.best = static_cast<std::size_t>(std::ranges::max_element(scan.share) - scan.share.begin());
  const auto degrees = static_cast<double>(residual.left.size() - residual.own_basis.cols() - 2);
  const double kept = std::max(1.0 - scan.share[scan.best], 1e-12);
  // Two parameters: P = (1 − share)^(ν/2).
  scan.evidence = -0.5 * degrees * std::log(kept) - std::log(static_cast<double>(count));
  return scan;
}

}  // namespace gear3k::calibrate
