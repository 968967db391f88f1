#include "calibrate/search/second_names.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "calibrate/search/search.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::second_names_test {
namespace {

/// Two sessions; friction that changes over the time as a function says.
class OverTime : public Bench {
 protected:
  OverTime() {
    data_ = measured_grid({.sun_speeds_rpm = {300.0, 900.0}, .rotations = {1}, .repeats = 4});
    data_.runs = {"first", "second"};
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      Condition& c = data_.rows[i].condition;
      c.time_s = 100.0 * static_cast<double>(i);
      c.run = 2 * i < data_.rows.size() ? 0 : 1;
    }
  }
  [[nodiscard]] Candidate of(const char* id, const std::string& form) const {
    for (const Candidate& c : candidates_for(simulation_, data_)) {
      if (c.cause->id == id && c.form.name == form) return c;
    }
    throw std::invalid_argument("no form " + form);
  }
  [[nodiscard]] Fit joined(const Hypothesis& truth) {
    constexpr double kNoise = 0.0005;
    measure(truth, kNoise, 3);
    const Problem p = problem();
    const Fit two =
        fit(p,
            hypothesis({of("drift", "linear_time_friction"), of("run_step", "from_friction")},
                       {0.0, 0.0}),
            kNoise);
    return with_one_law_of_time(p, candidates_for(simulation_, data_), two, kNoise);
  }
};

TEST_F(OverTime, ADriftThatSetsInLateIsNoDriftWithAStep) {
  const Hypothesis late = hypothesis({of("drift", "onset_any_scale_any_exponent_time_friction")},
                                     {0.8, std::log(0.5 / 0.3), std::log(4.0)});
  const Fit one = joined(late);
  ASSERT_EQ(one.hypothesis.effects.size(), 1U);
  EXPECT_EQ(one.hypothesis.effects[0].cause->id, "drift");
}

TEST_F(OverTime, FrictionThatCreepsWithTheLogarithmOfTheTimeIsOneDrift) {
  const Hypothesis creep =
      hypothesis({of("drift", "logarithmic_any_scale_time_friction")}, {0.12, -2.0});
  const Fit one = joined(creep);
  ASSERT_EQ(one.hypothesis.effects.size(), 1U);
  EXPECT_EQ(one.hypothesis.effects[0].form.name, "logarithmic_any_scale_time_friction");
  EXPECT_NEAR(one.hypothesis.value[0], 0.12, 0.02);
}

TEST_F(OverTime, ADriftAndAStepStayTwo) {
  // Up with time, and back down between the sessions: no monotone law.
  const Hypothesis both = hypothesis(
      {of("drift", "linear_time_friction"), of("run_step", "from_friction")}, {0.6, -0.5});
  EXPECT_EQ(joined(both).hypothesis.effects.size(), 2U);
}

/// Angles on a grid or at random.
class OverTheAngle : public Bench {
 protected:
  OverTheAngle() {
    data_ = measured_grid({.sun_speeds_rpm = {600.0}, .rotations = {1}, .repeats = 8});
  }
  void set_angles(double step_rad) {
    rig::DeterministicRandom random(4);
    for (Observation& row : data_.rows) {
      const double steps = random.between(0.0, 2000.0);
      row.condition.output_angle_rad = step_rad > 0.0 ? std::floor(steps) * step_rad : 0.1 * steps;
    }
  }
  [[nodiscard]] Candidate of(const char* id, const std::string& form, const char* body) const {
    for (const Candidate& c : candidates_for(simulation_, data_)) {
      if (c.cause->id == id && c.form.name == form && c.form.body == body) return c;
    }
    throw std::invalid_argument("no form " + form);
  }
  [[nodiscard]] Fit joined(const Hypothesis& truth) {
    constexpr double kNoise = 0.001;
    measure(truth, kNoise, 3);
    const Problem p = problem();
    const Fit two = fit(p,
                        hypothesis({of("mesh_order", "proportional", "stage 1"),
                                    of("runout", "proportional", "carrier")},
                                   {0.0, 0.0, 0.0, 0.0}),
                        kNoise);
    return with_one_wave(p, candidates_for(simulation_, data_), two, kNoise);
  }
};

