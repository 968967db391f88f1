#pragma once
// What a sensor with a coarse step reads of what a simulation foretells.

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "calibrate/measurement/measurement.hpp"
#include "calibrate/measurement/reading_steps.hpp"

namespace gear3k::calibrate {

/// Readings as they may have been before they were rounded, if the simulation is right: each is
/// drawn from the normal distribution about its simulated value between the bounds of its step,
///
///   y + σ Φ⁻¹(U),   U uniform in Φ((r ∓ u/2 − y)/σ),   σ² = a² + (b y)²
///
/// with a, b of the greatest likelihood of the rounded readings.  Where nothing is missed they are
/// exactly normal and independent, whatever the step u, while alike readings of one state share the
/// error of rounding; and none is farther than u/2 from its reading.
/// Source: Dunn and Smyth, Randomized quantile residuals, J. Comput. Graph. Statist. 5 (1996).
/// @param simulated  by row [SI]
/// @returns nothing where σ is above a step in all rows, of torques that were set (loads take more
///          values then) and of rows that were read from loops
std::optional<MeasurementSet> before_rounding(const MeasurementSet& data,
                                              const Eigen::VectorXd& simulated, std::uint64_t seed);

}  // namespace gear3k::calibrate
