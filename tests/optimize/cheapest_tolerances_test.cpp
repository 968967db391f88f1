// The cheapest tolerances, against every combination of steps.

#include "optimize/cheapest_tolerances.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/backlash/toleranced_train.hpp"

namespace gear3k::optimize::cheapest_tolerances_test {
namespace {

using backlash::ClearanceModel, backlash::DeviationLimits, backlash::GearTolerances,
    backlash::ToleranceKind, backlash::Tolerances;

constexpr int kMostSteps = 6;
constexpr double kEps = 1e-9;
using Steps = std::vector<int>;

double factor_of(int step) { return std::pow(2.0, 0.5 * step); }

/// The same gearboxes at any combination of steps: bounds of the plays are linear in each source.
class EveryCombination {
 public:
  EveryCombination(const ClearanceModel& model, const CheapestOptions& options)
      : EveryCombination(model, options, options.samples, options.seed) {}
  /// Of the series that verifies the result.
  static EveryCombination verifying(const ClearanceModel& model, const CheapestOptions& options) {
    return {model, options, options.verifying_samples, options.seed + 2};
  }

  [[nodiscard]] double cost(const Steps& steps) const {
    double sum = 0.0;
    for (std::size_t s = 0; s < steps.size(); ++s) {
      sum += options_.cost[static_cast<std::size_t>(model_.sources[s].kind)] / factor_of(steps[s]);
    }
    return sum;
  }

  [[nodiscard]] double yield(const Steps& steps) const {
    std::size_t good = 0;
    std::vector<backlash::PlanetPlay> plays(static_cast<std::size_t>(model_.planets));
    std::vector<double> bound;
    for (const auto& of_source : moves_) {
      bound = model_.middle_m;
      for (std::size_t s = 0; s < steps.size(); ++s) {
        const double factor = factor_of(steps[s]);
        for (std::size_t b = 0; b < bound.size(); ++b) bound[b] += factor * of_source[s][b];
      }
      for (int p = 0; p < model_.planets; ++p) {
        for (int k = 0; k < train::kMeshCount; ++k) {
          plays[static_cast<std::size_t>(p)][static_cast<std::size_t>(k)] = {
              .lower_m = bound[backlash::bound_index(p, k, false)],
              .upper_m = bound[backlash::bound_index(p, k, true)]};
        }
      }
      const auto range = backlash::output_range(model_.levers, plays);
      good += range.assembles() && range.width_rad() <= options_.limit_rad ? 1U : 0U;
    }
    return static_cast<double>(good) / static_cast<double>(moves_.size());
  }

  /// Least cost at which a yield is reached; infinity where it is nowhere.
  [[nodiscard]] double least_cost(double least_yield) const {
    const std::size_t n = model_.sources.size();
    std::vector<std::pair<double, Steps>> all;
    Steps steps(n, -kMostSteps);
    for (;;) {
      all.emplace_back(cost(steps), steps);
      std::size_t s = 0;
      while (s < n && ++steps[s] > kMostSteps) steps[s++] = -kMostSteps;
      if (s == n) break;
    }
    std::ranges::stable_sort(all, {}, &std::pair<double, Steps>::first);
    for (const auto& [price, at] : all) {
      if (yield(at) >= least_yield) return price;
    }
    return std::numeric_limits<double>::infinity();
  }

 private:
  EveryCombination(const ClearanceModel& model, const CheapestOptions& options,
                   std::uint64_t samples, std::uint64_t seed)
      : model_(model), options_(options) {
    const backlash::RandomGearbox gearboxes(model, options.scatter, seed);
    moves_.reserve(samples);
    for (std::uint64_t i = 0; i < samples; ++i) {
      const auto values = gearboxes.deviations(i);
      std::vector<std::vector<double>> of_source(model.sources.size(),
                                                 std::vector<double>(model.middle_m.size(), 0.0));
      for (std::size_t k = 0; k < values.size(); ++k) {
        const backlash::Deviation& d = model.deviations[k];
        for (const auto& e : d.x) of_source[d.source][e.bound] += e.coefficient * values[k].x_m;
        for (const auto& e : d.y) of_source[d.source][e.bound] += e.coefficient * values[k].y_m;
      }
      moves_.push_back(std::move(of_source));
    }
  }

