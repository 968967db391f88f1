#include "calibrate/loops/torque_angle_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace gear3k::calibrate::torque_angle_loop_test {
namespace {

using std::numbers::pi;

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// A shaft behind a dead band and two springs, moved against Coulomb friction.
struct Gearbox {
  double dead_band_rad = 2e-3;
  double positive_Nm_rad = 5000.0, negative_Nm_rad = 4000.0;
  double friction_Nm = 1.0;
  double angle_offset_rad = 0.3;

  /// By hand: the springs carry ±friction where the torque is zero.
  [[nodiscard]] double lost_motion_rad() const {
    return dead_band_rad + friction_Nm * (1.0 / positive_Nm_rad + 1.0 / negative_Nm_rad);
  }
  /// By hand: they carry the torque less friction on the loading flanks.
  [[nodiscard]] double travel_rad(double torque_Nm) const {
    return dead_band_rad +
           (torque_Nm - friction_Nm) * (1.0 / positive_Nm_rad + 1.0 / negative_Nm_rad);
  }
};

struct Ramp {
  std::size_t samples_per_loop = 1000;
  int half_loops = 2;
  double peak_Nm = 20.0;
  bool from_peak = true;  ///< else from zero, with a quarter loop before
  double step_s = 0.02;
  double time_jitter = 0.0;  ///< of a step
};

struct Scatter {
  double angle_rad = 0.0, torque_Nm = 0.0;
  double correlation = 0.0;  ///< of neighbouring angles
  double drift_rad_s = 0.0;
};

class Normal {
 public:
  explicit Normal(unsigned seed) : generator_(seed) {}
  double operator()() { return distribution_(generator_); }
  double uniform() { return std::uniform_real_distribution<double>(-0.5, 0.5)(generator_); }

