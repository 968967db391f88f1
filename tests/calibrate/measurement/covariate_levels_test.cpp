#include "calibrate/measurement/covariate_levels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace gear3k::calibrate::covariate_levels_test {
namespace {

constexpr double kRpm = std::numbers::pi / 30.0;

const Levels* find(const std::vector<Levels>& all, const std::string& name) {
  const auto at = std::ranges::find(all, name, &Levels::name);
  return at == all.end() ? nullptr : &*at;
}

MeasurementSet speeds(const std::vector<double>& rpm) {
  MeasurementSet data;
  for (const double n : rpm) {
    Observation row;
    row.condition.sun_speed_rad_s = n * kRpm;
    row.condition.output_torque_Nm = 5.0;
    data.rows.push_back(row);
  }
  return data;
}

TEST(CovariateLevels, AreTheValuesWhileTheyAreFew) {
  const auto all = covariate_levels(speeds({600.0, 200.0, 1000.0, 202.0, 598.0, kUnknown}));
  const Levels* speed = find(all, "speed");
  ASSERT_NE(speed, nullptr);
  EXPECT_EQ(speed->of, (std::vector<int>{1, 0, 2, 0, 1, -1}));
  ASSERT_EQ(speed->count, 3);
  EXPECT_NEAR(speed->at[0], 201.0, 1e-9);
  EXPECT_NEAR(speed->at[1], 599.0, 1e-9);
  EXPECT_NEAR(speed->at[2], 1000.0, 1e-9);
  EXPECT_FALSE(speed->binned);
  // What does not vary has no levels.
  EXPECT_EQ(find(all, "load"), nullptr);
}

TEST(CovariateLevels, RowsOfALoopHaveOneTime) {
  // Two loops that begin at lines 5 and 90, three torques each, read at times that follow the
  // torque.
  MeasurementSet data;
  for (int k = 0; k < 6; ++k) {
    Observation row;
    row.line = k < 3 ? 5 : 90;
    row.condition.test_torque_Nm = k % 3;
    row.condition.time_s = (k < 3 ? 10.0 : 110.0) + k % 3;
    data.rows.push_back(row);
  }
  data.kind = Kind::kTorqueAngle;
  EXPECT_EQ(reading_times(data), (std::vector<double>{11.0, 11.0, 11.0, 111.0, 111.0, 111.0}));
  const auto all = covariate_levels(data);
  ASSERT_NE(find(all, "time"), nullptr);
  EXPECT_EQ(find(all, "time")->of, (std::vector<int>{0, 0, 0, 1, 1, 1}));
  data.kind = Kind::kLostMotion;
  EXPECT_EQ(reading_times(data)[2], 12.0);
}

TEST(CovariateLevels, AreBinsOfEqualCountsWhereTheyAreMany) {
  std::vector<double> rpm;
  for (int k = 0; k < 80; ++k) rpm.push_back(100.0 + 10.0 * ((k * 37) % 80));
  const auto all = covariate_levels(speeds(rpm));
  const Levels* speed = find(all, "speed");
  ASSERT_NE(speed, nullptr);
  EXPECT_TRUE(speed->binned);
  ASSERT_EQ(speed->count, 8);
  for (int level = 0; level < speed->count; ++level) {
    EXPECT_EQ(std::ranges::count(speed->of, level), 10);
    EXPECT_NEAR(speed->at[static_cast<std::size_t>(level)], 145.0 + 100.0 * level, 1e-9);
  }
}

TEST(CovariateLevels, OfManyRowsAtTheLeastValueHaveRowsInEach) {
  // Three of five rows at 0, the others at 48 values.
  std::vector<double> rpm;
  for (int k = 0; k < 120; ++k) rpm.push_back(k % 5 < 3 ? 0.0 : 10.0 + 7.0 * k);
  const auto all = covariate_levels(speeds(rpm));
  const Levels* speed = find(all, "speed");
  ASSERT_NE(speed, nullptr);
  EXPECT_TRUE(speed->binned);
  for (int level = 0; level < speed->count; ++level) {
    EXPECT_GT(std::ranges::count(speed->of, level), 0) << level;
  }
  for (std::size_t i = 0; i < rpm.size(); ++i) {
    EXPECT_TRUE(rpm[i] > 0.0 || speed->of[i] == 0);
  }
}

TEST(CovariateLevels, CrossedAreTheCellsThatOccur) {
  const Levels a{.name = "a", .of = {0, 0, 1, 1, -1}, .count = 2};
  const Levels b{.name = "b", .of = {0, 1, 1, 1, 0}, .count = 2};
  const Levels both = crossed(a, b);
  EXPECT_EQ(both.count, 3);
  EXPECT_EQ(both.of, (std::vector<int>{0, 1, 2, 2, -1}));
  const Eigen::MatrixXd columns = indicators(both);
  EXPECT_EQ(columns.col(2), (Eigen::VectorXd(5) << 0.0, 0.0, 1.0, 1.0, 0.0).finished());
}

TEST(CovariateLevels, OfFurtherColumnsAndSessionsBearTheirNames) {
  MeasurementSet data = speeds({200.0, 200.0, 200.0, 200.0});
  data.covariates.push_back({.name = "oil", .value = {1.0, 2.0, 1.0, kUnknown}});
  data.runs = {"a", "b"};
  data.rows[1].condition.run = data.rows[2].condition.run = 1;
  data.rows[0].condition.run = data.rows[3].condition.run = 0;
  const auto all = covariate_levels(data);
  ASSERT_NE(find(all, "oil"), nullptr);
  EXPECT_EQ(find(all, "oil")->of, (std::vector<int>{0, 1, 0, -1}));
  ASSERT_NE(find(all, "run"), nullptr);
  EXPECT_EQ(find(all, "run")->of, (std::vector<int>{0, 1, 1, 0}));
}

}  // namespace
}  // namespace gear3k::calibrate::covariate_levels_test
