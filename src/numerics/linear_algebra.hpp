#pragma once

#include <Eigen/Core>
#include <memory>

/// Factorisations of dense matrices of doubles.  Eigen's take long to compile: they stand in one
/// source, and callers need its Core only.
namespace gear3k::numerics {

/// A = Q R Pᵀ with column pivoting; solves least squares, of full rank or not.
class ColumnPivotingQr {
 public:
  /// @param a  rows x columns, at least one column
  explicit ColumnPivotingQr(const Eigen::MatrixXd& a);
  ~ColumnPivotingQr();
  ColumnPivotingQr(ColumnPivotingQr&&) noexcept;
  ColumnPivotingQr& operator=(ColumnPivotingQr&&) noexcept;

  /// x with the least |A x − b|; zero for the columns beyond the rank
  /// @param b  rows
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

/// x with the least |A x − b|, by column-pivoting QR
/// @param a  rows x columns, at least one column
/// @param b  rows
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// Replaces the rows of A by the triangle R of A = Q R: the first columns' rows hold it, with zeros
/// below the diagonal; further rows hold what the factorisation left there.
/// @param a  at least as many rows as columns
void triangularise(Eigen::MatrixXd& a);

/// x of least norm with the least |A x − b|, by complete orthogonal decomposition
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// The Moore-Penrose inverse A⁺, by complete orthogonal decomposition
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a);

/// x = A⁻¹ b of a symmetric, positive definite A, by its L D Lᵀ factors
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// Eigenvalues of a symmetric matrix, ascending; of its lower triangle
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

}  // namespace gear3k::numerics