 private:
  std::mt19937_64 generator_;
  std::normal_distribution<double> distribution_;
};

TorqueAngleRecord measure(const Gearbox& gearbox, const Ramp& ramp, const Scatter& scatter = {},
                          unsigned seed = 1) {
  const std::size_t quarter = ramp.samples_per_loop / 4;
  const std::size_t lead = ramp.from_peak ? 0 : quarter;
  const std::size_t n = lead + static_cast<std::size_t>(ramp.half_loops) * 2 * quarter + 1;
  Normal normal(seed);
  TorqueAngleRecord record;
  record.time_s.reserve(n);
  record.angle_rad.reserve(n);
  record.torque_Nm.reserve(n);
  double spring = ramp.from_peak ? ramp.peak_Nm - gearbox.friction_Nm : 0.0;
  double correlated = normal();
  for (std::size_t i = 0; i < n; ++i) {
    // Triangle, 1 at the end of the lead.
    const double phase =
        (static_cast<double>(i) - static_cast<double>(lead)) / static_cast<double>(2 * quarter);
    const double folded = std::abs(phase - 2.0 * std::floor(0.5 * phase + 0.5));
    const double torque = ramp.peak_Nm * (1.0 - 2.0 * folded);
    spring = std::clamp(spring, torque - gearbox.friction_Nm, torque + gearbox.friction_Nm);
    const double angle =
        (spring > 0.0 ? spring / gearbox.positive_Nm_rad : spring / gearbox.negative_Nm_rad) +
        0.5 * gearbox.dead_band_rad * ((spring > 0.0) - (spring < 0.0));
    const double time =
        ramp.step_s * (static_cast<double>(i) + ramp.time_jitter * normal.uniform());
    correlated = scatter.correlation * correlated +
                 std::sqrt(1.0 - scatter.correlation * scatter.correlation) * normal();
    record.time_s.push_back(time);
    record.angle_rad.push_back(gearbox.angle_offset_rad + angle + scatter.angle_rad * correlated +
                               scatter.drift_rad_s * time);
    record.torque_Nm.push_back(torque + scatter.torque_Nm * normal());
  }
  return record;
}

/// The difference of the two angles at zero torque, by the two samples around it.
double unfiltered_lost_motion(const TorqueAngleRecord& record) {
  double falling = 0.0;
  double rising = 0.0;
  for (std::size_t i = 0; i + 1 < record.torque_Nm.size(); ++i) {
    const double t0 = record.torque_Nm[i];
    const double t1 = record.torque_Nm[i + 1];
    const double at_zero = (t1 * record.angle_rad[i] - t0 * record.angle_rad[i + 1]) / (t1 - t0);
    if (t0 >= 0.0 && t1 < 0.0) falling = at_zero;
    if (t0 < 0.0 && t1 >= 0.0) rising = at_zero;
  }
  return falling - rising;
}

void expect_no_nan(const LoopAnalysis& analysis) {
  EXPECT_TRUE(std::isfinite(analysis.cutoff_Hz));
  if (analysis.creep) {
    EXPECT_TRUE(std::isfinite(analysis.creep->rad_s) &&
                std::isfinite(analysis.creep->standard_deviation_rad_s));
  }
  for (const Loop& loop : analysis.loops) {
    for (const double x :
         {loop.lost_motion_rad, loop.lost_motion_sd_rad, loop.falling_zero_angle_rad,
          loop.rising_zero_angle_rad, loop.extrapolated_torque_Nm, loop.change_at_double_cutoff_rad,
          loop.closing_error_rad.value_or(0.0), loop.asymmetry.value_or(0.0)}) {
      EXPECT_TRUE(std::isfinite(x)) << loop_outcome_text(loop.outcome);
    }
  }
}

// --- noise-free loops ---------------------------------------------------------------------------

TEST(TorqueAngleLoop, FindsDeadBandFrictionAndBothStiffnesses) {
  for (const double friction : {0.8, 2.0, 5.0}) {
    for (const double dead_band : {0.0, 2e-4, 2e-3, 2e-2}) {
      const Gearbox gearbox{.dead_band_rad = dead_band, .friction_Nm = friction};
      const LoopAnalysis analysis = analyse_loops(measure(gearbox, {.samples_per_loop = 2000}));
      ASSERT_EQ(analysis.outcome, RecordOutcome::kLoops);
      ASSERT_EQ(analysis.loops.size(), 1u);
      const Loop& loop = analysis.loops[0];
      EXPECT_EQ(loop.outcome, LoopOutcome::kMeasured) << loop_outcome_text(loop.outcome);
      EXPECT_TRUE(loop.falling_first);
      EXPECT_EQ(loop.reversal_sample, 1000u);
      // The filter's tail of the dead band's jump, friction/peak of a quarter loop away.
      EXPECT_NEAR(loop.lost_motion_rad, gearbox.lost_motion_rad(),
                  0.02 * dead_band + 2e-3 * gearbox.lost_motion_rad())
          << friction << ' ' << dead_band;
      ASSERT_TRUE(loop.stiffness_positive && loop.stiffness_negative);
      EXPECT_NEAR(loop.stiffness_positive->stiffness_Nm_rad, 5000.0, 5000.0 * 1e-9);
      EXPECT_NEAR(loop.stiffness_negative->stiffness_Nm_rad, 4000.0, 4000.0 * 1e-9);
      EXPECT_NEAR(*loop.asymmetry, 1000.0 / 4500.0, 1e-9);
      ASSERT_EQ(loop.travel.size(), 5u);
      for (const TravelAtTorque& travel : loop.travel) {
        // At 0.1 of the peak friction may hold it in the dead band.
        if (travel.torque_Nm < 1.5 * friction) continue;
        EXPECT_NEAR(travel.angle_rad, gearbox.travel_rad(travel.torque_Nm),
                    2e-3 * gearbox.travel_rad(20.0))
            << travel.torque_Nm;
      }
      EXPECT_NEAR(loop.highest_torque_Nm, 20.0, 0.25);
      EXPECT_NEAR(loop.lowest_torque_Nm, -20.0, 0.25);
    }
  }
}

TEST(TorqueAngleLoop, AgreesWithInterpolationBetweenTheRawSamplesWithoutNoise) {
  for (const double friction : {1.0, 3.0}) {
    const Gearbox gearbox{.friction_Nm = friction};
    const TorqueAngleRecord record = measure(gearbox, {.samples_per_loop = 40000});
    const double brute_force = unfiltered_lost_motion(record);
    EXPECT_NEAR(brute_force, gearbox.lost_motion_rad(), 1e-6 * brute_force);
    const Loop loop = analyse_loops(record).loops[0];
    EXPECT_NEAR(loop.lost_motion_rad, brute_force, 0.01 * brute_force);
    // A finer filter comes closer.
    EXPECT_LT(std::abs(loop.lost_motion_rad + loop.change_at_double_cutoff_rad - brute_force),
              std::abs(loop.lost_motion_rad - brute_force));
  }
}

TEST(TorqueAngleLoop, ScalesWithTheUnitsOfAngleTorqueAndTime) {
  const TorqueAngleRecord record =
      measure({}, {.half_loops = 4}, {.angle_rad = 5e-5, .torque_Nm = 0.05});
  const LoopAnalysis base = analyse_loops(record);
  // Powers of two: the same roundings.
  TorqueAngleRecord scaled = record;
  for (double& x : scaled.angle_rad) x *= 8.0;
  for (double& x : scaled.torque_Nm) x *= 0.25;
  for (double& x : scaled.time_s) x *= 1024.0;
  const LoopAnalysis other = analyse_loops(scaled);
  ASSERT_EQ(base.loops.size(), 3u);
  ASSERT_EQ(other.loops.size(), 3u);
  EXPECT_EQ(other.cutoff_per_sample, base.cutoff_per_sample);
  for (std::size_t k = 0; k < 3; ++k) {
    const Loop& a = base.loops[k];
    const Loop& b = other.loops[k];
    EXPECT_EQ(a.outcome, LoopOutcome::kMeasured);
    EXPECT_EQ(b.outcome, LoopOutcome::kMeasured);
    EXPECT_NEAR(b.lost_motion_rad, 8.0 * a.lost_motion_rad, 16.0 * kEps);
    EXPECT_NEAR(b.lost_motion_sd_rad, 8.0 * a.lost_motion_sd_rad, 16.0 * kEps);
    EXPECT_NEAR(b.stiffness_positive->stiffness_Nm_rad,
                a.stiffness_positive->stiffness_Nm_rad / 32.0, 1e-9);
    EXPECT_NEAR(*b.asymmetry, *a.asymmetry, 1e-9);
  }
}

TEST(TorqueAngleLoop, ReversedSignsKeepLostMotionAndSwapTheSides) {
  const TorqueAngleRecord record = measure({}, {.half_loops = 2}, {.angle_rad = 5e-5});
  const Loop base = analyse_loops(record).loops[0];
  const auto reversed = [&](bool angle, bool torque) {
    TorqueAngleRecord r = record;
    for (double& x : r.angle_rad) x = angle ? -x : x;
    for (double& x : r.torque_Nm) x = torque ? -x : x;
    return analyse_loops(r);
  };
  for (const auto& [angle, torque] :
       {std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
    const LoopAnalysis analysis = reversed(angle, torque);
    const Loop& loop = analysis.loops[0];
    EXPECT_EQ(analysis.angle_sense, angle == torque ? 1 : -1);
    EXPECT_EQ(loop.outcome, LoopOutcome::kMeasured);
    EXPECT_NEAR(loop.lost_motion_rad, base.lost_motion_rad, 1e-12);
    EXPECT_NEAR(loop.lost_motion_sd_rad, base.lost_motion_sd_rad, 1e-12);
    EXPECT_EQ(loop.falling_first, !torque);
    EXPECT_NEAR(*loop.asymmetry, torque ? -*base.asymmetry : *base.asymmetry, 1e-9);
    EXPECT_GT(loop.stiffness_positive->stiffness_Nm_rad, 0.0);
  }
}

TEST(TorqueAngleLoop, UnevenlySampledTimeLeavesTheLoopUnchanged) {
  const Gearbox gearbox;
  const TorqueAngleRecord even = measure(gearbox, {});
  TorqueAngleRecord stretched = even;
  for (std::size_t i = 0; i < even.time_s.size(); ++i) {
    stretched.time_s[i] = std::pow(even.time_s[i], 1.5);
  }
  EXPECT_EQ(analyse_loops(stretched).loops[0].lost_motion_rad,
            analyse_loops(even).loops[0].lost_motion_rad);

  // Every second sample of the negative half dropped: the same curve, sampled unevenly.
  const TorqueAngleRecord dense = measure(gearbox, {.samples_per_loop = 4000});
  TorqueAngleRecord thinned;
  for (std::size_t i = 0; i < dense.time_s.size(); ++i) {
    if (dense.torque_Nm[i] < 0.0 && i % 2 == 1) continue;
    thinned.time_s.push_back(dense.time_s[i]);
    thinned.angle_rad.push_back(dense.angle_rad[i]);
    thinned.torque_Nm.push_back(dense.torque_Nm[i]);
  }
  const Loop loop = analyse_loops(thinned).loops[0];
  EXPECT_EQ(loop.outcome, LoopOutcome::kMeasured);
  EXPECT_NEAR(loop.lost_motion_rad, gearbox.lost_motion_rad(), 0.02 * gearbox.lost_motion_rad());
  EXPECT_NEAR(loop.stiffness_negative->stiffness_Nm_rad, 4000.0, 1e-4);
}

/// The angle turned slowly to and fro, the torque measured: -friction on the way down.
TorqueAngleRecord turn(const Gearbox& gearbox, bool sine, std::size_t dwell, const Scatter& scatter,
                       unsigned seed) {
  Normal normal(seed);
  TorqueAngleRecord record;
  double spring = 0.0;
  double before = 0.0;
  const auto add = [&](double angle) {
    // Stiffness of the contact in friction: 20 times that of the flank.
    spring = std::clamp(spring + 20.0 * gearbox.positive_Nm_rad * (angle - before),
                        -gearbox.friction_Nm, gearbox.friction_Nm);
    before = angle;
    const double half = 0.5 * gearbox.dead_band_rad;
    const double flank = angle > half    ? gearbox.positive_Nm_rad * (angle - half)
                         : angle < -half ? gearbox.negative_Nm_rad * (angle + half)
                                         : 0.0;
    record.time_s.push_back(0.02 * static_cast<double>(record.time_s.size()));
    record.angle_rad.push_back(angle + scatter.angle_rad * normal());
    record.torque_Nm.push_back(flank + spring + scatter.torque_Nm * normal());
  };
  for (int i = -500; i <= 1000; ++i) {
    const double phase = i / 1000.0;  // -0.5 to 1: from the middle, up, down and up again
    const double triangle =
        phase < 0.0 ? 1.0 + 2.0 * phase : 1.0 - 4.0 * std::min(phase, 1.0 - phase);
    const double angle = 6e-3 * (sine ? std::sin(0.5 * pi * triangle) : triangle);
    add(angle);
    if (i == 0 || i == 500) {
      for (std::size_t k = 0; k < dwell; ++k) add(angle);
    }
  }
  return record;
}

TEST(TorqueAngleLoop, TurnedAngleGivesTheSameAsRampedTorque) {
  // The friction contact yields by 2 friction/(20 k) at each reversal, not at zero torque.
  const Gearbox gearbox{.positive_Nm_rad = 5000.0, .negative_Nm_rad = 5000.0, .friction_Nm = 2.0};
  for (const bool sine : {false, true}) {
    for (const std::size_t dwell : {std::size_t{0}, std::size_t{100}}) {
      for (unsigned seed = 1; seed <= 20; ++seed) {
        const LoopAnalysis analysis =
            analyse_loops(turn(gearbox, sine, dwell, {.angle_rad = 1e-5, .torque_Nm = 0.2}, seed));
        ASSERT_EQ(analysis.loops.size(), 2u) << sine << dwell;
        const Loop& loop = analysis.loops[1];
        EXPECT_EQ(loop.outcome, LoopOutcome::kMeasured) << loop_outcome_text(loop.outcome);
        EXPECT_NEAR(loop.lost_motion_rad, gearbox.lost_motion_rad(),
                    4.0 * loop.lost_motion_sd_rad + 0.01 * gearbox.lost_motion_rad());
        EXPECT_LT(loop.lost_motion_sd_rad, 0.05 * gearbox.lost_motion_rad());
        EXPECT_NEAR(loop.stiffness_positive->stiffness_Nm_rad, 5000.0,
                    5.0 * loop.stiffness_positive->standard_deviation_Nm_rad);
      }
    }
  }
}

TEST(TorqueAngleLoop, TorqueThatRestsAtZeroIsAmbiguous) {
  const LoopAnalysis analysis =
      analyse_loops(turn({.friction_Nm = 0.0}, false, 0, {.torque_Nm = 0.05}, 1));
  const Loop& loop = analysis.loops.at(1);
  EXPECT_EQ(loop.outcome, LoopOutcome::kZeroAmbiguous) << loop_outcome_text(loop.outcome);
  EXPECT_LT(std::abs(loop.lost_motion_rad - 2e-3), 3.0 * loop.lost_motion_sd_rad);
  // The middle of the dead band.
  EXPECT_NEAR(loop.falling_zero_angle_rad, 0.0, 0.25 * 2e-3);
  EXPECT_NEAR(loop.rising_zero_angle_rad, 0.0, 0.25 * 2e-3);
  expect_no_nan(analysis);
}

// --- noise --------------------------------------------------------------------------------------

TEST(TorqueAngleLoop, NoiseMakesNoReversalsAndEveryPairIsALoop) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const LoopAnalysis analysis =
        analyse_loops(measure({}, {.half_loops = 7, .from_peak = false, .time_jitter = 0.8},
                              {.angle_rad = 2e-4, .torque_Nm = 1.0}, seed));
    ASSERT_EQ(analysis.loops.size(), 7u) << seed;
    for (std::size_t k = 0; k < 7; ++k) {
      EXPECT_NEAR(static_cast<double>(analysis.loops[k].reversal_sample),
                  250.0 + 500.0 * static_cast<double>(k), 25.0);
    }
    // The first branch starts from zero torque.
    EXPECT_EQ(analysis.loops[0].outcome, LoopOutcome::kPartialBranch);
    for (std::size_t k = 1; k < 7; ++k) {
      const Loop& loop = analysis.loops[k];
      EXPECT_EQ(loop.falling_first, k % 2 == 1);
      if (k < 6) {
        EXPECT_EQ(loop.last_sample, analysis.loops[k + 1].reversal_sample);
      }
    }
  }
}

