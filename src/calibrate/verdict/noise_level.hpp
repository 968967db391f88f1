#pragma once
// How much the rows scatter, who says so, and whether they scatter by more than they say.

#include <Eigen/Core>

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
NoiseLevel noise_level(const NoiseModel& noise, const PureError& pure, double scale_of_fit);

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
