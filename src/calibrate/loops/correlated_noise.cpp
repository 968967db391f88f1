#include "calibrate/loops/correlated_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numerics/square.hpp"

namespace gear3k::calibrate {
namespace {

using std::numbers::pi;

constexpr double kStrongestCorrelation = 0.95;

/// At lag 0 and 1.
struct LagCovariance {
  double lag0 = 0.0, lag1 = 0.0;
};

LagCovariance covariance(const std::vector<double>& u) {
  LagCovariance c;
  for (std::size_t i = 0; i < u.size(); ++i) {
    c.lag0 += u[i] * u[i] / static_cast<double>(u.size());
    if (i > 0) c.lag1 += u[i] * u[i - 1] / static_cast<double>(u.size() - 1);
  }
  return c;
}

/// What remains of the covariances of noise of variance 1 and correlation φ.
LagCovariance remaining_covariance(const LeftOutSpectrum& spectrum, double phi) {
  LagCovariance sum;
  for (std::size_t i = 0; i < LeftOutSpectrum::kSteps; ++i) {
    const double density =
        (1.0 - phi * phi) / (1.0 - 2.0 * phi * spectrum.cosine[i] + phi * phi) * spectrum.power[i];
    sum.lag0 += density;
    sum.lag1 += density * spectrum.cosine[i];
  }
  return sum;
}

}  // namespace

double variance_of_sum(const CorrelatedNoise& noise, const std::vector<double>& weight) {
  // Σ_j Σ_l w_j w_l φ^|j-l| by the recursion s_j = φ (s_{j-1} + w_{j-1}).
  double sum = 0.0;
  double before = 0.0;
  for (const double w : weight) {
    sum += w * (w + 2.0 * before);
    before = noise.correlation * (before + w);
  }
  return noise.variance * std::max(0.0, sum);
}

double variance_inflation(const CorrelatedNoise& noise) {
  return (1.0 + noise.correlation) / (1.0 - noise.correlation);
}

LeftOutSpectrum left_out_spectrum(double cutoff_per_sample) {
  LeftOutSpectrum spectrum;
  const double t_c = std::tan(pi * cutoff_per_sample);
  for (std::size_t i = 0; i < LeftOutSpectrum::kSteps; ++i) {
    const double omega = pi * (static_cast<double>(i) + 0.5) / LeftOutSpectrum::kSteps;
    const double ratio = numerics::square(numerics::square(std::tan(omega / 2.0) / t_c));
    spectrum.cosine[i] = std::cos(omega);
    spectrum.power[i] = numerics::square(ratio / (1.0 + ratio)) / LeftOutSpectrum::kSteps;
  }
  return spectrum;
}

CorrelatedNoise noise_of_left_out(const std::vector<double>& left_out,
                                  const LeftOutSpectrum& spectrum, double shown) {
  const LagCovariance c = covariance(left_out);
  if (!(c.lag0 > 0.0)) return {};
  const double wanted = c.lag1 / c.lag0;
  const LagCovariance white = remaining_covariance(spectrum, 0.0);
  if (std::abs(wanted - white.lag1 / white.lag0) <
      shown / std::sqrt(static_cast<double>(left_out.size()))) {
    return {.variance = c.lag0 / white.lag0, .correlation = 0.0};
  }
  double low = -kStrongestCorrelation;
  double high = kStrongestCorrelation;
  for (int i = 0; i < 40; ++i) {
    const double phi = 0.5 * (low + high);
    const LagCovariance remaining = remaining_covariance(spectrum, phi);
    (remaining.lag1 / remaining.lag0 < wanted ? low : high) = phi;
  }
  const double phi = 0.5 * (low + high);
  return {.variance = c.lag0 / remaining_covariance(spectrum, phi).lag0, .correlation = phi};
}

CorrelatedNoise noise_of_line_residuals(const std::vector<double>& residual, double parameters) {
  const LagCovariance c = covariance(residual);
  if (!(c.lag0 > 0.0)) return {};
  const auto n = static_cast<double>(residual.size());
  return {
      .variance = c.lag0 * n / (n - parameters),
      .correlation = std::clamp(c.lag1 / c.lag0, -kStrongestCorrelation, kStrongestCorrelation)};
}

}  // namespace gear3k::calibrate
