#include "calibrate/loops/zero_before_jump.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include "calibrate/loops/torque_angle_loop.hpp"

namespace gear3k::calibrate::zero_before_jump_test {
namespace {

using std::numbers::pi;

/// Springs behind dry friction, with a dead band between them.
struct Gears {
  double dead_band_rad = 3e-3;
  double wind_up_rad = 1e-3;  ///< of one side at the peak
  double exponent = 1.0;      ///< of the torque in the wind-up
  double friction = 0.01;     ///< of the peak, as the next
  double edge = 0.0;          ///< over which the dead band's edge is rounded; 0: sharp
};

struct Bench {
  int samples_per_loop = 400;
  bool sine = false;
  double angle_noise_rad = 0.0, torque_noise = 0.0;  ///< the latter of the peak
  double first_phase = 0.0;                          ///< of a sample
};

constexpr double kPeak_Nm = 8.0;

double angle_of(const Gears& gears, double spring) {
  const double side = gears.edge > 0.0 ? std::tanh(spring / gears.edge)
                                       : static_cast<double>((spring > 0.0) - (spring < 0.0));
  return 0.5 * gears.dead_band_rad * side +
         std::copysign(gears.wind_up_rad * std::pow(std::abs(spring), gears.exponent), spring);
}

/// By hand: where the torque is zero the springs carry the friction to either side.
double lost_motion(const Gears& gears) { return 2.0 * angle_of(gears, gears.friction); }

/// Two and a half loops from zero torque.
TorqueAngleRecord record_of(const Gears& gears, const Bench& bench, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  TorqueAngleRecord record;
  double spring = 0.0;
  constexpr int kSteps = 20;  // of the friction, between samples
  for (int k = 0; k <= kSteps * 5 * bench.samples_per_loop / 2; ++k) {
    const double turns =
        (static_cast<double>(k) / kSteps + bench.first_phase) / bench.samples_per_loop;
    const double wave = std::sin(2.0 * pi * turns);
    const double torque = bench.sine ? wave : 2.0 / pi * std::asin(wave);
    if (torque - spring > gears.friction) spring = torque - gears.friction;
    if (spring - torque > gears.friction) spring = torque + gears.friction;
    if (k % kSteps != 0) continue;
    record.time_s.push_back(0.1 * k / kSteps);
    record.torque_Nm.push_back(kPeak_Nm * (torque + bench.torque_noise * normal(generator)));
    record.angle_rad.push_back(angle_of(gears, spring) + bench.angle_noise_rad * normal(generator));
  }
  return record;
}

TEST(ZeroBeforeJump, SharpJumpIsReadWithoutBiasAndWithAnHonestDeviation) {
  constexpr unsigned kRecords = 12;
  for (const double friction : {0.01, 0.02, 0.03}) {
    for (const int samples : {200, 400, 1600}) {
      for (const bool sine : {false, true}) {
        const Gears gears{.friction = friction};
        const double truth = lost_motion(gears);
        double error = 0.0, squares = 0.0, stated = 0.0, count = 0.0;
        for (unsigned seed = 1; seed <= kRecords; ++seed) {
          const Bench bench{.samples_per_loop = samples,
                            .sine = sine,
                            .angle_noise_rad = 3e-5,
                            .torque_noise = 1e-3,
                            .first_phase = 0.08 * seed};
          for (const Loop& loop : analyse_loops(record_of(gears, bench, seed)).loops) {
            if (loop.outcome != LoopOutcome::kMeasured) continue;
            error += loop.lost_motion_rad - truth;
            squares += std::pow(loop.lost_motion_rad - truth, 2);
            stated += std::pow(loop.lost_motion_sd_rad, 2);
            count += 1.0;
          }
        }
        // Five branches make four loops, of which the first is from rest.
        ASSERT_GT(count, 2.5 * kRecords) << friction << ' ' << samples << ' ' << sine;
        // Four standard errors; neighbouring loops share a branch.
        const double mean_error = std::sqrt(2.0 * squares) / count;
        EXPECT_LT(std::abs(error / count), 4.0 * mean_error + 1e-3 * truth)
            << friction << ' ' << samples << ' ' << sine << ' ' << error / count / truth;
        // 200 samples per loop leave little to tell the noise by: it is then overstated.
        EXPECT_LT(std::sqrt(squares / stated), 1.3) << friction << ' ' << samples << ' ' << sine;
        EXPECT_GT(std::sqrt(squares / stated), samples > 200 ? 0.7 : 0.4)
            << friction << ' ' << samples << ' ' << sine;
      }
    }
  }
}

TEST(ZeroBeforeJump, WithoutNoiseTheReadingIsExactOnStraightFlanksAndCloseOnCurvedOnes) {
  for (const double friction : {0.01, 0.02, 0.03}) {
    for (const int samples : {200, 800, 3000}) {
      const Gears straight{.friction = friction};
      const Gears hertz{.exponent = 2.0 / 3.0, .friction = friction};
      for (const Loop& loop :
           analyse_loops(record_of(straight, {.samples_per_loop = samples}, 1)).loops) {
        if (loop.outcome != LoopOutcome::kMeasured) continue;
        EXPECT_NEAR(loop.lost_motion_rad, lost_motion(straight), 1e-6 * lost_motion(straight));
        EXPECT_NEAR(loop.change_at_double_cutoff_rad, 0.0, 1e-15);
      }
      for (const Loop& loop :
           analyse_loops(record_of(hertz, {.samples_per_loop = samples}, 1)).loops) {
        if (loop.outcome != LoopOutcome::kMeasured) continue;
        EXPECT_NEAR(loop.lost_motion_rad, lost_motion(hertz), 0.01 * lost_motion(hertz))
            << friction << ' ' << samples;
      }
    }
  }
}

TEST(ZeroBeforeJump, RoundedEdgeThatReachesZeroTorqueIsToldAndLeavesTheTravel) {
  for (const double friction : {0.01, 0.02}) {
    for (const int samples : {200, 400, 800, 8000}) {
      const Gears gears{.friction = friction, .edge = friction};
      const Bench bench{.samples_per_loop = samples, .angle_noise_rad = 1e-5, .torque_noise = 5e-4};
      const LoopAnalysis analysis = analyse_loops(record_of(gears, bench, 3));
      int told = 0;
      for (const Loop& loop : analysis.loops) {
        if (loop.outcome == LoopOutcome::kPartialBranch) continue;
        EXPECT_EQ(loop.outcome, LoopOutcome::kAtEdge) << loop_outcome_text(loop.outcome);
        ++told;
        ASSERT_GE(loop.travel.size(), 4U);
        for (const TravelAtTorque& travel : loop.travel) {
          const double torque = travel.torque_Nm / kPeak_Nm;
          if (torque < 0.2) continue;
          EXPECT_NEAR(travel.angle_rad, 2.0 * angle_of(gears, torque - friction),
                      0.01 * gears.dead_band_rad);
        }
      }
      EXPECT_GE(told, 3) << friction << ' ' << samples;
    }
  }
}

TEST(ZeroBeforeJump, AJumpBeyondTheFilterIsReadFiltered) {
  // Friction of a tenth of the peak is 40 samples away, the filter reaches 23.
  const LoopAnalysis analysis = analyse_loops(
      record_of({.friction = 0.1}, {.samples_per_loop = 1600, .angle_noise_rad = 1e-5}, 1));
  int filtered = 0;
  for (const Loop& loop : analysis.loops) {
    if (loop.outcome != LoopOutcome::kMeasured) continue;
    EXPECT_NE(loop.change_at_double_cutoff_rad, 0.0);
    ++filtered;
  }
  EXPECT_GE(filtered, 2);
}

}  // namespace
}  // namespace gear3k::calibrate::zero_before_jump_test
