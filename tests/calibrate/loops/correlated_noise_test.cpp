#include "calibrate/loops/correlated_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "calibrate/loops/zero_phase_filter.hpp"

namespace gear3k::calibrate::correlated_noise_test {
namespace {

std::vector<double> draw(const CorrelatedNoise& noise, std::size_t n, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const double fresh = std::sqrt(1.0 - noise.correlation * noise.correlation);
  std::vector<double> x;
  x.reserve(n);
  double unit = normal(generator);
  for (std::size_t i = 0; i < n; ++i) {
    x.push_back(std::sqrt(noise.variance) * unit);
    unit = noise.correlation * unit + fresh * normal(generator);
  }
  return x;
}

TEST(CorrelatedNoise, VarianceOfASumIsTheDoubleSumOverAllPairs) {
  const std::vector<double> weight{0.3, -1.2, 0.0, 2.5, 0.7, -0.1};
  for (const double phi : {-0.8, 0.0, 0.4, 0.9}) {
    double brute_force = 0.0;
    for (std::size_t j = 0; j < weight.size(); ++j) {
      for (std::size_t l = 0; l < weight.size(); ++l) {
        const auto lag = std::abs(static_cast<double>(j) - static_cast<double>(l));
        brute_force += 4.0 * weight[j] * weight[l] * std::pow(phi, lag);
      }
    }
    EXPECT_NEAR(variance_of_sum({.variance = 4.0, .correlation = phi}, weight), brute_force, 1e-13);
  }
}

TEST(CorrelatedNoise, InflationIsThatOfALongMean) {
  constexpr std::size_t kSamples = 100000;
  const std::vector<double> mean(kSamples, 1.0 / kSamples);
  for (const double phi : {-0.5, 0.0, 0.8}) {
    const CorrelatedNoise noise{.variance = 2.0, .correlation = phi};
    // The ends have neighbours on one side only.
    EXPECT_NEAR(variance_of_sum(noise, mean) * kSamples / 2.0, variance_inflation(noise), 1e-3);
  }
}

TEST(CorrelatedNoise, SpectrumLeftOutHasThePowerOfTheWeightsThatTheFilterLeaves) {
  for (const double cutoff : {0.02, 0.1, 0.2}) {
    const LeftOutSpectrum spectrum = left_out_spectrum(cutoff);
    double power = 0.0;
    for (const double p : spectrum.power) power += p;
    // White noise of variance 1 through the weights δ - h.
    const std::vector<double> h = impulse_response(cutoff);
    double sum = (1.0 - h[0]) * (1.0 - h[0]);
    for (std::size_t k = 1; k < h.size(); ++k) sum += 2.0 * h[k] * h[k];
    EXPECT_NEAR(power, sum, 1e-5) << cutoff;
  }
}

TEST(CorrelatedNoise, IsFoundAgainInWhatTheFilterLeavesOut) {
  constexpr double kCutoff = 0.06;
  const LeftOutSpectrum spectrum = left_out_spectrum(kCutoff);
  for (const double phi : {-0.4, 0.0, 0.5}) {
    const std::vector<double> x = draw({.variance = 9.0, .correlation = phi}, 100000, 11);
    std::vector<double> left_out = zero_phase_filter(x, kCutoff);
    for (std::size_t i = 0; i < x.size(); ++i) left_out[i] = x[i] - left_out[i];
    const CorrelatedNoise found = noise_of_left_out(left_out, spectrum);
    // Five standard errors or so of 100000 samples.
    EXPECT_NEAR(found.correlation, phi, 0.03) << phi;
    EXPECT_NEAR(found.variance, 9.0, 0.3) << phi;
  }
  EXPECT_EQ(noise_of_left_out({0.0, 0.0, 0.0}, spectrum).variance, 0.0);
}

TEST(CorrelatedNoise, OfResidualsCountsTheParametersAndStaysBelowFullCorrelation) {
  const CorrelatedNoise alternating = noise_of_line_residuals({2.0, -2.0, 2.0, -2.0}, 2.0);
  EXPECT_DOUBLE_EQ(alternating.variance, 16.0 / (4.0 - 2.0));
  EXPECT_DOUBLE_EQ(alternating.correlation, -0.95);
  const CorrelatedNoise found =
      noise_of_line_residuals(draw({.variance = 4.0, .correlation = 0.6}, 50000, 3), 2.0);
  EXPECT_NEAR(found.correlation, 0.6, 0.02);
  EXPECT_NEAR(found.variance, 4.0, 0.3);
  EXPECT_EQ(noise_of_line_residuals({0.0, 0.0, 0.0}, 2.0).variance, 0.0);
}

}  // namespace
}  // namespace gear3k::calibrate::correlated_noise_test
