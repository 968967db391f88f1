#include "calibrate/dynamic/motion_windows.hpp"

#include <gtest/gtest.h>

namespace gear3k::motion_windows_test {
namespace {

using namespace calibrate;  // NOLINT(google-build-using-namespace)

// A start with constant acceleration: a and the mean weighted speed are known by hand.
TEST(MotionWindows, EvenAccelerationIsExactForSpeedsAndAngles) {
  for (const bool angle : {false, true}) {
    MotionStretch s;
    s.load_kgm2 = 0.2;
    for (int k = 0; k < 400; ++k) {
      const double t = 0.005 * k;
      s.time_s.push_back(t);
      if (angle) {
        s.angle_rad.push_back(7.0 + 2.0 * t + 0.5 * 3.0 * t * t);
      } else {
        s.speed_rad_s.push_back(2.0 + 3.0 * t);
      }
      s.motor_Nm.push_back(1.5);
      s.load_Nm.push_back(-0.4);
    }
    const auto windows =
        motion_windows({.files = {}, .stretches = {s}, .notes = {}}, {.output_coulomb_Nm = 0.1});
    ASSERT_GE(windows.size(), 1U);
    for (const MotionWindow& w : windows) {
      const double root = w.term[4];
      EXPECT_NEAR(w.term[0] / root, 3.0, 1e-9);
      EXPECT_NEAR(w.term[1] / root, 2.0 + 3.0 * w.time_s, 1e-9);
      EXPECT_DOUBLE_EQ(w.term[2] / root, 1.0);
      EXPECT_NEAR(w.term[3] / root, 0.4, 1e-12);
      EXPECT_NEAR(w.motor_Nm / root, 1.5, 1e-12);
      EXPECT_EQ(w.flow, 1);
    }
  }
}

}  // namespace
}  // namespace gear3k::motion_windows_test