  const ClearanceModel& model_;
  const CheapestOptions& options_;
  std::vector<std::vector<std::vector<double>>> moves_;  ///< by gearbox, source, bound
};

Steps steps_of(const CheapestTolerances& result) {
  Steps steps;
  steps.reserve(result.factor.size());
  for (const double factor : result.factor) {
    steps.push_back(static_cast<int>(std::lround(2.0 * std::log2(factor))));
    EXPECT_NEAR(factor, factor_of(steps.back()), kEps);
    EXPECT_LE(std::abs(steps.back()), kMostSteps);
  }
  return steps;
}

/// What the header promises of any result that reaches the yield.
/// @returns the yield that its own series was asked for: `yield`, or, where the verifying series
///   fell short of it, at most what it has
double expect_no_single_step_or_exchange_saves(const CheapestTolerances& result,
                                               const EveryCombination& brute, double yield) {
  const Steps at = steps_of(result);
  const double here = brute.cost(at);
  EXPECT_NEAR(result.cost, here, kEps * here + kEps);
  EXPECT_GE(brute.yield(at), yield);
  double best = 0.0;
  for (std::size_t up = 0; up < at.size(); ++up) {
    if (at[up] == kMostSteps) continue;
    for (std::size_t down = 0; down < at.size(); ++down) {
      Steps trial = at;
      ++trial[up];
      if (down != up) {
        if (at[down] == -kMostSteps) continue;
        --trial[down];
      }
      if (brute.cost(trial) < here - 1e-11) best = std::max(best, brute.yield(trial));
    }
  }
  EXPECT_LT(best, brute.yield(at));
  return best < yield ? yield : brute.yield(at);
}

/// Limit of the lost motion, `part` of the way from the middle of all tolerances to the worst case.
double limit_at(const ClearanceModel& model, double part) {
  const backlash::WorstCase worst = backlash::worst_case(model);
  return worst.middle_rad + part * (worst.greatest_rad - worst.middle_rad);
}

/// Two to four sources of a random kind, a random limit and random costs.
struct Task {
  ClearanceModel model;
  CheapestOptions options;
};
class RandomTask {
 public:
  explicit RandomTask(unsigned seed) : random_(seed) {}

  Task task(int sources) {
    Tolerances t;
    std::vector<int> kinds(12);
    std::iota(kinds.begin(), kinds.end(), 0);
    std::shuffle(kinds.begin(), kinds.end(), random_);
    for (int k = 0; k < sources; ++k) add(t, kinds[static_cast<std::size_t>(k)]);
    Task result{.model = *backlash::clearance_model(
                    backlash::thinned_bilateral_drive_gear(between(0.01, 0.05)), t),
                .options = {}};
    for (double& cost : result.options.cost) cost = between(0.2, 4.0);
    result.options.limit_rad = limit_at(result.model, between(0.005, 0.06));
    result.options.samples = 1000;
    result.options.verifying_samples = 4000;
    result.options.seed = random_();
    // Turn about, more and less than the stated tolerances reach.
    const double stated = cheapest_tolerances(result.model, at_once(result.options)).stated_yield;
    more_ = !more_;
    result.options.yield = more_ ? stated + 0.5 * (1.0 - stated) : stated - between(0.01, 0.1);
    return result;
  }

