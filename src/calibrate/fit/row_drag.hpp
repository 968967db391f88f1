#pragma once
// The torque that a law of drag has in the measured rows, and whether any seal or oil has such a
// one.

#include <vector>

#include "calibrate/fit/final_fit.hpp"
#include "calibrate/fit/parameter_results.hpp"

namespace gear3k::calibrate {

/// Appends to the parameters of a drag that grows with the speed `greatest_drag`, its torque at the
/// shaft's greatest speed in the rows [N m], where that is above kMostDrag_Nm and above what the
/// shaft carries at most in the rows, and so not plausible:
///
///   M = c ω₁, c ω₁²        ω₁ of the sun, or of the output (less by the ratio)
///
/// A coefficient says what a shaft loses at 1 rad/s, which a sun never runs at and an output hardly
/// passes.  What the output carries is its torque, what the sun carries its torque less the drag
/// forward and with it backward.  The torques of a constant drag are held against the same.
void add_implausible_drag(const Problem& problem, const FinalFit& fit, std::size_t effect,
                          std::vector<ParameterResult>& parameters);

}  // namespace gear3k::calibrate
