// What all rows have in common is no drift and no step, whatever the library calls it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "calibrate/search/better_names.hpp"
#include "calibrate/search/search.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::constants_test {
namespace {

/// A gearbox of a catalogue, as its definition says: ratio 50, 80 % forward, 75 % backward.
double catalogue_torque(bool forward, double output_Nm) {
  return forward ? output_Nm / 50.0 / 0.8 : output_Nm / 50.0 * 0.75;
}

/// A torque at the sun, of what the output really carries, its rotation and time.
struct Row {
  bool forward;
  int rotation;
  double stated_Nm, time_share;
};
using Truth = std::function<double(const Row&)>;

class Constants : public testing::Test {
 protected:
  Constants()
      : box_{.name = "catalogue",
             .ratio = 50.0,
             .efficiency_forward = 0.8,
             .efficiency_backward = 0.75},
        simulation_(box_, Kind::kTransmission) {}

  /// Loads and order at random, in three sessions.
  void measure(const Truth& truth, bool both_rotations) {
    constexpr int kRows = 60;
    constexpr double kNoise_Nm = 0.001;
    rig::DeterministicRandom random(11);
    data_ = {};
    data_.kind = Kind::kTransmission;
    data_.runs = {"a", "b", "c"};
    for (int i = 0; i < kRows; ++i) {
      const Row row{.forward = random.between(0.0, 1.0) < 0.5,
                    .rotation = both_rotations && random.between(0.0, 1.0) < 0.5 ? -1 : 1,
                    .stated_Nm = random.between(4.0, 30.0),
                    .time_share = i / (kRows - 1.0)};
      Observation o;
      o.condition.direction =
          row.forward ? design::Direction::kForward : design::Direction::kBackward;
      o.condition.rotation = row.rotation;
      o.condition.sun_speed_rad_s = random.between(20.0, 150.0);
      o.condition.output_torque_Nm = row.stated_Nm;
      o.condition.time_s = 60.0 * i;
      o.condition.run = 3 * i / kRows;
      o.response = truth(row) + kNoise_Nm * random.normal();
      data_.rows.push_back(o);
    }
  }
  [[nodiscard]] SearchResult found() const {
    const Problem p{.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
    return search_causes(p, candidates_for(simulation_, data_), {});
  }
  [[nodiscard]] static bool may_be(const SearchResult& result, const std::string& id) {
    return std::ranges::any_of(result.effects, [&](const FoundEffect& e) {
      return std::ranges::any_of(e.replacements,
                                 [&](const Replacement& r) { return r.candidate.cause->id == id; });
    });
  }
  static void expect_one(const SearchResult& result, const std::string& form, double value) {
    ASSERT_EQ(result.effects.size(), 1U);
    const Candidate& c = result.fit.hypothesis.effects[0];
    EXPECT_EQ(c.cause->id, "sensor_offset");
    EXPECT_EQ(c.form.name, form);
    EXPECT_NEAR(result.fit.hypothesis.value[0], value, 0.06);
    EXPECT_FALSE(may_be(result, "drift"));
    EXPECT_FALSE(may_be(result, "run_step"));
  }

  BlackBox box_;
  Simulation simulation_;
  MeasurementSet data_;
};

TEST_F(Constants, AZeroOfTheOutputsSensorIsToldInItsSign) {
  constexpr double kZero_Nm = 0.5;
  measure(
      [](const Row& r) {
        const double along = r.rotation * (r.forward ? 1.0 : -1.0);
        return catalogue_torque(r.forward, r.stated_Nm - along * kZero_Nm);
      },
      true);
  expect_one(found(), "output", kZero_Nm);
}

TEST_F(Constants, AHangerThatNobodyWeighedIsLoadInAllRows) {
  constexpr double kHanger_Nm = 0.5;
  measure([](const Row& r) { return catalogue_torque(r.forward, r.stated_Nm + kHanger_Nm); }, true);
  expect_one(found(), "output_magnitude", -kHanger_Nm);
}

TEST_F(Constants, InOneRotationADragAtTheOutputDoesAsWell) {
  measure(
      [](const Row& r) {
        return catalogue_torque(r.forward, r.stated_Nm + (r.forward ? 0.5 : -0.5));
      },
      false);
  const SearchResult result = found();
  ASSERT_EQ(result.effects.size(), 1U);
  const std::string_view id = result.fit.hypothesis.effects[0].cause->id;
  EXPECT_TRUE(id == "drag_constant" ? may_be(result, "sensor_offset")
                                    : id == "sensor_offset" && may_be(result, "drag_constant"));
}

TEST_F(Constants, OfOneDirectionTheZeroOfTheSensorThatWasReadIsNamedBeforeTheOthers) {
  // Forward alone either sensor's zero draws the same: 0.01 N m at the sun are 0.4 at the output.
  constexpr double kZero_Nm = 0.01;
  measure(
      [](const Row& r) { return catalogue_torque(r.forward, r.stated_Nm) + r.rotation * kZero_Nm; },
      true);
  std::erase_if(data_.rows, [](const Observation& o) {
    return o.condition.direction == design::Direction::kBackward;
  });
  SearchResult result = found();
  ASSERT_EQ(result.effects.size(), 1U);
  EXPECT_EQ(result.fit.hypothesis.effects[0].form.name, "offset");
  EXPECT_NEAR(std::abs(result.fit.hypothesis.value[0]), kZero_Nm, 0.001);
  const std::vector<Replacement>& elsewhere = result.effects[0].other_bodies;
  const auto output = std::ranges::find(elsewhere, "output",
                                        [](const Replacement& r) { return r.candidate.form.name; });
  ASSERT_NE(output, elsewhere.end());
  EXPECT_NEAR(std::abs(output->fit.hypothesis.value[0]), kZero_Nm * 50.0 * 0.8, 0.04);
  // Nor does the output's keep the name where it was found first.
  const Problem p{.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
  const std::vector<Candidate> all = candidates_for(simulation_, data_);
  result.fit = output->fit;
  const Judge judge(p, all, result.fit, result.scale);
  take_better_names(judge, all, result);
  EXPECT_EQ(result.fit.hypothesis.effects[0].form.name, "offset");
  EXPECT_NEAR(std::abs(result.fit.hypothesis.value[0]), kZero_Nm, 0.001);
}

TEST_F(Constants, ADragThatPushesIsNoDriftAndNoStep) {
  // A constant of no cause: drags brake.
  measure(
      [](const Row& r) {
        return catalogue_torque(r.forward, r.stated_Nm) + (r.forward ? -0.01 : 0.01);
      },
      true);
  for (const Candidate& c : found().fit.hypothesis.effects) {
    EXPECT_NE(c.cause->id, "drift") << c.form.name;
    EXPECT_NE(c.cause->id, "run_step") << c.form.name;
  }
}

TEST_F(Constants, AnInstantIsAStepFromWhateverTimeIsCounted) {
  for (const double start_s : {0.0, -6000.0}) {
    measure(
        [](const Row& r) {
          return catalogue_torque(r.forward, r.stated_Nm) * (r.time_share > 0.6 ? 1.05 : 1.0);
        },
        true);
    data_.runs.clear();
    for (Observation& row : data_.rows) {
      row.condition.run = -1;
      row.condition.time_s += start_s;
    }
    const SearchResult result = found();
    ASSERT_EQ(result.effects.size(), 1U) << start_s;
    EXPECT_EQ(result.fit.hypothesis.effects[0].cause->id, "run_step") << start_s;
  }
}

TEST_F(Constants, AZeroThatCreepsIsStillADrift) {
  measure(
      [](const Row& r) {
        return catalogue_torque(r.forward, r.stated_Nm + 0.5 + 0.6 * r.time_share);
      },
      true);
  const SearchResult result = found();
  EXPECT_TRUE(std::ranges::any_of(result.fit.hypothesis.effects, [](const Candidate& c) {
    return c.cause->id == "drift" || c.cause->id == "run_step";
  }));
}

}  // namespace
}  // namespace gear3k::calibrate::constants_test
