#include "backlash/random_gearbox.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/backlash/scatter_deviation.hpp"
#include "tests/backlash/toleranced_train.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::backlash::random_gearbox_test {
namespace {

constexpr ScatterOptions kUniformScatter{.scatter = Scatter::kUniform, .sigma_level = 3.0};

/// Arguments at random, at all distances from the ends, and the ends.
std::vector<std::uint32_t> arguments() {
  std::mt19937 generator(3);
  std::vector<std::uint32_t> all{0U, 0xFFFFFFFFU, 0x7FFFFFFFU, 0x80000000U};
  for (int i = 0; i < 20000; ++i) {
    const auto n = static_cast<std::uint32_t>(generator()) >> (static_cast<unsigned>(i) % 32U);
    all.push_back(n);
    all.push_back(~n);
  }
  return all;
}
double argument(std::uint32_t r) { return 0x1p-32 * (static_cast<double>(r) + 0.5); }

class SigmaLevel : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Levels, SigmaLevel, ::testing::Values(0.5, 1.0, 2.0, 3.0, 4.0, 6.0));

TEST_P(SigmaLevel, NumbersFollowTheQuantilesOfATruncatedNormalDistribution) {
  const double level = GetParam();
  const OctaveTable table = number_table({.scatter = Scatter::kNormal, .sigma_level = level});
  const boost::math::normal_distribution<long double> normal;
  LargestDeviation largest;
  int at = 0;
  for (const std::uint32_t r : arguments()) {
    const long double low = cdf(normal, -static_cast<long double>(level));
    const long double high = cdf(complement(normal, static_cast<long double>(level)));
    const long double u = argument(r), v = argument(~r);
    // From the nearer end, so that the tails keep their digits.
    const long double q = u < 0.5L ? quantile(normal, low + u * (1.0L - low - high))
                                   : quantile(complement(normal, high + v * (1.0L - low - high)));
    largest.see(at++, table(r) - static_cast<double>(q / static_cast<long double>(level)), 2e-7);
  }
  largest.expect_allowed("quantile");
}

TEST_P(SigmaLevel, RadiiFollowTheQuantilesOfAPlaneNormalDistributionCutAtTheCircle) {
  const double level = GetParam();
  const OctaveTable table = radius_table({.scatter = Scatter::kNormal, .sigma_level = level});
  // By the distribution function: u = (1 − e^{−ρ²/2})/(1 − e^{−L²/2}).
  LargestDeviation largest;
  int at = 0;
  for (const std::uint32_t r : arguments()) {
    const long double within = -std::expm1(-0.5L * level * level);
    const long double v = argument(~r);
    // Share beyond the radius: of what is cut off and of v.
    const long double log_beyond = r < 0x80000000U
                                       ? std::log1p(-static_cast<long double>(argument(r)) * within)
                                       : std::log(std::exp(-0.5L * level * level) + v * within);
    const double rho = static_cast<double>(std::sqrt(-2.0L * log_beyond));
    largest.see(at++, table(r) - rho / level, 2e-7);
  }
  largest.expect_allowed("radius");
}

TEST_P(SigmaLevel, ValuesStayWithinLimitsAndRise) {
  for (const Scatter scatter : {Scatter::kNormal, Scatter::kUniform}) {
    const ScatterOptions options{.scatter = scatter, .sigma_level = GetParam()};
    const OctaveTable number = number_table(options), radius = radius_table(options);
    EXPECT_GE(number(0U), -1.0);
    EXPECT_LE(number(0xFFFFFFFFU), 1.0);
    EXPECT_GE(radius(0U), 0.0);
    EXPECT_LE(radius(0xFFFFFFFFU), 1.0);
    auto all = arguments();
    std::sort(all.begin(), all.end());
    for (std::size_t i = 1; i < all.size(); ++i) {
      // Rounding of a cell's polynomial.
      EXPECT_GE(number(all[i]), number(all[i - 1]) - 1e-14) << all[i];
      EXPECT_GE(radius(all[i]), radius(all[i - 1]) - 1e-14) << all[i];
    }
  }
}

