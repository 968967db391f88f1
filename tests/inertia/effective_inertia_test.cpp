#include "inertia/effective_inertia.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/largest_deviation.hpp"
#include "tests/linear_solve.hpp"
#include "tests/random_train.hpp"

namespace gear3k::inertia::effective_inertia_test {
namespace {

using train::ToothSet;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr int kCases = 4000;

class Random : public RandomTrain {
 public:
  Random() : RandomTrain(12) {}
  InertialTrain<double> train(bool g2_below_one) {
    return {.teeth = teeth(g2_below_one),
            .planets = count(1, 6),
            .center_distance_m = between(10e-3, 40e-3),
            .bodies = {.sun_kgm2 = between(1e-7, 1e-4),
                       .planet1_kgm2 = between(1e-8, 1e-5),
                       .planet2_kgm2 = between(1e-8, 1e-5),
                       .planet_mass_kg = between(5e-3, 0.2),
                       .carrier_kgm2 = between(0.0, 1e-4),
                       .ring2_kgm2 = between(1e-5, 1e-3)}};
  }
  DirectionalEfficiencies<double> efficiencies(double least) {
    DirectionalEfficiencies<double> eta{};
    for (std::size_t k = 0; k < 3; ++k) {
      eta.forward[k] = between(least, 1.0);
      eta.backward[k] = std::min(1.0, eta.forward[k] * between(0.995, 1.005));
    }
    return eta;
  }
};

constexpr DirectionalEfficiencies<double> kLossless{.forward = {1.0, 1.0, 1.0},
                                                    .backward = {1.0, 1.0, 1.0}};

/// Speeds, with the driving end at +1.
struct Speeds {
  double sun, output, carrier, planet;
  std::array<double, 3> rolling;  // S, R1, R2 seen from the carrier
};
Speeds speeds_of(const ToothSet& z, bool forward) {
  // R1 at rest, the carrier at +1: planets roll off inside R1.
  const double planet_rolling = -static_cast<double>(z.R1) / z.P1;
  Speeds w{.sun = 1.0 - planet_rolling * z.P1 / z.S,
           .output = 1.0 + planet_rolling * z.P2 / z.R2,
           .carrier = 1.0,
           .planet = 1.0 + planet_rolling,
           .rolling = {-planet_rolling * z.P1 / z.S, -1.0, planet_rolling * z.P2 / z.R2}};
  const double driving = forward ? w.sun : w.output;
  for (double* speed : {&w.sun, &w.output, &w.carrier, &w.planet}) *speed /= driving;
  for (double& speed : w.rolling) speed /= driving;
  return w;
}

double kinetic_energy_doubled(const InertialTrain<double>& t, const Speeds& w) {
  const auto& b = t.bodies;
  const double orbit_speed = w.carrier * t.center_distance_m;
  return b.sun_kgm2 * w.sun * w.sun + b.ring2_kgm2 * w.output * w.output +
         b.carrier_kgm2 * w.carrier * w.carrier +
         t.planets * ((b.planet1_kgm2 + b.planet2_kgm2) * w.planet * w.planet +
                      b.planet_mass_kg * orbit_speed * orbit_speed);
}

/// Driving torque, and the power lost in the meshes, of a train that is accelerated by 1 rad/s2 as
/// it passes 1 rad/s at the driving end.
struct Motion {
  double torque, lost_power;
};

/// All motions that obey the balances.  Which gear drives in each mesh is tried out.
std::vector<Motion> consistent_motions(const InertialTrain<double>& t,
                                       const DirectionalEfficiencies<double>& eta, bool forward) {
  const Speeds w = speeds_of(t.teeth, forward);  // accelerations are the same numbers
  const auto& z = t.teeth;
  const auto& b = t.bodies;
  const bool g2_below_one = z.P2 * z.R1 < z.P1 * z.R2;
  // When the train is driven forward, S drives P1; R1 is driven and R2 drives for G2 < 1, and the
  // other way round for G2 > 1.
  const std::array<bool, 3> central_drives_forward{true, !g2_below_one, g2_below_one};
  const double spin = t.planets * (b.planet1_kgm2 + b.planet2_kgm2) * w.planet;
  const double carried =
      (b.carrier_kgm2 + t.planets * b.planet_mass_kg * t.center_distance_m * t.center_distance_m) *
          w.carrier +
      spin;
  const std::size_t driven = forward ? 2 : 0;
  const std::size_t driving = forward ? 0 : 2;
  const double driven_torque = forward ? -b.ring2_kgm2 * w.output : -b.sun_kgm2 * w.sun;
  const double own_torque = forward ? b.sun_kgm2 * w.sun : b.ring2_kgm2 * w.output;
  std::vector<Motion> motions;
  for (unsigned pattern = 0; pattern < 8; ++pattern) {
    std::array<double, 3> passed{};  // of the central gear's power, what arrives at the planet
    std::array<bool, 3> central_drives{};
    for (std::size_t k = 0; k < 3; ++k) {
      central_drives[k] = (pattern >> k & 1U) != 0;
      const double e =
          central_drives[k] == central_drives_forward[k] ? eta.forward[k] : eta.backward[k];
      passed[k] = central_drives[k] ? e : 1.0 / e;
    }
    // Torques that S, R1 and R2 put into their meshes: together they move what the carrier carries;
    // what arrives in the frame of the carrier spins the planets up; the driven end is moved by
    // nothing but its mesh.
    Eigen::Matrix3d balance;
    balance.row(0).setOnes();
    for (Eigen::Index k = 0; k < 3; ++k) {
      balance(1, k) = passed[static_cast<std::size_t>(k)] * w.rolling[static_cast<std::size_t>(k)];
    }
    balance.row(2).setZero();
    balance(2, static_cast<Eigen::Index>(driven)) = 1.0;
    const Eigen::Vector3d torque = test::solved(
        balance, Eigen::Vector3d(carried, spin * (w.planet - w.carrier), driven_torque));
    bool consistent = torque.allFinite();
    double lost = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double power = torque[static_cast<Eigen::Index>(k)] * w.rolling[k];
      if (power != 0.0 && (power > 0.0) != central_drives[k]) consistent = false;
      lost += power - passed[k] * power;
    }
    const double driving_torque = own_torque + torque[static_cast<Eigen::Index>(driving)];
    if (consistent && driving_torque >= 0.0) motions.push_back({driving_torque, lost});
  }
  return motions;
}

/// The balances lose digits as G2 nears 1 and where little of the driving power is left in the end.
double rounding(const InertialTrain<double>& t, const Motion& motion) {
  const double lever = 1.0 + std::abs(train::ratio(t.teeth));
  return 4.0 * kEps * lever * motion.torque *
         (1.0 + motion.torque / (motion.torque - motion.lost_power));
}

class TrainOfEitherSense : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Trains, TrainOfEitherSense, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& below) {
                           return below.param ? "G2BelowOne" : "G2AboveOne";
                         });

