#include "calibrate/loops/loop_creep.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace gear3k::calibrate::loop_creep_test {
namespace {

BranchZero branch(bool rising, double time_s, double angle_rad, double variance_rad2 = 1.0) {
  BranchZero zero;
  zero.rising = rising;
  zero.at = Crossing{.angle_rad = angle_rad, .time_s = time_s};
  zero.variance_rad2 = variance_rad2;
  return zero;
}

/// Samples one second apart.
FilteredRecord seconds(std::size_t samples) {
  FilteredRecord f;
  f.secant = 4;
  for (std::size_t i = 0; i < samples; ++i) f.raw.time_s.push_back(static_cast<double>(i));
  return f;
}

TEST(LoopCreep, CommonSlopeSeesDriftAndNoneOfTheLostMotion) {
  // Uneven times; rising branches 0.7 rad below, a drift of 0.03 rad/s.
  std::vector<BranchZero> branches;
  bool rising = false;
  for (const double time : {0.0, 5.5, 9.0, 16.0, 20.0}) {
    branches.push_back(branch(rising, time, (rising ? -0.7 : 0.0) + 0.03 * time));
    rising = !rising;
  }
  branches.push_back({});  // its zero torque is not known
  const CommonSlope slope = common_slope(branches);
  ASSERT_TRUE(slope.repeats);
  double sum = 0.0;
  for (std::size_t k = 0; k < 5; ++k) sum += slope.weight_per_s[k] * branches[k].at->angle_rad;
  EXPECT_NEAR(sum, 0.03, 1e-15);
  EXPECT_EQ(slope.weight_per_s[5], 0.0);
}

TEST(LoopCreep, IsTheSlopeThatBranchesHaveInCommon) {
  const std::vector<BranchZero> branches{branch(false, 0.0, 1.0, 4e-4), branch(true, 5.0, 0.0),
                                         branch(false, 10.0, 1.2, 4e-4)};
  const std::vector<Loop> loops{{.first_sample = 0, .last_sample = 8},
                                {.first_sample = 4, .last_sample = 16}};
  const auto creep = find_creep(seconds(17), branches, loops);
  ASSERT_TRUE(creep);
  EXPECT_NEAR(creep->rad_s, 0.02, 1e-15);
  // By hand: the difference of two angles over 10 s.
  EXPECT_NEAR(creep->standard_deviation_rad_s, std::sqrt(2.0 * 4e-4) / 10.0, 1e-15);
}

TEST(LoopCreep, OfOneLoopIsItsClosingErrorOverItsDuration) {
  const std::vector<BranchZero> branches{branch(false, 2.0, 1.0), branch(true, 6.0, 0.0)};
  Loop loop{.first_sample = 0, .last_sample = 8};
  EXPECT_FALSE(find_creep(seconds(9), branches, {loop}));
  loop.closing_error_rad = 0.4;
  const auto creep = find_creep(seconds(9), branches, {loop});
  ASSERT_TRUE(creep);
  EXPECT_NEAR(creep->rad_s, 0.05, 1e-15);
}

}  // namespace
}  // namespace gear3k::calibrate::loop_creep_test
