#include "calibrate/loops/branch_zero.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>

namespace gear3k::calibrate::branch_zero_test {
namespace {

/// From -20 Nm to +20 Nm, θ = 0.25 + T/5000 and white noise.
TorqueAngleRecord ramp(std::size_t samples, double noise_rad, double noise_Nm, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  TorqueAngleRecord record;
  for (std::size_t i = 0; i < samples; ++i) {
    const double torque = -20.0 + 40.0 * static_cast<double>(i) / static_cast<double>(samples - 1);
    record.time_s.push_back(static_cast<double>(i));
    record.torque_Nm.push_back(torque + noise_Nm * normal(generator));
    record.angle_rad.push_back(0.25 + torque / 5000.0 + noise_rad * normal(generator));
  }
  return record;
}

BranchZero zero_of(const TorqueAngleRecord& record, Branch branch) {
  return find_branch_zero(
      filter_record(record, 0.12, 2.0 * static_cast<double>(record.time_s.size())), branch, 0.01);
}

TEST(BranchZero, OfAStraightFlankIsItsIntercept) {
  const BranchZero zero =
      zero_of(ramp(501, 0.0, 0.0, 1), {.first = 0, .last = 500, .rising = true});
  ASSERT_EQ(zero.outcome, LoopOutcome::kMeasured);
  EXPECT_TRUE(zero.rising);
  EXPECT_NEAR(zero.at->angle_rad, 0.25, 1e-12);
  EXPECT_NEAR(zero.at_double->angle_rad, 0.25, 1e-12);
  EXPECT_NEAR(zero.at->time_s, 250.0, 1e-6);
  EXPECT_LT(zero.variance_rad2, 1e-16);
}

TEST(BranchZero, StatedVarianceCoversNoiseOfAngleAndTorque) {
  for (const double noise_Nm : {0.0, 0.2}) {
    double error = 0.0;
    double stated = 0.0;
    for (unsigned seed = 1; seed <= 400; ++seed) {
      const BranchZero zero =
          zero_of(ramp(501, 1e-4, noise_Nm, seed), {.first = 0, .last = 500, .rising = true});
      ASSERT_EQ(zero.outcome, LoopOutcome::kMeasured);
      error += std::pow(zero.at->angle_rad - 0.25, 2);
      stated += zero.variance_rad2;
    }
    // Four standard errors of 400 seeds, and 5 % for the model of the noise.
    EXPECT_NEAR(std::sqrt(error / stated), 1.0, 4.0 / std::sqrt(800.0) + 0.05) << noise_Nm;
  }
}

TEST(BranchZero, SaysWhyThereIsNone) {
  const TorqueAngleRecord record = ramp(501, 0.0, 0.0, 1);
  const BranchZero partial =
      zero_of(record, {.first = 0, .last = 500, .rising = true, .loaded = false});
  EXPECT_EQ(partial.outcome, LoopOutcome::kPartialBranch);
  const BranchZero short_of_zero = zero_of(record, {.first = 0, .last = 200, .rising = true});
  EXPECT_EQ(short_of_zero.outcome, LoopOutcome::kZeroNotCrossed);
  const BranchZero brief = zero_of(record, {.first = 245, .last = 500, .rising = true});
  EXPECT_EQ(brief.outcome, LoopOutcome::kTooFewSamples);
  EXPECT_FALSE(partial.at || short_of_zero.at || brief.at);
}

}  // namespace
}  // namespace gear3k::calibrate::branch_zero_test
