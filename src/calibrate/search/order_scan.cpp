#include "calibrate/search/order_scan.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

/// Share of the residual's squares that whitened cosines and sines take off.  The residual is free
/// of the fit already, so that only the waves' squares need what they have in common with the fit
/// taken off: CᵀC − (BᵀC)ᵀ(BᵀC).
double share_of(const Eigen::MatrixXd& wave, const FreeResidual& residual, double total) {
  const auto cosine = wave.col(0);
  const auto sine = wave.col(1);
  const double cc = cosine.squaredNorm();
  const double ss = sine.squaredNorm();
  double free_cc = cc;
  double free_ss = ss;
  double free_cs = cosine.dot(sine);
  for (Eigen::Index k = 0; k < residual.own_basis.cols(); ++k) {
    const double c = residual.own_basis.col(k).dot(cosine);
    const double s = residual.own_basis.col(k).dot(sine);
    free_cc -= c * c;
    free_ss -= s * s;
    free_cs -= c * s;
  }
  constexpr double kLeast = 1e-12;  // share of its squares that a free wave keeps
  const double determinant = free_cc * free_ss - free_cs * free_cs;
  constexpr double kDependent = 1e-9;
  if (free_cc <= kLeast * cc || free_ss <= kLeast * ss ||
      !(determinant > kDependent * free_cc * free_ss)) {
    return 0.0;
  }
  const double mc = cosine.dot(residual.left);
  const double ms = sine.dot(residual.left);
  return (mc * mc * free_ss - 2.0 * mc * ms * free_cs + ms * ms * free_cc) / (determinant * total);
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

OrderScan scan_orders(const std::vector<double>& phase, double first, double step, int count,
                      const FreeResidual& residual) {
  OrderScan scan;
  if (count < 1) return scan;
  scan.order.resize(static_cast<std::size_t>(count));
  scan.share.resize(scan.order.size());
  // Neighbouring orders follow from one another by a rotation; begun afresh every so often.
  constexpr int kFresh = 128;
  const Eigen::MatrixXd turn = waves(phase, step);
  const double total = residual.left.squaredNorm();
  // Rows that count alike need no weights: a share does not depend on the waves' unit.
  const bool alike = residual.noise.counts_rows_alike();
  const Whitening whiten(residual.noise);
  constexpr double kManyWaves = 1e5;  // rows by orders: some milliseconds
  const auto scan_part = [&](std::size_t part) {
    const int start = kFresh * static_cast<int>(part);
    Eigen::MatrixXd now = waves(phase, first + step * start);
    Eigen::MatrixXd whitened;
    for (int k = start; k < std::min(count, start + kFresh); ++k) {
      const auto at = static_cast<std::size_t>(k);
      scan.order[at] = first + step * k;
      if (!alike) {
        whitened = now;
        whiten(whitened);
      }
      scan.share[at] = share_of(alike ? now : whitened, residual, total);
      for (Eigen::Index i = 0; i < now.rows(); ++i) {
        const double cosine = now(i, 0) * turn(i, 0) - now(i, 1) * turn(i, 1);
        now(i, 1) = now(i, 1) * turn(i, 0) + now(i, 0) * turn(i, 1);
        now(i, 0) = cosine;
      }
    }
  };
  numerics::parallel_for(static_cast<std::size_t>((count + kFresh - 1) / kFresh), scan_part,
                         static_cast<double>(residual.left.size()) * count > kManyWaves);
  scan.best = static_cast<std::size_t>(std::ranges::max_element(scan.share) - scan.share.begin());
  const auto degrees = static_cast<double>(residual.left.size() - residual.own_basis.cols() - 2);
  const double kept = std::max(1.0 - scan.share[scan.best], 1e-12);
  // Two parameters: P = (1 − share)^(ν/2).
  scan.evidence = -0.5 * degrees * std::log(kept) - std::log(static_cast<double>(count));
  return scan;
}

}  // namespace gear3k::calibrate
