#pragma once
// What the choice of a law's form adds to the uncertainty of the parameters beside it.

#include <vector>

#include "calibrate/fit/final_fit.hpp"

namespace gear3k::calibrate {

/// Widens the deviations of a fit of several effects by what their forms leave open.
///
/// A search takes the plainest form that BIC allows, and what the form misses moves the parameters
/// of the other effects.  Fits with one law in a freer form, and with the level of friction free,
/// each have the weight w ∝ exp(−AIC/2); the deviation of a parameter becomes
///
///   Σ w √(V + (θ − θ_0)²)      over the fits in which its own effect keeps its form,
///
/// θ_0 that of the fit itself (Buckland, Burnham and Augustin 1997, Biometrics 53, 603-618, eq. 9).
///
/// A law whose reference is taken from the design or the data (thermal expansion) has a fit with
/// the constant that moves it (clearance) among them, alone as well.
///
/// @param all    candidates, with those of free shape
/// @param scale  of the treatment of outliers, as of fit()
void widen_by_forms(const Problem& problem, const std::vector<Candidate>& all, double scale,
                    FinalFit& final);

}  // namespace gear3k::calibrate
