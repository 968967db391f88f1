#include "efficiency/train_efficiency.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/largest_deviation.hpp"
#include "tests/linear_solve.hpp"
#include "tests/random_train.hpp"

namespace gear3k::efficiency::train_efficiency_test {
namespace {

using train::kMeshCount, train::kMeshP1R1, train::kMeshP2R2, train::kMeshSP1;
using train::ToothSet;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr int kCases = 4000;

class Random : public RandomTrain {
 public:
  Random() : RandomTrain(10) {}
  MeshEfficiencies<double> efficiencies(double least) {
    return {between(least, 1.0), between(least, 1.0), between(least, 1.0)};
  }
};

/// A consistent flow of power through the train: efficiency, and which meshes are driven by their
/// central gear (S, R1, R2) in the frame of the carrier.
struct PowerFlow {
  double efficiency = 0.0;
  std::array<bool, kMeshCount> central_drives{};
};

/// All flows that obey the balances of torque and power.  In each mesh the central gear gives the
/// planet a power (in the frame of the carrier) of which the loss takes its share; every choice of
/// who gives and who takes is tried, and kept when the solution agrees with it.
std::vector<PowerFlow> consistent_flows(const ToothSet& z, const MeshEfficiencies<double>& eta,
                                        bool forward) {
  // Speeds seen from the carrier, from equal pitch velocities, when ring R1 turns by +1 there: the
  // carrier then turns by -1 in the frame where R1 is at rest.
  const double planet = static_cast<double>(z.R1) / z.P1;
  std::array<double, 3> rolling{-planet * z.P1 / z.S, 1.0, planet * z.P2 / z.R2};
  double sun_speed = rolling[0] - 1.0;
  double output_speed = rolling[2] - 1.0;
  const double driving_speed = forward ? sun_speed : output_speed;
  for (double& speed : rolling) speed /= driving_speed;  // now the driving end turns by +1
  sun_speed /= driving_speed;
  output_speed /= driving_speed;
  std::vector<PowerFlow> flows;
  for (unsigned pattern = 0; pattern < 8; ++pattern) {
    PowerFlow flow;
    std::array<double, 3> passed{};  // of the central gear's power, what arrives at the planet
    for (unsigned k = 0; k < 3; ++k) {
      flow.central_drives[k] = (pattern >> k & 1U) != 0;
      passed[k] = flow.central_drives[k] ? eta[k] : 1.0 / eta[k];
    }
    // Torques from outside on S, R1, R2, each passed on by its one mesh:
    // none acts on the carrier, so they add to zero; the planets keep no power in the frame of
    // the carrier; the driving torque is 1.
    Eigen::Matrix3d balance;
    balance.row(0).setOnes();
    for (unsigned k = 0; k < 3; ++k) balance(1, k) = passed[k] * rolling[k];
    balance.row(2).setZero();
    balance(2, forward ? 0 : 2) = 1.0;
    const Eigen::Vector3d torque = test::solved(balance, Eigen::Vector3d(0.0, 0.0, 1.0));
    bool consistent = torque.allFinite();
    for (unsigned k = 0; k < 3; ++k) {
      if ((torque[k] * rolling[k] > 0.0) != flow.central_drives[k]) consistent = false;
    }
    flow.efficiency = forward ? -torque[2] * output_speed : -torque[0] * sun_speed;
    if (consistent && flow.efficiency > 0.0) flows.push_back(flow);
  }
  return flows;
}

class TrainOfEitherSense : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Trains, TrainOfEitherSense, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& below) {
                           return below.param ? "G2BelowOne" : "G2AboveOne";
                         });