 private:
  /// As they are stated, without a search.
  static CheapestOptions at_once(CheapestOptions options) {
    options.stop = [] { return true; };
    return options;
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  void add(Tolerances& t, int kind) {
    switch (kind) {
      case 0:
        t.pin_position_m = between(5e-6, 30e-6);
        break;
      case 1:
        t.planet_phase_rad = {.lower = -between(1e-4, 6e-4), .upper = between(1e-4, 6e-4)};
        break;
      default: {
        GearTolerances& g = t.gears[static_cast<std::size_t>(kind % train::kGearCount)];
        if (kind < 2 + train::kGearCount) {
          g.tooth_thickness_m = {.lower = -between(5e-6, 40e-6), .upper = 0.0};
        } else {
          g.runout_m = between(5e-6, 40e-6);
        }
      }
    }
  }
  std::mt19937 random_;
  bool more_ = false;
};

class CheapestOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Sources, CheapestOf, testing::Values(2, 3, 4));

TEST_P(CheapestOf, IsALocalOptimumAndAtMostAQuarterAboveTheCheapestOfAllCombinations) {
  RandomTask random(static_cast<unsigned>(GetParam()));
  int reached = 0;
  int widened = 0;
  int at_once = 0;  // the verifying series agreed
  double worst = 1.0;
  double sum = 0.0;
  constexpr int kTrials = 4;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Task task = random.task(GetParam());
    const CheapestTolerances result = cheapest_tolerances(task.model, task.options);
    const EveryCombination brute(task.model, task.options);
    const Steps stated(task.model.sources.size(), 0);
    EXPECT_NEAR(result.stated_cost, brute.cost(stated), kEps * result.stated_cost);
    const auto verifying = EveryCombination::verifying(task.model, task.options);
    EXPECT_EQ(result.stated_yield, verifying.yield(stated));
    EXPECT_EQ(result.yield, verifying.yield(steps_of(result)));
    EXPECT_EQ(result.reached, result.yield >= task.options.yield);
    if (!result.reached) {
      EXPECT_EQ(steps_of(result), Steps(stated.size(), -kMostSteps));
      continue;
    }
    ++reached;
    widened += result.stated_yield >= task.options.yield ? 1 : 0;
    const double asked = expect_no_single_step_or_exchange_saves(result, brute, task.options.yield);
    at_once += asked == task.options.yield ? 1 : 0;
    const double least = brute.least_cost(asked);
    EXPECT_LE(least, result.cost * (1.0 + kEps));
    worst = std::max(worst, result.cost / least);
    sum += result.cost / least;
  }
  EXPECT_GE(reached, 3);
  EXPECT_GE(at_once, 1);
  EXPECT_EQ(widened, kTrials / 2);
  EXPECT_LE(worst, 1.25);
  EXPECT_LE(sum / reached, 1.06);
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("mean", std::to_string(sum / reached));
}

/// Thicknesses of the three central gears: all planets are alike.
ClearanceModel central_thicknesses() {
  Tolerances t;
  for (const int gear : {train::kS, train::kR1, train::kR2}) {
    t.gears[static_cast<std::size_t>(gear)].tooth_thickness_m = {.lower = -20e-6, .upper = 0.0};
  }
  return *backlash::clearance_model(backlash::thinned_bilateral_drive_gear(), t);
}

CheapestOptions options_with(double limit_rad, double cost) {
  CheapestOptions options{
      .yield = 0.9, .limit_rad = limit_rad, .samples = 1000, .verifying_samples = 1000};
  options.cost.fill(cost);
  return options;
}

TEST(CheapestTolerances, AreAllTheWidestWhereNothingLimitsThem) {
  const ClearanceModel model = central_thicknesses();
  const auto result = cheapest_tolerances(model, options_with(1.0, 1.0));
  EXPECT_TRUE(result.reached);
  EXPECT_EQ(result.stated_yield, 1.0);
  EXPECT_EQ(steps_of(result), Steps(3, kMostSteps));
  EXPECT_NEAR(result.cost, 3.0 / 8.0, kEps);
  EXPECT_NEAR(result.stated_cost, 3.0, kEps);
}

TEST(CheapestTolerances, StayAsStatedWhereTheMiddleItselfIsBeyondTheLimit) {
  const ClearanceModel model = central_thicknesses();
  const double middle = backlash::worst_case(model).middle_rad;
  const auto result = cheapest_tolerances(model, options_with(0.9 * middle, 1.0));
  EXPECT_FALSE(result.reached);
  EXPECT_EQ(result.yield, 0.0);
  EXPECT_EQ(steps_of(result), Steps(3, 0));
  EXPECT_EQ(result.cost, result.stated_cost);
}

TEST(CheapestTolerances, AreRefusedForAYieldThatTheirSeriesDoesNotTellFromOne) {
  const ClearanceModel model = central_thicknesses();
  CheapestOptions options = options_with(1.0, 1.0);
  options.yield = 0.999;
  EXPECT_TRUE(cheapest_tolerances(model, options).reached);
  options.yield = 0.9991;
  EXPECT_THROW(cheapest_tolerances(model, options), std::invalid_argument);
}

TEST(CheapestTolerances, ThatCostNothingStayAsStatedOnceTheYieldIsReached) {
  const ClearanceModel model = central_thicknesses();
  const auto wide = cheapest_tolerances(model, options_with(1.0, 0.0));
  EXPECT_TRUE(wide.reached);
  EXPECT_EQ(wide.cost, 0.0);
  EXPECT_EQ(steps_of(wide), Steps(3, 0));
  const double middle = backlash::worst_case(model).middle_rad;
  const auto narrow = cheapest_tolerances(model, options_with(1.01 * middle, 0.0));
  EXPECT_LT(narrow.stated_yield, 0.9);
  EXPECT_TRUE(narrow.reached);
  EXPECT_EQ(narrow.cost, 0.0);
}

TEST(CheapestTolerances, ASourceWithoutCostIsTightenedInPlaceOfTheOthers) {
  Tolerances t;
  t.center_distance_m = {.lower = -10e-6, .upper = 10e-6};
  t.gears[train::kR2].tooth_thickness_m = {.lower = -20e-6, .upper = 0.0};
  t.gears[train::kR1].tooth_thickness_m = {.lower = -20e-6, .upper = 0.0};
  const auto model = *backlash::clearance_model(backlash::thinned_bilateral_drive_gear(), t);
  CheapestOptions options = options_with(limit_at(model, 0.5), 1.0);
  options.cost[static_cast<std::size_t>(ToleranceKind::kCenterDistance)] = 0.0;
  const auto result = cheapest_tolerances(model, options);
  ASSERT_TRUE(result.reached);
  EXPECT_GT(result.stated_yield, options.yield);
  EXPECT_LT(steps_of(result)[0], 0) << "the centre distance, by exchange alone";
  const EveryCombination brute(model, options);
  const double asked = expect_no_single_step_or_exchange_saves(result, brute, options.yield);
  EXPECT_LE(result.cost, 1.2 * brute.least_cost(asked));
}

TEST(CheapestTolerances, AreNoWiderThanPermitted) {
  const ClearanceModel model = central_thicknesses();
  CheapestOptions options = options_with(1.0, 1.0);
  options.may_widen = [](const std::vector<double>& factor) {
    return factor[0] < 1.1 && factor[1] * factor[2] < 2.1;
  };
  const auto result = cheapest_tolerances(model, options);
  EXPECT_TRUE(result.reached);
  EXPECT_EQ(steps_of(result)[0], 0);
  // 1/a + 1/b is least at a = b where only their product is limited.
  EXPECT_EQ(steps_of(result), (Steps{0, 1, 1}));
}

// The few gearboxes of the search's own series all jam, whatever is tightened by a step; of the
// many that verify the result a few do not.
TEST(CheapestTolerances, WhereNoStepGainsTheCheapestSourceIsTightenedFirst) {
  constexpr double kWide_m = 120e-6;  // most gearboxes jam
  Tolerances t;
  t.pin_position_m = kWide_m;
  t.gears[train::kP1].tooth_thickness_m = {.lower = -kWide_m, .upper = kWide_m};
  t.gears[train::kP2].runout_m = kWide_m;
  const auto model = *backlash::clearance_model(backlash::thinned_bilateral_drive_gear(0.02), t);
  ASSERT_EQ(model.sources.size(), 3U);
  CheapestOptions options = options_with(limit_at(model, 1.0), 4.0);
  options.yield = 0.7;
  options.samples = 4;
  options.verifying_samples = 20'000;
  for (std::size_t cheapest = 0; cheapest < model.sources.size(); ++cheapest) {
    options.cost.fill(4.0);
    options.cost[static_cast<std::size_t>(model.sources[cheapest].kind)] = 0.2;
    options.stop = [asked = 0]() mutable { return ++asked > 2; };  // after the first step
    const CheapestTolerances result = cheapest_tolerances(model, options);
    ASSERT_FALSE(result.reached);
    ASSERT_GT(result.yield, result.stated_yield);
    Steps expected(model.sources.size(), 0);
    expected[cheapest] = -1;
    EXPECT_EQ(steps_of(result), expected) << cheapest;
  }
}

TEST(CheapestTolerances, StoppedAtOnceAreThoseStated) {
  CheapestOptions options = options_with(0.0, 1.0);
  options.stop = [] { return true; };
  const auto result = cheapest_tolerances(central_thicknesses(), options);
  EXPECT_FALSE(result.reached);
  EXPECT_EQ(steps_of(result), Steps(3, 0));
}

/// Each source of the model of the scaled tolerances is the stated one times its factor.
void expect_scaled_model(const train::TrainParameters<double>& drawn, const Tolerances& stated,
                         const ClearanceModel& model, const std::vector<double>& factor) {
  const Tolerances result = scaled(stated, model, factor, std::cos(drawn.pressure_angle_rad));
  const auto again = backlash::clearance_model(drawn, result);
  ASSERT_TRUE(again);
  ASSERT_EQ(again->sources.size(), model.sources.size());
  for (std::size_t s = 0; s < model.sources.size(); ++s) {
    EXPECT_EQ(again->sources[s].name(), model.sources[s].name());
    const double asked = factor[s] * model.sources[s].half_width_m;
    EXPECT_NEAR(again->sources[s].half_width_m, asked, 1e-12 * asked + 1e-18) << s;
  }
  // About the same middles, which neither add nor take backlash.
  for (std::size_t b = 0; b < model.middle_m.size(); ++b) {
    EXPECT_NEAR(again->middle_m[b], model.middle_m[b], 1e-15);
  }
}

TEST(ScaledTolerances, HaveTheScaledSourcesAndTheSameMiddles) {
  const auto drawn = backlash::thinned_bilateral_drive_gear();
  Tolerances stated = backlash::all_tolerances();
  stated.center_distance_m = {.lower = -3e-6, .upper = 9e-6};
  stated.planet_phase_rad = {.lower = -1e-4, .upper = 4e-4};
  const auto model = *backlash::clearance_model(drawn, stated);
  ASSERT_EQ(model.sources.size(), 3U + 4U * train::kGearCount);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> step(-kMostSteps, kMostSteps);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<double> factor(model.sources.size());
    for (double& f : factor) f = factor_of(step(random));
    expect_scaled_model(drawn, stated, model, factor);
  }
}

