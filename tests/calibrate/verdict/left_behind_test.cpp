// What later measurements meet, beside refits of one value by other causes and a search of its own.

#include "calibrate/verdict/left_behind.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "calibrate/measurement/noise.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::left_behind_test {
namespace {

// Thirds end where a sum is flat within its rounding.
constexpr double kFlat = 1e-6;
constexpr std::array kGains{0.06, -0.03, 0.01, 0.02};  // of the sessions

class LeftBehind : public Bench {
 protected:
  /// Sessions of loads and numbers of rows of their own, a row every minute.
  LeftBehind() {
    const MeasurementSet grid = measured_grid({.rotations = {1}});
    data_.kind = grid.kind;
    data_.runs = {"a", "b", "c", "d"};
    const std::array rows{12, 8, 9, 6};
    const std::array loads_Nm{4.0, 40.0, 15.0, 60.0};
    for (std::size_t run = 0; run < rows.size(); ++run) {
      for (int k = 0; k < rows[run]; ++k) {
        Observation row = grid.rows[static_cast<std::size_t>(k) * 5 % grid.rows.size()];
        row.condition.run = static_cast<int>(run);
        row.condition.output_torque_Nm = loads_Nm[run] * (1.0 + 0.02 * k);
        row.condition.time_s = 60.0 * static_cast<double>(data_.rows.size());
        data_.rows.push_back(row);
      }
    }
    as_given_ = simulated(simulation_, data_, {}).value();
  }

  [[nodiscard]] static Hypothesis gains_of_sessions() {
    return hypothesis(
        {candidate("run_step",
                   {.name = "sessions_gain",
                    .constants = {{.name = "sessions", .unit = "", .value = kGains.size()}},
                    .law = kOnGain})},
        {kGains.begin(), kGains.end()});
  }
  [[nodiscard]] Hypothesis drift(std::string_view law, double change) const {
    const double span = data_.rows.back().condition.time_s;
    return hypothesis(
        {candidate("drift", {.name = "linear_time_" + std::string(law),
                             .constants = {{.name = "start", .unit = "s", .value = 0.0},
                                           {.name = "span", .unit = "s", .value = span},
                                           {.name = "time_constant", .unit = "s", .value = span}},
                             .law = law})},
        {change});
  }
  /// Value of a cause of one parameter with the least Σ ρ(r/s) over the measured rows, alike in
  /// weight, between two bounds by thirds; ρ: squares up to 3, then linear, s: as simulated as
  /// given.
  [[nodiscard]] double refitted(const Candidate& cause, double low, double high) const {
    const Eigen::VectorXd y = measured(data_);
    const double scale = robust_deviation(y - as_given_);
    const auto sum = [&](double value) {
      const Eigen::VectorXd of_cause =
          simulated(simulation_, data_, hypothesis({cause}, {value})).value();
      double total = 0.0;
      for (const double r : y - of_cause) {
        const double far = std::abs(r) / scale;
        total += far < 3.0 ? far * far : 6.0 * far - 9.0;
      }
      return total;
    };
    for (int step = 0; step < 80; ++step) {
      const double a = (2.0 * low + high) / 3.0;
      const double b = (low + 2.0 * high) / 3.0;
      (sum(a) < sum(b) ? high : low) = sum(a) < sum(b) ? b : a;
    }
    return 0.5 * (low + high);
  }
  [[nodiscard]] double refitted_gain() const {
    return refitted(candidate("sensor_gain", {.name = "gain"}), -0.2, 0.2);
  }
  [[nodiscard]] double refitted_friction() const {
    return refitted(candidate("friction_level", {.name = "coefficient"}), -0.2, 0.6);
  }
  [[nodiscard]] static Effect found(const Hypothesis& h, const std::string& alternative) {
    Effect effect;
    effect.id = h.effects.front().cause->id;
    effect.form = h.effects.front().form;
    if (!alternative.empty()) {
      effect.alternatives.emplace_back();
      effect.alternatives.back().id = alternative;
    }
    return effect;
  }

  Eigen::VectorXd as_given_;
};

TEST_F(LeftBehind, SessionsAreExpectedAtTheGainOfARefit) {
  const Hypothesis h = gains_of_sessions();
  measure(h, 0.0, 1);
  const auto left = change_left_behind(problem(), h, 0, {found(h, "")});
  ASSERT_TRUE(left.has_value());
  EXPECT_EQ(left->law, kOnGain);
  EXPECT_NEAR(left->value, refitted_gain(), kFlat);
  EXPECT_GT(std::abs(left->value - 0.015), 0.005);  // of the mean of the sessions
}

TEST_F(LeftBehind, ADriftThatALawOfTemperatureMayBeIsExpectedAtARefit) {
  const Hypothesis h = drift(kOnFriction, 0.4);
  measure(h, 0.0, 1);
  const auto left = change_left_behind(problem(), h, 0, {found(h, "friction_temperature")});
  ASSERT_TRUE(left.has_value());
  EXPECT_EQ(left->law, kOnFriction);
  EXPECT_NEAR(left->value, refitted_friction(), kFlat);
}

TEST_F(LeftBehind, ADriftThatNothingElseExplainsGoesOnAsItWas) {
  const Hypothesis h = drift(kOnGain, 0.1);
  measure(h, 0.0, 1);
  EXPECT_FALSE(change_left_behind(problem(), h, 0, {found(h, "")}).has_value());
  // A step says of later rows what the drift does.
  EXPECT_FALSE(change_left_behind(problem(), h, 0, {found(h, "run_step")}).has_value());
}

TEST_F(LeftBehind, AFormulaThatExplainsNothingIsExpectedAtARefit) {
  const Hypothesis h = drift(kOnGain, 0.1);
  measure(h, 0.0, 1);
  const auto left = change_left_behind(problem(), h, 0, {});
  ASSERT_TRUE(left.has_value());
  EXPECT_NEAR(left->value, refitted_gain(), kFlat);
}

TEST_F(LeftBehind, WhatACauseDoesNotChangeDoesNotStandForIt) {
  // Friction that explains what an offset did would miss the rows by more.
  const Hypothesis h = hypothesis(
      {candidate("run_step",
                 {.name = "sensor_sessions",
                  .constants = {{.name = "sessions", .unit = "", .value = kGains.size()}},
                  .law = kOnOffset})},
      {0.3, 0.31, 0.29, 0.3});
  measure(h, 0.0, 1);
  const auto left = change_left_behind(problem(), h, 0, {found(h, "")});
  ASSERT_TRUE(left.has_value());
  EXPECT_EQ(left->law, kOnOffset);
  // In its own sign every row counts alike: the mean over the rows.
  EXPECT_NEAR(left->value, (12 * 0.3 + 8 * 0.31 + 9 * 0.29 + 6 * 0.3) / 35.0, 1e-12);
}

TEST_F(LeftBehind, AModelPredictsLaterRowsNoWorseThanTheRefit) {
  const Hypothesis h = gains_of_sessions();
  measure_evenly(h, 1e-4, 5);
  const auto d = diagnose_as_read(simulation_, data_, {});
  ASSERT_TRUE(d.has_value());
  ASSERT_EQ(d->model.causes.size(), 1U);
  ASSERT_EQ(d->model.causes.front().id, "run_step");
  Condition later = data_.rows.front().condition;
  later.run = -1;
  later.time_s = 1e6;
  Modification m;
  apply_model(d->model, later, Kind::kTransmission, m);
  EXPECT_NEAR(m.sensor_gain.a, 1.0 + refitted_gain(), 1e-4);
}

}  // namespace
}  // namespace gear3k::calibrate::left_behind_test
