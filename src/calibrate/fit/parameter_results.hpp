#pragma once
// Fitted parameters as a reader sees them: value, interval, plausibility, and what follows from
// them.

#include <string>
#include <vector>

#include "calibrate/fit/final_fit.hpp"

namespace gear3k::calibrate {

/// A fitted parameter, in its unit.
struct ParameterResult {
  std::string name, unit;
  double value = 0.0;
  double low = 0.0, high = 0.0;  ///< 95 % interval
  bool at_bound = false;
  bool plausible = true;
  double plausible_low = 0.0, plausible_high = 0.0;
  bool derived = false;  ///< follows from the others (amplitude of a run-out)
};

/// Factor of a standard deviation for a 95 % interval: the normal's where the scatter is known,
/// else Student's.
double interval_factor(const FinalFit& fit);

/// Parameters of one effect of a fit with 95 % intervals (Student's t over the fit's degrees of
/// freedom), and its derived quantities (Cause::derived), whose variance is gᵀ C g by their
/// gradient g and the fit's covariance C.
std::vector<ParameterResult> parameter_results(const Simulation& simulation, const FinalFit& fit,
                                               std::size_t effect);

}  // namespace gear3k::calibrate
