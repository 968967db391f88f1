#include "backlash/monte_carlo.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "tests/backlash/scatter_deviation.hpp"
#include "tests/backlash/toleranced_train.hpp"

namespace gear3k::backlash::monte_carlo_test {
namespace {

constexpr ScatterOptions kUniformScatter{.scatter = Scatter::kUniform, .sigma_level = 3.0};

/// Nothing on planets, nothing that turns: the lost motion is linear in the deviations.
Tolerances alike_planets() {
  Tolerances t;
  t.gears[train::kS].tooth_thickness_m = {.lower = -20e-6, .upper = 4e-6};
  t.gears[train::kR1].tooth_thickness_m = {.lower = -10e-6, .upper = 0.0};
  t.gears[train::kR2].tooth_thickness_m = {.lower = -15e-6, .upper = 5e-6};
  return t;
}

/// Σ (weight_k cos α · half width)² of the three thicknesses, over the square of
/// number_deviation().
double closed_form_square(const train::TrainGeometry<double>& train) {
  const auto weight = kinematic_lost_motion(train, std::array{1.0, 1.0, 1.0});
  const double c = train.gears[train::kS].angle.cos;
  return std::pow(weight[0] * c * 12e-6, 2) + std::pow(weight[1] * c * 5e-6, 2) +
         std::pow(weight[2] * c * 10e-6, 2);
}

class MonteCarlo : public ::testing::TestWithParam<ScatterOptions> {};
INSTANTIATE_TEST_SUITE_P(Scatters, MonteCarlo,
                         ::testing::Values(ScatterOptions{}, kUniformScatter,
                                           ScatterOptions{.scatter = Scatter::kNormal,
                                                          .sigma_level = 2.0}));

TEST_P(MonteCarlo, LostMotionOfAlikePlanetsHasTheMomentsOfTheClosedForm) {
  const auto drawn = thinned_bilateral_drive_gear();
  const auto train = *train::make_train_geometry(drawn);
  const auto model = *clearance_model(drawn, alike_planets());
  const auto result = monte_carlo(model, {.samples = 400'000, .seed = 3, .scatter = GetParam()});
  auto j = normal_backlashes(train);
  const double c = train.gears[train::kS].angle.cos;
  // Middles of the limits: the teeth are thinner by 8, 5 and 5 µm.
  j[0] += 8e-6 * c;
  j[1] += 5e-6 * c;
  j[2] += 5e-6 * c;
  const double mean = output_lost_motion(train, j, LostMotionModel::kKinematic);
  const double deviation = number_deviation(GetParam()) * std::sqrt(closed_form_square(train));
  EXPECT_EQ(result.assembled.count, result.samples);
  const auto n = static_cast<double>(result.samples);
  EXPECT_NEAR(result.lost_motion.mean_rad, mean, 5.0 * deviation / std::sqrt(n));
  EXPECT_NEAR(result.lost_motion.deviation_rad, deviation, 5.0 * deviation / std::sqrt(2.0 * n));
  // The distribution is symmetric about its mean.
  EXPECT_NEAR(result.lost_motion.quantiles[4].value, mean, 5.0 * 1.5 * deviation / std::sqrt(n));
}

TEST_P(MonteCarlo, HalvedTolerancesHalveTheScatter) {
  ClearanceModel model = *clearance_model(thinned_bilateral_drive_gear(), all_tolerances());
  // Shared deviations only: a minimum over planets is not linear.
  std::erase_if(model.deviations, [](const Deviation& d) { return d.planet >= 0 || d.planar; });
  ClearanceModel half = model;
  for (ToleranceSource& s : half.sources) s.half_width_m *= 0.5;
  const MonteCarloOptions options{.samples = 50'000, .seed = 4, .scatter = GetParam()};
  const auto whole_result = monte_carlo(model, options);
  const auto half_result = monte_carlo(half, options);
  ASSERT_EQ(whole_result.jammed.count, 0U);
  EXPECT_NEAR(half_result.lost_motion.deviation_rad, 0.5 * whole_result.lost_motion.deviation_rad,
              1e-9 * whole_result.lost_motion.deviation_rad);
}

/// A mesh of the only planet is left with a backlash of `middle_m`, and one thickness scatters.
ClearanceModel one_tolerance(double middle_m) {
  auto drawn = thinned_bilateral_drive_gear();
  drawn.planets = 1;
  Tolerances t;
  t.gears[train::kS].tooth_thickness_m = {.lower = -10e-6, .upper = 10e-6};
  ClearanceModel model = *clearance_model(drawn, t);
  model.middle_m[bound_index(0, 0, false)] = -0.5 * middle_m;
  model.middle_m[bound_index(0, 0, true)] = 0.5 * middle_m;
  return model;
}

TEST(JamProbability, OfOneThicknessIsItsDistributionFunction) {
  const double cos_alpha = std::cos(20.0 * std::numbers::pi / 180.0);
  for (const double share : {-0.6, -0.1, 0.2, 0.5, 0.9}) {
    // j = middle − A cos α < 0 where A exceeds middle/cos α = share · half width.
    const ClearanceModel model = one_tolerance(share * 10e-6 * cos_alpha);
    const auto uniform =
        monte_carlo(model, {.samples = 200'000, .seed = 5, .scatter = kUniformScatter});
    const double expected = 0.5 * (1.0 - share);
    EXPECT_NEAR(uniform.jammed.value, expected, 5.0 * std::sqrt(expected * (1.0 - expected) / 2e5));
    EXPECT_LT(uniform.jammed.lower, uniform.jammed.value);
    EXPECT_GT(uniform.jammed.upper, uniform.jammed.value);
    const auto normal = monte_carlo(model, {.samples = 200'000, .seed = 5});
    const double beyond = 0.5 * std::erfc(3.0 / std::numbers::sqrt2);
    const double jams =
        (0.5 * std::erfc(3.0 * share / std::numbers::sqrt2) - beyond) / (1.0 - 2.0 * beyond);
    EXPECT_NEAR(normal.jammed.value, jams, 5.0 * std::sqrt(jams * (1.0 - jams) / 2e5));
  }
}

TEST(MonteCarloResults, CountEveryGearboxOnce) {
  ClearanceModel model = *clearance_model(thinned_bilateral_drive_gear(0.01), all_tolerances());
  for (ToleranceSource& s : model.sources) s.half_width_m *= 2.5;
  const MonteCarloOptions unlimited{.samples = 100'001, .seed = 6};
  const auto all = monte_carlo(model, unlimited);
  MonteCarloOptions limited = unlimited;
  limited.limit_rad = all.lost_motion.quantiles[4].value;  // the median
  const auto r = monte_carlo(model, limited);
  EXPECT_GT(r.jammed.count, 1000U);
  EXPECT_GT(r.assembled.count, 1000U);
  EXPECT_EQ(r.jammed.count + r.assembled.count, r.samples);
  EXPECT_EQ(r.yield.count + r.beyond_limit.count, r.assembled.count);
  EXPECT_EQ(all.yield.count, all.assembled.count);
  // Half of those that assemble lie below the median; within a bin of the fine histogram.
  EXPECT_NEAR(static_cast<double>(r.yield.count), 0.5 * static_cast<double>(r.assembled.count),
              0.001 * static_cast<double>(r.samples));
  std::uint64_t drawn = 0;
  for (const HistogramBin& bin : r.lost_motion.histogram) drawn += bin.count;
  EXPECT_EQ(drawn, r.assembled.count);
  EXPECT_LE(r.lost_motion.histogram.size(), 100U);
  EXPECT_FALSE(r.limit_of_99_percent_rad.has_value());
  EXPECT_TRUE(r.worst.can_jam());
}

TEST(MonteCarloResults, AreThoseOfTheGearboxesOneByOne) {
  ClearanceModel model = *clearance_model(thinned_bilateral_drive_gear(0.01), all_tolerances());
  for (ToleranceSource& s : model.sources) s.half_width_m *= 2.0;
  const MonteCarloOptions options{.samples = 10'007, .seed = 8, .limit_rad = 3e-3};
  const auto result = monte_carlo(model, options);
  const RandomGearbox random(model, options.scatter, options.seed);
  std::vector<double> lost, margin;
  std::uint64_t within = 0;
  for (std::uint64_t g = 0; g < options.samples; ++g) {
    const auto range = output_range(model.levers, plays(model, random.deviations(g)));
    margin.push_back(range.margin_m);
    if (!range.assembles()) continue;
    lost.push_back(range.width_rad());
    within += range.width_rad() <= *options.limit_rad ? 1U : 0U;
  }
  ASSERT_EQ(result.assembled.count, lost.size());
  EXPECT_EQ(result.yield.count, within);
  std::sort(lost.begin(), lost.end());
  std::sort(margin.begin(), margin.end());
  EXPECT_EQ(result.lost_motion.least_rad, lost.front());
  EXPECT_EQ(result.lost_motion.greatest_rad, lost.back());
  double mean = std::accumulate(lost.begin(), lost.end(), 0.0) / static_cast<double>(lost.size());
  double square = 0.0;
  for (const double x : lost) square += (x - mean) * (x - mean);
  const double deviation = std::sqrt(square / static_cast<double>(lost.size() - 1));
  EXPECT_NEAR(result.lost_motion.mean_rad, mean, 1e-12 * mean);
  EXPECT_NEAR(result.lost_motion.deviation_rad, deviation, 1e-10 * deviation);
  // The value at rank k lies between the sorted neighbours, to a bin's width.
  const auto expect_quantile = [](const std::vector<double>& sorted, const Quantile& q,
                                  double resolution) {
    const double rank = q.probability * static_cast<double>(sorted.size());
    const auto below = static_cast<std::size_t>(std::max(0.0, std::floor(rank) - 1.0));
    const auto above = std::min(sorted.size() - 1, static_cast<std::size_t>(std::ceil(rank)));
    EXPECT_GE(q.value, sorted[below] - resolution) << q.probability;
    EXPECT_LE(q.value, sorted[above] + resolution) << q.probability;
  };
  for (const Quantile& q : result.lost_motion.quantiles) {
    expect_quantile(lost, q, result.worst.greatest_rad / kFineBins);
  }
  for (const Quantile& q : result.margin) {
    expect_quantile(margin, q,
                    (result.worst.greatest_margin_m - result.worst.least_margin_m) / kFineBins);
  }
}

TEST(MonteCarloResults, LimitOf99PercentIsMetBy99Percent) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), all_tolerances());
  MonteCarloOptions options{.samples = 200'000, .seed = 9};
  const auto result = monte_carlo(model, options);
  ASSERT_TRUE(result.limit_of_99_percent_rad.has_value());
  options.limit_rad = result.limit_of_99_percent_rad;
  EXPECT_NEAR(monte_carlo(model, options).yield.value, 0.99, 5e-4);
}

bool same_bits(const MonteCarloResult& a, const MonteCarloResult& b) {
  const auto& x = a.lost_motion;
  const auto& y = b.lost_motion;
  const auto same_quantiles = [](const std::vector<Quantile>& p, const std::vector<Quantile>& q) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(),
                      [](const Quantile& s, const Quantile& t) { return s.value == t.value; });
  };
  return a.assembled.count == b.assembled.count && a.yield.count == b.yield.count &&
         x.mean_rad == y.mean_rad && x.deviation_rad == y.deviation_rad &&
         x.least_rad == y.least_rad && x.greatest_rad == y.greatest_rad &&
         same_quantiles(x.quantiles, y.quantiles) && same_quantiles(a.margin, b.margin) &&
         std::equal(x.histogram.begin(), x.histogram.end(), y.histogram.begin(), y.histogram.end(),
                    [](const HistogramBin& s, const HistogramBin& t) {
                      return s.lower == t.lower && s.upper == t.upper && s.count == t.count;
                    });
}

TEST(MonteCarloResults, AreTheSameBitsAtOneAndFourThreads) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(0.01), all_tolerances());
  const MonteCarloOptions options{.samples = 300'001, .seed = 10, .limit_rad = 3e-3};
  omp_set_num_threads(1);
  const auto one = monte_carlo(model, options);
  omp_set_num_threads(4);
  const auto four = monte_carlo(model, options);
  omp_set_num_threads(omp_get_num_procs());
  EXPECT_TRUE(same_bits(one, four));
  MonteCarloOptions other = options;
  other.seed = 11;
  EXPECT_FALSE(same_bits(one, monte_carlo(model, other)));
}

TEST(MonteCarloResults, OfASeriesThatIsEndedAreThoseOfAShorterOne) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), all_tolerances());
  MonteCarloOptions options{.samples = 3 * kWaveChunks * kChunkGearboxes, .seed = 12};
  std::vector<std::uint64_t> calls;
  options.progress = [&](std::uint64_t done) {
    calls.push_back(done);
    return calls.size() < 2;
  };
  const auto ended = monte_carlo(model, options);
  EXPECT_EQ(calls, (std::vector<std::uint64_t>{262'144, 524'288}));
  EXPECT_EQ(ended.samples, 524'288U);
  EXPECT_TRUE(same_bits(ended, monte_carlo(model, {.samples = 524'288, .seed = 12})));
}

TEST(MonteCarloResults, NeverExceedTheWorstCase) {
  RandomToleranced trains(41);
  for (int i = 0; i < 8; ++i) {
    const ClearanceModel model = trains.model(i % 2 == 0);
    for (const ScatterOptions& scatter : {kUniformScatter, ScatterOptions{}}) {
      const auto r = monte_carlo(model, {.samples = 200'000, .seed = 13, .scatter = scatter});
      if (r.assembled.count == 0) continue;
      EXPECT_LE(r.lost_motion.greatest_rad, r.worst.greatest_rad * (1.0 + 1e-13));
      EXPECT_GE(r.lost_motion.least_rad, r.worst.least_rad - 1e-13 * r.worst.greatest_rad);
      if (r.jammed.count > 0) {
        EXPECT_TRUE(r.worst.can_jam());
      }
    }
  }
}

TEST(MonteCarloResults, WithoutTolerancesAreTheDrawnGearbox) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), {});
  const auto r = monte_carlo(model, {.samples = 1000, .seed = 14});
  EXPECT_EQ(r.assembled.count, 1000U);
  EXPECT_NEAR(r.lost_motion.mean_rad, r.worst.middle_rad, 1e-13 * r.worst.middle_rad);
  EXPECT_EQ(r.lost_motion.least_rad, r.lost_motion.greatest_rad);
  EXPECT_NEAR(r.lost_motion.deviation_rad, 0.0, 1e-12 * r.worst.middle_rad);
}

TEST(MonteCarloResults, OfGearboxesThatAllJamHaveNoLostMotion) {
  const auto r = monte_carlo(one_tolerance(-30e-6), {.samples = 1000, .seed = 15});
  EXPECT_EQ(r.jammed.count, 1000U);
  EXPECT_EQ(r.jammed.upper, 1.0);
  EXPECT_TRUE(r.lost_motion.histogram.empty());
  EXPECT_FALSE(r.limit_of_99_percent_rad.has_value());
}

TEST(Proportions, HaveTheIntervalsOfClopperAndPearson) {
  // Closed forms at the ends: 1 − 0.025^{1/n}.
  const Proportion none = proportion(0, 50);
  EXPECT_EQ(none.lower, 0.0);
  EXPECT_NEAR(none.upper, 1.0 - std::pow(0.025, 1.0 / 50.0), 1e-12);
  const Proportion all = proportion(50, 50);
  EXPECT_NEAR(all.lower, std::pow(0.025, 1.0 / 50.0), 1e-12);
  EXPECT_EQ(all.upper, 1.0);
  // At the limits of the interval the tails of the binomial distribution hold 2.5 % each.
  const Proportion some = proportion(7, 50);
  const auto tail = [](double p, int from, int to) {
    double sum = 0.0;
    for (int k = from; k <= to; ++k) {
      sum += std::exp(std::lgamma(51.0) - std::lgamma(k + 1.0) - std::lgamma(51.0 - k) +
                      k * std::log(p) + (50 - k) * std::log1p(-p));
    }
    return sum;
  };
  EXPECT_NEAR(tail(some.lower, 7, 50), 0.025, 1e-9);
  EXPECT_NEAR(tail(some.upper, 0, 7), 0.025, 1e-9);
  EXPECT_THROW(proportion(2, 1), std::invalid_argument);
  EXPECT_THROW(proportion(0, 0), std::invalid_argument);
}

TEST(MonteCarloOptions, WithoutSamplesOrWithALimitThatIsNoNumberAreRefused) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), {});
  EXPECT_THROW(monte_carlo(model, {.samples = 0}), std::invalid_argument);
  EXPECT_THROW(monte_carlo(model, {.samples = 1, .limit_rad = std::nan("")}),
               std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::backlash::monte_carlo_test
