#pragma once
// Least squares of a hypothesis, by Gauss-Newton steps.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calibrate/fit/linearisation.hpp"
#include "numerics/parallel.hpp"

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

/// Each hypothesis by itself, in threads where rows are few (kManyRows).
std::vector<Fit> fit_all(const Problem& problem, const std::vector<Hypothesis>& starts,
                         double scale);

/// body(k) of independent fits, as fit_all().
template <class Body>
void for_fits(const Problem& problem, std::size_t count, const Body& body) {
  numerics::parallel_for(count, body, count > 1 && problem.data.rows.size() < kManyRows);
}

/// Whether a parameter stands at an end of its range that a step would cross.
bool leaves_range(const ParameterRecord& record, double value, double step);

/// Huber's ρ, twice: the square of a residual in standard deviations, linear beyond kWinsor.
double huber_square(double deviations);

/// Residuals beyond ±kWinsor·scale are set to it.
Eigen::VectorXd winsorised(Eigen::VectorXd residual, double scale);

}  // namespace gear3k::calibrate
