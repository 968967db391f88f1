#include "calibrate/series/random_effects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "numerics/distributions.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::random_effects_test {
namespace {

std::vector<UnitEstimate> drawn(std::uint64_t seed, int units, double mean, double deviation,
                                bool equal) {
  rig::DeterministicRandom random(seed);
  std::vector<UnitEstimate> result;
  for (int u = 0; u < units; ++u) {
    const double sd = equal ? 0.3 : random.between(0.1, 0.6);
    result.push_back(
        {.value = mean + deviation * random.normal() + sd * random.normal(), .sd = sd});
  }
  return result;
}

/// −2 ln of the density of the contrasts y_u − y_1, whose covariance is D + d_1 11ᵀ: another way to
/// the restricted likelihood, by Gaussian elimination.
double contrast_deviance(const std::vector<UnitEstimate>& units, double variance) {
  const std::size_t n = units.size() - 1;
  const double first = units[0].sd * units[0].sd + variance;
  std::vector<std::vector<double>> a(n, std::vector<double>(n, first));
  std::vector<double> z(n), x(n);
  for (std::size_t i = 0; i < n; ++i) {
    a[i][i] += units[i + 1].sd * units[i + 1].sd + variance;
    z[i] = x[i] = units[i + 1].value - units[0].value;
  }
  double log_determinant = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    log_determinant += std::log(a[k][k]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      x[i] -= f * x[k];
    }
  }
  double squares = 0.0;
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) x[k] -= a[k][j] * x[j];
    x[k] /= a[k][k];
    squares += x[k] * z[k];
  }
  return log_determinant + squares;
}

/// Log odds ratios of nine trials of diuretics against pre-eclampsia: events and women of each arm.
/// Source: Collins, Yusuf and Peto, BMJ 290 (1985), as in Viechtbauer, Stat. Med. 26 (2007), table
/// I.
std::vector<UnitEstimate> pre_eclampsia() {
  struct Trial {
    double events, women, control_events, control_women;
  };
  const std::vector<Trial> trials{{14, 131, 14, 136}, {21, 385, 17, 134},  {14, 57, 24, 48},
                                  {6, 38, 18, 40},    {12, 1011, 35, 760}, {138, 1370, 175, 1336},
                                  {15, 506, 20, 524}, {6, 108, 2, 103},    {65, 153, 40, 102}};
  std::vector<UnitEstimate> units;
  for (const Trial& t : trials) {
    const double a = t.events, b = t.women - t.events, c = t.control_events,
                 d = t.control_women - t.control_events;
    units.push_back({.value = std::log(a * d / (b * c)),
                     .sd = std::sqrt(1.0 / a + 1.0 / b + 1.0 / c + 1.0 / d)});
  }
  return units;
}

TEST(RandomEffects, PublishedTrialsHaveThePublishedVarianceAndInterval) {
  // Viechtbauer (2007), table II: REML 0.301, Q-profile 0.072 to 2.203.
  const RandomEffects r = random_effects(pre_eclampsia());
  constexpr double kLastDigit = 0.5e-3;
  EXPECT_NEAR(r.deviation * r.deviation, 0.301, kLastDigit);
  EXPECT_NEAR(r.deviation_low * r.deviation_low, 0.072, kLastDigit);
  EXPECT_NEAR(r.deviation_high * r.deviation_high, 2.203, kLastDigit);
}

TEST(RandomEffects, RestrictedDevianceIsThatOfTheContrasts) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto units = drawn(seed, 6, 0.7, 0.5, false);
    const double base = restricted_deviance(units, 0.1) - contrast_deviance(units, 0.1);
    for (const double variance : {0.0, 0.02, 0.5, 3.0}) {
      EXPECT_NEAR(restricted_deviance(units, variance) - contrast_deviance(units, variance), base,
                  1e-10)
          << "seed " << seed << ", variance " << variance;
    }
  }
}

TEST(RandomEffects, NoVarianceOfAFineGridIsLikelier) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto units = drawn(seed, 5 + static_cast<int>(seed % 8), 0.0,
                             0.05 * static_cast<double>(seed % 12), false);
    const RandomEffects r = random_effects(units);
    const double best = contrast_deviance(units, r.deviation * r.deviation);
    for (double v = 0.0; v < 4.0; v += 0.002) {
      ASSERT_GE(contrast_deviance(units, v), best - 1e-8) << "seed " << seed << ", variance " << v;
    }
  }
}

