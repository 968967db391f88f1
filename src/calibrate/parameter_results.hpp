#pragma once
// Fitted parameters as a reader sees them: value, interval, plausibility, and what follows from
// them.

#include <vector>

#include "calibrate/diagnosis.hpp"
#include "calibrate/fit.hpp"

namespace gear3k::calibrate {

/// Parameters of one effect of a fit with 95 % intervals (Student's t over the fit's degrees of
/// freedom), and its derived quantities (Cause::derived), whose variance is gᵀ C g by their
/// gradient g and the fit's covariance C.
std::vector<ParameterResult> parameter_results(const Simulation& simulation, const FinalFit& fit,
                                               std::size_t effect);

}  // namespace gear3k::calibrate
