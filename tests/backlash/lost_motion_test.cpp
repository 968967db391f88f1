#include "backlash/lost_motion.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include "backlash/normal_backlash.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/linear_solve.hpp"
#include "tests/random_train.hpp"

namespace gear3k::backlash::lost_motion_test {
namespace {

using train::kMeshP1R1, train::kMeshP2R2, train::kMeshSP1;
using train::kP1, train::kP2, train::kR1, train::kR2, train::kS;
using train::TrainGeometry;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr int kCases = 3000;

class Random : public RandomTrain {
 public:
  Random() : RandomTrain(8) {}
  std::array<double, 3> backlashes() {
    return {between(0.0, 50e-6), between(0.0, 50e-6), between(0.0, 50e-6)};
  }
};

/// Which end of the train is held while the other is turned.
enum class Held { kSun, kOutput };

/// Rigid bodies with play: small rotations of carrier, planet and the free end, R1 fixed.  Each
/// mesh may close its clearance j by +-j/2 along the line of action; the free end's range is found
/// by closing the meshes in all ways and solving for the rotations.
double solved_range(const TrainGeometry<double>& t, const std::array<double, 3>& j, Held held) {
  const double d = t.center_distance_m;
  Eigen::Matrix3d closing;  // rows: meshes; columns: carrier, planet, free end
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const bool internal = k != kMeshSP1;
    const auto& gear1 = t.gears[static_cast<std::size_t>(first)];
    const auto& gear2 = t.gears[static_cast<std::size_t>(second)];
    // Pitch point on the line of centres: where it divides as the tooth numbers do.
    const double z1 = gear1.gear.teeth;
    const double z2 = gear2.gear.teeth;
    const double central = internal ? d * z2 / (z2 - z1) : d * z1 / (z1 + z2);
    const double cos_w = (internal ? gear2 : gear1).base_radius_m / central;
    // Velocities at the pitch point at right angles to the line of centres; the line of action is
    // inclined to them by the working angle.
    const double planet_by_carrier = d;
    const double planet_by_spin = central - d;
    const auto row = static_cast<Eigen::Index>(k);
    closing(row, 0) = cos_w * planet_by_carrier;
    closing(row, 1) = cos_w * planet_by_spin;
    const bool moves =
        (k == kMeshSP1 && held == Held::kOutput) || (k == kMeshP2R2 && held == Held::kSun);
    closing(row, 2) = moves ? -cos_w * central : 0.0;
  }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d gap;
    for (unsigned k = 0; k < 3; ++k) gap[k] = (corner >> k & 1U) != 0 ? 0.5 * j[k] : -0.5 * j[k];
    const double turned = test::solved(closing, gap)[2];
    low = std::min(low, turned);
    high = std::max(high, turned);
  }
  return high - low;
}

/// Rounding of the rigid-body solution: its matrix nears singularity as G2 nears 1.
double rounding(const TrainGeometry<double>& t, double angle) {
  return 4.0 * kEps * angle * (1.0 + std::abs(train::ratio(t.teeth)));
}

class LostMotion : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Trains, LostMotion, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& below) {
                           return below.param ? "G2BelowOne" : "G2AboveOne";
                         });

TEST_P(LostMotion, KinematicModelIsTheRangeOfRigidBodiesWithPlay) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto j = random.backlashes();
    const double range = solved_range(t, j, Held::kSun);
    largest.see(i, output_lost_motion(t, j, LostMotionModel::kKinematic) - range,
                rounding(t, range));
  }
  largest.expect_allowed("range");
}

TEST_P(LostMotion, EachMeshAloneMovesTheOutputByItsShare) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto j = random.backlashes();
    const auto share = kinematic_lost_motion(t, j);
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> alone{};
      alone[k] = j[k];
      const double range = solved_range(t, alone, Held::kSun);
      largest.see(i, share[k] - range, rounding(t, range));
      largest.see(i, output_lost_motion(t, alone, LostMotionModel::kKinematic) - range,
                  rounding(t, range));
    }
  }
  largest.expect_allowed("share");
}

