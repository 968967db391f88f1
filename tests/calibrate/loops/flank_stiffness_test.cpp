#include "calibrate/loops/flank_stiffness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace gear3k::calibrate::flank_stiffness_test {
namespace {

/// From zero to the peak torque; θ = T/k.
FilteredRecord ramp(double peak_Nm, double stiffness_Nm_rad, std::size_t samples = 501) {
  TorqueAngleRecord record;
  for (std::size_t i = 0; i < samples; ++i) {
    const double torque = peak_Nm * static_cast<double>(i) / static_cast<double>(samples - 1);
    record.time_s.push_back(static_cast<double>(i));
    record.torque_Nm.push_back(torque);
    record.angle_rad.push_back(torque / stiffness_Nm_rad);
  }
  return filter_record(record, 0.12, 1000.0);
}

TEST(FlankStiffness, IsTheSlopeBetweenHalfAndNineTenthsOfThePeak) {
  for (const double peak : {20.0, -20.0}) {
    for (const double k : {5000.0, -5000.0}) {
      const auto found =
          flank_stiffness(ramp(peak, k), {.first = 0, .last = 500, .rising = peak > 0.0});
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->stiffness_Nm_rad, 5000.0, 1e-8);
      EXPECT_NEAR(static_cast<double>(found->first_sample), 250.0, 2.0);
      EXPECT_NEAR(static_cast<double>(found->last_sample), 450.0, 2.0);
    }
  }
}

TEST(FlankStiffness, IsRefusedWithFewSamplesAgainstTheSenseOrWithinItsDeviation) {
  // Eight samples between half and nine tenths need some 20 to the peak.
  FilteredRecord f = ramp(20.0, 5000.0);
  EXPECT_FALSE(flank_stiffness(f, {.first = 480, .last = 486, .rising = true}));
  f.angle_sense = -1;
  EXPECT_FALSE(flank_stiffness(f, {.first = 0, .last = 500, .rising = true}));
  f = ramp(20.0, 5000.0);
  for (double& angle : f.raw.angle_rad) angle = 1.0;
  EXPECT_FALSE(flank_stiffness(f, {.first = 0, .last = 500, .rising = true}));
  // A swing of the angle that dwarfs the slope.
  for (std::size_t i = 0; i < 501; ++i) {
    f.raw.angle_rad[i] = f.raw.torque_Nm[i] / 5000.0 + std::sin(0.7 * static_cast<double>(i));
  }
  EXPECT_FALSE(flank_stiffness(f, {.first = 0, .last = 500, .rising = true}));
}

TEST(FlankStiffness, ComesFromTheBranchBeforeWhereTheLoopsOwnIsNotLoaded) {
  FilteredRecord f;
  // Turning points: rising to 20, falling to -20, rising to 4, falling to -20 Nm.
  f.once.torque_Nm = {-20.0, 20.0, -20.0, 4.0, -20.0};
  const std::vector<Branch> branches{{.first = 0, .last = 1, .rising = true},
                                     {.first = 1, .last = 2},
                                     {.first = 2, .last = 3, .rising = true},
                                     {.first = 3, .last = 4}};
  EXPECT_EQ(loading_branch(f, branches, 0, true, 20.0), 0u);
  EXPECT_EQ(loading_branch(f, branches, 0, false, -20.0), 1u);
  // The loop of branches 1 and 2 begins at 20 Nm.
  EXPECT_EQ(loading_branch(f, branches, 1, true, 20.0), 0u);
  EXPECT_EQ(loading_branch(f, branches, 2, true, 4.0), 2u);
  EXPECT_EQ(loading_branch(f, branches, 2, false, -20.0), 3u);
  f.once.torque_Nm[1] = 4.0;
  EXPECT_FALSE(loading_branch(f, branches, 1, true, 20.0));
}

}  // namespace
}  // namespace gear3k::calibrate::flank_stiffness_test
