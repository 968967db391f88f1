#pragma once
// The last fit of a hypothesis: by Ceres, with what the rows say of its parameters.

#include <Eigen/Core>
#include <vector>

#include "calibrate/fit/fit.hpp"

namespace gear3k::calibrate {

/// Final fit by Ceres: exact derivatives, bounds, Huber's loss.
struct FinalFit {
  Hypothesis hypothesis;
  Eigen::VectorXd simulated;
  /// Of the parameters, in their units: s² (JᵀJ)⁻¹, deviations widened where the residuals say that
  /// rows do not scatter alike.
  Eigen::MatrixXd covariance;
  std::vector<bool> at_bound;
  /// Of a parameter at a bound: how far beyond it the rows would have it, by linearisation; else 0.
  std::vector<double> beyond;
  /// Whether the rows determine the parameter; its variance says nothing where they do not.
  std::vector<bool> determined;
  double scale = 0.0;           ///< standard deviation of the whitened rows after the fit
  bool scale_is_known = false;  ///< NoiseModel::known_scale(), not estimated
  int degrees = 0;              ///< rows less parameters
};

/// @param start  a fit already
FinalFit final_fit(const Problem& problem, const Hypothesis& start, double scale);

/// What the rows say of a hypothesis' parameters together, J the whitened derivatives.
struct InverseNormal {
  Eigen::VectorXd variance;   ///< diagonal of (JᵀJ)⁻¹, or of the pseudoinverse
  Eigen::VectorXd inflation;  ///< of it by the others: 1/(1 − R²), R² of a column of J by theirs
};
InverseNormal inverse_normal(const Problem& problem, const Hypothesis& h);

}  // namespace gear3k::calibrate
