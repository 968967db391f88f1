#pragma once

#include <Eigen/Core>

namespace gear3k::optimize {

/// min ‖A x − b‖₂ subject to x ≥ 0, by the active-set method of Lawson and Hanson.
///
/// Meant for small dense problems (tens of columns).
/// Source: Lawson, Hanson, Solving Least Squares Problems, 1974, ch. 23 (algorithm NNLS).
/// @returns x ≥ 0.  Karush-Kuhn-Tucker conditions hold to about 1e-12 ‖A‖ ‖b‖ unless the method
///   ends early: where the column with the greatest gradient gains nothing, as next to one that it
///   depends on, or after 3 (columns + 1) rounds.  Judge x by its residual, which is then no less
///   than the least: a KKT residual found with it errs to the safe side.
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace gear3k::optimize
