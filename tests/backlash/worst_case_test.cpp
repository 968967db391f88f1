#include "backlash/worst_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "backlash/random_gearbox.hpp"
#include "tests/backlash/toleranced_train.hpp"

namespace gear3k::backlash::worst_case_test {
namespace {

/// Rounding of sums of some dozens of terms of the size of the greatest value.
constexpr double kRounding = 1e-13;

class WorstCases : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Trains, WorstCases, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& below) {
                           return below.param ? "G2BelowOne" : "G2AboveOne";
                         });

void expect_within(const WorstCase& worst, const OutputRange& range) {
  const double size_m = std::max(std::abs(worst.least_margin_m), std::abs(worst.greatest_margin_m));
  EXPECT_GE(range.margin_m, worst.least_margin_m - kRounding * size_m);
  EXPECT_LE(range.margin_m, worst.greatest_margin_m + kRounding * size_m);
  if (!range.assembles()) return;
  EXPECT_LE(range.width_rad(), worst.greatest_rad * (1.0 + kRounding));
  EXPECT_GE(range.width_rad(), worst.least_rad - worst.greatest_rad * kRounding);
}

/// All deviations at ends of their intervals or on their circles.
std::vector<DeviationValue> at_ends(const ClearanceModel& model, RandomTrain& random) {
  std::vector<DeviationValue> values;
  for (const Deviation& d : model.deviations) {
    const double half = model.sources[d.source].half_width_m;
    const double angle = random.between(0.0, 2.0 * std::numbers::pi);
    values.push_back(
        d.planar ? DeviationValue{.x_m = half * std::cos(angle), .y_m = half * std::sin(angle)}
                 : DeviationValue{.x_m = random.count(0, 1) == 0 ? -half : half, .y_m = 0.0});
  }
  return values;
}

TEST_P(WorstCases, AreNeverExceeded) {
  RandomToleranced random(31);
  for (int i = 0; i < 100; ++i) {
    const ClearanceModel model = random.model(GetParam());
    const WorstCase worst = worst_case(model);
    for (const Scatter scatter : {Scatter::kNormal, Scatter::kUniform}) {
      const RandomGearbox gearbox(model, {.scatter = scatter, .sigma_level = 1.0}, 7);
      for (std::uint64_t g = 0; g < 200; ++g) {
        expect_within(worst, output_range(model.levers, plays(model, gearbox.deviations(g))));
      }
    }
    for (int g = 0; g < 400; ++g) {
      expect_within(worst, output_range(model.levers, plays(model, at_ends(model, random))));
    }
  }
}

/// Moves each deviation in turn to where a value is greatest, until none improves: a lower bound of
/// the greatest value that knows nothing of the forms.
template <class Value>  // double(std::span<const DeviationValue>)
double climbed(const ClearanceModel& model, std::vector<DeviationValue> at, Value value) {
  constexpr int kDirections = 72;
  double best = value(at);
  for (bool better = true; better;) {
    better = false;
    for (std::size_t d = 0; d < at.size(); ++d) {
      const double half = model.sources[model.deviations[d].source].half_width_m;
      const DeviationValue before = at[d];
      DeviationValue chosen = before;
      const auto attempt = [&](double x, double y) {
        at[d] = {.x_m = x, .y_m = y};
        const double v = value(at);
        if (v > best + 1e-12 * std::abs(best)) {
          best = v;
          chosen = at[d];
          better = true;
        }
      };
      if (model.deviations[d].planar) {
        for (int k = 0; k < kDirections; ++k) {
          const double angle = 2.0 * std::numbers::pi * k / kDirections;
          attempt(half * std::cos(angle), half * std::sin(angle));
        }
      } else {
        attempt(-half, 0.0);
        attempt(half, 0.0);
      }
      at[d] = chosen;
    }
  }
  return best;
}