TEST(ScaledTolerances, OfFactorsOfOneAreTheStatedOnes) {
  const auto drawn = backlash::thinned_bilateral_drive_gear();
  Tolerances stated = backlash::all_tolerances();
  stated.gears[train::kS].cumulative_pitch_m = 5e-6;  // less than run-out alone makes of it
  stated.gears[train::kR2].runout_m = 0.0;
  const auto model = *backlash::clearance_model(drawn, stated);
  const Tolerances result = scaled(stated, model, std::vector<double>(model.sources.size(), 1.0),
                                   std::cos(drawn.pressure_angle_rad));
  constexpr double kRounding = 1e-18;
  for (std::size_t i = 0; i < result.gears.size(); ++i) {
    const GearTolerances& a = result.gears[i];
    const GearTolerances& b = stated.gears[i];
    EXPECT_NEAR(a.tooth_thickness_m.lower, b.tooth_thickness_m.lower, kRounding);
    EXPECT_NEAR(a.tooth_thickness_m.upper, b.tooth_thickness_m.upper, kRounding);
    EXPECT_NEAR(a.runout_m, b.runout_m, kRounding);
    EXPECT_NEAR(a.cumulative_pitch_m, b.cumulative_pitch_m, kRounding) << i;
    EXPECT_NEAR(a.single_pitch_m, b.single_pitch_m, kRounding);
  }
  EXPECT_EQ(result.pin_position_m, stated.pin_position_m);
}

TEST(ScaledTolerances, WhereRunoutIsAllOfTheCumulativePitchNoSourceAppears) {
  const auto drawn = backlash::thinned_bilateral_drive_gear();
  Tolerances stated;
  stated.gears[train::kR1].runout_m = 10e-6;
  for (const double cumulative_m : {4e-6, 10e-6}) {
    stated.gears[train::kR1].cumulative_pitch_m = cumulative_m;
    const auto model = *backlash::clearance_model(drawn, stated);
    ASSERT_EQ(model.sources.size(), 1U);
    for (int step = -kMostSteps; step <= kMostSteps; ++step) {
      expect_scaled_model(drawn, stated, model, {factor_of(step)});
    }
  }
}

}  // namespace
}  // namespace gear3k::optimize::cheapest_tolerances_test
