// Play and compliance between both sides of logs of motion, on the bench that prescribes the
// motion, and what else is read from such logs.
#include "calibrate/dynamic/windup.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrate/dynamic/motion_readings.hpp"
#include "tests/calibrate/dynamic/motion_rig.hpp"
#include "tests/random_numbers.hpp"
#include "tests/sample.hpp"

namespace gear3k::windup_test {
namespace {

using namespace calibrate;  // NOLINT(google-build-using-namespace)

using test::MotionRig, test::RigDrive;

constexpr double kArcmin = 3.14159265358979 / 180.0 / 60.0;

/// The bench with sensors on both sides; play and compliance are stated as they are at first.
MotionRig both_sides(int seed, bool angles) {
  MotionRig rig = test::motion_rig(static_cast<std::uint64_t>(seed) + 700, true);
  RandomNumbers random(static_cast<std::uint32_t>(seed) + 5);
  rig.logs_motor_angle = angles;
  rig.logs_motor_speed = !angles;
  rig.angle_noise = random.between(0.3, 1.5) * kArcmin;
  rig.eccentricity_rad = random.between(0.0, 1.0) * kArcmin;
  rig.delay_s = angles ? random.between(-1e-3, 1e-3) : 0.0;
  rig.drive.play_rad = random.between(1.0, 8.0) * kArcmin;
  rig.drive.compliance = random.between(0.5, 3.0) * 1e-4;
  return rig;
}

std::optional<WindupDiagnosis> windup_of(const MotionRig& rig, const RigDrive& drive) {
  const auto record = test::rig_log(rig, drive);
  const auto d = diagnose_motion(record, test::rig_stated(rig), {});
  if (!d) return std::nullopt;
  return diagnose_windup(
      d->rows, d->drive,
      {.play_rad = rig.drive.play_rad, .compliance_rad_Nm = rig.drive.compliance}, 0.01);
}

struct WindupRates {
  int runs = 0, found = 0, named = 0, listed = 0, intervals = 0, covered = 0, both = 0;
};

/// A change of `strength` times the noise of one reading of the wind-up.
void count(WindupRates& r, const MotionRig& rig, std::size_t cause, double strength) {
  const double noise = std::sqrt(2.0) * rig.angle_noise;
  RigDrive unit = rig.drive;
  (cause == kClearanceChange ? unit.play_rad : unit.compliance) += 1e-3;
  const double by = 1e-3 * strength * noise / test::rig_windup_effect(rig, rig.drive, unit);
  RigDrive drive = rig.drive;
  (cause == kClearanceChange ? drive.play_rad : drive.compliance) += by;
  const auto d = windup_of(rig, drive);
  // A weight that keeps the mesh on one flank leaves play open, and that is said.
  if (d && cause == kClearanceChange && d->flank_changes == 0) {
    EXPECT_FALSE(d->found[0]);
    return;
  }
  ++r.runs;
  if (!d || d->effects.empty()) return;
  ++r.found;
  const MotionEffect& first = d->effects.front();
  const bool named = first.cause == cause;
  r.named += named ? 1 : 0;
  r.both += d->effects.size() > 1 ? 1 : 0;
  r.listed += named || std::ranges::any_of(first.alternatives,
                                           [&](const auto& a) { return a.cause == cause; })
                  ? 1
                  : 0;
  if (!named) return;
  ++r.intervals;
  r.covered += first.estimate.low <= by && by <= first.estimate.high ? 1 : 0;
}

TEST(Windup, PlayAndComplianceAreNamedByLogsOfBothAngles) {
  for (const double strength : {0.5, 2.0, 4.0, 8.0}) {
    WindupRates r;
    for (const std::size_t cause :
         {std::size_t{kClearanceChange}, std::size_t{kComplianceChange}}) {
      for (int seed = 0; seed < sample(2, 50); ++seed)
        count(r, both_sides(seed, true), cause, strength);
    }
    if (long_samples()) {
      fmt::print(
          "angles, strength {}: {} runs, found {}, named {}, listed {}, two {}, covered {} of {}\n",
          strength, r.runs, r.found, r.named, r.listed, r.both, r.covered, r.intervals);
    }
    if (strength < 2.0) continue;
    EXPECT_GE(r.named, sample(r.runs - 1, r.runs * 92 / 100));
  }
}

TEST(Windup, SpeedsOfBothSidesShowPlayToo) {
  WindupRates r;
  for (int seed = 0; seed < sample(2, 50); ++seed) {
    MotionRig rig = both_sides(seed, false);
    rig.speed_noise = 0.005;
    rig.angle_noise = 4.0 * kArcmin;
    count(r, rig, kClearanceChange, 8.0);
  }
  if (long_samples()) {
    fmt::print("speeds: {} runs, found {}, named {}, covered {} of {}\n", r.runs, r.found, r.named,
               r.covered, r.intervals);
  }
  EXPECT_GE(r.named, r.runs * 92 / 100);
}

TEST(Windup, NothingIsFoundWhereNothingIsWrong) {
  const int seeds = sample(12, 200);
  int wrong = 0, known = 0, covered = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const MotionRig rig = both_sides(seed + 300, seed % 4 != 0);
    const auto d = windup_of(rig, rig.drive);
    ASSERT_TRUE(d) << seed;
    wrong += d->effects.empty() ? 0 : 1;
    const std::array<double, 2> truth{rig.drive.play_rad, rig.drive.compliance};
    for (std::size_t k = 0; k < 2; ++k) {
      if (!d->found.at(k)) continue;
      ++known;
      covered += d->found.at(k)->low <= truth.at(k) && truth.at(k) <= d->found.at(k)->high ? 1 : 0;
    }
  }
  if (long_samples()) {
    fmt::print("nothing wrong: {} of {} find something; {} of {} intervals cover\n", wrong, seeds,
               covered, known);
  }
  EXPECT_LE(wrong, sample(2, 12));
  EXPECT_GE(covered, known * sample(80, 88) / 100);
}

TEST(Windup, ADelayBetweenTheSensorsIsNoCause) {
  MotionRig rig = both_sides(7, true);
  rig.delay_s = 4e-3;
  const auto d = windup_of(rig, rig.drive);
  ASSERT_TRUE(d);
  EXPECT_TRUE(d->effects.empty());
  EXPECT_NEAR(d->delay_s, 4e-3, 3e-4);
}

// A coasting drive by its closed form: J w' = −c − D w.
TEST(MotionReadings, RunDownsGiveTheDragBack) {
  const DriveParameters drive{.motor_inertia_kgm2 = 0.1,
                              .motor_viscous_Nms = 0.05,
                              .motor_coulomb_Nm = 0.6,
                              .output_inertia_kgm2 = 0.02,
                              .output_viscous_Nms = 0.0,
                              .output_coulomb_Nm = 0.0,
                              .efficiency_forward = 0.8,
                              .efficiency_backward = 0.7};
  // The output drives: J1 + eta_b J2, here with 0.1 kg m2 of load; the motor's drag alone.
  const double inertia = 0.1 + 0.7 * 0.12, c = 0.6, d = 0.05;
  MotionRecord record;
  RandomNumbers random(2);
  for (int run = 0; run < 4; ++run) {
    MotionStretch s;
    s.load_kgm2 = 0.1;
    s.session = run;
    const double start = 6.0 + run;
    for (int k = 0; k < 300; ++k) {
      const double t = 0.005 * k, w = (start + c / d) * std::exp(-d / inertia * t) - c / d;
      if (w < 0.5) break;
      s.time_s.push_back(2.0 * run + t);
      s.speed_rad_s.push_back(w + 1e-3 * random.between(-1.0, 1.0));
      s.motor_Nm.push_back(1e-4 * random.between(-1.0, 1.0));
    }
    record.stretches.push_back(s);
  }
  // Something that drives it at other times.
  MotionStretch driven = record.stretches.front();
  for (double& tau : driven.motor_Nm) tau = 4.0;
  for (double& w : driven.speed_rad_s) w = 5.0;
  driven.session = 9;
  record.stretches.push_back(driven);
  const auto windows = motion_windows(record, drive);
  const MotionReadings r = motion_readings(record, drive, windows, 40.0);
  EXPECT_EQ(r.run_downs.size(), 4U);
  ASSERT_EQ(r.drags.size(), 1U);
  EXPECT_EQ(r.drags[0].flow, -1);
  EXPECT_NEAR(r.drags[0].constant_Nm.value, c, 0.01);
  ASSERT_TRUE(r.drags[0].viscous_Nms);
  EXPECT_NEAR(r.drags[0].viscous_Nms->value, d, 0.003);
  EXPECT_NEAR(r.drags[0].stated_constant_Nm, 0.6, 1e-12);
  EXPECT_NEAR(r.run_downs[1].from_rad_s, 7.0, 0.4);
}

TEST(MotionReadings, RippleOfTheMotorsShaftIsFoundByItsOrder) {
  int found = 0, others = 0, runs = 0, false_waves = 0;
  for (int seed = 0; seed < sample(3, 40); ++seed) {
    MotionRig rig = both_sides(seed + 50, true);
    const auto read = [&] {
      const auto record = test::rig_log(rig, rig.drive);
      const DriveParameters stated = test::rig_stated(rig);
      return motion_readings(record, stated, motion_windows(record, stated), 40.0);
    };
    const MotionReadings quiet = read();
    // The bench's own ripple, 60 waves a turn of the output, is 1.5 times the motor's order.
    false_waves += static_cast<int>(quiet.ripple.size());
    rig.motor_ripple_Nm = rig.torque_noise;
    const MotionReadings r = read();
    ++runs;
    for (const TorqueRipple& w : r.ripple) {
      if (w.shaft == "motor" && w.harmonic == 2) {
        ++found;
        EXPECT_NEAR(w.amplitude_Nm, rig.motor_ripple_Nm, 0.3 * rig.motor_ripple_Nm);
      } else {
        ++others;
      }
    }
  }
  if (long_samples())
    fmt::print("ripple: {} of {}, others {}, where none is {}\n", found, runs, others, false_waves);
  EXPECT_GE(found, runs * 8 / 10);
  EXPECT_LE(others + false_waves, 1 + runs / 20);
}

/// A weight that turns round and round with the output, whose speed it bends once a turn; with a
/// wave of the motor's torque over the output's angle.
MotionRecord turning_weight(const DriveParameters& drive, std::uint64_t seed, double wave_Nm,
                            bool angles) {
  RandomNumbers random(seed);
  MotionStretch s;
  s.load_kgm2 = 0.1;
  const auto beta = drive_coefficients(drive, 1, s.load_kgm2);
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.01 * k, angle = 5.0 * t + 0.5 * std::sin(5.0 * t);
    const double speed = 5.0 + 2.5 * std::cos(5.0 * t), rate = -12.5 * std::sin(5.0 * t);
    const double load = 4.0 * std::sin(angle) - 6.0;
    const auto noise = [&](double size) {
      return size * (random.between(-1.0, 1.0) + random.between(-1.0, 1.0));
    };
    s.time_s.push_back(t);
    if (angles) {
      s.angle_rad.push_back(angle + noise(1e-5));
    } else {
      s.speed_rad_s.push_back(speed + noise(0.01));
    }
    s.load_Nm.push_back(load + noise(0.02));
    s.motor_Nm.push_back(beta[0] * rate + beta[1] * speed + beta[2] - beta[3] * load +
                         wave_Nm * std::sin(angle + 0.4) + noise(0.05));
  }
  MotionRecord record;
  record.stretches.push_back(std::move(s));
  return record;
}

