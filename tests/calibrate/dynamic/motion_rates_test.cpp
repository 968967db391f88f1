// How often the cause is named, by a bench whose laws and noise are not those of the library.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrate/dynamic/motion_diagnosis.hpp"
#include "tests/calibrate/dynamic/motion_rig.hpp"
#include "tests/sample.hpp"

namespace gear3k::motion_rates_test {
namespace {

using namespace calibrate;  // NOLINT(google-build-using-namespace)

using test::MotionRig, test::RigDrive;

RigDrive altered(RigDrive d, std::size_t cause, double by) {
  switch (cause) {
    case kLevelChange:
      d.loss_forward *= 1.0 + by;
      d.loss_backward *= 1.0 + by;
      break;
    case kDirectionChange:
      d.loss_forward *= 1.0 + by;
      d.loss_backward *= 1.0 - by;
      break;
    case kMotorCoulombChange:
      d.c1 += by;
      break;
    case kOutputCoulombChange:
      d.c2 += by;
      break;
    case kMotorViscousChange:
      d.d1 += by;
      break;
    case kOutputViscousChange:
      d.d2 += by;
      break;
    case kMotorInertiaChange:
      d.j1 += by;
      break;
    case kOutputInertiaChange:
      d.j2 += by;
      break;
    default:
      d.gain *= 1.0 + by;
      break;
  }
  return d;
}

/// Size of a cause by which the torque changes by `strength` times its noise, both as root mean
/// square over the log.
double size_of(const MotionRig& rig, std::size_t cause, double strength) {
  const auto short_of = [&](double by) {
    return test::rig_effect(rig, rig.drive, altered(rig.drive, cause, by)) <
           strength * rig.torque_noise;
  };
  double low = 0.0, high = 1e-3;
  while (short_of(high) && high < 100.0) high *= 2.0;
  for (int k = 0; k < 20; ++k) {
    const double middle = 0.5 * (low + high);
    (short_of(middle) ? low : high) = middle;
  }
  return high;
}

/// Losses that exist: an asymmetry of at most 1, a level that leaves η_b above −1.
bool exists(std::size_t cause, double by, const RigDrive& d) {
  return (cause != kDirectionChange || by <= 1.0) && d.loss_backward < 2.0;
}

struct Rates {
  int runs = 0, found = 0, named = 0, listed = 0, covered = 0;
};

void count(Rates& r, const MotionRig& rig, std::size_t cause, double strength) {
  const double by = size_of(rig, cause, strength);
  const RigDrive drive = altered(rig.drive, cause, by);
  if (!exists(cause, by, drive)) return;
  const auto d = diagnose_motion(test::rig_log(rig, drive), test::rig_stated(rig), {});
  ++r.runs;
  if (!d || d->effects.empty()) return;
  ++r.found;
  const MotionEffect& first = d->effects.front();
  const bool named = first.cause == cause;
  r.named += named ? 1 : 0;
  r.listed += named || std::ranges::any_of(first.alternatives,
                                           [&](const auto& a) { return a.cause == cause; })
                  ? 1
                  : 0;
  r.covered += named && first.estimate.low <= by && by <= first.estimate.high ? 1 : 0;
}

TEST(MotionRates, CausesBeyondTheNoiseOfTheTorqueAreNamed) {
  for (const double strength : {2.0, 4.0, 8.0}) {
    Rates r;
    for (std::size_t cause = 0; cause < kDriveChanges; ++cause) {
      for (int seed = 0; seed < sample(1, 50); ++seed) {
        count(r, test::motion_rig(static_cast<std::uint64_t>(seed) + 1, true), cause, strength);
      }
    }
    if (long_samples()) {
      fmt::print("strength {}: {} runs, found {}, named {}, listed {}, covered {}\n", strength,
                 r.runs, r.found, r.named, r.listed, r.covered);
    }
    EXPECT_EQ(r.found, r.runs);
    EXPECT_GE(r.named, sample(r.runs - 2, r.runs * 92 / 100));
    EXPECT_GE(r.covered, r.named * sample(70, 88) / 100);
  }
}

TEST(MotionRates, NothingIsFoundWhereNothingIsWrongAndNumbersAreCovered) {
  const int seeds = sample(30, 200);
  int wrong = 0, known = 0, covered = 0;
  double square = 0.0, efficiencies = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    const MotionRig rig = test::motion_rig(static_cast<std::uint64_t>(seed) + 300, true);
    const auto d = diagnose_motion(test::rig_log(rig, rig.drive), test::rig_stated(rig), {});
    ASSERT_TRUE(d) << seed;
    wrong += d->effects.empty() ? 0 : 1;
    for (const MotionQuantity& q : d->quantities) {
      if (!q.found) continue;
      ++known;
      covered += q.found->low <= q.stated && q.stated <= q.found->high ? 1 : 0;
      if (!q.name.starts_with("efficiency")) continue;
      square += (q.found->value - q.stated) * (q.found->value - q.stated);
      efficiencies += 1.0;
    }
  }
  const double rms = std::sqrt(square / efficiencies);
  if (long_samples()) {
    fmt::print("nothing wrong: {} of {} find something; {} of {} intervals cover; rms of η {}\n",
               wrong, seeds, covered, known, rms);
  }
  EXPECT_LE(wrong, sample(3, 17));
  EXPECT_GE(covered, known * sample(85, 92) / 100);
  EXPECT_LT(rms, 0.005);
}

// Where a weight keeps the mesh on one flank each flow has one sense: the torque's offset and both
// constant drags are three numbers for two.
TEST(MotionRates, OneSenseInEachFlowLeavesConstantDragsOpenAndSaysSo) {
  MotionRig rig = test::motion_rig(4, true);
  rig.weight_Nm = 4.0;
  rig.spring_Nm = 0.0;
  rig.constant_Nm = -20.0;
  const auto d = diagnose_motion(test::rig_log(rig, rig.drive), test::rig_stated(rig), {});
  ASSERT_TRUE(d);
  std::string notes;
  for (const auto& note : d->notes) notes += note;
  EXPECT_NE(notes.find("each flow has one sense"), std::string::npos) << notes;
  for (const MotionQuantity& q : d->quantities) {
    const bool open = q.name == "motor_coulomb" || q.name == "output_coulomb";
    EXPECT_EQ(q.found.has_value(), !open) << q.name;
  }
}

}  // namespace
}  // namespace gear3k::motion_rates_test