TEST_P(TrainOfEitherSense, FormulasAreTheOnlyConsistentPowerFlowWhereTheTrainCanBeDrivenBack) {
  Random random;
  LargestDeviation forward, backward;
  int seen = 0;
  for (int i = 0; i < kCases; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const auto eta = random.efficiencies(i % 2 == 0 ? 0.97 : 0.8);
    const double eta_b = backward_efficiency(z, eta);
    if (!(eta_b > 0.0)) continue;
    ++seen;
    // The balances lose as many digits as eta2 eta3 and G2 (or their inverses) have in common.
    const double loss_of_digits =
        (1.0 + std::abs(train::ratio(z))) / std::min(1.0, backdriving_margin(z, eta));
    for (const bool direction : {true, false}) {
      const auto flows = consistent_flows(z, eta, direction);
      ASSERT_EQ(flows.size(), 1U) << "case " << i << ", forward " << direction;
      const double formula = direction ? forward_efficiency(z, eta) : eta_b;
      (direction ? forward : backward)
          .see(i, formula - flows[0].efficiency, 4.0 * kEps * loss_of_digits);
    }
  }
  forward.expect_allowed("forward");
  backward.expect_allowed("backward");
  EXPECT_GT(seen, kCases / 10);
}

TEST_P(TrainOfEitherSense, DrivingGearOfEachMeshIsTheOneThatThePowerFlowFinds) {
  Random random;
  int seen = 0;
  for (int i = 0; i < kCases; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const auto eta = random.efficiencies(0.95);
    if (!(backward_efficiency(z, eta) > 0.0)) continue;
    ++seen;
    for (const bool direction : {true, false}) {
      const auto flows = consistent_flows(z, eta, direction);
      ASSERT_EQ(flows.size(), 1U);
      const auto drives = [&](train::MeshId mesh) {
        return train::gear1_drives(mesh, GetParam(), direction);
      };
      // Gear 1 is the central gear of S-P1 and the planet of the internal meshes.
      EXPECT_EQ(drives(kMeshSP1), flows[0].central_drives[0]);
      EXPECT_EQ(drives(kMeshP1R1), !flows[0].central_drives[1]);
      EXPECT_EQ(drives(kMeshP2R2), !flows[0].central_drives[2]);
    }
  }
  EXPECT_GT(seen, 500);
}

TEST_P(TrainOfEitherSense, NoPowerFlowDrivesALockedTrainBack) {
  Random random;
  int seen = 0;
  for (int i = 0; i < kCases; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const auto eta = random.efficiencies(0.7);
    if (!(backward_efficiency(z, eta) < 0.0)) continue;
    ++seen;
    EXPECT_TRUE(consistent_flows(z, eta, false).empty()) << "case " << i;
  }
  EXPECT_GT(seen, 500);
}

TEST_P(TrainOfEitherSense, BackdrivingMarginHasTheSignOfTheBackwardEfficiency) {
  Random random;
  int locked = 0, driven = 0;
  for (int i = 0; i < 5 * kCases; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const auto eta = random.efficiencies(i % 2 == 0 ? 0.97 : 0.8);
    const bool backdrivable = backdriving_margin(z, eta) > 0.0;
    EXPECT_EQ(backdrivable, backward_efficiency(z, eta) > 0.0);
    (backdrivable ? driven : locked) += 1;
  }
  EXPECT_GT(locked, 100);
  EXPECT_GT(driven, 100);
}

TEST_P(TrainOfEitherSense, EfficienciesLieBetweenZeroAndOne) {
  Random random;
  for (int i = 0; i < 5 * kCases; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const auto eta = random.efficiencies(0.5);
    const double forward = forward_efficiency(z, eta);
    EXPECT_GT(forward, 0.0);
    EXPECT_LE(forward, 1.0);
    EXPECT_LE(backward_efficiency(z, eta), 1.0);
  }
}

TEST_P(TrainOfEitherSense, LosslessMeshesMakeALosslessTrain) {
  constexpr MeshEfficiencies<double> kLossless{1.0, 1.0, 1.0};
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const double allowed = 4.0 * kEps * (1.0 + std::abs(train::ratio(z)));
    largest.see(i, forward_efficiency(z, kLossless) - 1.0, allowed);
    largest.see(i, backward_efficiency(z, kLossless) - 1.0, allowed);
  }
  largest.expect_allowed("lossless");
}

