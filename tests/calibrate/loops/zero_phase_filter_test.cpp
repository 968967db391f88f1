#include "calibrate/loops/zero_phase_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

namespace gear3k::calibrate::zero_phase_filter_test {
namespace {

using std::numbers::pi;

/// The filter's continued ends are cut where its response has decayed to this.
constexpr double kFilterTruncation = 1e-5;

TEST(ZeroPhaseFilter, SineKeepsItsPhaseAndTakesTheSquaredButterworthAmplitude) {
  constexpr std::size_t kSamples = 4000;
  for (const double cutoff : {0.02, 0.075, 0.2}) {
    for (const double f : {0.01, 0.02, 0.075, 0.15, 0.3}) {
      std::vector<double> x;
      x.reserve(kSamples);
      for (std::size_t i = 0; i < kSamples; ++i) {
        x.push_back(std::sin(2.0 * pi * f * static_cast<double>(i) + 0.4));
      }
      const std::vector<double> y = zero_phase_filter(x, cutoff);
      // In-phase and quadrature parts over whole periods (all f are multiples of 1/200).
      double in_phase = 0.0;
      double quadrature = 0.0;
      for (std::size_t i = 1000; i < 3000; ++i) {
        const double phase = 2.0 * pi * f * static_cast<double>(i) + 0.4;
        in_phase += y[i] * std::sin(phase) / 1000.0;
        quadrature += y[i] * std::cos(phase) / 1000.0;
      }
      const double analogue = std::tan(pi * f) / std::tan(pi * cutoff);
      EXPECT_NEAR(in_phase, 1.0 / (1.0 + std::pow(analogue, 4)), 1e-9) << cutoff << ' ' << f;
      EXPECT_NEAR(quadrature, 0.0, 1e-9) << cutoff << ' ' << f;
      if (f == cutoff) {
        EXPECT_NEAR(in_phase, 0.5, 1e-9);
      }
    }
  }
}

TEST(ZeroPhaseFilter, LeavesStraightLinesAloneUpToTheirEnds) {
  std::vector<double> line;
  line.reserve(300);
  for (int i = 0; i < 300; ++i) line.push_back(7.0 - 0.25 * i);
  const std::vector<double> y = zero_phase_filter(line, 0.05);
  for (std::size_t i = 0; i < line.size(); ++i) {
    EXPECT_NEAR(y[i], line[i], kFilterTruncation * 75.0) << i;
  }
}

TEST(ZeroPhaseFilter, RefusesCutOffsBeyondNyquistAndShortSignals) {
  const std::vector<double> x(100, 1.0);
  EXPECT_THROW(zero_phase_filter(x, 0.5), std::invalid_argument);
  EXPECT_THROW(zero_phase_filter(x, 0.0), std::invalid_argument);
  EXPECT_THROW(zero_phase_filter(x, std::nan("")), std::invalid_argument);
  EXPECT_THROW(zero_phase_filter(x, 0.02), std::invalid_argument);
  EXPECT_EQ(zero_phase_filter(x, 0.05).size(), x.size());
}

TEST(ZeroPhaseFilter, ResponseToAnImpulseKeepsItsArea) {
  for (const double cutoff : {0.01, 0.075, 0.25}) {
    const std::vector<double> h = impulse_response(cutoff);
    ASSERT_EQ(h.size(), filter_padding(cutoff) + 1);
    double area = -h[0];
    for (const double x : h) area += 2.0 * x;
    // The tails that are cut sum up to some of their first values.
    EXPECT_NEAR(area, 1.0, 4.0 * kFilterTruncation) << cutoff;
  }
  EXPECT_THROW(impulse_response(0.5), std::invalid_argument);
}

TEST(ZeroPhaseFilter, WeightsGiveTheFilteredSampleUpToTheEnds) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  std::vector<double> x(200);
  for (double& value : x) value = 3.0 + normal(generator);
  for (const double cutoff : {0.03, 0.2}) {
    const std::vector<double> y = zero_phase_filter(x, cutoff);
    const std::vector<double> response = impulse_response(cutoff);
    for (const std::size_t i : {0, 1, 7, 100, 192, 198, 199}) {
      std::vector<double> weight(x.size(), 0.0);
      add_filter_weights(response, i, 0.25, weight);
      add_filter_weights(response, i, 0.75, weight);
      double sum = 0.0;
      for (std::size_t j = 0; j < x.size(); ++j) sum += weight[j] * x[j];
      // The record's range is some 6.
      EXPECT_NEAR(sum, y[i], 10.0 * kFilterTruncation) << cutoff << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace gear3k::calibrate::zero_phase_filter_test