/// Deviations that move a few bounds of some planets most, by the effects alone: where to climb
/// from.
std::vector<DeviationValue> towards_some_bounds(const ClearanceModel& model, RandomTrain& random) {
  std::vector<double> direction(model.middle_m.size(), 0.0);
  for (int k = random.count(1, 12); k > 0; --k) {
    const std::size_t bound = bound_index(random.count(0, model.planets - 1), random.count(0, 2),
                                          random.count(0, 1) == 1);
    direction[bound] = random.between(-2.0, 2.0);
  }
  std::vector<DeviationValue> values(model.deviations.size());
  for (std::size_t d = 0; d < values.size(); ++d) {
    const double half = model.sources[model.deviations[d].source].half_width_m;
    const auto slope = [&](const std::vector<PlayEffect>& effects) {
      double sum = 0.0;
      for (const PlayEffect& e : effects) sum += direction[e.bound] * e.coefficient;
      return sum;
    };
    const double x = slope(model.deviations[d].x), y = slope(model.deviations[d].y);
    const double size = std::hypot(x, y);
    if (size > 0.0) values[d] = {.x_m = half * x / size, .y_m = half * y / size};
  }
  return values;
}

TEST_P(WorstCases, LeastMarginAndLeastLostMotionAreReached) {
  RandomToleranced random(32);
  int without_jamming = 0;
  for (int i = 0; i < 12; ++i) {
    ClearanceModel model = random.model(GetParam(), 2, 3);
    // Every second one with room enough for all gearboxes to assemble.
    if (i % 2 == 0) {
      for (ToleranceSource& s : model.sources) s.half_width_m *= 0.1;
    }
    const WorstCase worst = worst_case(model);
    const auto range_of = [&](std::span<const DeviationValue> v) {
      return output_range(model.levers, plays(model, v));
    };
    std::vector<std::vector<DeviationValue>> starts;
    starts.reserve(10000);
    for (int k = 0; k < 10000; ++k) starts.push_back(towards_some_bounds(model, random));
    const auto climb_from_best = [&](auto value) {
      std::vector<std::pair<double, std::size_t>> order;
      order.reserve(starts.size());
      for (std::size_t k = 0; k < starts.size(); ++k) order.emplace_back(-value(starts[k]), k);
      std::sort(order.begin(), order.end());
      double best = -1.0;
      for (std::size_t k = 0; k < 30; ++k) {
        best = std::max(best, climbed(model, starts[order[k].second], value));
      }
      return best;
    };
    const double least_margin_m =
        -climb_from_best([&](const auto& v) { return -range_of(v).margin_m; });
    const double least_rad =
        -climb_from_best([&](const auto& v) { return -range_of(v).width_rad(); });
    // 72 directions miss that of a circle by 2.5° at most, 1 - cos of which is 1e-3 of its part.
    double swing_m = 0.0;
    for (const Deviation& d : model.deviations) {
      swing_m += d.planar ? model.sources[d.source].half_width_m : 0.0;
    }
    EXPECT_NEAR(least_margin_m, worst.least_margin_m, 2e-3 * swing_m);
    EXPECT_GE(least_margin_m, worst.least_margin_m - kRounding * 1e-3);
    if (worst.can_jam()) continue;
    ++without_jamming;
    EXPECT_NEAR(least_rad, worst.least_rad, 4e-3 * swing_m / model.levers.output_m);
  }
  EXPECT_GT(without_jamming, 3);
}

