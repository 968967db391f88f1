#include "backlash/tolerance_shares.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/backlash/scatter_deviation.hpp"
#include "tests/backlash/toleranced_train.hpp"

namespace gear3k::backlash::tolerance_shares_test {
namespace {

/// Thickness of sun and rings and centre distance: the same on all planets, so that the lost motion
/// is a sum.
Tolerances additive() {
  Tolerances t;
  t.gears[train::kS].tooth_thickness_m = {.lower = -20e-6, .upper = 0.0};
  t.gears[train::kR1].tooth_thickness_m = {.lower = -6e-6, .upper = 0.0};
  t.gears[train::kR2].tooth_thickness_m = {.lower = -10e-6, .upper = 0.0};
  t.center_distance_m = {.lower = -8e-6, .upper = 8e-6};
  return t;
}

TEST(ToleranceShares, OfASumAreItsTermsShares) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), additive());
  const WorstCase worst = worst_case(model);
  const auto shares = tolerance_shares(model, {.samples = 300'000, .seed = 2});
  ASSERT_EQ(shares.sources.size(), 4U);
  ASSERT_EQ(shares.jam_probability, 0.0);
  double squares = 0.0, sum = 0.0;
  for (const double s : worst.share_rad) squares += s * s;
  for (std::size_t i = 0; i < 4; ++i) {
    const double expected = worst.share_rad[i] * worst.share_rad[i] / squares;
    const ToleranceShare& s = shares.sources[i];
    EXPECT_NEAR(s.first_order.value, expected, 5.0 * s.first_order.standard_error);
    EXPECT_NEAR(s.total.value, expected, 5.0 * s.total.standard_error);
    EXPECT_LT(s.first_order.standard_error, 0.005);
    EXPECT_LT(s.total.standard_error, 0.005);
    sum += s.first_order.value;
  }
  EXPECT_NEAR(sum, 1.0, 0.01);
  const double variance = std::pow(number_deviation({}), 2) * squares;
  EXPECT_NEAR(shares.variance_rad2, variance, 5.0 * variance / std::sqrt(3e5));
}

TEST(ToleranceShares, StandardErrorsAreTheScatterOverSeeds) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), all_tolerances());
  constexpr int kSeeds = 40;
  const std::size_t sources = model.sources.size();
  std::vector<double> sum(2 * sources), square(2 * sources), stated(2 * sources);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto shares =
        tolerance_shares(model, {.samples = 4096, .seed = 100U + static_cast<std::uint64_t>(seed)});
    for (std::size_t i = 0; i < 2 * sources; ++i) {
      const ToleranceShare& s = shares.sources[i / 2];
      const Estimate& e = i % 2 == 0 ? s.first_order : s.total;
      sum[i] += e.value;
      square[i] += e.value * e.value;
      stated[i] += e.standard_error * e.standard_error / kSeeds;
    }
  }
  for (std::size_t i = 0; i < 2 * sources; ++i) {
    const double variance = (square[i] - sum[i] * sum[i] / kSeeds) / (kSeeds - 1);
    // The ratio of a sample variance of 40 to its mean scatters by √(2/39): 4.5 of those.
    EXPECT_NEAR(variance / stated[i], 1.0, 4.5 * std::sqrt(2.0 / (kSeeds - 1)))
        << model.sources[i / 2].name();
  }
}

TEST(ToleranceShares, TotalIsAtLeastFirstOrder) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), all_tolerances());
  const auto shares = tolerance_shares(model, {.samples = 100'000, .seed = 3});
  double first = 0.0, total = 0.0;
  for (const ToleranceShare& s : shares.sources) {
    EXPECT_GE(s.total.value, s.first_order.value - 5.0 * std::hypot(s.total.standard_error,
                                                                    s.first_order.standard_error));
    first += s.first_order.value;
    total += s.total.value;
  }
  // The least over planets is no sum: what interacts lies between the two.
  EXPECT_LT(first, 1.0);
  EXPECT_GT(total, 1.0);
}

TEST(ToleranceShares, HalvedTolerancesAreModelsWithHalvedLimits) {
  ClearanceModel model = *clearance_model(thinned_bilateral_drive_gear(0.01), all_tolerances());
  for (ToleranceSource& s : model.sources) s.half_width_m *= 2.0;
  MonteCarloOptions options{.samples = 30'000, .seed = 4};
  const auto as_is = monte_carlo(model, options);
  options.limit_rad = as_is.lost_motion.quantiles[6].value;
  const auto shares = tolerance_shares(model, options);
  EXPECT_EQ(shares.yield, monte_carlo(model, options).yield.value);
  EXPECT_EQ(shares.jam_probability, as_is.jammed.value);
  EXPECT_GT(as_is.jammed.count, 100U);
  for (std::size_t i = 0; i < model.sources.size(); ++i) {
    ClearanceModel half = model;
    half.sources[i].half_width_m *= 0.5;
    const auto r = monte_carlo(half, options);
    const auto& halved = shares.sources[i].halved;
    // To a few roundings of a frequency.
    EXPECT_NEAR(halved.yield, r.yield.value, 1e-14);
    EXPECT_NEAR(halved.jam_probability, r.jammed.value, 1e-14);
    EXPECT_NEAR(halved.yield_gain.value, r.yield.value - shares.yield, 1e-14);
    EXPECT_NEAR(halved.quantile_99_rad, r.lost_motion.quantiles[7].value,
                2.0 * r.worst.greatest_rad / (1 << 13));
  }
}

TEST(ToleranceShares, AreTheSameBitsAtOneAndFourThreads) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(0.01), all_tolerances());
  const MonteCarloOptions options{.samples = 30'000, .seed = 5, .limit_rad = 3e-3};
  omp_set_num_threads(1);
  const auto one = tolerance_shares(model, options);
  omp_set_num_threads(4);
  const auto four = tolerance_shares(model, options);
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_EQ(one.variance_rad2, four.variance_rad2);
  EXPECT_EQ(one.quantile_99_rad, four.quantile_99_rad);
  for (std::size_t i = 0; i < one.sources.size(); ++i) {
    const ToleranceShare& a = one.sources[i];
    const ToleranceShare& b = four.sources[i];
    EXPECT_EQ(a.first_order.value, b.first_order.value);
    EXPECT_EQ(a.first_order.standard_error, b.first_order.standard_error);
    EXPECT_EQ(a.total.value, b.total.value);
    EXPECT_EQ(a.total.standard_error, b.total.standard_error);
    EXPECT_EQ(a.halved.yield, b.halved.yield);
    EXPECT_EQ(a.halved.quantile_99_rad, b.halved.quantile_99_rad);
  }
}

TEST(ToleranceShares, WithoutTolerancesThereIsNoVariance) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), {});
  const auto shares = tolerance_shares(model, {.samples = 1000, .seed = 6});
  EXPECT_TRUE(shares.sources.empty());
  EXPECT_NEAR(shares.variance_rad2, 0.0, 1e-24 * shares.mean_rad * shares.mean_rad);
}

}  // namespace
}  // namespace gear3k::backlash::tolerance_shares_test
