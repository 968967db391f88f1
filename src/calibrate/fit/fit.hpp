#pragma once
// Least squares of a hypothesis, by Gauss-Newton steps.

#include <Eigen/Core>

#include "calibrate/fit/linearisation.hpp"

namespace gear3k::calibrate {

struct Fit {
  Hypothesis hypothesis;
  Eigen::VectorXd simulated;
  Eigen::VectorXd residual;     ///< measured − simulated, whitened, not scaled
  double sum_of_squares = 0.0;  ///< huber_square() of the residuals over the scale
};

/// Beyond this many standard deviations a residual counts as this many (Huber's function).
inline constexpr double kWinsor = 3.0;

/// Least squares of a hypothesis from its values on, by Gauss-Newton steps inside the bounds.
/// @param scale  standard deviation of the whitened rows, for the treatment of outliers
Fit fit(const Problem& problem, Hypothesis start, double scale);

/// Whether a parameter stands at an end of its range that a step would cross.
bool leaves_range(const ParameterRecord& record, double value, double step);

/// Huber's ρ, twice: the square of a residual in standard deviations, linear beyond kWinsor.
double huber_square(double deviations);

/// Residuals beyond ±kWinsor·scale are set to it.
Eigen::VectorXd winsorised(Eigen::VectorXd residual, double scale);

}  // namespace gear3k::calibrate