TEST_P(WorstCases, GreatestIsThatOfAlikePlanetsWithTheirGreatestBacklashes) {
  RandomToleranced random(33);
  int attained = 0;
  for (int i = 0; i < 100; ++i) {
    const ClearanceModel model = random.model(GetParam(), 2);
    const WorstCase worst = worst_case(model);
    if (!worst.greatest_attained) continue;
    ++attained;
    // What raises the lost motion of alike planets: each deviation at an end, planar ones of
    // planets outwards or inwards, those of sun and rings 0.
    std::vector<DeviationValue> at(model.deviations.size());
    const auto width = [&] { return output_range(model.levers, plays(model, at)).width_rad(); };
    std::vector<std::pair<int, bool>> seen;
    for (std::size_t s = 0; s < model.sources.size(); ++s) {
      const double half = model.sources[s].half_width_m;
      const bool flanks = model.sources[s].kind == ToleranceKind::kSinglePitch;
      const auto set = [&](double sign) {
        for (std::size_t d = 0; d < at.size(); ++d) {
          const Deviation& deviation = model.deviations[d];
          if (deviation.source != s) continue;
          if (!deviation.planar) {
            // Each single pitch opens its own flank.
            const bool opens =
                flanks && (deviation.x[0].bound % 2 == 1) == (deviation.x[0].coefficient > 0.0);
            at[d].x_m = flanks ? (opens ? half : -half) : sign * half;
          } else if (deviation.planet >= 0) {
            const double angle = 2.0 * std::numbers::pi * deviation.planet / model.planets;
            at[d] = {.x_m = sign * half * std::cos(angle), .y_m = sign * half * std::sin(angle)};
          }
        }
      };
      set(1.0);
      const double up = width();
      set(-1.0);
      if (up > width()) set(1.0);
    }
    EXPECT_NEAR(width(), worst.greatest_rad, kRounding * worst.greatest_rad);
  }
  EXPECT_GT(attained, 50);
}

TEST(WorstCase, SharesAreChangesOfTheClosedFormByOneTolerance) {
  const auto drawn = thinned_bilateral_drive_gear();
  Tolerances only;
  only.gears[train::kP1].tooth_thickness_m = {.lower = -8e-6, .upper = 8e-6};
  only.gears[train::kR2].tooth_thickness_m = {.lower = -5e-6, .upper = 5e-6};
  const ClearanceModel model = *clearance_model(drawn, only);
  const WorstCase worst = worst_case(model);
  const auto train = *train::make_train_geometry(drawn);
  auto j = normal_backlashes(train);
  const auto closed = [&] { return output_lost_motion(train, j, LostMotionModel::kKinematic); };
  const double middle = closed();
  EXPECT_NEAR(worst.middle_rad, middle, kRounding * middle);
  const double cos_alpha = std::cos(drawn.pressure_angle_rad);
  j[0] += 8e-6 * cos_alpha;
  j[1] += 8e-6 * cos_alpha;
  const double by_p1 = closed() - middle;
  j[2] += 5e-6 * cos_alpha;
  const double both = closed() - middle;
  ASSERT_EQ(worst.share_rad.size(), 2U);
  EXPECT_NEAR(worst.share_rad[0], by_p1, kRounding * middle);
  EXPECT_NEAR(worst.share_rad[1], both - by_p1, kRounding * middle);
  EXPECT_NEAR(worst.greatest_rad, middle + both, kRounding * middle);
  EXPECT_NEAR(worst.root_sum_square_rad, std::hypot(by_p1, both - by_p1), kRounding * middle);
  EXPECT_TRUE(worst.greatest_attained);
}

TEST(WorstCase, WithoutTolerancesIsTheDrawnGearbox) {
  const auto drawn = thinned_bilateral_drive_gear();
  const WorstCase worst = worst_case(*clearance_model(drawn, {}));
  const auto train = *train::make_train_geometry(drawn);
  const auto j = normal_backlashes(train);
  const double lost = output_lost_motion(train, j, LostMotionModel::kKinematic);
  EXPECT_NEAR(worst.least_rad, lost, kRounding * lost);
  EXPECT_NEAR(worst.middle_rad, lost, kRounding * lost);
  EXPECT_NEAR(worst.greatest_rad, lost, kRounding * lost);
  EXPECT_NEAR(worst.least_margin_m, std::min({j[0], j[1], j[2]}), kRounding * 1e-3);
  EXPECT_FALSE(worst.can_jam());
  EXPECT_EQ(worst.root_sum_square_rad, 0.0);
}

}  // namespace
}  // namespace gear3k::backlash::worst_case_test
