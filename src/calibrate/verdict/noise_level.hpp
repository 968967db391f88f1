#pragma once
// How much the rows scatter, who says so, and whether they scatter by more than they say.

#include <Eigen/Core>
#include <string>

#include "calibrate/fit/final_fit.hpp"
#include "calibrate/measurement/noise.hpp"

namespace gear3k::calibrate {

/// The noise of weighted rows and where it is known from: stated, else of the repeats, else of the
/// residuals.
struct NoiseLevel {
  double scale = 0.0;  ///< standard deviation of a whitened row; 1 where it is stated
  NoiseSource source = NoiseSource::kResiduals;
};
/// @param pure  scatter of the repeats, of whitened rows; taken from ten degrees of freedom on,
///     unless it is above that of the fit or as good as none
/// @param scale_of_fit  standard deviation of the whitened residuals
/// @param stated_holds  whether a stated level is that of the rows; else it only weighs them
NoiseLevel noise_level(const NoiseModel& noise, const PureError& pure, double scale_of_fit,
                       bool stated_holds);

/// What a fit leaves of the rows.
struct LeftOver {
  const Eigen::VectorXd& whitened;  ///< residuals
  int degrees = 0;                  ///< of freedom of the fit
  double scale = 0.0;               ///< standard deviation of a whitened row
  /// mean_square_as_read() of the simulation as given and of the fit, and of all noise together.
  double missed = 0.0, missed_by_effects = 0.0, noise = 0.0;
  bool of_time_alone = false;  ///< all that stands are steps and drifts
};

/// Whether the stated standard deviations are of the size that rows scatter by: by chi-squared at
/// 0.1 % and within a quarter what is left is not less and, where it has no structure, not greater.
/// True where nothing is stated, and of rows too few to say it themselves
/// (NoiseModel::known_scale()).
/// @param structure  whether what is left follows something that the data state
bool stated_level_holds(const NoiseModel& noise, const LeftOver& left, bool structure);

/// "the rows scatter by 2.1 times the stated sigma ...": what is said where it does not hold.
/// @param factor  scatter of the rows over what is stated
std::string note_on_stated_level(double factor);
bool tells_of_stated_level(const std::string& note);

/// Nobody knows a standard deviation better than to a quarter.
inline constexpr double kAsStated = 1.25;

/// Whether rows scatter by more than they state, outliers aside, whatever the structure: the
/// chi-squared probability of their winsorised squares.
/// @param whitened  residuals of the final fit
/// @param degrees  of freedom of that fit
/// @returns the probability of residuals as large as these; 1 where no scatter is stated, or where
/// it is within a quarter of the stated one: nobody knows it better
double chance_of_scatter(const NoiseModel& noise, const Eigen::VectorXd& whitened, int degrees);

/// Whether the rows say how much they scatter, by sigma, repeats or by being many.
bool noise_is_known(NoiseSource source, const FinalFit& final);

}  // namespace gear3k::calibrate