struct Coverage {
  double error_over_stated = 0.0;  ///< root-mean-square error over root-mean-square stated
  double within95 = 0.0, bias_over_stated = 0.0;
  int count = 0;
};

Coverage coverage(const Gearbox& gearbox, const Ramp& ramp, const Scatter& scatter) {
  constexpr unsigned kSeeds = 400;
  Coverage c;
  double error = 0.0;
  double stated = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const LoopAnalysis analysis = analyse_loops(measure(gearbox, ramp, scatter, seed));
    const Loop& loop = analysis.loops.at(0);
    if (loop.outcome != LoopOutcome::kMeasured) continue;
    const double e = loop.lost_motion_rad - gearbox.lost_motion_rad();
    error += e * e;
    stated += loop.lost_motion_sd_rad * loop.lost_motion_sd_rad;
    c.within95 += std::abs(e) < 1.96 * loop.lost_motion_sd_rad ? 1.0 : 0.0;
    c.bias_over_stated += e;
    ++c.count;
  }
  c.bias_over_stated /= std::sqrt(stated * c.count);
  c.error_over_stated = std::sqrt(error / stated);
  c.within95 /= c.count;
  return c;
}

// Four standard errors of a ratio of root-mean-squares and of a fraction of 95 % over 400 seeds,
// and 5 % for what the noise model itself leaves open.
void expect_covered(const Coverage& c, const std::string& name) {
  EXPECT_GE(c.count, 390) << name;
  EXPECT_NEAR(c.error_over_stated, 1.0, 4.0 / std::sqrt(2.0 * 400.0) + 0.05) << name;
  EXPECT_NEAR(c.within95, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / 400.0)) << name;
}

