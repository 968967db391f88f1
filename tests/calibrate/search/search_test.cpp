#include "calibrate/search/search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <string>

#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::search_test {
namespace {

class Search : public Bench {
 protected:
  [[nodiscard]] SearchResult search() const {
    return search_causes(problem(), candidates_for(simulation_, data_), {});
  }
  static bool could_be(const FoundEffect& effect, const std::string& id) {
    return std::ranges::any_of(effect.replacements,
                               [&](const Replacement& r) { return r.candidate.cause->id == id; });
  }
};

TEST_F(Search, NamesFrictionForAnyLossInProportionToTheLoadOfForwardData) {
  // One line through the origin: nothing tells what makes it steeper, and the coefficient of
  // friction is the one that needs no new physics.
  data_ = measured_grid({.sun_speeds_rpm = {600.0},
                         .directions = {design::Direction::kForward},
                         .rotations = {1},
                         .repeats = 10});
  const Hypothesis gain = hypothesis({candidate("sensor_gain", {.name = "gain"})}, {0.03});
  const Hypothesis bearing =
      hypothesis({candidate("bearing_load", {.name = "output_bearing", .body = "output"})}, {0.03});
  const Hypothesis direction =
      hypothesis({candidate("friction_direction", {.name = "forward"})}, {0.2});
  for (const Hypothesis& hidden : {gain, bearing, direction}) {
    const std::string id(hidden.effects[0].cause->id);
    measure(hidden, 0.002, 1);
    const SearchResult result = search();
    ASSERT_EQ(result.effects.size(), 1U) << id;
    EXPECT_EQ(result.fit.hypothesis.effects[0].cause->id, "friction_level") << id;
    EXPECT_TRUE(could_be(result.effects[0], id)) << id;
  }
}

TEST_F(Search, NamesAStepWhereSessionsAreInTheOrderOfALaw) {
  // A torque that is there from the second session on, which is the one at speed.
  data_ = measured_grid({.sun_speeds_rpm = {2.0, 1000.0},
                         .directions = {design::Direction::kForward},
                         .rotations = {1},
                         .repeats = 10});
  data_.runs = {"slow", "fast"};
  for (Observation& row : data_.rows) {
    row.condition.run = row.condition.sun_speed_rad_s > 1.0 ? 1 : 0;
  }
  const Hypothesis drag =
      hypothesis({candidate("drag_viscous", {.name = "sun", .body = "sun"})}, {2e-4});
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    measure(drag, 0.004, seed);
    const SearchResult result = search();
    ASSERT_EQ(result.effects.size(), 1U);
    EXPECT_EQ(result.fit.hypothesis.effects[0].cause->id, "run_step");
    EXPECT_TRUE(could_be(result.effects[0], "drag_viscous"));
  }
}

TEST_F(Search, FindsNothingInNoise) {
  data_ = measured_grid({.repeats = 2});
  constexpr int kCases = 40;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    measure({}, 0.004, seed);
    const SearchResult result = search();
    found += result.effects.empty() ? 0 : 1;
    // What is named has passed the test, and has paid for its parameters.
    EXPECT_TRUE(result.effects.empty() || result.first_p <= SearchOptions{}.rate);
  }
  // The rate asked for is 4 %: P(X ≥ 8 of 40) < 0.001.
  EXPECT_LE(found, 7);
}

TEST_F(Search, FindsCausesThatActTogether) {
  // Each far above the noise, and told apart by direction, rotation and speed.
  data_ = measured_grid({.repeats = 4});
  const Hypothesis hidden = hypothesis({candidate("friction_level", {.name = "coefficient"}),
                                        candidate("drag_viscous", {.name = "sun", .body = "sun"}),
                                        candidate("sensor_offset", {.name = "offset"})},
                                       {0.3, 2e-4, 0.02});
  measure(hidden, 0.004, 9);
  const SearchResult result = search();
  ASSERT_EQ(result.effects.size(), 3U);
  for (const Candidate& c : hidden.effects) {
    const auto& effects = result.fit.hypothesis.effects;
    const auto at = static_cast<std::size_t>(
        std::ranges::find(effects, c.cause, &Candidate::cause) - effects.begin());
    ASSERT_LT(at, effects.size()) << c.cause->id;
    const auto k = static_cast<std::size_t>(
        std::ranges::find(hidden.effects, c.cause, &Candidate::cause) - hidden.effects.begin());
    EXPECT_NEAR(values_of(result.fit.hypothesis, at)[0], hidden.value[k],
                0.2 * std::abs(hidden.value[k]))
        << c.cause->id;
    EXPECT_GT(result.effects[at].delta_bic, 10.0) << c.cause->id;
  }
}

}  // namespace
}  // namespace gear3k::calibrate::search_test
