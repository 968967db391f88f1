#pragma once
// Noise whose neighbouring samples correlate: what of it a filter hides, and what it does to sums.

#include <array>
#include <cstddef>
#include <vector>

namespace gear3k::calibrate {

/// Stationary noise whose correlation falls as φ^|lag|.
struct CorrelatedNoise {
  double variance = 0.0;     ///< σ², in the square of the signal's unit
  double correlation = 0.0;  ///< φ, between neighbours; |φ| < 1
};

/// Variance of Σ w_j x_j.
///
///   σ² Σ_j Σ_l w_j w_l φ^|j-l|
///
/// Source: docs/theory §31.  Accuracy: rounding; ≥ 0.
double variance_of_sum(const CorrelatedNoise& noise, const std::vector<double>& weight);

/// Variance of the mean of many samples, in units of that of independent ones.
///
///   Σ_lag φ^|lag| = (1 + φ)/(1 - φ)
///
/// Source: docs/theory §31.  Valid: many more samples than 1/(1 - |φ|).
double variance_inflation(const CorrelatedNoise& noise);

/// Share of white noise that a signal less its zero_phase_filter() keeps, over frequency.
///
///   power = |1 - |H|²|²/kSteps at ω = π (i + 1/2)/kSteps, i = 0 ... kSteps - 1
///
/// Source: docs/theory §31, eq. 31.1.
struct LeftOutSpectrum {
  static constexpr std::size_t kSteps = 512;
  std::array<double, kSteps> cosine{};  ///< cos ω
  std::array<double, kSteps> power{};
};

/// Valid: 0 < f_c < 0.5.
LeftOutSpectrum left_out_spectrum(double cutoff_per_sample);

/// The noise of which a signal less its zero_phase_filter() shows these samples.
///
/// The filter leaves out of it the density (1 - φ²)/(1 - 2 φ cos ω + φ²) times the spectrum's
/// power; σ² and φ are those that give the samples' variance and covariance at lag 1 (bisection
/// over |φ| ≤ 0.95). Source: own derivation, docs/theory §31 (uncertainty). Valid: a signal
/// whose own features pass the filter.
/// @param shown  correlation counts where that at lag 1 is by so many deviations of white noise,
///     1/√n, off white noise's: a filter that leaves little of the noise hides it
/// @returns variance 0 where the samples are all 0
CorrelatedNoise noise_of_left_out(const std::vector<double>& left_out,
                                  const LeftOutSpectrum& spectrum, double shown = 0.0);

/// The noise of the residuals of a least-squares line with so many parameters: variance over n less
/// parameters, correlation at lag 1 within ±0.95.
/// Source: docs/theory §31 (deviation of the stiffness).
/// Valid: more residuals than parameters.
/// @returns variance 0 where the residuals are all 0
CorrelatedNoise noise_of_line_residuals(const std::vector<double>& residual, double parameters);

}  // namespace gear3k::calibrate
