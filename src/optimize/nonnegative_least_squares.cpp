#include "optimize/nonnegative_least_squares.hpp"

#include <limits>
#include <vector>

#include "numerics/linear_algebra.hpp"

namespace gear3k::optimize {

namespace {

/// Least squares over the columns of the passive set, zero elsewhere.
Eigen::VectorXd solve_passive(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                              const std::vector<Eigen::Index>& passive) {
  Eigen::MatrixXd columns(a.rows(), static_cast<Eigen::Index>(passive.size()));
  for (std::size_t k = 0; k < passive.size(); ++k) {
    columns.col(static_cast<Eigen::Index>(k)) = a.col(passive[k]);
  }
  const Eigen::VectorXd part = numerics::least_squares(columns, b);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
  for (std::size_t k = 0; k < passive.size(); ++k) {
    x[passive[k]] = part[static_cast<Eigen::Index>(k)];
  }
  return x;
}

}  // namespace

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a.cols());
  std::vector<Eigen::Index> passive;
  std::vector<bool> is_passive(static_cast<std::size_t>(a.cols()), false);
  const double tolerance = 1e-12 * (1.0 + a.norm()) * (1.0 + b.norm());
  for (Eigen::Index iteration = 0; iteration < 3 * a.cols() + 3; ++iteration) {
    const Eigen::VectorXd w = a.transpose() * (b - a * x);
    Eigen::Index enter = -1;
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      if (!is_passive[static_cast<std::size_t>(j)] && w[j] > tolerance &&
          (enter < 0 || w[j] > w[enter])) {
        enter = j;
      }
    }
    if (enter < 0) break;
    is_passive[static_cast<std::size_t>(enter)] = true;
    passive.push_back(enter);
    Eigen::VectorXd candidate = solve_passive(a, b, passive);
    // A column that enters with a non-positive coefficient does so by rounding alone.
    if (candidate[enter] <= 0.0) {
      is_passive[static_cast<std::size_t>(enter)] = false;
      passive.pop_back();
      break;
    }
    while (true) {
      double step = std::numeric_limits<double>::infinity();
      for (const Eigen::Index j : passive) {
        if (candidate[j] <= 0.0) step = std::min(step, x[j] / (x[j] - candidate[j]));
      }
      if (step == std::numeric_limits<double>::infinity()) break;
      x += step * (candidate - x);
      std::vector<Eigen::Index> kept;
      for (const Eigen::Index j : passive) {
        if (x[j] > 1e-15 * (1.0 + x.cwiseAbs().maxCoeff())) {
          kept.push_back(j);
        } else {
          x[j] = 0.0;
          is_passive[static_cast<std::size_t>(j)] = false;
        }
      }
      passive = kept;
      if (passive.empty()) {
        candidate.setZero();
        break;
      }
      candidate = solve_passive(a, b, passive);
    }
    x = candidate;
  }
  return x;
}

}  // namespace gear3k::optimize