TEST(TorqueAngleLoop, StatedDeviationCoversTheErrorForWhiteAndCorrelatedNoise) {
  const Gearbox gearbox{.friction_Nm = 4.0};
  expect_covered(coverage(gearbox, {}, {.angle_rad = 1e-4}), "exact torque");
  expect_covered(coverage(gearbox, {}, {.angle_rad = 1e-4, .torque_Nm = 0.4}), "both noisy");
  expect_covered(coverage(gearbox, {}, {.angle_rad = 1e-4, .correlation = 0.5}), "correlated");
  expect_covered(coverage(gearbox, {}, {.angle_rad = 1e-4, .correlation = -0.4}), "alternating");
  expect_covered(coverage(gearbox, {.samples_per_loop = 400}, {.angle_rad = 1e-4}), "few samples");
}

TEST(TorqueAngleLoop, StatedDeviationCoversTheErrorWhereABranchEndsShortOfZero) {
  // The rising branch ends two steps of 0.08 Nm short of zero.
  const Gearbox gearbox{.friction_Nm = 4.0};
  double error = 0.0;
  double stated = 0.0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    TorqueAngleRecord record = measure(gearbox, {}, {.angle_rad = 1e-4}, seed);
    for (auto* column : {&record.time_s, &record.angle_rad, &record.torque_Nm}) column->resize(749);
    const Loop loop = analyse_loops(record).loops.at(0);
    ASSERT_EQ(loop.outcome, LoopOutcome::kMeasured) << loop_outcome_text(loop.outcome);
    EXPECT_NEAR(loop.extrapolated_torque_Nm, 0.16, 1e-6);
    EXPECT_FALSE(loop.stiffness_positive);
    EXPECT_TRUE(loop.stiffness_negative);
    error += std::pow(loop.lost_motion_rad - gearbox.lost_motion_rad(), 2);
    stated += std::pow(loop.lost_motion_sd_rad, 2);
  }
  EXPECT_NEAR(std::sqrt(error / stated), 1.0, 0.2);
}

