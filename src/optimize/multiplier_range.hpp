#pragma once
// Multipliers of an optimum, and what is left open of them where they are not unique.

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace gear3k::optimize {

/// Least and greatest value of a sum of multipliers.
struct MultiplierRange {
  double least = 0.0;
  std::optional<double> greatest;  ///< empty: there is none
};

/// The multipliers λ ≥ 0 with A λ = ∇f of an optimum: one of them, and how far they reach.
///
/// Where the columns of A are dependent there are many (a degenerate active set).  For a limit of
/// rows with weights w_k = |∂g_k/∂L| the least Σ w_k λ_k is what the objective gains per unit by
/// which the limit gives way, the greatest what it loses per unit by which it is tightened; without
/// a greatest nothing feasible is left, to first order.
/// Source: own derivation, docs/theory §12.
class Multipliers {
 public:
  /// @param a  gradients of active rows and bounds, at least one row and column
  /// @param b  gradient of the objective
  Multipliers(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

  /// ‖∇f − A λ‖₂ of the least-squares multipliers.
  [[nodiscard]] double residual() const { return residual_; }
  /// @param weight  one of each column, none negative
  [[nodiscard]] MultiplierRange range_of(const Eigen::VectorXd& weight) const;

 private:
  /// The greatest weight·λ by the simplex method from λ; empty where there is none.
  [[nodiscard]] std::optional<double> greatest(const Eigen::VectorXd& weight) const;

  Eigen::MatrixXd a_;  ///< columns of length 1
  Eigen::VectorXd length_;
  Eigen::VectorXd value_;  ///< multipliers of those columns
  std::vector<Eigen::Index> basis_;
  double residual_ = 0.0;
};

}  // namespace gear3k::optimize
