#include "calibrate/measurement/loop_friction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::loop_friction_test {
namespace {

/// A dead band and a wind-up of both flanks together that goes with T^(1-h), behind friction.
struct Flanks {
  double friction_Nm = 0.0;
  double hardening = 0.0;
  double dead_band_rad = 2e-3;
  double wind_up_rad = 8e-3;  ///< at 8 N m
};

double wind_up(const Flanks& flanks, double torque_Nm) {
  const double share = torque_Nm / 8.0;
  return torque_Nm > 0.0 ? flanks.wind_up_rad * std::exp((1.0 - flanks.hardening) * std::log(share))
                         : 0.0;
}

LoopReading reading_of(const Flanks& flanks, double noise_rad, rig::DeterministicRandom& random) {
  const double variance = noise_rad * noise_rad;
  LoopReading reading{.zero_rad = flanks.dead_band_rad + wind_up(flanks, flanks.friction_Nm) +
                                  2.0 * noise_rad * random.normal(),
                      .zero_variance_rad2 = 4.0 * variance};
  for (const double share : kTravelFractions) {
    const double torque_Nm = share * 8.0;
    reading.travel.push_back({.torque_Nm = torque_Nm,
                              .angle_rad = flanks.dead_band_rad +
                                           wind_up(flanks, torque_Nm - flanks.friction_Nm) +
                                           noise_rad * random.normal(),
                              .variance_rad2 = variance});
  }
  return reading;
}

std::vector<LoopReading> readings_of(const Flanks& flanks, int loops, double noise_rad,
                                     std::uint64_t seed) {
  rig::DeterministicRandom random(seed);
  std::vector<LoopReading> readings;
  readings.reserve(static_cast<std::size_t>(loops));
  for (int k = 0; k < loops; ++k) readings.push_back(reading_of(flanks, noise_rad, random));
  return readings;
}

/// What friction does to readings, and how far they are off it at most.
double worst_share(const Flanks& flanks, const LoopReading& reading, const FrictionShare& share) {
  double worst = std::abs(share.zero_rad - wind_up(flanks, flanks.friction_Nm));
  for (std::size_t k = 0; k < reading.travel.size(); ++k) {
    const double torque_Nm = reading.travel[k].torque_Nm;
    const double off = wind_up(flanks, torque_Nm) - wind_up(flanks, torque_Nm - flanks.friction_Nm);
    worst = std::max(worst, std::abs(share.travel_rad[k] - off));
  }
  return worst;
}

TEST(LoopFriction, OfFlanksThatCurveIsWhatLiesBeforeThem) {
  for (const double hardening : {-0.1, 0.0, 0.2, 1.0 / 3.0}) {
    for (const double friction_Nm : {0.12, 0.5, 1.0}) {
      const Flanks flanks{.friction_Nm = friction_Nm, .hardening = hardening};
      const auto readings = readings_of(flanks, 3, 1e-8, 3);
      const auto shares = friction_shares(readings);
      for (std::size_t k = 0; k < shares.size(); ++k) {
        EXPECT_NEAR(shares[k].friction_Nm, friction_Nm, 0.002) << hardening;
        EXPECT_LT(worst_share(flanks, readings[k], shares[k]), 2e-6)
            << hardening << ' ' << friction_Nm;
      }
    }
  }
}

TEST(LoopFriction, CurvatureIsNoneHoweverManyLoops) {
  // A line through the travels would open these by 0.05 to -0.21 of their wind-up.
  for (const double hardening : {-0.15, -0.1, 0.1, 1.0 / 3.0}) {
    for (const int loops : {1, 8, 200}) {
      for (const FrictionShare& share :
           friction_shares(readings_of({.hardening = hardening}, loops, 1e-5, 7))) {
        EXPECT_EQ(share.friction_Nm, 0.0) << hardening << ' ' << loops;
        EXPECT_EQ(share.zero_rad, 0.0);
      }
    }
  }
}

TEST(LoopFriction, FlanksThatNoPowerFollowsAreNotTakenForItByTheirNumber) {
  // Stiffness in two pieces with the step at half the peak: softer below, then harder.
  for (const int loops : {1, 200}) {
    auto readings = readings_of({}, loops, 1e-6, 9);
    for (LoopReading& reading : readings) {
      for (TravelReading& travel : reading.travel) {
        travel.angle_rad += 1e-3 * std::max(0.0, travel.torque_Nm - 4.4);
      }
    }
    for (const FrictionShare& share : friction_shares(readings)) {
      EXPECT_EQ(share.friction_Nm, 0.0) << loops;
    }
  }
}

TEST(LoopFriction, WithinNoiseIsTakenInFewCampaigns) {
  int taken = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const auto shares = friction_shares(readings_of({.hardening = 0.1}, 4, 1e-5, seed));
    if (shares.front().friction_Nm > 0.0) ++taken;
  }
  // 3 deviations to one side: 0.14 %; five or more of 400 then have a chance of 0.03 %.
  EXPECT_LE(taken, 4);
}