TEST_P(TrainOfEitherSense, LosslessInertiaIsTwiceTheKineticEnergyAtUnitOutputSpeed) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const double expected = kinetic_energy_doubled(t, speeds_of(t.teeth, false));
    largest.see(i, lossless_inertia(t) - expected,
                4.0 * kEps * expected * (1.0 + std::abs(train::ratio(t.teeth))));
  }
  largest.expect_allowed("energy");
}

TEST_P(TrainOfEitherSense, EffectiveInertiaIsTheTorqueOfTheConsistentMotion) {
  Random random;
  LargestDeviation largest;
  int seen = 0, locked = 0;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto eta = random.efficiencies(i % 2 == 0 ? 0.98 : 0.9);
    for (const bool forward : {true, false}) {
      const auto motions = consistent_motions(t, eta, forward);
      const auto inertia = effective_inertia(t, eta, forward);
      ASSERT_LE(motions.size(), 1U) << "case " << i << ", forward " << forward;
      ASSERT_EQ(inertia.has_value(), !motions.empty()) << "case " << i;
      if (!inertia) {
        ++locked;
        continue;
      }
      largest.see(i, *inertia - motions[0].torque, rounding(t, motions[0]));
      ++seen;
    }
  }
  largest.expect_allowed("torque");
  EXPECT_GT(seen, kCases);
  EXPECT_GT(locked, 100);
}

