#include "calibrate/causes/angle_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "calibrate/fit/wave_amplitude.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::angle_order_test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// So many angles, a step apart.
std::vector<double> every(double step_deg, int count) {
  std::vector<double> result;
  for (int k = 0; k < count; ++k) result.push_back(step_deg / 360.0 * kTurn * k);
  return result;
}
std::vector<double> at_random(int count, double turns) {
  rig::DeterministicRandom random(3);
  std::vector<double> result;
  for (int k = 0; k < count; ++k) result.push_back(random.between(0.0, turns * kTurn));
  std::ranges::sort(result);
  return result;
}

TEST(AnglesShow, WavesOfWhichTheyHoldEnough) {
  // Variances over those of a whole turn, by solving the normal equations elsewhere: over half a
  // turn 5.28, over 0.6 of one 2.79; with a second harmonic over 0.6 19.8, over 0.7 4.08 and over
  // 0.8 1.68.
  EXPECT_FALSE(angles_show(every(0.45, 400), 1.0, 1));
  EXPECT_TRUE(angles_show(every(0.54, 400), 1.0, 1));
  EXPECT_FALSE(angles_show(every(0.54, 400), 1.0, 2));
  EXPECT_FALSE(angles_show(every(0.63, 400), 1.0, 2));
  EXPECT_TRUE(angles_show(every(0.72, 400), 1.0, 2));
  // Two phases do not tell a cosine and a sine from a mean, three do, and four no second harmonic.
  EXPECT_FALSE(angles_show(every(180.0, 20), 1.0, 1));
  EXPECT_TRUE(angles_show(every(120.0, 21), 1.0, 1));
  EXPECT_FALSE(angles_show(every(90.0, 20), 1.0, 2));
  EXPECT_FALSE(angles_show({}, 1.0, 1));
}

TEST(AnglesShow, NoTurnThatTheyPassByInStepsOfAboutWholeTurns) {
  // 96.24 turns in 48 steps of 7.5 degrees: 2.005 a step.
  EXPECT_FALSE(angles_show(every(7.5, 36), 96.24, 1));
  // 4.0217 turns a step: over 60 steps they walk through it once, as a drift does.
  EXPECT_FALSE(angles_show(every(15.0, 60), 96.52, 1));
  EXPECT_TRUE(angles_show(every(15.0, 200), 96.52, 1));
  EXPECT_TRUE(angles_show(every(15.0, 60), 1.0, 1));
  EXPECT_TRUE(angles_show(every(0.3, 60), 96.24, 1));
  EXPECT_TRUE(angles_show(at_random(60, 1.0), 96.24, 3));
}

class Waves : public Bench {
 protected:
  Waves() { data_ = measured_grid({.rotations = {1}, .repeats = 4}); }
  void turn(const std::vector<double>& angles) {
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].condition.output_angle_rad = angles[i];
    }
  }
  [[nodiscard]] bool is_sought(double order, const std::string& cause = "runout") const {
    return std::ranges::any_of(candidates_for(simulation_, data_), [&](const Candidate& c) {
      return c.cause->id == cause && c.form.order == order;
    });
  }
};

TEST_F(Waves, AreNotSoughtWhereTheAnglesDoNotShowThem) {
  const auto rows = static_cast<int>(data_.rows.size());
  turn(at_random(rows, 3.0));
  const std::vector<train::ShaftOrder> shafts = shafts_of(simulation_.occasion(data_));
  const auto sun = std::ranges::find(shafts, "sun", &train::ShaftOrder::body);
  ASSERT_NE(sun, shafts.end());
  EXPECT_TRUE(is_sought(sun->order));
  EXPECT_TRUE(shafts_not_shown(simulation_.occasion(data_)).empty());
  // A step of one turn of the sun.
  turn(every(360.0 / sun->order, rows));
  EXPECT_FALSE(is_sought(sun->order));
  const std::vector<std::string> hidden = shafts_not_shown(simulation_.occasion(data_));
  ASSERT_FALSE(hidden.empty());
  EXPECT_TRUE(
      std::ranges::any_of(hidden, [](const std::string& s) { return s.starts_with("the sun ("); }));
}

TEST_F(Waves, ThatDrawWhatAShownShaftDoesStayItsAlternatives) {
  const auto rows = static_cast<int>(data_.rows.size());
  turn(at_random(rows, 3.0));
  const std::vector<Candidate> all = candidates_for(simulation_, data_);
  const auto teeth =
      std::ranges::find_if(all, [](const Candidate& c) { return c.cause->id == "mesh_order"; });
  ASSERT_NE(teeth, all.end());
  const double order = teeth->form.order;
  // Places of which so many steps make the turn that the teeth, like the output, go by once in it
  // (1.2 turns in all).
  const double passed = std::round(1.2 * (order - 1.0) / rows);
  const std::vector<double> places = every(360.0 * passed / (order - 1.0), rows);
  turn(places);
  ASSERT_FALSE(angles_show(places, order, 1));
  EXPECT_TRUE(is_sought(1.0));
  EXPECT_TRUE(is_sought(order, "mesh_order"));
  // Of another shift they draw what no shaft does, a slow curve.
  turn(every(360.0 * passed / (order - 0.7), rows));
  EXPECT_FALSE(is_sought(order, "mesh_order"));
}

TEST_F(Waves, HaveAnAmplitudeOfMoreThanTheirIntervalAndLessThanTheResponse) {
  turn(at_random(static_cast<int>(data_.rows.size()), 3.0));
  const Candidate wave = candidate(
      "runout", {.name = "constant", .body = "sun", .order = std::abs(simulation_.ratio())});
  measure({}, 0.0, 1);
  const Problem p = problem();
  const auto is_none = [&](double cosine, double sine, double sigma) {
    return is_no_wave(p, hypothesis({wave}, {cosine, sine}), 0, sigma * sigma);
  };
  // Of n rows at random phases σ √(2/n), 1.96 times.
  const double half = 1.96 * std::sqrt(2.0 / static_cast<double>(data_.rows.size()));
  EXPECT_TRUE(is_none(0.5 * half * 0.01, 0.0, 0.01));
  EXPECT_FALSE(is_none(0.0, 2.0 * half * 0.01, 0.01));
  const double mean = measured(data_).cwiseAbs().mean();
  EXPECT_FALSE(is_none(0.5 * mean, 0.0, 0.01));
  EXPECT_TRUE(is_none(1.1 * mean, 0.0, 0.01));
}

}  // namespace
}  // namespace gear3k::calibrate::angle_order_test