TEST(LoopFriction, IsAsCertainAsFreeCurvatureLeavesIt) {
  // From the normal equations of b, C, h and T_f at 6 % of the peak with twice the deviation at
  // zero torque: 2.26 of a travel's, in angle.
  constexpr double kNoise_rad = 1e-5;
  constexpr int kCampaigns = 300;
  const Flanks flanks{.friction_Nm = 0.48};
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= kCampaigns; ++seed) {
    const auto shares = friction_shares(readings_of(flanks, 1, kNoise_rad, seed));
    const double off_Nm = shares.front().friction_Nm - flanks.friction_Nm;
    squares += off_Nm * off_Nm / kCampaigns;
  }
  const double deviation_rad = std::sqrt(squares) * flanks.wind_up_rad / 8.0;
  EXPECT_NEAR(deviation_rad / kNoise_rad, 2.26, 0.3);
}

TEST(LoopFriction, OneLoopFarOffAmongOthersIsLuck) {
  auto readings = readings_of({}, 4, 1e-8, 1);
  const double off[] = {3.5, -1.0, 0.2, -0.4};
  for (std::size_t k = 0; k < 4; ++k) {
    readings[k].zero_rad += 1e-4 * off[k];
    readings[k].zero_variance_rad2 = 1e-8;
    for (TravelReading& travel : readings[k].travel) travel.variance_rad2 = 1e-10;
  }
  for (const FrictionShare& share : friction_shares(readings)) EXPECT_EQ(share.friction_Nm, 0.0);
}

TEST(LoopFriction, IsEachLoopsOwnWhereTheyDiffer) {
  rig::DeterministicRandom random(4);
  const std::vector<double> friction_Nm{0.9, 0.7, 0.5, 0.3, 0.0};
  std::vector<LoopReading> readings;
  readings.reserve(friction_Nm.size());
  for (const double f : friction_Nm)
    readings.push_back(reading_of({.friction_Nm = f}, 1e-6, random));
  const auto shares = friction_shares(readings);
  for (std::size_t k = 0; k + 1 < shares.size(); ++k) {
    EXPECT_NEAR(shares[k].friction_Nm, friction_Nm[k], 0.03);
    EXPECT_LT(worst_share({.friction_Nm = friction_Nm[k]}, readings[k], shares[k]), 5e-5);
  }
  EXPECT_NEAR(shares.back().friction_Nm, 0.0, 0.03);
}

TEST(LoopFriction, ANoisySessionDoesNotHideTheQuietOne) {
  // A mean without weights would have the noise of the noisy one.
  const Flanks flanks{.friction_Nm = 0.4};
  auto readings = readings_of(flanks, 4, 1e-6, 5);
  const auto noisy = readings_of(flanks, 4, 1e-3, 6);
  readings.insert(readings.end(), noisy.begin(), noisy.end());
  for (const FrictionShare& share : friction_shares(readings)) {
    EXPECT_NEAR(share.friction_Nm, 0.4, 0.02);
  }
}

TEST(LoopFriction, OfALoopThatIsNotReadAtAllTorquesIsThatOfAll) {
  const Flanks flanks{.friction_Nm = 0.4};
  auto readings = readings_of(flanks, 3, 1e-7, 8);
  readings[1].travel.resize(2);
  const auto shares = friction_shares(readings);
  EXPECT_EQ(shares[1].friction_Nm, shares[0].friction_Nm);
  ASSERT_EQ(shares[1].travel_rad.size(), 2U);
  EXPECT_LT(worst_share(flanks, readings[1], shares[1]), 1e-5);
}

TEST(LoopFriction, ThreeTravelsTellNoCurvature) {
  // Of all travels the last three, as where flanks begin late.
  for (const double friction_Nm : {0.0, 0.6}) {
    for (const double hardening : {-0.1, 0.0, 0.3}) {
      const Flanks flanks{.friction_Nm = friction_Nm, .hardening = hardening};
      auto readings = readings_of(flanks, 1, 1e-5, 10);
      readings[0].travel.erase(readings[0].travel.begin(), readings[0].travel.begin() + 3);
      const FrictionShare share = friction_shares(readings).front();
      if (friction_Nm == 0.0) {
        EXPECT_EQ(share.friction_Nm, 0.0) << hardening;
      } else if (hardening == 0.0) {
        EXPECT_LT(worst_share(flanks, readings[0], share), 2e-4);
      }
    }
  }
}

TEST(LoopFriction, OfNoLoopIsNone) {
  EXPECT_TRUE(friction_shares({}).empty());
  EXPECT_EQ(friction_shares({LoopReading{}}).front().friction_Nm, 0.0);
}

}  // namespace
}  // namespace gear3k::calibrate::loop_friction_test