TEST_P(TrainOfEitherSense, EfficienciesTendToOneInProportionToVanishingFriction) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    const auto t = random.train(GetParam());
    const double lever = 1.0 + std::abs(train::ratio(t.teeth));  // of mesh losses on the train's
    for (const LossModel model : {LossModel::kSliding, LossModel::kOhlendorf}) {
      for (const bool direction : {true, false}) {
        const auto loss_at = [&](double mu) {
          const auto eta = mesh_efficiencies(t, mu, model, direction);
          return 1.0 -
                 (direction ? forward_efficiency(t.teeth, eta) : backward_efficiency(t.teeth, eta));
        };
        // Truncation: the loss is analytic in mu with a radius of about 1/lever.
        const double mu = 1e-6 / lever;
        const double loss = loss_at(mu);
        EXPECT_GT(loss, 0.0);
        EXPECT_NEAR(loss_at(0.5 * mu) / loss, 0.5, 1e-4);
        EXPECT_NEAR(loss_at(0.0), 0.0, 4.0 * kEps * lever);
      }
    }
  }
}

TEST_P(TrainOfEitherSense, ApproachIsTheAddendumOfTheDrivenGearAndChangesPlacesBackward) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    const auto t = random.train(GetParam());
    for (const auto mesh : {kMeshSP1, kMeshP1R1, kMeshP2R2}) {
      const auto& m = t.meshes[static_cast<std::size_t>(mesh)];
      for (const bool direction : {true, false}) {
        const auto contact = mesh_contact(t, mesh, direction);
        const bool gear1_drives = train::gear1_drives(mesh, GetParam(), direction);
        EXPECT_EQ(contact.approach_contact_ratio,
                  gear1_drives ? m.addendum_contact_ratio2 : m.addendum_contact_ratio1);
        EXPECT_EQ(contact.recess_contact_ratio,
                  gear1_drives ? m.addendum_contact_ratio1 : m.addendum_contact_ratio2);
        EXPECT_EQ(contact.sign, mesh == kMeshSP1 ? 1.0 : -1.0);
      }
      EXPECT_EQ(mesh_contact(t, mesh, true).approach_contact_ratio,
                mesh_contact(t, mesh, false).recess_contact_ratio);
    }
  }
}

TEST_P(TrainOfEitherSense, MeshEfficienciesAreThoseOfTheMeshesInTheirOrder) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const auto t = random.train(GetParam());
    for (const bool direction : {true, false}) {
      const auto eta = mesh_efficiencies(t, 0.08, LossModel::kSliding, direction);
      for (const auto mesh : {kMeshSP1, kMeshP1R1, kMeshP2R2}) {
        EXPECT_EQ(eta[static_cast<std::size_t>(mesh)],
                  mesh_efficiency(mesh_contact(t, mesh, direction), 0.08, LossModel::kSliding));
      }
    }
  }
}

TEST(DrivingGear, IsWhoTheTheorySaysForwardAndTheOtherOneBackward) {
  // G2 < 1: S drives P1, P1 drives R1, R2 drives P2; G2 > 1: R1 drives P1, P2 drives R2.
  EXPECT_TRUE(train::gear1_drives(kMeshSP1, true, true));
  EXPECT_TRUE(train::gear1_drives(kMeshP1R1, true, true));
  EXPECT_FALSE(train::gear1_drives(kMeshP2R2, true, true));
  EXPECT_TRUE(train::gear1_drives(kMeshSP1, false, true));
  EXPECT_FALSE(train::gear1_drives(kMeshP1R1, false, true));
  EXPECT_TRUE(train::gear1_drives(kMeshP2R2, false, true));
  for (const auto mesh : {kMeshSP1, kMeshP1R1, kMeshP2R2}) {
    for (const bool below : {true, false}) {
      EXPECT_NE(train::gear1_drives(mesh, below, true), train::gear1_drives(mesh, below, false));
    }
  }
}

}  // namespace
}  // namespace gear3k::efficiency::train_efficiency_test
