#pragma once
// Fits of causes to data: linearisation, Gauss-Newton steps for the search, final fits.

#include <Eigen/Core>
#include <vector>

#include "calibrate/measurement/noise.hpp"
#include "calibrate/model/hypothesis.hpp"
#include "calibrate/model/row_responses.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate {

/// Data, simulation and noise that belong together.
struct Problem {
  const Simulation& simulation;
  const MeasurementSet& data;
  NoiseModel noise;
  RowStates states{data.rows};
};

/// Simulated responses and their derivatives, as they are (not weighted).
struct Linearisation {
  Eigen::VectorXd simulated;
  Eigen::MatrixXd own;    ///< by the hypothesis' parameters
  Eigen::MatrixXd other;  ///< by the parameters of further candidates, at 0
  bool runs = true;       ///< false where some row has no simulation
};

/// @param others  candidates to add, each by itself, not of a cause in the hypothesis
Linearisation linearise(const Problem& problem, const Hypothesis& hypothesis,
                        const std::vector<Candidate>& others);

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
/// (JᵀJ)⁻¹ of the whitened derivatives by a hypothesis' parameters; of what the rows do not
/// determine the pseudoinverse.
Eigen::MatrixXd inverse_normal(const Problem& problem, const Hypothesis& h);

/// @param start  a fit already
FinalFit final_fit(const Problem& problem, const Hypothesis& start, double scale);

/// Huber's ρ, twice: the square of a residual in standard deviations, linear beyond kWinsor.
double huber_square(double deviations);

/// Residuals beyond ±kWinsor·scale are set to it.
Eigen::VectorXd winsorised(Eigen::VectorXd residual, double scale);

/// Measured responses.
Eigen::VectorXd measured(const MeasurementSet& data);

}  // namespace gear3k::calibrate