TEST(TorqueAngleLoop, StiffnessIsUnbiasedWithNoiseOnBothAndItsDeviationCoversIt) {
  const Gearbox gearbox;
  constexpr unsigned kSeeds = 400;
  // Regressing torque on so noisy an angle would lose a tenth of the slope.
  for (const Scatter& scatter : {Scatter{.angle_rad = 1.5e-4, .torque_Nm = 0.7},
                                 Scatter{.angle_rad = 1.5e-4, .correlation = 0.6}}) {
    double sum = 0.0;
    double squares = 0.0;
    double stated = 0.0;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const Loop loop = analyse_loops(measure(gearbox, {}, scatter, seed)).loops[0];
      ASSERT_TRUE(loop.stiffness_positive);
      const double e = loop.stiffness_positive->stiffness_Nm_rad - 5000.0;
      sum += e;
      squares += e * e;
      stated += std::pow(loop.stiffness_positive->standard_deviation_Nm_rad, 2);
    }
    EXPECT_LT(std::abs(sum / kSeeds), 4.0 * std::sqrt(stated / kSeeds) / std::sqrt(kSeeds));
    EXPECT_NEAR(std::sqrt(squares / stated), 1.0, 0.19);
  }
}

// --- creep --------------------------------------------------------------------------------------

TEST(TorqueAngleLoop, CreepIsReportedAndStaysInTheLostMotion) {
  const Gearbox gearbox{.friction_Nm = 4.0};
  // 20 s a loop.
  for (const int half_loops : {2, 3, 6}) {
    const TorqueAngleRecord record =
        measure(gearbox, {.half_loops = half_loops}, {.drift_rad_s = 1e-4});
    const LoopAnalysis as_is = analyse_loops(record);
    ASSERT_TRUE(as_is.creep) << half_loops;
    EXPECT_NEAR(as_is.creep->rad_s, 1e-4, 2e-6) << half_loops;
    // Falling to rising, half a loop apart.
    EXPECT_NEAR(as_is.loops[0].lost_motion_rad, gearbox.lost_motion_rad() - 1e-3, 3e-5);
    EXPECT_EQ(as_is.loops[0].outcome, LoopOutcome::kDoesNotClose);
    ASSERT_TRUE(as_is.loops[0].closing_error_rad);
    EXPECT_NEAR(*as_is.loops[0].closing_error_rad, 2e-3, 4e-5);
  }
}