TEST_P(SigmaLevel, StatedDeviationsAreIntegralsOfTheDensities) {
  const double level = GetParam();
  const ScatterOptions options{.scatter = Scatter::kNormal, .sigma_level = level};
  using Rule = boost::math::quadrature::gauss_kronrod<double, 61>;
  const auto integral = [&](auto f, double low) {
    return Rule::integrate(f, low, level, 10, 1e-13);
  };
  const double number = integral([](double q) { return q * q * std::exp(-0.5 * q * q); }, -level) /
                        integral([](double q) { return std::exp(-0.5 * q * q); }, -level);
  EXPECT_NEAR(number_deviation(options), std::sqrt(number) / level, 1e-12);
  // One component's share of the mean square radius.
  const double radius = integral([](double q) { return q * q * q * std::exp(-0.5 * q * q); }, 0.0) /
                        integral([](double q) { return q * std::exp(-0.5 * q * q); }, 0.0);
  EXPECT_NEAR(component_deviation(options), std::sqrt(0.5 * radius) / level, 1e-12);
}

TEST(UniformScatter, IsEvenOnTheIntervalAndOverTheCircle) {
  const OctaveTable number = number_table(kUniformScatter), radius = radius_table(kUniformScatter);
  for (const std::uint32_t r : arguments()) {
    EXPECT_NEAR(number(r), 2.0 * argument(r) - 1.0, 1e-14);
    // A share r² of the area lies within radius r.
    EXPECT_NEAR(radius(r) * radius(r), argument(r), 1e-7 * std::sqrt(argument(r)));
  }
  EXPECT_NEAR(number_deviation(kUniformScatter), std::sqrt(1.0 / 3.0), 1e-15);
  EXPECT_NEAR(component_deviation(kUniformScatter), 0.5, 1e-15);
}

TEST(UnitCircle, DirectionsAreThoseOfCosineAndSine) {
  const UnitCircleTable table;
  for (const std::uint32_t r : arguments()) {
    const double angle = 2.0 * std::numbers::pi * argument(r);
    const auto [x, y] = table(r);
    EXPECT_NEAR(x, std::cos(angle), 5e-12);
    EXPECT_NEAR(y, std::sin(angle), 5e-12);
    EXPECT_LE(x * x + y * y, 1.0 + 1e-15);
  }
}

class RandomDeviations : public ::testing::TestWithParam<Scatter> {
 protected:
  const ClearanceModel model_ = *clearance_model(thinned_bilateral_drive_gear(), all_tolerances());
  const ScatterOptions scatter_{.scatter = GetParam(), .sigma_level = 3.0};
  [[nodiscard]] double half_width(std::size_t d) const {
    return model_.sources[model_.deviations[d].source].half_width_m;
  }
};
INSTANTIATE_TEST_SUITE_P(Scatters, RandomDeviations,
                         ::testing::Values(Scatter::kNormal, Scatter::kUniform));

TEST_P(RandomDeviations, StayWithinTheirLimitsWithTheirMeansAndDeviations) {
  const RandomGearbox random(model_, scatter_, 11);
  constexpr std::uint64_t kGearboxes = 40000;
  std::vector<double> sum_x(model_.deviations.size()), sum_xx(sum_x), sum_y(sum_x), sum_yy(sum_x);
  for (std::uint64_t g = 0; g < kGearboxes; ++g) {
    const auto values = random.deviations(g);
    for (std::size_t d = 0; d < values.size(); ++d) {
      const double x = values[d].x_m / half_width(d), y = values[d].y_m / half_width(d);
      ASSERT_LE(std::hypot(x, y), 1.0 + 1e-15);
      sum_x[d] += x;
      sum_xx[d] += x * x;
      sum_y[d] += y;
      sum_yy[d] += y * y;
    }
  }
  for (std::size_t d = 0; d < sum_x.size(); ++d) {
    const bool planar = model_.deviations[d].planar;
    const double sd = planar ? component_deviation(scatter_) : number_deviation(scatter_);
    // 5 standard errors of the mean, and of the variance (a fourth moment of at most 3 sd⁴).
    const double mean_error = 5.0 * sd / std::sqrt(kGearboxes);
    const double square_error = 5.0 * sd * sd * std::sqrt(2.0 / kGearboxes);
    EXPECT_NEAR(sum_x[d] / kGearboxes, 0.0, mean_error) << d;
    EXPECT_NEAR(sum_xx[d] / kGearboxes, sd * sd, square_error) << d;
    EXPECT_NEAR(sum_y[d] / kGearboxes, 0.0, planar ? mean_error : 0.0) << d;
    EXPECT_NEAR(sum_yy[d] / kGearboxes, planar ? sd * sd : 0.0, planar ? square_error : 0.0) << d;
  }
}

