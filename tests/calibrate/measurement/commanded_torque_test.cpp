#include "calibrate/measurement/commanded_torque.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "calibrate/measurement/noise.hpp"

namespace gear3k::calibrate::commanded_torque_test {
namespace {

/// Sun torques and the loads that go with them, in either direction.
MeasurementSet torques(const std::vector<std::array<double, 2>>& sun_and_output) {
  MeasurementSet data;
  for (const auto& [sun, output] : sun_and_output) {
    Observation row;
    row.condition.output_torque_Nm = output;
    row.response = sun;
    data.rows.push_back(row);
  }
  return data;
}

TEST(Commanded, IsASunTorqueOfFewValuesAtLoadsThatFollowIt) {
  const auto set = torques({{0.1, 8.1},
                            {0.1, 8.3},
                            {0.1, 7.9},
                            {0.1, 8.2},
                            {0.2, 16.1},
                            {0.2, 16.4},
                            {0.2, 15.8},
                            {0.2, 16.0}});
  EXPECT_TRUE(is_commanded(set));
  EXPECT_EQ(make_noise_model(set).rounding, 0.0);
  // Loads that were set, at a coarse sensor.
  EXPECT_FALSE(is_commanded(torques({{0.1, 8.0}, {0.1, 8.0}, {0.2, 16.0}, {0.2, 16.0}})));
  // A sensor at its limit shows one torque at any load.
  EXPECT_FALSE(is_commanded(torques(
      {{0.1, 8.1}, {0.1, 8.3}, {0.1, 7.9}, {0.2, 16.1}, {0.2, 26.4}, {0.2, 35.8}, {0.2, 46.0}})));
}

// Small torques were set, of which the drag takes some, more of it the faster: the loads at 1 N m
// go over half of what they reach, and every tenth reading of a load is wrong.
TEST(Commanded, IsASunTorqueBesideDragAndOutliers) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> speed(0.0, 1.0);
  std::vector<std::array<double, 2>> rows;
  for (int k = 0; k < 120; ++k) {
    const double sun = 1.0 + k % 3;
    const double output = 10.0 * (sun - 0.2 - 0.5 * speed(random));
    rows.push_back({sun, k % 10 == 9 ? output + (k % 20 == 9 ? -0.6 : 8.0) : output});
  }
  EXPECT_TRUE(is_commanded(torques(rows)));
}

// Readings in steps of 1 N m, at loads of any size up to what the sensor's limit of 3 N m shows.
TEST(Commanded, IsNotWhatACoarseSensorReads) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> load(6.0, 45.0);
  std::vector<std::array<double, 2>> rows;
  for (int k = 0; k < 200; ++k) {
    const double output = load(random);
    rows.push_back({std::min(3.0, std::round(0.1 * output)), output});
  }
  EXPECT_FALSE(is_commanded(torques(rows)));
}

/// Loads of any size in a range, at a sensor of a tenth of them that shows steps up to a limit.
MeasurementSet read_by_sensor(double low_Nm, double high_Nm, double step_Nm, double limit_Nm) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> load(low_Nm, high_Nm);
  std::vector<std::array<double, 2>> rows;
  for (int k = 0; k < 200; ++k) {
    const double output = load(random);
    rows.push_back({std::min(limit_Nm, step_Nm * std::round(0.1 * output / step_Nm)), output});
  }
  return torques(rows);
}

// Nearly all rows are at the limit, at loads that differ by less than half of the greatest, and
// those short of it are few and read one value each.
TEST(Commanded, IsNotWhatASensorReadsThatIsMostlyAtItsLimit) {
  EXPECT_FALSE(is_commanded(read_by_sensor(40.0, 60.0, 1e-5, 4.3)));
  EXPECT_FALSE(is_commanded(read_by_sensor(40.0, 60.0, 0.02, 4.3)));
}

// Several rows at each step, one step's loads apart; at the limit they go over many steps.
TEST(Commanded, IsNotWhatACoarseSensorReadsUpToItsLimit) {
  EXPECT_FALSE(is_commanded(read_by_sensor(30.0, 60.0, 0.1, 4.5)));
  EXPECT_FALSE(is_commanded(read_by_sensor(40.0, 60.0, 0.25, 4.5)));
}

// Loads scatter in proportion to what was set, from 0.1 to 6.4 N m.
TEST(Commanded, IsASunTorqueSetInDoublingsAtLossesThatScatter) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> loss(0.2, 0.4);
  std::vector<std::array<double, 2>> rows;
  for (int k = 0; k < 140; ++k) {
    const double sun = 0.1 * (1 << k % 7);
    rows.push_back({sun, 80.0 * sun * (1.0 - loss(random))});
  }
  EXPECT_TRUE(is_commanded(torques(rows)));
}

}  // namespace
}  // namespace gear3k::calibrate::commanded_torque_test
