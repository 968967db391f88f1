#include "strength/flank_stress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::strength::flank_stress_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Elasticity kSteel{.youngs_modulus_Pa = 206e9, .poissons_ratio = 0.3};
constexpr Elasticity kPom{.youngs_modulus_Pa = 3.2e9, .poissons_ratio = 0.35};

/// Hertz: greatest pressure of two cylinders of radii r1, r2 (r2 < 0: hollow) under a line load.
double hertz_pressure(double line_load_N_m, double r1_m, double r2_m) {
  const double curvature = 1.0 / r1_m + 1.0 / r2_m;
  const double modulus = 1.0 / ((1.0 - 0.3 * 0.3) / 206e9 + (1.0 - 0.35 * 0.35) / 3.2e9);
  const double half_width = std::sqrt(4.0 * line_load_N_m / (kPi * curvature * modulus));
  return 2.0 * line_load_N_m / (kPi * half_width);
}

TEST(FlankStress, NominalIsHertzAtThePitchPointTimesTheContactRatioFactor) {
  LargestDeviation largest, at_b;
  RandomTrain random(51);
  for (int i = 0; i < 1000; ++i) {
    const auto train = random.train(i % 2 == 0);
    const ToothLoad<double> load{.tangential_N = random.between(1.0, 5000.0),
                                 .face_width_m = random.between(3e-3, 30e-3)};
    for (const std::size_t k : {0u, 1u, 2u}) {
      const auto& g1 = train.gears[k == 0 ? 0 : k == 1 ? 1 : 3];
      const auto& g2 = train.gears[k == 0 ? 1 : k == 1 ? 2 : 4];
      const auto& mesh = train.meshes[k];
      const auto stress = flank_stress<double>(
          {.gear1 = g1, .gear2 = g2, .mesh = mesh, .elasticity1 = kSteel, .elasticity2 = kPom},
          load, {});
      const double sign = k == 0 ? 1.0 : -1.0;
      const double normal = load.tangential_N / std::cos(g1.angle.alpha_rad) / load.face_width_m;
      const double tan_w = std::tan(mesh.alpha_w_rad);
      const double hertz =
          hertz_pressure(normal, g1.base_radius_m * tan_w, sign * g2.base_radius_m * tan_w);
      largest.see(i, stress.nominal_Pa / (hertz * stress.contact_ratio.value) - 1.0, 1e-12);
      // At B the same line load on the radii of curvature there, where it is larger.
      const double own =
          std::sqrt(g1.tip_radius_m * g1.tip_radius_m - g1.base_radius_m * g1.base_radius_m) -
          mesh.base_pitch_m;
      const double other = mesh.tangent_length_m - sign * own;
      if (stress.single_contact1.in_range) {
        const double ratio = std::max(1.0, hertz_pressure(normal, own, sign * other) / hertz);
        at_b.see(i, stress.single_contact1.value / ratio - 1.0, 1e-12);
      }
    }
  }
  largest.expect_allowed("hertz_at_the_pitch_point");
  at_b.expect_allowed("hertz_at_b");
}

TEST(FlankStress, ScaledLengthsAndForcesLeaveIt) {
  RandomTrain random(52);
  const auto train = random.train(true);
  const double s = 3.7;
  auto g1 = train.gears[0].gear, g2 = train.gears[1].gear;
  g1.module_m *= s;
  g2.module_m *= s;
  const auto big1 = geometry::make_gear_geometry(g1, train.gears[0].angle);
  const auto big2 = geometry::make_gear_geometry(g2, train.gears[1].angle);
  const auto mesh =
      geometry::make_mesh_geometry(big1, big2, s * train.meshes[0].center_distance_m).value();
  const auto small_stress = flank_stress<double>({.gear1 = train.gears[0],
                                                  .gear2 = train.gears[1],
                                                  .mesh = train.meshes[0],
                                                  .elasticity1 = kSteel,
                                                  .elasticity2 = kSteel},
                                                 {.tangential_N = 70.0, .face_width_m = 8e-3}, {});
  const auto big_stress = flank_stress<double>(
      {.gear1 = big1, .gear2 = big2, .mesh = mesh, .elasticity1 = kSteel, .elasticity2 = kSteel},
      {.tangential_N = 70.0 * s * s, .face_width_m = 8e-3 * s}, {});
  EXPECT_NEAR(big_stress.stress1_Pa / small_stress.stress1_Pa, 1.0, 1e-12);
  EXPECT_NEAR(big_stress.stress2_Pa / small_stress.stress2_Pa, 1.0, 1e-12);
}

TEST(FlankStress, OfARingsMateHasARingFactorOfOne) {
  RandomTrain random(53);
  const auto train = random.train(true);
  const auto stress = flank_stress<double>({.gear1 = train.gears[1],
                                            .gear2 = train.gears[2],
                                            .mesh = train.meshes[1],
                                            .elasticity1 = kSteel,
                                            .elasticity2 = kSteel},
                                           {.tangential_N = 70.0, .face_width_m = 8e-3},
                                           {.application = 1.5, .face = 1.2});
  EXPECT_EQ(stress.single_contact2.value, 1.0);
  EXPECT_EQ(stress.single_contact2.branch, "ring");
  EXPECT_DOUBLE_EQ(stress.stress2_Pa, stress.nominal_Pa * std::sqrt(1.5 * 1.2));
}

TEST(FlankStress, RefusesWhatHasNoMeaning) {
  RandomTrain random(54);
  const auto train = random.train(true);
  const auto rate = [&](ToothLoad<double> load, Elasticity elasticity) {
    return flank_stress<double>({.gear1 = train.gears[0],
                                 .gear2 = train.gears[1],
                                 .mesh = train.meshes[0],
                                 .elasticity1 = elasticity,
                                 .elasticity2 = kSteel},
                                load, {});
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(rate({.tangential_N = 1.0, .face_width_m = 0.0}, kSteel), std::invalid_argument);
  EXPECT_THROW(rate({.tangential_N = -1.0, .face_width_m = 1.0}, kSteel), std::invalid_argument);
  EXPECT_THROW(rate({.tangential_N = nan, .face_width_m = 1.0}, kSteel), std::invalid_argument);
  EXPECT_THROW(rate({.tangential_N = 1.0, .face_width_m = 1.0}, {.youngs_modulus_Pa = 0.0}),
               std::invalid_argument);
  EXPECT_EQ(rate({.tangential_N = 0.0, .face_width_m = 1.0}, kSteel).stress1_Pa, 0.0);
}

}  // namespace
}  // namespace gear3k::strength::flank_stress_test