TEST_P(RandomDeviations, AreUncorrelated) {
  const RandomGearbox random(model_, scatter_, 12);
  const GearboxBatch batch(model_);
  const std::size_t components = batch.components().size();
  constexpr std::uint64_t kBatches = 600;
  std::vector<double> products(components * components), squares(components);
  std::vector<Lanes> values;
  for (std::uint64_t g = 0; g < kBatches; ++g) {
    random.draw(g * kBatch, values);
    for (std::size_t i = 0; i < components; ++i) {
      for (std::size_t b = 0; b < kBatch; ++b) {
        squares[i] += values[i].lane[b] * values[i].lane[b];
        for (std::size_t j = 0; j < i; ++j) {
          products[i * components + j] += values[i].lane[b] * values[j].lane[b];
        }
      }
    }
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < components; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      largest = std::max(
          largest, std::abs(products[i * components + j]) / std::sqrt(squares[i] * squares[j]));
    }
  }
  // 4095 coefficients with a standard error of 1/√19200 each: 5.5 of those.
  EXPECT_LT(largest, 5.5 / std::sqrt(static_cast<double>(kBatches * kBatch)));
}

TEST_P(RandomDeviations, OfABatchAreThoseOfItsGearboxes) {
  const RandomGearbox random(model_, scatter_, 13);
  std::vector<Lanes> values;
  const std::uint64_t first = 4096 + 5;
  random.draw(first, values);
  const auto components = GearboxBatch(model_).components();
  for (std::size_t b = 0; b < kBatch; ++b) {
    const auto alone = random.deviations(first + b);
    for (std::size_t c = 0; c < components.size(); ++c) {
      const DeviationValue& v = alone[components[c].deviation];
      EXPECT_EQ(values[c].lane[b], components[c].y ? v.y_m : v.x_m);
    }
  }
}

TEST_P(RandomDeviations, DependOnSeedStreamAndIndex) {
  const auto first = [&](std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
    return RandomGearbox(model_, scatter_, seed, stream).deviations(index)[0].x_m;
  };
  EXPECT_EQ(first(1, 0, 0), first(1, 0, 0));
  EXPECT_NE(first(1, 0, 0), first(2, 0, 0));
  EXPECT_NE(first(1, 0, 0), first(1, 1, 0));
  EXPECT_NE(first(1, 0, 0), first(1, 0, 1));
}

TEST(RandomDeviations, RefuseASigmaLevelThatIsNotPositive) {
  const auto model = *clearance_model(thinned_bilateral_drive_gear(), all_tolerances());
  for (const double level : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW(RandomGearbox(model, {.scatter = Scatter::kNormal, .sigma_level = level}, 1),
                 std::invalid_argument);
  }
}

TEST(GearboxBatch, GivesTheBitsOfPlaysAndOutputRange) {
  RandomToleranced trains(21);
  int jammed = 0;
  for (int i = 0; i < 200; ++i) {
    const ClearanceModel model = trains.model(i % 2 == 0);
    const RandomGearbox random(model, kUniformScatter, 5);
    const GearboxBatch batch(model);
    std::vector<Lanes> values;
    random.draw(0, values);
    std::vector<const Lanes*> pointers;
    pointers.reserve(values.size());
    for (const Lanes& v : values) pointers.push_back(&v);
    BatchRange range{};
    batch.ranges(pointers, range);
    for (std::size_t b = 0; b < kBatch; ++b) {
      const OutputRange alone = output_range(model.levers, plays(model, random.deviations(b)));
      EXPECT_EQ(range.width_rad.lane[b], alone.width_rad());
      EXPECT_EQ(range.margin_m.lane[b], alone.margin_m);
      jammed += alone.assembles() ? 0 : 1;
    }
  }
  EXPECT_GT(jammed, 200);
  EXPECT_LT(jammed, 6200);
}

}  // namespace
}  // namespace gear3k::backlash::random_gearbox_test
