#pragma once
// Waves of unknown order in a residual: the Lomb-Scargle periodogram.

#include <Eigen/Core>
#include <vector>

#include "calibrate/measurement/noise.hpp"

namespace gear3k::calibrate {

/// A whitened residual from which the columns of a fit have been projected off.
struct FreeResidual {
  const NoiseModel& noise;
  Eigen::MatrixXd own_basis;  ///< of the fit's columns, orthonormal
  Eigen::VectorXd left;       ///< free of them
};

/// Cosine and sine of an order of a phase [rad], as they are; 0 where the phase is NaN.
Eigen::MatrixXd waves(const std::vector<double>& phase, double order);

/// What waves of each order take off the residual.
struct OrderScan {
  /// Orders, and the share of the residual's squares, 0 to 1, that cosine and sine of each take off
  /// together, whatever the phases (the generalised Lomb-Scargle power).
  std::vector<double> order, share;
  std::size_t best = 0;
  double evidence = 0.0;  ///< of the best: −ln p by itself, less ln of the number of orders
};

/// Orders from `first` in `count` steps of `step`.
OrderScan scan_orders(const std::vector<double>& phase, double first, double step, int count,
                      const FreeResidual& residual);

}  // namespace gear3k::calibrate