TEST(TorqueAngleLoop, LoopsWithUnequalPeaksAreComparedAtTheSameTorque) {
  // Ends 1.2 Nm short of the peak it started from.
  TorqueAngleRecord record = measure({}, {});
  for (auto* column : {&record.time_s, &record.angle_rad, &record.torque_Nm}) column->resize(971);
  const Loop loop = analyse_loops(record).loops[0];
  ASSERT_TRUE(loop.closing_error_rad);
  EXPECT_NEAR(*loop.closing_error_rad, 0.0, 1e-7);
  EXPECT_EQ(loop.outcome, LoopOutcome::kMeasured);
}

TEST(TorqueAngleLoop, StatedDeviationOfTheCreepCoversItsError) {
  double error = 0.0;
  double stated = 0.0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const LoopAnalysis analysis = analyse_loops(measure(
        {.friction_Nm = 4.0}, {.half_loops = 6}, {.angle_rad = 1e-4, .drift_rad_s = 1e-5}, seed));
    ASSERT_TRUE(analysis.creep);
    error += std::pow(analysis.creep->rad_s - 1e-5, 2);
    stated += std::pow(analysis.creep->standard_deviation_rad_s, 2);
  }
  EXPECT_NEAR(std::sqrt(error / stated), 1.0, 0.2);
}

// --- what cannot be measured --------------------------------------------------------------------

TEST(TorqueAngleLoop, SaysWhyThereIsNoLoop) {
  TorqueAngleRecord flat;
  for (int i = 0; i < 200; ++i) {
    flat.time_s.push_back(i);
    flat.angle_rad.push_back(0.0);
    flat.torque_Nm.push_back(3.0);
  }
  EXPECT_EQ(analyse_loops(flat).outcome, RecordOutcome::kTooFewReversals);
  EXPECT_EQ(analyse_loops(measure({}, {.half_loops = 1})).outcome, RecordOutcome::kTooFewReversals);
  EXPECT_EQ(analyse_loops({}).outcome, RecordOutcome::kTooFewSamples);
  EXPECT_EQ(analyse_loops(measure({}, {.samples_per_loop = 12})).outcome,
            RecordOutcome::kTooFewSamples);
  for (const auto outcome :
       {RecordOutcome::kLoops, RecordOutcome::kTooFewSamples, RecordOutcome::kTooFewReversals}) {
    EXPECT_FALSE(record_outcome_text(outcome).empty());
    EXPECT_EQ(record_outcome_remedy(outcome).empty(), outcome == RecordOutcome::kLoops);
  }
}

