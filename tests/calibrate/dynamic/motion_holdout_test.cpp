#include "calibrate/dynamic/motion_holdout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calibrate/dynamic/window_fit.hpp"
#include "tests/calibrate/dynamic/drive_bench.hpp"

namespace gear3k::motion_holdout_test {
namespace {

using namespace calibrate;  // NOLINT(google-build-using-namespace)

using test::DriveBench;

/// Logs of a drive with more drag at the motor than is stated, each other noise; one file a log, or
/// all of them in one.
MotionRecord logs(int count, double extra_Nm, bool one_file) {
  DriveBench bench;
  bench.c1 += extra_Nm;
  bench.seconds = 6.0;
  MotionRecord all;
  for (int k = 0; k < count; ++k) {
    MotionRecord one = log_of(bench, 40 + static_cast<std::uint64_t>(k));
    one.stretches.front().log = one_file ? 0 : k;
    one.stretches.front().session = k;
    all.files.push_back("log");
    all.stretches.push_back(one.stretches.front());
  }
  return all;
}

/// What is left of the motor's torque with so much more drag at the motor, in the text's own words
/// (drag against the turn; what the load drives the motor need not, through the losses of its
/// flow).
double left_of(const MotionWindow& w, const DriveBench& b, double extra_Nm) {
  const double share = w.flow > 0 ? 1.0 / b.eta_f : b.eta_b;
  const double a = w.term[0] / w.term[4], v = w.term[1] / w.term[4], load = -w.term[3] / w.term[4];
  const double s = w.sense;
  const double motor_side = b.j1 * a + b.d1 * v + (b.c1 + extra_Nm) * s;
  const double output_side = (b.j2 + w.load_kgm2) * a + b.d2 * v + b.c2 * s - load;
  return w.motor_Nm / w.term[4] - motor_side - share * output_side;
}

TEST(MotionHoldout, PredictsEachLogByTheDragOfTheOthers) {
  const DriveBench bench;
  const DriveParameters stated = stated_of(bench);
  const auto windows = motion_windows(logs(3, 0.06, false), stated);
  const MotionHoldout held = hold_out(windows, stated, {kMotorCoulombChange});
  EXPECT_EQ(held.blocks, "log");
  ASSERT_EQ(held.residual.size(), windows.size());
  for (int log = 0; log < 3; ++log) {
    std::vector<MotionWindow> others;
    for (const MotionWindow& w : windows) {
      if (w.log != log) others.push_back(w);
    }
    const auto sums = window_sums(others);
    ASSERT_TRUE(sums);
    const double drag =
        fit_drive(*sums, stated, {kMotorCoulombChange}).changes.at(kMotorCoulombChange);
    for (std::size_t k = 0; k < windows.size(); ++k) {
      if (windows[k].log != log) continue;
      EXPECT_NEAR(held.residual[k], left_of(windows[k], bench, drag), 1e-9) << log;
    }
  }
}

TEST(MotionHoldout, FewerLogsAreHeldOutInFiveParts) {
  const DriveBench bench;
  const DriveParameters stated = stated_of(bench);
  const auto windows = motion_windows(logs(2, 0.06, true), stated);
  const MotionHoldout held = hold_out(windows, stated, {kMotorCoulombChange});
  EXPECT_EQ(held.blocks, "time");
  // The drag that each window was predicted with: few, in runs, none that of the whole.
  const auto sums = window_sums(windows);
  ASSERT_TRUE(sums);
  const double whole =
      fit_drive(*sums, stated, {kMotorCoulombChange}).changes.at(kMotorCoulombChange);
  std::vector<double> drags;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const double drag = windows[k].sense * (left_of(windows[k], bench, 0.0) - held.residual[k]);
    EXPECT_GT(std::abs(drag - whole), 1e-9);
    if (drags.empty() || std::abs(drag - drags.back()) > 1e-9) drags.push_back(drag);
  }
  EXPECT_EQ(drags.size(), 5U);
}

TEST(MotionHoldout, ErrorsAreThoseOfTheNoiseWhereTheCauseIsFound) {
  const DriveBench bench;
  const DriveParameters stated = stated_of(bench);
  const auto d = diagnose_motion(logs(4, 0.12, false), stated, {});
  ASSERT_TRUE(d);
  ASSERT_EQ(d->effects.size(), 1U);
  EXPECT_GT(d->held_out.baseline_Nm, 0.11);
  // Least squares are least on what they were fitted to; the bench's torque is 0.02 N m off.
  EXPECT_GT(d->held_out.extended_Nm, d->extended_Nm);
  EXPECT_LT(d->held_out.extended_Nm, 1.3 * std::hypot(d->noise_Nm, 0.02));
}

TEST(MotionHoldout, WhereNothingIsFoundTheDriveAsStatedPredicts) {
  const DriveBench bench;
  const DriveParameters stated = stated_of(bench);
  const auto windows = motion_windows(logs(3, 0.0, false), stated);
  const MotionHoldout held = hold_out(windows, stated, {});
  EXPECT_EQ(held.baseline_Nm, held.extended_Nm);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    EXPECT_NEAR(held.residual[k], left_of(windows[k], bench, 0.0), 1e-9);
  }
}

// Of logs of which one alone shows the losses driven back, the others do not fix how both
// directions differ.
TEST(MotionHoldout, WhatTheOtherLogsDoNotFixIsNotPredicted) {
  const DriveBench bench;
  const DriveParameters stated = stated_of(bench);
  auto windows = motion_windows(logs(3, 0.0, false), stated);
  std::erase_if(windows, [](const MotionWindow& w) { return w.log > 0 && w.flow < 0; });
  const MotionHoldout held = hold_out(windows, stated, {kLevelChange, kDirectionChange});
  std::size_t known = 0, of_first = 0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const bool is_known = std::isfinite(held.residual[k]);
    if (windows[k].log == 0) {
      EXPECT_FALSE(is_known);
      ++of_first;
    } else {
      EXPECT_TRUE(is_known);
      ++known;
    }
  }
  EXPECT_GT(known, 20U);
  EXPECT_GT(of_first, 10U);
  EXPECT_TRUE(std::isfinite(held.extended_Nm));
}

}  // namespace
}  // namespace gear3k::motion_holdout_test