TEST(RandomEffects, EqualErrorsHaveTheClosedForm) {
  // τ² = max(0, S² − s²), Q(τ²) = (U − 1) S²/(s² + τ²), t = ȳ √U/S.
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto units = drawn(seed, 8, 0.5, 0.1 * static_cast<double>(seed % 6), true);
    double mean = 0.0, squares = 0.0;
    for (const UnitEstimate& u : units) mean += u.value / 8.0;
    for (const UnitEstimate& u : units) squares += (u.value - mean) * (u.value - mean);
    const double s2 = 0.09;
    const RandomEffects r = random_effects(units);
    EXPECT_NEAR(r.mean, mean, 1e-12);
    EXPECT_NEAR(r.deviation * r.deviation, std::max(0.0, squares / 7.0 - s2), 1e-6);
    EXPECT_NEAR(r.p_between, numerics::gamma_upper(3.5, 0.5 * squares / s2), 1e-12);
    // χ²_7 at 2.5 % and 97.5 %.
    EXPECT_NEAR(std::pow(r.deviation_low, 2), std::max(0.0, squares / 16.01276 - s2), 1e-6);
    EXPECT_NEAR(std::pow(r.deviation_high, 2), std::max(0.0, squares / 1.689869 - s2), 1e-6);
    const double spread = std::max(squares / 7.0, s2);
    EXPECT_NEAR(r.mean_sd, std::sqrt(spread / 8.0), 1e-6);
  }
}

TEST(RandomEffects, IntervalsCoverAsTheySay) {
  // Binomial law: of 600 intervals of 95 % fewer than 550 cover once in 10⁴ runs.
  int mean_inside = 0, deviation_inside = 0;
  constexpr int kRuns = 600;
  for (int k = 0; k < kRuns; ++k) {
    const auto units = drawn(1000 + static_cast<std::uint64_t>(k), 8, 2.0, 0.4, false);
    const RandomEffects r = random_effects(units);
    mean_inside += r.mean_low <= 2.0 && 2.0 <= r.mean_high ? 1 : 0;
    deviation_inside += r.deviation_low <= 0.4 && 0.4 <= r.deviation_high ? 1 : 0;
  }
  const double least = 0.916 * kRuns;
  EXPECT_GT(mean_inside, least);
  EXPECT_GT(deviation_inside, least);
}

TEST(RandomEffects, UnitsThatAgreeHaveNoDeviation) {
  const RandomEffects r = random_effects(
      {{.value = 1.0, .sd = 0.1}, {.value = 1.0, .sd = 0.2}, {.value = 1.0, .sd = 0.1}});
  EXPECT_EQ(r.deviation, 0.0);
  EXPECT_EQ(r.deviation_low, 0.0);
  EXPECT_EQ(r.p_between, 1.0);
  // With known variances, not with the scatter of 0.
  EXPECT_NEAR(r.mean_sd, 1.0 / std::sqrt(225.0), 1e-12);
}

TEST(RandomEffects, ScalesWithTheUnit) {
  auto units = drawn(3, 7, 0.4, 0.3, false);
  const RandomEffects r = random_effects(units);
  for (UnitEstimate& u : units) {
    u.value *= 1e-6;
    u.sd *= 1e-6;
  }
  const RandomEffects small = random_effects(units);
  EXPECT_NEAR(small.deviation, 1e-6 * r.deviation, 1e-12);
  EXPECT_NEAR(small.deviation_high, 1e-6 * r.deviation_high, 1e-12);
  EXPECT_NEAR(small.p_mean, r.p_mean, 1e-6);
}

TEST(RandomEffects, RefusesWhatItCannotEstimate) {
  EXPECT_THROW(random_effects({{.value = 1.0, .sd = 0.1}}), std::invalid_argument);
  EXPECT_THROW(random_effects({{.value = 1.0, .sd = 0.1}, {.value = NAN, .sd = 0.1}}),
               std::invalid_argument);
  EXPECT_THROW(random_effects({{.value = 1.0, .sd = 0.1}, {.value = 1.0, .sd = 0.0}}),
               std::invalid_argument);
}

TEST(HolmAdjusted, IsTheTextbookExample) {
  // Holm, Scand. J. Stat. 6 (1979): 4 tests; the smallest times 4, the next times 3, not falling.
  const auto p = holm_adjusted({0.01, 0.04, 0.03, 0.005});
  EXPECT_DOUBLE_EQ(p[3], 0.02);
  EXPECT_DOUBLE_EQ(p[0], 0.03);
  EXPECT_DOUBLE_EQ(p[2], 0.06);
  EXPECT_DOUBLE_EQ(p[1], 0.06);
}

}  // namespace
}  // namespace gear3k::calibrate::random_effects_test