TEST_F(OverTheAngle, AWaveWithItsHarmonicIsOne) {
  // The mesh's order is that of the output, backward, at every angle of the grid.
  set_angles(1.0);
  const double mesh = of("mesh_order", "proportional", "stage 1").form.order;
  set_angles(2.0 * std::numbers::pi / (mesh + 1.0));
  const Fit one = joined(
      hypothesis({of("runout", "proportional_with_second", "output")}, {0.02, 0.01, -0.01, 0.005}));
  ASSERT_EQ(one.hypothesis.effects.size(), 1U);
  EXPECT_EQ(one.hypothesis.effects[0].form.name, "proportional_with_second");
}

TEST_F(OverTheAngle, WavesOfTwoBodiesStayTwo) {
  set_angles(0.0);
  const Hypothesis both = hypothesis(
      {of("mesh_order", "proportional", "stage 1"), of("runout", "proportional", "carrier")},
      {0.02, 0.01, -0.01, 0.02});
  EXPECT_EQ(joined(both).hypothesis.effects.size(), 2U);
}

/// Laws of load and speed beside causes that take up what their plain forms leave.
class FreedRests : public Bench {
 protected:
  FreedRests() {
    data_ = measured_grid({.sun_speeds_rpm = {100.0, 300.0, 1000.0},
                           .output_torques_Nm = {3.0, 6.0, 12.0, 25.0, 50.0},
                           .repeats = 2});
  }
  [[nodiscard]] Candidate of(const char* id, const std::string& form) const {
    for (const Candidate& c : candidates_for(simulation_, data_)) {
      if (c.cause->id == id && c.form.name == form) return c;
    }
    throw std::invalid_argument("no form " + form);
  }
  [[nodiscard]] Hypothesis freed(const Hypothesis& truth, const Hypothesis& two) {
    constexpr double kNoise = 0.002;
    measure(truth, kNoise, 5);
    const Problem p = problem();
    return with_freed_rests(p, candidates_for(simulation_, data_), fit(p, two, kNoise), kNoise)
        .hypothesis;
  }
};

TEST_F(FreedRests, ALawOfAnotherLevelIsOneEffect) {
  const Hypothesis law = hypothesis({of("friction_load", "any_level")}, {-0.2, 0.15});
  const Hypothesis found = freed(
      law, hypothesis({of("friction_load", "about_middle"), of("friction_level", "coefficient")},
                      {0.0, 0.0}));
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].cause->id, "friction_load");
  EXPECT_NEAR(found.value[0], -0.2, 0.05);
}

TEST_F(FreedRests, TwoCausesThatNoFreeShapeReplacesStay) {
  const Hypothesis both =
      hypothesis({of("friction_load", "about_middle"), of("drag_constant", "sun")}, {-0.2, 0.03});
  EXPECT_TRUE(same_forms(freed(both, both), both));
}

/// Sessions of a constant that moves between them.
class NamedMeans : public OverTime {
 protected:
  [[nodiscard]] Hypothesis named(const std::vector<double>& offset_Nm) {
    data_.runs = {"1", "2", "3"};
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].condition.run = static_cast<int>(3 * i / data_.rows.size());
    }
    constexpr double kNoise = 0.0005;
    const Hypothesis sessions = hypothesis({of("run_step", "sensor_sessions")}, offset_Nm);
    measure(sessions, kNoise, 3);
    const Problem p = problem();
    return with_named_means(p, candidates_for(simulation_, data_), fit(p, sessions, kNoise), kNoise,
                            3)
        .hypothesis;
  }
};

TEST_F(NamedMeans, AZeroErrorThatMovesIsAZeroErrorAndAStep) {
  const Hypothesis found = named({0.03, 0.026, 0.026});
  ASSERT_EQ(found.effects.size(), 2U);
  EXPECT_EQ(found.effects[0].cause->id, "sensor_offset");
}

TEST_F(NamedMeans, SessionsThatDifferAsTheyLikeStaySessions) {
  const Hypothesis found = named({0.03, -0.04, 0.01});
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].form.name, "sensor_sessions");
}

}  // namespace
}  // namespace gear3k::calibrate::second_names_test
