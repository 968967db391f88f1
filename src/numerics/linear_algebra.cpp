#include "numerics/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace gear3k::numerics {

struct ColumnPivotingQr::Factors {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
};

ColumnPivotingQr::ColumnPivotingQr(const Eigen::MatrixXd& a)
    : factors_(new Factors{a.colPivHouseholderQr()}) {}
ColumnPivotingQr::~ColumnPivotingQr() = default;
ColumnPivotingQr::ColumnPivotingQr(ColumnPivotingQr&&) noexcept = default;
ColumnPivotingQr& ColumnPivotingQr::operator=(ColumnPivotingQr&&) noexcept = default;

Eigen::VectorXd ColumnPivotingQr::solve(const Eigen::VectorXd& b) const {
  return factors_->qr.solve(b);
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

void triangularise(Eigen::MatrixXd& a) {
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> in_place(a);
  a.topRows(a.cols()).triangularView<Eigen::StrictlyLower>().setZero();
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a) {
  return a.completeOrthogonalDecomposition().pseudoInverse();
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace gear3k::numerics
