#pragma once
// A parameter that differs from gearbox to gearbox: its mean and its part-to-part deviation.

#include <vector>

namespace gear3k::calibrate {

/// A parameter as fitted in one gearbox.
struct UnitEstimate {
  double value = 0.0;
  double sd = 0.0;  ///< standard deviation of its error, > 0
};

/// Estimates of a random-effects model, in the unit of the values.
///
///   y_u = μ + b_u + e_u,   b_u ~ N(0, τ²),   e_u ~ N(0, s_u²),   w_u = 1/(s_u² + τ²)
///
/// τ² maximises the restricted likelihood, μ = Σ w y / Σ w.  With
///
///   Q(τ²) = Σ w_u(τ²) (y_u − μ(τ²))² ~ χ²_{U−1}
///
/// p_between = P(χ²_{U−1} ≥ Q(0)), and the 95 % interval of τ² holds the values at which Q is
/// between the 2.5 % and 97.5 % points of χ²_{U−1} (Q-profile).  The interval of μ is μ ± t_{U−1}
/// √(max(1, Q(τ̂²)/(U−1)) / Σ w), p_mean that of μ = 0 by the same deviation (Hartung-Knapp, never
/// narrower than with known variances).
///
/// Source: Viechtbauer, Confidence intervals for the amount of heterogeneity in meta-analysis,
/// Stat. Med. 26 (2007) (REML, Q-profile); Hartung and Knapp, Stat. Med. 20 (2001); the bound by 1:
/// Röver, Knapp and Friede, BMC Med. Res. Methodol. 15:99 (2015). Limits: s_u is taken as known (a
/// fit over n rows knows it to 1/√(2n)); b_u normal.
struct RandomEffects {
  double mean = 0.0;
  double mean_sd = 0.0;  ///< of the mean, as its interval has it
  double mean_low = 0.0, mean_high = 0.0;
  double deviation = 0.0;  ///< τ
  double deviation_low = 0.0, deviation_high = 0.0;
  double p_mean = 1.0;     ///< of a mean as far from 0
  double p_between = 1.0;  ///< of units that differ as much by their errors alone
};

/// @throws std::invalid_argument for fewer than two units, values that are not finite or deviations
/// that are not above 0
RandomEffects random_effects(const std::vector<UnitEstimate>& units);

/// −2 ln of the restricted likelihood at τ², up to a constant:
/// Σ ln(s² + τ²) + ln Σ w + Σ w (y − μ)².
double restricted_deviance(const std::vector<UnitEstimate>& units, double variance);

/// Holm's adjusted p-values: the k-th smallest of m times m − k + 1, not falling, at most 1.
std::vector<double> holm_adjusted(const std::vector<double>& p);

}  // namespace gear3k::calibrate