TEST_P(TrainOfEitherSense, DrivingPowerIsTheRateOfKineticEnergyAndTheLosses) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto eta = random.efficiencies(0.97);
    for (const bool forward : {true, false}) {
      const auto motions = consistent_motions(t, eta, forward);
      const auto inertia = effective_inertia(t, eta, forward);
      if (motions.empty() || !inertia) continue;
      // At unit speed and acceleration of the driving end.
      const double rate = kinetic_energy_doubled(t, speeds_of(t.teeth, forward));
      EXPECT_GE(motions[0].lost_power, 0.0);
      largest.see(i, *inertia - rate - motions[0].lost_power, rounding(t, motions[0]));
    }
  }
  largest.expect_allowed("power");
}

TEST_P(TrainOfEitherSense, WithoutLossesItIsTheKineticEnergyOfEitherEnd) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const double i2 = train::ratio(t.teeth) * train::ratio(t.teeth);
    const double lossless = lossless_inertia(t);
    const auto backward = effective_inertia(t, kLossless, false);
    const auto forward = effective_inertia(t, kLossless, true);
    ASSERT_TRUE(backward && forward) << "case " << i;
    const double allowed = 4.0 * kEps * (1.0 + std::sqrt(i2)) * lossless;
    largest.see(i, *backward - lossless, allowed);
    largest.see(i, *forward - lossless / i2, allowed / i2);
  }
  largest.expect_allowed("lossless");
}

TEST_P(TrainOfEitherSense, OfTheSunAloneIsSeenFromTheOutputThroughTheBackwardEfficiency) {
  Random random;
  LargestDeviation largest;
  int seen = 0, locked = 0;
  for (int i = 0; i < kCases; ++i) {
    auto t = random.train(GetParam());
    t.bodies = {};
    t.bodies.sun_kgm2 = random.between(1e-7, 1e-4);
    const auto eta = random.efficiencies(0.96);
    const double eta_b = efficiency::backward_efficiency(t.teeth, eta.backward);
    const auto inertia = effective_inertia(t, eta, false);
    ASSERT_EQ(inertia.has_value(), eta_b > 0.0) << "case " << i;
    if (!inertia) {
      ++locked;
      continue;
    }
    ++seen;
    const double i2 = train::ratio(t.teeth) * train::ratio(t.teeth);
    const double expected = t.bodies.sun_kgm2 * i2 / eta_b;
    largest.see(i, *inertia - expected,
                4.0 * kEps * (1.0 + std::sqrt(i2)) * expected *
                    (1.0 + 1.0 / efficiency::backdriving_margin(t.teeth, eta.backward)));
  }
  largest.expect_allowed("sun");
  EXPECT_GT(seen, 1000);
  EXPECT_GT(locked, 10);
}

TEST_P(TrainOfEitherSense, OfTheOutputAloneIsSeenFromTheSunThroughTheForwardEfficiency) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    auto t = random.train(GetParam());
    t.bodies = {};
    t.bodies.ring2_kgm2 = random.between(1e-5, 1e-3);
    const auto eta = random.efficiencies(0.96);
    const auto inertia = effective_inertia(t, eta, true);
    ASSERT_TRUE(inertia);
    const double i2 = train::ratio(t.teeth) * train::ratio(t.teeth);
    const double expected =
        t.bodies.ring2_kgm2 / (i2 * efficiency::forward_efficiency(t.teeth, eta.forward));
    largest.see(i, *inertia - expected, 4.0 * kEps * (1.0 + std::sqrt(i2)) * expected);
  }
  largest.expect_allowed("output");
}

