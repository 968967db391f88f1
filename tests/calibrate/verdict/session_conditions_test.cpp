// Conditions that are told by the session alone: data cannot say what is theirs and what is time's.

#include "calibrate/verdict/session_conditions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "calibrate/verdict/diagnosis.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::session_conditions_test {
namespace {

constexpr std::size_t kSessions = 4;
constexpr double kSigma = 0.0005;

/// Four sessions, a day apart, whose friction grows by a like amount from one to the next.
class Sessions : public Bench {
 protected:
  /// @param temperature_c  of a row, by its session and its place within it
  template <typename Temperature>
  Diagnosis diagnosed(Temperature temperature_c) {
    data_ = measured_grid({.repeats = kSessions});
    data_.runs = {"a", "b", "c", "d"};
    const std::size_t rows = data_.rows.size() / kSessions;
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      Condition& c = data_.rows[i].condition;
      c.run = static_cast<int>(i / rows);
      c.time_s = 86400.0 * c.run + 20.0 * static_cast<double>(i % rows);
      c.temperature_K = 273.15 + temperature_c(i / rows, i % rows);
    }
    // Each session by itself, at its own coefficient: no law of time or temperature.
    rig::DeterministicRandom random(8);
    for (std::size_t s = 0; s < kSessions; ++s) {
      const auto level = hypothesis({candidate("friction_level", {.name = "coefficient"})},
                                    {0.25 * static_cast<double>(s)});
      const Eigen::VectorXd clean = simulated(simulation_, data_, level).value();
      for (std::size_t i = s * rows; i < (s + 1) * rows; ++i) {
        data_.rows[i].response = clean[static_cast<Eigen::Index>(i)] + kSigma * random.normal();
        data_.rows[i].sigma = kSigma;
      }
    }
    return *diagnose(simulation_, data_, {});
  }
  static bool lists(const Diagnosis& d, const std::string& id) {
    return std::ranges::any_of(d.effects, [&](const Effect& e) {
      return e.id == id ||
             std::ranges::find(e.alternatives, id, &Alternative::id) != e.alternatives.end();
    });
  }
};

TEST_F(Sessions, OneTemperatureEachLeaveTheTemperatureAsAnAlternativeOfAnyShape) {
  const Diagnosis d = diagnosed(
      [](std::size_t session, std::size_t) { return 20.0 + 13.0 * static_cast<double>(session); });
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_TRUE(lists(d, "friction_temperature"));
  EXPECT_TRUE(lists(d, "drift") || lists(d, "run_step"));
  EXPECT_EQ(d.verdict, Verdict::kAmbiguous);
  EXPECT_EQ(d.conditions_by_session, std::vector<std::string>{"temperature"});
  EXPECT_TRUE(std::ranges::any_of(d.notes, [](const std::string& note) {
    return note.starts_with("every session has one temperature (20, 33, 46, 59)");
  }));
}

TEST_F(Sessions, TemperaturesThatMeetInEverySessionRuleItOut) {
  const Diagnosis d = diagnosed([](std::size_t session, std::size_t row) {
    return 20.0 + 13.0 * static_cast<double>((session + row) % kSessions);
  });
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_FALSE(lists(d, "friction_temperature"));
  EXPECT_EQ(d.verdict, Verdict::kExplained);
  EXPECT_TRUE(d.conditions_by_session.empty());
}

TEST_F(Sessions, FrictionThatFallsAsEachSessionWarmsUpIsLeftAlongSessionTime) {
  data_ = measured_grid({.repeats = kSessions});
  data_.runs = {"a", "b", "c", "d"};
  const std::size_t rows = data_.rows.size() / kSessions;
  const auto at = [&](double relative_friction) {
    return simulated(simulation_, data_,
                     hypothesis({candidate("friction_level", {.name = "coefficient"})},
                                {relative_friction}))
        .value();
  };
  const Eigen::VectorXd cold = at(0.2), warm = at(0.0);
  for (const double share : {1.0, 4.0}) {
    rig::DeterministicRandom random(3);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      Condition& c = data_.rows[i].condition;
      c.run = static_cast<int>(i / rows);
      // Loads and speeds in another order in every session.
      const double minutes =
          static_cast<double>((i * 7 + static_cast<std::size_t>(c.run) * 11) % rows);
      c.time_s = 86400.0 * c.run + 60.0 * minutes;
      const auto k = static_cast<Eigen::Index>(i);
      data_.rows[i].response = warm[k] + share * (cold[k] - warm[k]) * std::exp(-minutes / 10.0) +
                               kSigma * random.normal();
      data_.rows[i].sigma = kSigma;
    }
    const Diagnosis d = *diagnose(simulation_, data_, {});
    EXPECT_EQ(d.verdict, Verdict::kUnexplained) << share;
    EXPECT_TRUE(d.remainder.significant) << share;
    const auto before =
        std::ranges::find(d.covariates_before, "session time", &CovariateTest::name);
    ASSERT_NE(before, d.covariates_before.end());
    EXPECT_LT(before->p_value, 1e-6) << share;
  }
}

TEST(ConditionsBySession, AreThoseOfOneLevelEachAndNotAllTheSame) {
  MeasurementSet data = measured_grid({.repeats = 2});
  data.runs = {"a", "b"};
  // All forward rows in one session, all backward ones in the other; loads and speeds in both.
  for (Observation& row : data.rows) {
    row.condition.run = row.condition.direction == design::Direction::kForward ? 0 : 1;
  }
  const auto conditions = conditions_by_session(data, covariate_levels(data));
  ASSERT_EQ(conditions.size(), 1U);
  EXPECT_EQ(conditions[0].name, "direction");
  data.rows.front().condition.run = 1;
  EXPECT_TRUE(conditions_by_session(data, covariate_levels(data)).empty());
}

}  // namespace
}  // namespace gear3k::calibrate::session_conditions_test
