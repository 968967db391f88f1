#include "calibrate/dynamic/motion_windows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

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

/// A row every 10 ms with rows lost: every third, every fifth, or one of three by chance.
std::vector<double> thinned_times(int lost) {
  std::mt19937_64 random(7);
  std::vector<double> times;
  for (int k = 0; k < 1500; ++k) {
    const bool away = lost > 0 ? k % lost == lost - 1 : random() % 3 == 0;
    if (!away) times.push_back(0.01 * k);
  }
  return times;
}

// A speed of fourth degree in time under a torque J a + D w: every window balances to the last
// digits, whichever rows are lost.
TEST(MotionWindows, CubicAccelerationsBalanceAtAnySampling) {
  constexpr double kInertia = 0.7, kDamping = 0.3;
  for (const int lost : {0, 3, 5}) {
    for (const bool angle : {false, true}) {
      MotionStretch s;
      for (const double t : thinned_times(lost)) {
        const double u = t / 15.0;
        const double speed = 2.0 + u * (3.0 + u * (5.0 + u * (-4.0 + u * 1.5)));
        const double rate = (3.0 + u * (10.0 + u * (-12.0 + u * 6.0))) / 15.0;
        s.time_s.push_back(t);
        if (angle) {
          const double sum = u * (2.0 + u * (1.5 + u * (5.0 / 3.0 + u * (-1.0 + u * 0.3))));
          s.angle_rad.push_back(15.0 * sum);
        } else {
          s.speed_rad_s.push_back(speed);
        }
        s.motor_Nm.push_back(kInertia * rate + kDamping * speed);
      }
      const auto windows = motion_windows({.files = {}, .stretches = {s}, .notes = {}},
                                          {.output_inertia_kgm2 = 0.2});
      ASSERT_GE(windows.size(), 4U);
      for (const MotionWindow& w : windows) {
        const double torque = kInertia * w.term[0] + kDamping * w.term[1];
        EXPECT_NEAR(torque / w.term[4], w.motor_Nm / w.term[4], 1e-8) << lost << ' ' << angle;
      }
    }
  }
}

// The noise of a load that moves twice a second is told whichever rows are lost.
TEST(MotionWindows, WhiteNoiseIsToldAtAnySampling) {
  constexpr double kNoise = 0.01;
  for (const int lost : {0, 3, 5}) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> noise(0.0, kNoise);
    MotionStretch s;
    for (const double t : thinned_times(lost)) {
      s.time_s.push_back(t);
      s.speed_rad_s.push_back(2.0);
      s.motor_Nm.push_back(1.0);
      s.load_Nm.push_back(-3.0 + 2.0 * std::sin(12.0 * t) + noise(random));
    }
    const auto windows =
        motion_windows({.files = {}, .stretches = {s}, .notes = {}}, {.output_inertia_kgm2 = 0.2});
    ASSERT_GE(windows.size(), 4U);
    // The terms are scaled so that a window's variance is that of one sample.
    for (const MotionWindow& w : windows) {
      EXPECT_NEAR(std::sqrt(w.variance[1]), kNoise, 0.12 * kNoise) << lost;
    }
  }
}

}  // namespace
}  // namespace gear3k::motion_windows_test
