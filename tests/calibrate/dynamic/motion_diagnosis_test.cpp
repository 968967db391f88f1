#include "calibrate/dynamic/motion_diagnosis.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "calibrate/dynamic/window_fit.hpp"
#include "tests/calibrate/dynamic/drive_bench.hpp"
#include "tests/sample.hpp"

namespace gear3k::motion_diagnosis_test {
namespace {

using namespace calibrate;  // NOLINT(google-build-using-namespace)

using test::DriveBench;

void change(DriveBench& b, std::size_t cause, double by) {
  // Its own words for the changes of friction: the losses per power.
  const double forward = 1.0 / b.eta_f - 1.0, backward = 1.0 - b.eta_b;
  switch (cause) {
    case kLevelChange:
      b.eta_f = 1.0 / (1.0 + forward * (1.0 + by));
      b.eta_b = 1.0 - backward * (1.0 + by);
      break;
    case kDirectionChange:
      b.eta_f = 1.0 / (1.0 + forward * (1.0 + by));
      b.eta_b = 1.0 - backward * (1.0 - by);
      break;
    case kMotorCoulombChange:
      b.c1 += by;
      break;
    case kOutputCoulombChange:
      b.c2 += by;
      break;
    case kMotorViscousChange:
      b.d1 += by;
      break;
    case kOutputViscousChange:
      b.d2 += by;
      break;
    case kMotorInertiaChange:
      b.j1 += by;
      break;
    case kOutputInertiaChange:
      b.j2 += by;
      break;
    default:
      b.gain *= 1.0 + by;
      break;
  }
}

MotionDiagnosis found(const DriveBench& b, const DriveParameters& stated, std::uint64_t seed) {
  const auto d = diagnose_motion(log_of(b, seed), stated, {});
  EXPECT_TRUE(d);
  return d.value_or(MotionDiagnosis{});
}

/// Standard error of a cause by itself in a log of the bench.
double standard_error(const DriveBench& b, const DriveParameters& stated, std::size_t cause) {
  const auto windows = window_sums(motion_windows(log_of(b, 7), stated));
  EXPECT_TRUE(windows);
  const DriveFit fit = fit_drive(*windows, stated, {cause});
  EXPECT_TRUE(fit.determined);
  return std::sqrt(fit.covariance(0, 0));
}

struct Tally {
  int runs = 0, found = 0, named = 0, listed = 0, covered = 0, intervals = 0, ambiguous = 0;
};

void add(Tally& t, const MotionDiagnosis& d, std::size_t cause, double by) {
  ++t.runs;
  if (d.effects.empty()) return;
  ++t.found;
  t.ambiguous += d.verdict == MotionVerdict::kAmbiguous ? 1 : 0;
  const MotionEffect& first = d.effects.front();
  bool listed = first.cause == cause;
  for (const auto& a : first.alternatives) listed = listed || a.cause == cause;
  t.listed += listed ? 1 : 0;
  if (first.cause != cause) return;
  ++t.named;
  if (d.effects.size() > 1) return;
  ++t.intervals;
  t.covered += first.estimate.low <= by && by <= first.estimate.high ? 1 : 0;
}

/// Every cause at a strength in its standard errors, over seeds.
Tally campaign(const DriveBench& b, double strength, int seeds) {
  const DriveParameters stated = stated_of(b);
  Tally t;
  for (std::size_t cause = 0; cause < kDriveChanges; ++cause) {
    const double by = strength * standard_error(b, stated, cause);
    DriveBench changed = b;
    change(changed, cause, by);
    for (int s = 0; s < seeds; ++s) {
      add(t, found(changed, stated, 1000 + static_cast<std::uint64_t>(s)), cause, by);
    }
  }
  if (long_samples())
    fmt::print(
        "strength {}: {} runs, found {}, listed {}, named {}, ambiguous {}, covered {} of {}\n",
        strength, t.runs, t.found, t.listed, t.named, t.ambiguous, t.covered, t.intervals);
  return t;
}

DriveBench without_load() {
  DriveBench b;
  b.logs_load = false;
  b.gravity_Nm = 0.0;
  return b;
}

// Rates of 5 %: with so few seeds a bound that chance passes once in a thousand.
TEST(MotionDiagnosis, WhereNothingIsWrongNothingIsFound) {
  const int seeds = sample(20, 400);
  for (const DriveBench& b : {DriveBench{}, without_load()}) {
    int wrong = 0;
    for (int s = 0; s < seeds; ++s) {
      const auto d = found(b, stated_of(b), 100 + static_cast<std::uint64_t>(s));
      wrong += d.effects.empty() ? 0 : 1;
    }
    if (long_samples()) fmt::print("nulls wrong {} of {}\n", wrong, seeds);
    EXPECT_LE(wrong, sample(5, 34));
  }
}

TEST(MotionDiagnosis, NamesOrListsTheCause) {
  for (const double strength : {2.0, 4.0, 8.0}) {
    const Tally t = campaign(DriveBench{}, strength, sample(3, 50));
    if (strength == 8.0) {
      EXPECT_GE(t.found, t.runs);
      EXPECT_GE(t.listed, t.runs * 9 / 10);
    }
    EXPECT_GE(t.covered, t.intervals * 8 / 10);
  }
}

// Far beyond the noise only what the log cannot tell apart stays open.
TEST(MotionDiagnosis, StrongCausesAreNamedAlone) {
  const Tally t = campaign(DriveBench{}, 40.0, sample(2, 20));
  EXPECT_GE(t.named, t.runs * 92 / 100);
}

TEST(MotionDiagnosis, WithoutAnOutputTorqueTheCauseIsListed) {
  const Tally t = campaign(without_load(), 8.0, sample(2, 50));
  EXPECT_GE(t.listed, t.runs * 85 / 100);
}

// Of the cause that it is, whatever would have been named: intervals of runs that name it are of
// those that noise has made look like it.
TEST(MotionDiagnosis, IntervalsWithoutAnOutputTorqueCover) {
  const int seeds = sample(10, 400);
  for (const std::size_t cause : {std::size_t{kLevelChange}, std::size_t{kOutputInertiaChange}}) {
    DriveBench b = without_load();
    const DriveParameters stated = stated_of(b);
    const double by = 8.0 * standard_error(b, stated, cause);
    change(b, cause, by);
    int covered = 0;
    double square = 0.0;
    for (int s = 0; s < seeds; ++s) {
      const auto record = log_of(b, 5000 + static_cast<std::uint64_t>(s));
      // The flow of a sample depends on what is found: twice, as the diagnosis does.
      DriveParameters drive = stated;
      double z = 0.0;
      for (int round = 0; round < 2; ++round) {
        const auto windows = window_sums(motion_windows(record, drive));
        ASSERT_TRUE(windows);
        const DriveFit fit = fit_drive(*windows, stated, {cause});
        z = (fit.changes.at(cause) - by) / std::sqrt(fit.covariance(0, 0));
        drive = changed_drive(stated, fit.changes);
      }
      covered += std::abs(z) < 1.99 ? 1 : 0;
      square += z * z;
    }
    if (long_samples()) {
      fmt::print("cause {}: covered {} of {}, root mean square of z {:.3f}\n", cause, covered,
                 seeds, std::sqrt(square / seeds));
    }
    EXPECT_GE(covered, seeds * sample(70, 93) / 100);
  }
}

TEST(MotionDiagnosis, AllNumbersOfADriveAreFoundWithAnOutputTorque) {
  DriveBench b;
  const DriveParameters truth = stated_of(b);
  const std::array<double, 8> want{truth.efficiency_forward, truth.efficiency_backward,
                                   truth.motor_coulomb_Nm,   truth.output_coulomb_Nm,
                                   truth.motor_viscous_Nms,  truth.output_viscous_Nms,
                                   truth.motor_inertia_kgm2, truth.output_inertia_kgm2};
  const int seeds = sample(12, 200);
  int covered = 0;
  double square = 0.0, worst = 0.0;
  for (int s = 0; s < seeds; ++s) {
    const auto d = found(b, truth, 500 + static_cast<std::uint64_t>(s));
    for (std::size_t k = 0; k < want.size(); ++k) {
      const auto& q = d.quantities[k];
      ASSERT_TRUE(q.found) << q.name;
      covered += q.found->low <= want.at(k) && want.at(k) <= q.found->high ? 1 : 0;
      if (k > 1) continue;
      const double error = std::abs(q.found->value - want.at(k));
      square += error * error;
      worst = std::max(worst, error);
    }
  }
  const double rms = std::sqrt(square / (2.0 * seeds));
  if (long_samples())
    fmt::print("covered {} of {}, efficiencies: rms error {}, worst {}\n", covered, 8 * seeds, rms,
               worst);
  EXPECT_LT(rms, 0.005);
  EXPECT_GE(covered, 8 * seeds * 88 / 100);
}

TEST(MotionDiagnosis, AnglesOfAnEncoderDoAsWell) {
  DriveBench b;
  b.logs_angle = true;
  const DriveParameters stated = stated_of(b);
  const auto null = found(b, stated, 3);
  ASSERT_TRUE(null.quantities[0].found);
  EXPECT_NEAR(null.quantities[0].found->value, b.eta_f, 0.01);
  EXPECT_NEAR(null.quantities[1].found->value, b.eta_b, 0.015);
  b.c1 += 0.15;
  const auto d = found(b, stated, 3);
  ASSERT_FALSE(d.effects.empty());
  EXPECT_EQ(d.effects[0].cause, kMotorCoulombChange);
}

TEST(MotionDiagnosis, OneSenseAndOneFlowSayWhatCannotBeKnown) {
  DriveBench b;
  b.turn_rad_s = 8.0;
  b.amplitude_rad = 0.15;
  b.gravity_Nm = 0.0;
  b.d2 = 1.0;
  const auto d = found(b, stated_of(b), 5);
  EXPECT_EQ(d.windows[1], 0U);
  EXPECT_FALSE(d.quantities[1].found);
  std::string notes;
  for (const auto& note : d.notes) notes += note;
  EXPECT_NE(notes.find("forward throughout"), std::string::npos) << notes;
  EXPECT_NE(notes.find("one way only"), std::string::npos) << notes;
}

// An inertia is the only load: the level of friction is not to be told from inertia.
TEST(MotionDiagnosis, InertiaAsTheOnlyLoadIsAmbiguousAndAsksForGravityOrASecondInertia) {
  DriveBench b = without_load();
  const DriveParameters stated = stated_of(b);
  change(b, kLevelChange, 8.0 * standard_error(b, stated, kLevelChange));
  int ambiguous = 0, right = 0;
  for (std::uint64_t s = 0; s < 6; ++s) {
    const auto d = found(b, stated, 40 + s);
    if (d.effects.empty()) continue;
    EXPECT_EQ(d.verdict, MotionVerdict::kAmbiguous);
    ++ambiguous;
    if (d.next && (d.next->id == "gravity" || d.next->id == "second_inertia")) ++right;
  }
  EXPECT_GE(ambiguous, 4);
  EXPECT_GE(right, ambiguous - 1);
  // However strong it is.
  DriveBench strong = without_load();
  change(strong, kLevelChange, 0.5);
  const auto d = found(strong, stated, 40);
  EXPECT_EQ(d.verdict, MotionVerdict::kAmbiguous);
  ASSERT_TRUE(d.next);
  EXPECT_TRUE(d.next->id == "gravity" || d.next->id == "second_inertia") << d.next->id;
}

}  // namespace
}  // namespace gear3k::motion_diagnosis_test
