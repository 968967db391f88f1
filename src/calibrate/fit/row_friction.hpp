#pragma once
// The coefficient of friction that a fit says the flanks have in the measured rows, and whether any
// material shows such a one.

#include <optional>
#include <vector>

#include "calibrate/fit/final_fit.hpp"
#include "calibrate/fit/parameter_results.hpp"

namespace gear3k::calibrate {

/// Least and greatest coefficient of friction on any flank in any row under a hypothesis: that of
/// the gearbox at the row's direction, speed, load and temperature, times what the row's session,
/// time or angle makes of it.
///
/// Of more than 500 states of the gearbox, every n-th and those of the least and the greatest
/// temperature, speed and torque.
/// @returns nothing for a black box, which has no flanks, and for lost motion
std::optional<FrictionRange> row_friction(const Problem& problem, const Hypothesis& h);

/// Appends to the parameters of an effect that acts on friction `least_friction` below 0 and
/// `greatest_friction` above kMostFriction, which are not plausible: what the fit says where rows
/// are, not what its form says elsewhere.  What the simulation as given has is not held against it.
/// Pairs whose coefficients in approach and recess are among the parameters are told by those.
void add_implausible_friction(const Problem& problem, const FinalFit& fit, std::size_t effect,
                              std::vector<ParameterResult>& parameters);

/// parameter_results() with these, and what is not plausible of drags (fit/row_drag.hpp) and of a
/// sensor's gain (fit/row_gain.hpp).
std::vector<ParameterResult> parameter_results(const Problem& problem, const FinalFit& fit,
                                               std::size_t effect);

}  // namespace gear3k::calibrate