TEST(TorqueAngleLoop, SaysWhyALoopIsNotMeasured) {
  // Zero torque is never reached.
  TorqueAngleRecord one_sided = measure({}, {});
  for (double& x : one_sided.torque_Nm) x += 25.0;
  LoopAnalysis analysis = analyse_loops(one_sided);
  ASSERT_EQ(analysis.loops.size(), 1u);
  EXPECT_EQ(analysis.loops[0].outcome, LoopOutcome::kZeroNotCrossed);
  EXPECT_EQ(analysis.loops[0].lost_motion_rad, 0.0);
  expect_no_nan(analysis);

  // A quarter loop from zero, then half a loop: one full branch only.
  analysis = analyse_loops(measure({}, {.half_loops = 1, .from_peak = false}));
  ASSERT_EQ(analysis.loops.size(), 1u);
  EXPECT_EQ(analysis.loops[0].outcome, LoopOutcome::kPartialBranch);
  EXPECT_EQ(analysis.loops[0].lost_motion_rad, 0.0);
  expect_no_nan(analysis);

  // The last branch stops at -2 Nm of -20: too far from zero to continue it.
  TorqueAngleRecord cut = measure({}, {});
  for (auto* column : {&cut.time_s, &cut.angle_rad, &cut.torque_Nm}) column->resize(726);
  analysis = analyse_loops(cut);
  ASSERT_EQ(analysis.loops.size(), 1u);
  EXPECT_EQ(analysis.loops[0].outcome, LoopOutcome::kZeroNotCrossed);

  // Eight samples from the reversal to zero, less the reach of the filter.
  analysis = analyse_loops(measure({}, {.samples_per_loop = 32, .half_loops = 4}));
  ASSERT_FALSE(analysis.loops.empty());
  for (const Loop& loop : analysis.loops) EXPECT_EQ(loop.outcome, LoopOutcome::kTooFewSamples);
  expect_no_nan(analysis);

  // A moved sensor: half the lost motion between the two branches' ends.
  TorqueAngleRecord slipped = measure({}, {});
  for (std::size_t i = 400; i < slipped.angle_rad.size(); ++i) slipped.angle_rad[i] += 1e-3;
  EXPECT_EQ(analyse_loops(slipped).loops[0].outcome, LoopOutcome::kDoesNotClose);

  // A sensor that averages over nine samples rounds the dead band's jump, two samples from zero.
  const TorqueAngleRecord jump = measure({.dead_band_rad = 2e-2, .friction_Nm = 0.2}, {});
  TorqueAngleRecord rounded = jump;
  for (std::size_t i = 4; i + 4 < jump.angle_rad.size(); ++i) {
    double sum = 0.0;
    for (std::size_t k = i - 4; k <= i + 4; ++k) sum += jump.angle_rad[k];
    rounded.angle_rad[i] = sum / 9.0;
  }
  analysis = analyse_loops(rounded);
  EXPECT_EQ(analysis.loops[0].outcome, LoopOutcome::kAtEdge);
  expect_no_nan(analysis);
  EXPECT_EQ(analyse_loops(jump).loops[0].outcome, LoopOutcome::kMeasured);

  for (const auto outcome :
       {LoopOutcome::kMeasured, LoopOutcome::kPartialBranch, LoopOutcome::kZeroNotCrossed,
        LoopOutcome::kTooFewSamples, LoopOutcome::kDoesNotClose, LoopOutcome::kZeroAmbiguous,
        LoopOutcome::kDependsOnFilter, LoopOutcome::kAtEdge}) {
    EXPECT_FALSE(loop_outcome_text(outcome).empty());
    EXPECT_EQ(loop_outcome_remedy(outcome).empty(), outcome == LoopOutcome::kMeasured);
  }
}

TEST(TorqueAngleLoop, RigidAndPureNoiseRecordsHaveNoStiffness) {
  TorqueAngleRecord rigid = measure({}, {});
  std::fill(rigid.angle_rad.begin(), rigid.angle_rad.end(), 0.25);
  LoopAnalysis analysis = analyse_loops(rigid);
  EXPECT_FALSE(analysis.loops[0].stiffness_positive);
  EXPECT_EQ(analysis.loops[0].lost_motion_rad, 0.0);
  expect_no_nan(analysis);
  Normal normal(3);
  for (double& x : rigid.angle_rad) x = 0.01 * normal();
  analysis = analyse_loops(rigid);
  EXPECT_FALSE(analysis.loops[0].asymmetry);
  expect_no_nan(analysis);
}

