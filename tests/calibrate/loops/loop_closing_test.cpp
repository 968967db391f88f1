#include "calibrate/loops/loop_closing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>

namespace gear3k::calibrate::loop_closing_test {
namespace {

TEST(LoopClosing, TurnIsTheEndOfTheLineThatLeadsToItOrAtTheStartFollowsIt) {
  TorqueAngleRecord record;
  // Rises by 2 Nm a sample to sample 20, then falls by 3.
  for (int i = 0; i <= 40; ++i) {
    record.time_s.push_back(i);
    record.torque_Nm.push_back(i <= 20 ? 2.0 * i : 40.0 - 3.0 * (i - 20));
    record.angle_rad.push_back(0.1 + 0.5 * record.torque_Nm.back());
  }
  for (const std::size_t turn : {0, 20, 40}) {
    const TorqueAnglePoint at = point_at_turn(record, turn, 5);
    EXPECT_NEAR(at.torque_Nm, record.torque_Nm[turn], 1e-12) << turn;
    EXPECT_NEAR(at.angle_rad, record.angle_rad[turn], 1e-12) << turn;
  }
}

TEST(LoopClosing, ErrorIsReferredToTheSameTorque) {
  // Ends at 18 Nm instead of 20 and 0.003 rad beside the flank of 100 Nm/rad.
  for (const int sense : {1, -1}) {
    FilteredRecord f;
    f.secant = 2;
    f.angle_sense = sense;
    for (const double torque : {20.0, 19.0, 18.0, 17.0, -20.0, 16.0, 17.0, 18.0}) {
      const double beside = f.raw.time_s.size() > 3 ? 0.003 : 0.0;
      f.raw.time_s.push_back(static_cast<double>(f.raw.time_s.size()));
      f.raw.torque_Nm.push_back(torque);
      f.raw.angle_rad.push_back(sense * torque / 100.0 + beside);
    }
    Loop loop{.first_sample = 0, .reversal_sample = 4, .last_sample = 7};
    EXPECT_FALSE(closing_error_rad(f, loop)) << "no stiffness";
    loop.stiffness_positive = FlankStiffness{.stiffness_Nm_rad = 100.0};
    ASSERT_TRUE(closing_error_rad(f, loop));
    EXPECT_NEAR(*closing_error_rad(f, loop), 0.003, 1e-12);
    // 15 Nm is a quarter below 20.
    for (const std::size_t i : {5, 6, 7}) f.raw.torque_Nm[i] -= 3.0;
    EXPECT_FALSE(closing_error_rad(f, loop));
  }
}

TEST(LoopClosing, DeviationIsThatOfTheEndsOfTwoLinesThroughWhiteNoise) {
  constexpr std::size_t kSecant = 40;
  constexpr int kDraws = 4000;
  std::mt19937_64 generator(2);
  std::normal_distribution<double> normal;
  double squares = 0.0;
  TorqueAngleRecord record{.angle_rad = std::vector<double>(kSecant + 1, 0.0),
                           .torque_Nm = std::vector<double>(kSecant + 1, 0.0)};
  for (int draw = 0; draw < kDraws; ++draw) {
    for (double& x : record.angle_rad) x = 0.1 * normal(generator);
    squares += std::pow(point_at_turn(record, kSecant, kSecant).angle_rad, 2) / kDraws;
  }
  BranchZero branch;
  branch.noise = {.variance = 0.01};
  // 4/m holds for many samples: (4 m - 2)/(m (m + 1)) is 4 % less at 41; scatter of 4000 draws 2 %.
  EXPECT_NEAR(closing_deviation_rad(kSecant, branch, branch), std::sqrt(2.0 * squares),
              0.06 * std::sqrt(2.0 * squares));
  branch.noise.correlation = 0.5;
  EXPECT_NEAR(closing_deviation_rad(kSecant, branch, branch), std::sqrt(3.0 * 0.08 / 41.0), 1e-15);
}

}  // namespace
}  // namespace gear3k::calibrate::loop_closing_test
