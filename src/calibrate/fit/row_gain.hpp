#pragma once
// What errors of the sensors come to in the measured rows, and whether a sensor has such.

#include <vector>

#include "calibrate/fit/final_fit.hpp"
#include "calibrate/fit/parameter_results.hpp"

namespace gear3k::calibrate {

/// Appends to the parameters of a drift that acts on the gain `greatest_gain_change`, of that row
/// in which the gain is furthest from 1, where that is more than kMostGainChange and so not
/// plausible. What the law of the drift tends to, no row need reach.
void add_implausible_gain(const Problem& problem, const FinalFit& fit, std::size_t effect,
                          std::vector<ParameterResult>& parameters);

/// Judges a zero error of the output's torque sensor by the greatest torque that it read: a tenth
/// of that, or 1 Nm where that is more, can be (an assumption).
void judge_output_zero(const Problem& problem, const FinalFit& fit, std::size_t effect,
                       std::vector<ParameterResult>& parameters);

}  // namespace gear3k::calibrate
