#include "optimize/multiplier_range.hpp"

#include <algorithm>
#include <limits>

#include "numerics/linear_algebra.hpp"
#include "optimize/nonnegative_least_squares.hpp"

namespace gear3k::optimize {

namespace {

/// What a column leaves beyond the others from which it counts as independent of them.
constexpr double kIndependent = 1e-6;
/// What counts as nothing among multipliers and their sums, of the largest.
constexpr double kNoMultiplier = 1e-9;

Eigen::MatrixXd columns_of(const Eigen::MatrixXd& a, const std::vector<Eigen::Index>& places) {
  Eigen::MatrixXd part(a.rows(), static_cast<Eigen::Index>(places.size()));
  for (std::size_t k = 0; k < places.size(); ++k) {
    part.col(static_cast<Eigen::Index>(k)) = a.col(places[k]);
  }
  return part;
}

bool holds(const std::vector<Eigen::Index>& places, Eigen::Index place) {
  return std::ranges::find(places, place) != places.end();
}

}  // namespace

Multipliers::Multipliers(const Eigen::MatrixXd& a, const Eigen::VectorXd& b)
    : a_(a), length_(a.colwise().norm()) {
  for (Eigen::Index k = 0; k < a_.cols(); ++k) {
    if (length_[k] > 0.0) a_.col(k) /= length_[k];
  }
  value_ = nonnegative_least_squares(a_, b);
  residual_ = (b - a_ * value_).norm();
  const double none = kNoMultiplier * (1.0 + value_.cwiseAbs().maxCoeff());
  for (Eigen::Index k = 0; k < a_.cols(); ++k) {
    if (value_[k] <= none) value_[k] = 0.0;
    if (value_[k] > 0.0) basis_.push_back(k);
  }
  // Columns that are independent of those with a multiplier complete the basis, at 0.
  for (Eigen::Index k = 0; k < a_.cols(); ++k) {
    if (holds(basis_, k) || !(length_[k] > 0.0)) continue;
    const Eigen::VectorXd column = a_.col(k);
    double left = 1.0;
    if (!basis_.empty()) {
      const Eigen::MatrixXd others = columns_of(a_, basis_);
      left = (column - others * numerics::least_squares(others, column)).norm();
    }
    if (left > kIndependent) basis_.push_back(k);
  }
}

std::optional<double> Multipliers::greatest(const Eigen::VectorXd& weight) const {
  std::vector<Eigen::Index> basis = basis_;
  Eigen::VectorXd value = value_;
  const double none = kNoMultiplier * (1.0 + weight.cwiseAbs().maxCoeff());
  // By the rule of Bland, the first column that helps and the first that leaves, it ends.
  for (Eigen::Index steps = 0; steps < 100 * (a_.cols() + 1); ++steps) {
    const Eigen::MatrixXd columns = columns_of(a_, basis);
    bool moved = false;
    for (Eigen::Index enter = 0; enter < a_.cols() && !moved; ++enter) {
      if (holds(basis, enter) || !(length_[enter] > 0.0)) continue;
      const Eigen::VectorXd share = numerics::least_squares(columns, a_.col(enter));
      double gain = weight[enter];
      for (std::size_t k = 0; k < basis.size(); ++k) {
        gain -= weight[basis[k]] * share[static_cast<Eigen::Index>(k)];
      }
      if (!(gain > none)) continue;
      double step = std::numeric_limits<double>::infinity();
      std::size_t leave = basis.size();
      for (std::size_t k = 0; k < basis.size(); ++k) {
        const double falls = share[static_cast<Eigen::Index>(k)];
        if (!(falls > kNoMultiplier)) continue;
        const double length = std::max(0.0, value[basis[k]]) / falls;
        if (length < step || (length == step && basis[k] < basis[leave])) {
          step = length;
          leave = k;
        }
      }
      if (leave == basis.size()) return std::nullopt;
      for (std::size_t k = 0; k < basis.size(); ++k) {
        value[basis[k]] -= step * share[static_cast<Eigen::Index>(k)];
      }
      value[enter] = step;
      value[basis[leave]] = 0.0;
      basis[leave] = enter;
      moved = true;
    }
    if (!moved) break;
  }
  return weight.dot(value);
}

MultiplierRange Multipliers::range_of(const Eigen::VectorXd& weight) const {
  Eigen::VectorXd own = weight;
  for (Eigen::Index k = 0; k < own.size(); ++k) {
    own[k] = length_[k] > 0.0 ? weight[k] / length_[k] : 0.0;
  }
  const std::optional<double> most = greatest(own);
  // The least is bounded: neither weights nor multipliers are negative.
  return {.least = std::max(0.0, -greatest(-own).value_or(0.0)), .greatest = most};
}

}  // namespace gear3k::optimize
