#include "calibrate/loops/filtered_record.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gear3k::calibrate::filtered_record_test {
namespace {

/// Triangle between ±peak; θ = 0.25 + T/k.
TorqueAngleRecord triangle(double stiffness_Nm_rad, std::size_t samples) {
  TorqueAngleRecord record;
  for (std::size_t i = 0; i < samples; ++i) {
    const double phase = static_cast<double>(i) / 500.0;
    const double torque =
        20.0 * (1.0 - 2.0 * std::abs(phase - 2.0 * std::floor(0.5 * phase + 0.5)));
    record.time_s.push_back(0.02 * static_cast<double>(i));
    record.torque_Nm.push_back(torque);
    record.angle_rad.push_back(0.25 + torque / stiffness_Nm_rad);
  }
  return record;
}

TEST(FilteredRecord, KeepsEveryCurveOnTheLineOfTheFlank) {
  for (const double k : {5000.0, -5000.0}) {
    const FilteredRecord f = filter_record(triangle(k, 1001), 0.12, 1000.0);
    EXPECT_EQ(f.angle_sense, k > 0.0 ? 1 : -1);
    for (const TorqueAngleCurve* curve : {&f.once, &f.twice, &f.smooth}) {
      ASSERT_EQ(curve->torque_Nm.size(), 1001u);
      for (std::size_t i = 0; i < 1001; ++i) {
        EXPECT_NEAR(curve->angle_rad[i], 0.25 + curve->torque_Nm[i] / k, 1e-14);
      }
    }
  }
}

TEST(FilteredRecord, RoundsTheTurnLessTheHigherTheCutOff) {
  const FilteredRecord f = filter_record(triangle(5000.0, 1001), 0.12, 1000.0);
  const auto low = [](const std::vector<double>& x) {
    return *std::min_element(x.begin(), x.end());
  };
  EXPECT_LT(-20.0, low(f.twice.torque_Nm));
  EXPECT_LT(low(f.twice.torque_Nm), low(f.once.torque_Nm));
  EXPECT_LT(low(f.once.torque_Nm), low(f.smooth.torque_Nm));
  EXPECT_LT(low(f.smooth.torque_Nm), low(f.choice_Nm));
}

TEST(FilteredRecord, ChoosesByTheFilteredTorqueWhereTheRecordIsTooShortForLess) {
  // 15 cycles per loop would need 200 samples.
  const FilteredRecord f = filter_record(triangle(5000.0, 180), 0.12, 1000.0);
  EXPECT_EQ(f.choice_Nm, f.once.torque_Nm);
}

}  // namespace
}  // namespace gear3k::calibrate::filtered_record_test