TEST(MotionReadings, AWeightThatTurnsWithTheOutputIsNoRipple) {
  const DriveParameters drive{.motor_inertia_kgm2 = 0.1,
                              .motor_viscous_Nms = 0.05,
                              .motor_coulomb_Nm = 0.3,
                              .output_inertia_kgm2 = 0.02,
                              .output_viscous_Nms = 0.02,
                              .output_coulomb_Nm = 0.2,
                              .efficiency_forward = 0.85,
                              .efficiency_backward = 0.8};
  for (const bool angles : {false, true}) {
    int none = 0;
    for (int seed = 1; seed <= 4; ++seed) {
      const auto read = [&](double wave_Nm) {
        const MotionRecord record = turning_weight(drive, seed, wave_Nm, angles);
        return motion_readings(record, drive, motion_windows(record, drive), 50.0).ripple;
      };
      none += read(0.0).empty() ? 1 : 0;
      const std::vector<TorqueRipple> found = read(0.1);
      ASSERT_FALSE(found.empty()) << seed << angles;
      EXPECT_EQ(found[0].shaft, "output");
      EXPECT_EQ(found[0].harmonic, 1);
      EXPECT_NEAR(found[0].amplitude_Nm, 0.1, 0.015) << seed << angles;
    }
    EXPECT_EQ(none, 4) << angles;
  }
}

}  // namespace
}  // namespace gear3k::windup_test