TEST(TorqueAngleLoop, RefusesBrokenRecordsAndOptions) {
  const TorqueAngleRecord good = measure({}, {});
  TorqueAngleRecord r = good;
  r.angle_rad.pop_back();
  EXPECT_THROW(analyse_loops(r), std::invalid_argument);
  r = good;
  r.torque_Nm[7] = std::nan("");
  EXPECT_THROW(analyse_loops(r), std::invalid_argument);
  r = good;
  std::swap(r.time_s[7], r.time_s[8]);
  EXPECT_THROW(analyse_loops(r), std::invalid_argument);
  EXPECT_THROW(analyse_loops(good, {.reversal_fraction = 0.0}), std::invalid_argument);
  EXPECT_THROW(analyse_loops(good, {.closing_fraction = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(analyse_loops(good, {.travel_levels = {0.5, 1.0}}), std::invalid_argument);
}

// --- a real record ------------------------------------------------------------------------------

struct PrintedGearbox {
  std::vector<std::string> notes, lines;
  TorqueAngleRecord record;
};

PrintedGearbox printed_gearbox() {
  PrintedGearbox printed;
  std::ifstream file(GEAR3K_SOURCE_DIR "/data/printed_cpg_windup.csv");
  std::string line;
  bool header = true;
  while (std::getline(file, line)) {
    if (line.rfind('#', 0) == 0) {
      printed.notes.push_back(line);
      continue;
    }
    if (std::exchange(header, false)) continue;
    printed.lines.push_back(line);
    std::istringstream fields(line);
    double time = 0.0;
    double angle = 0.0;
    double torque = 0.0;
    char comma = 0;
    fields >> time >> comma >> angle >> comma >> torque;
    printed.record.time_s.push_back(time);
    printed.record.angle_rad.push_back(angle * pi / 180.0);
    printed.record.torque_Nm.push_back(torque);
  }
  return printed;
}

// Rows of the original: COMPAct (MIT licence, (c) 2026 Aman Singh), transmission stiffness test,
// every 4th row: time_s, encoder_pos_rad (motor side), output_torque_Nm (commanded, 14:1).
TEST(PrintedGearbox, DataFileIsTheOriginalInDegreesAndTorqueOverTheRatio) {
  struct Row {
    std::size_t index;
    double time_s, encoder_pos_rad, output_torque_Nm;
  };
  const PrintedGearbox printed = printed_gearbox();
  ASSERT_EQ(printed.record.time_s.size(), 801u);
  for (const char* note : {"# kind: torque_angle", "# locked: output"}) {
    EXPECT_EQ(std::count(printed.notes.begin(), printed.notes.end(), note), 1) << note;
  }
  for (const Row& row :
       {Row{0, 0.010679, -0.226267082, 0.025}, Row{1, 0.053697, -0.224283692, 0.125},
        Row{10, 0.438609, 0.039833129, 1.025}, Row{36, 1.553669, 0.380071828, 3.625},
        Row{200, 8.571582, 1.659540636, 20.0}, Row{600, 25.66784, -1.6254193, -19.975}}) {
    EXPECT_DOUBLE_EQ(printed.record.time_s[row.index], row.time_s);
    // Half a unit of the file's last digit: 5e-8 degrees and 5e-10 Nm.
    EXPECT_NEAR(printed.record.angle_rad[row.index], row.encoder_pos_rad, 5.1e-8 * pi / 180.0);
    EXPECT_NEAR(printed.record.torque_Nm[row.index], row.output_torque_Nm / 14.0, 5.1e-10);
  }
}

TEST(PrintedGearbox, LoopAgreesWithAnotherProgram) {
  const LoopAnalysis analysis = analyse_loops(printed_gearbox().record);
  ASSERT_EQ(analysis.outcome, RecordOutcome::kLoops);
  // 801 rows: 0 to 20, to -19.975, to -0.05 Nm at the output.
  ASSERT_EQ(analysis.loops.size(), 2u);
  EXPECT_EQ(analysis.loops[0].reversal_sample, 200u);
  EXPECT_EQ(analysis.loops[1].reversal_sample, 600u);
  EXPECT_DOUBLE_EQ(analysis.cutoff_per_sample, 0.15);
  // The branch that starts at rest inside the loop is not taken for the rising branch.
  EXPECT_EQ(analysis.loops[0].outcome, LoopOutcome::kPartialBranch);
  const Loop& loop = analysis.loops[1];
  ASSERT_EQ(loop.outcome, LoopOutcome::kMeasured) << loop_outcome_text(loop.outcome);
  EXPECT_NEAR(loop.extrapolated_torque_Nm, 0.05 / 14.0, 1e-6);
  EXPECT_FALSE(loop.closing_error_rad);
  // SciPy: filtfilt(*butter(2, 2 0.15), padlen=20) on angle and torque, np.interp at zero torque;
  // the rising branch on the line through its last filtered sample and the fourth before it.
  EXPECT_NEAR(loop.falling_zero_angle_rad, 0.5605432, 1e-6);
  EXPECT_NEAR(loop.rising_zero_angle_rad, -0.6296402, 1e-6);
  EXPECT_NEAR(loop.lost_motion_rad, 1.1901834, 2e-6);
  // NumPy: the straight line through the last eight raw samples reaches zero torque at -0.62852.
  EXPECT_NEAR(loop.rising_zero_angle_rad, -0.62852, 2e-3);
  // It scatters by stick-slip of some hundredths of a radian.
  EXPECT_GT(loop.lost_motion_sd_rad, 0.005);
  EXPECT_LT(loop.lost_motion_sd_rad, 0.05);
  // NumPy: 1/polyfit(torque, angle, 1) between 0.5 and 0.9 of the raw peak; the filter rounds the
  // peak by 0.6 %, which moves the window by a sample.
  ASSERT_TRUE(loop.stiffness_positive && loop.stiffness_negative);
  EXPECT_NEAR(loop.stiffness_positive->stiffness_Nm_rad, 0.80827, 0.005 * 0.81);
  EXPECT_NEAR(loop.stiffness_negative->stiffness_Nm_rad, 0.84696, 0.005 * 0.85);
  EXPECT_LT(std::abs(*loop.asymmetry), 0.06);
  // np.interp on the raw samples: travel between the loading flanks.
  ASSERT_EQ(loop.travel.size(), 3u);
  EXPECT_NEAR(loop.travel[0].torque_Nm, 0.71339, 0.01 * 0.71);
  EXPECT_NEAR(loop.travel[0].angle_rad, 1.56294, 0.02 * 1.56);
  EXPECT_NEAR(loop.travel[2].angle_rad, 2.92599, 0.02 * 2.93);
  expect_no_nan(analysis);
}

}  // namespace
}  // namespace gear3k::calibrate::torque_angle_loop_test