TEST_P(TrainOfEitherSense, EachEndsOwnInertiaIsSeenUnchanged) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    auto t = random.train(GetParam());
    const auto eta = random.efficiencies(0.97);
    t.bodies = {};
    t.bodies.ring2_kgm2 = 3e-4;
    const auto backward = effective_inertia(t, eta, false);
    ASSERT_TRUE(backward);
    EXPECT_DOUBLE_EQ(*backward, 3e-4);
    t.bodies = {};
    t.bodies.sun_kgm2 = 2e-5;
    const auto forward = effective_inertia(t, eta, true);
    ASSERT_TRUE(forward);
    EXPECT_DOUBLE_EQ(*forward, 2e-5);
  }
}

TEST_P(TrainOfEitherSense, LossesNeverMakeATrainLighter) {
  Random random;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto eta = random.efficiencies(0.95);
    const double i2 = train::ratio(t.teeth) * train::ratio(t.teeth);
    const double lossless = lossless_inertia(t);
    EXPECT_GE(effective_inertia(t, eta, false).value_or(lossless), lossless);
    EXPECT_GE(effective_inertia(t, eta, true).value_or(lossless) * i2, lossless);
  }
}

TEST_P(TrainOfEitherSense, PaperInertiaHasTheTermsOfEquations32And33) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto eta = random.efficiencies(0.9).backward;
    const auto& z = t.teeth;
    const auto& b = t.bodies;
    // i_T of eq. 31 for the sun, rolling ratios for the planets, the carrier's absolute speed.
    const Speeds w = speeds_of(z, false);
    const double planet_rolling = (w.planet - w.carrier) / (w.output - w.carrier);
    const double n = t.planets;
    const double carrier =
        b.carrier_kgm2 + n * (b.planet1_kgm2 + b.planet2_kgm2 +
                              b.planet_mass_kg * t.center_distance_m * t.center_distance_m);
    const double expected =
        w.sun * w.sun / (eta[0] * eta[1]) * b.sun_kgm2 +
        n * planet_rolling * planet_rolling * (b.planet1_kgm2 / eta[1] + b.planet2_kgm2 / eta[2]) +
        b.ring2_kgm2 + w.carrier * w.carrier * carrier;
    largest.see(i, paper_inertia(t, eta) - expected,
                4.0 * kEps * (1.0 + std::abs(train::ratio(z))) * expected);
  }
  largest.expect_allowed("paper");
}

TEST(PublishedGearbox, PlanetsCountByTheirAbsoluteSpinAndNotByTheRollingOne) {
  // Low-backlash gearbox, 14/40/94/36/92: energy gives 282 J_P for a planet at unit output speed,
  // the paper's eq. 32 read literally 6.5 J_P; rolling spin and carrier apart would give 854 + 155.
  const ToothSet z{.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92};
  const train::SpeedRatios w = train::speed_ratios(z);
  EXPECT_NEAR(w.planet * w.planet, 282.0, 0.5);
  EXPECT_NEAR(w.planet_rolling * w.planet_rolling, 6.5, 0.05);
  EXPECT_NEAR((w.planet - w.carrier) * (w.planet - w.carrier), 854.0, 0.5);
  EXPECT_NEAR(w.carrier * w.carrier, 155.0, 0.5);
  InertialTrain<double> t{.teeth = z, .planets = 1, .center_distance_m = 0.0, .bodies = {}};
  t.bodies.planet1_kgm2 = 1.0;
  EXPECT_NEAR(lossless_inertia(t), 282.0, 0.5);
}

TEST(LosslessInertia, GrowsWithTheFifthPowerOfSizeAtFixedDensity) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    const auto small = random.train(i % 2 == 0);
    const double scale = random.between(0.3, 3.0);
    auto large = small;
    const double fifth = std::pow(scale, 5);
    auto& b = large.bodies;
    for (double* j :
         {&b.sun_kgm2, &b.planet1_kgm2, &b.planet2_kgm2, &b.carrier_kgm2, &b.ring2_kgm2}) {
      *j *= fifth;
    }
    b.planet_mass_kg *= std::pow(scale, 3);
    large.center_distance_m *= scale;
    EXPECT_NEAR(lossless_inertia(large) / lossless_inertia(small), fifth, 32.0 * kEps * fifth);
  }
}

}  // namespace
}  // namespace gear3k::inertia::effective_inertia_test