TEST_P(LostMotion, AtTheInputIsTheRatioTimesThatAtTheOutput) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto j = random.backlashes();
    const double range = solved_range(t, j, Held::kOutput);
    largest.see(
        i,
        output_lost_motion(t, j, LostMotionModel::kKinematic) * std::abs(train::ratio(t.teeth)) -
            range,
        rounding(t, range));
  }
  largest.expect_allowed("input_range");
}

TEST_P(LostMotion, NegativeBacklashKeepsItsSignInTheShares) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const auto t = random.train(GetParam());
    const auto j = random.backlashes();
    const std::array<double, 3> mirrored{-j[0], -j[1], -j[2]};
    EXPECT_EQ(output_lost_motion(t, mirrored, LostMotionModel::kKinematic),
              -output_lost_motion(t, j, LostMotionModel::kKinematic));
    const auto share = kinematic_lost_motion(t, mirrored);
    for (const double s : share) EXPECT_LE(s, 0.0);
  }
}

TEST_P(LostMotion, PaperModelAddsTheFirstAngleToTheLargerOfTheOthers) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < kCases; ++i) {
    const auto t = random.train(GetParam());
    const auto j = random.backlashes();
    const auto& z = t.teeth;
    // Eqs. 16-17 with reference radii m z/2, the sun's multiplied by the ratio.
    const double cos_alpha = t.gears[kS].base_radius_m / t.gears[kS].reference_radius_m;
    const double g1 = static_cast<double>(z.R1) / z.S;
    const double g2 = static_cast<double>(z.P2) * z.R1 / (static_cast<double>(z.P1) * z.R2);
    const double m1 = t.gears[kS].gear.module_m;
    const double m2 = t.gears[kP2].gear.module_m;
    const double phi1 = j[0] / cos_alpha / (std::abs((1.0 + g1) / (1.0 - g2)) * 0.5 * m1 * z.S);
    const double phi2 = j[1] / cos_alpha / (0.5 * m1 * z.R1);
    const double phi3 = j[2] / cos_alpha / (0.5 * m2 * z.R2);
    const double total = phi1 + std::max(phi2, phi3);
    const auto phi = paper_lost_motion(t, j);
    const double allowed = rounding(t, total);
    largest.see(i, phi[0] - phi1, allowed);
    largest.see(i, phi[1] - phi2, allowed);
    largest.see(i, phi[2] - phi3, allowed);
    largest.see(i, output_lost_motion(t, j, LostMotionModel::kPaper) - total, allowed);
  }
  largest.expect_allowed("paper");
}

TEST_P(LostMotion, NormalBacklashesAreThoseOfTheMeshesInTheirOrder) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const auto t = random.train(GetParam());
    const auto j = normal_backlashes(t);
    EXPECT_EQ(j[kMeshSP1], normal_backlash(t.gears[kS], t.gears[kP1], t.meshes[kMeshSP1]));
    EXPECT_EQ(j[kMeshP1R1], normal_backlash(t.gears[kP1], t.gears[kR1], t.meshes[kMeshP1R1]));
    EXPECT_EQ(j[kMeshP2R2], normal_backlash(t.gears[kP2], t.gears[kR2], t.meshes[kMeshP2R2]));
  }
}

TEST(LostMotionModels, PaperFallsShortOfRigidBodiesAtEqualBacklashWithG2NearOne) {
  // |G1 + G2| is close to 1 + G1 there: the paper drops one of two terms that rigid bodies add.
  Random random;
  for (int i = 0; i < 500; ++i) {
    const auto t = random.train(true);
    if (train::g2(t.teeth) < 0.9) continue;
    const std::array<double, 3> equal{20e-6, 20e-6, 20e-6};
    EXPECT_LT(output_lost_motion(t, equal, LostMotionModel::kPaper),
              output_lost_motion(t, equal, LostMotionModel::kKinematic));
  }
}

}  // namespace
}  // namespace gear3k::backlash::lost_motion_test
