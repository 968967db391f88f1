#include "strength/train_stiffness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "strength/mesh_stiffness.hpp"
#include "tests/backlash/toleranced_train.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"
#include "tests/strength/spring_network.hpp"

namespace gear3k::strength::train_stiffness_test {
namespace {

TEST(TrainStiffness, IsThatOfAnAssembledNetworkOfSprings) {
  RandomTrain random(61);
  LargestDeviation output, input, ratio;
  for (int n = 0; n < 1000; ++n) {
    auto g = random.train(n % 2 == 0);
    g.planets = random.count(1, 5);
    const TrainSprings<double> springs = random_springs(random);
    const auto k = train_stiffness(g, springs);
    const SpringNetwork network(g, springs);
    output.see(n,
               network.stiffness(SpringNetwork::kOutput, SpringNetwork::kInput) - k.output_Nm_rad,
               1e-9 * k.output_Nm_rad);
    input.see(n, network.stiffness(SpringNetwork::kInput, SpringNetwork::kOutput) - k.input_Nm_rad,
              1e-9 * k.input_Nm_rad);
    const double i = train::ratio(g.teeth);
    ratio.see(n, k.input_Nm_rad * i * i - k.output_Nm_rad, 1e-14 * k.output_Nm_rad);
  }
  output.expect_allowed("output");
  input.expect_allowed("input");
  ratio.expect_allowed("input_from_output");
}

TEST(TrainStiffness, CompliancesAddUp) {
  RandomTrain random(62);
  const auto g = random.train(true);
  const auto k = train_stiffness(g, random_springs(random));
  const auto& c = k.compliance;
  const double sum =
      c.mesh[0] + c.mesh[1] + c.mesh[2] + c.planet_torsion + c.bearings + c.sun_shaft + c.ring2;
  EXPECT_NEAR(sum * k.output_Nm_rad, 1.0, 1e-14);
}

TEST(TrainStiffness, DerivativesAreThoseOfDifferences) {
  RandomTrain random(63);
  for (int n = 0; n < 40; ++n) {
    const train::ToothSet z = random.teeth(n % 2 == 0);
    const auto stiffness = [&](const auto& x) {
      using T = std::decay_t<decltype(x[0])>;
      train::TrainParameters<T> p{};
      p.teeth = z;
      p.planets = 3;
      p.pressure_angle_rad = x[3];
      p.module_m = {x[0], x[1]};
      p.center_distance_m = x[2];
      const auto g = train::make_train_geometry(p);
      TrainSprings<T> springs;
      springs.mesh_N_m = {1e8 * x[4], 2e8 * x[4], 1.5e8 * x[4]};
      springs.planet_torsion_Nm_rad = 900.0 * x[5];
      springs.sun_shaft_Nm_rad = 200.0 * x[5];
      springs.ring2_Nm_rad = 3e4 * x[5];
      springs.bearings = PlanetBearings<T>{.axis = {.plane1_m = constant<T>(0.0),
                                                    .plane2_m = 9e-3 * x[6],
                                                    .support_a_m = constant<T>(-4e-3),
                                                    .support_b_m = constant<T>(14e-3),
                                                    .mass_center_m = constant<T>(0.0)},
                                           .stiffness_N_m = {{T(3e7 * x[6]), T(4e7 * x[6])}},
                                           .pin_stiffness_N_m = T(9e7 * x[7])};
      return train_stiffness(*g, springs).output_Nm_rad;
    };
    const double m1 = 0.7e-3, m2 = m1 * (z.R1 - z.P1) / (z.R2 - z.P2);
    const std::array<double, 8> at{m1,  m2, 0.5 * m1 * (z.R1 - z.P1) * 1.03, 0.35, 1.0, 1.0,
                                   1.0, 1.0};
    std::array<Jet1, 8> jets;
    for (std::size_t i = 0; i < 8; ++i) jets[i] = Jet1(at[i], static_cast<int>(i));
    const Jet1 exact = stiffness(jets);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto difference = [&](double h) {
        std::array<double, 8> up = at, down = at;
        up[i] *= 1.0 + h;
        down[i] *= 1.0 - h;
        return (stiffness(up) - stiffness(down)) / (2.0 * h);
      };
      const double expected = (4.0 * difference(2e-4) - difference(4e-4)) / 3.0;
      EXPECT_NEAR(exact.v[static_cast<int>(i)] * at[i], expected, 1e-6 * exact.a) << n << ' ' << i;
    }
  }
}

/// K_out of the bilateral drive gear in steel with the analytic stiffness of its meshes.
template <class T>
T loaded_stiffness(const std::array<T, 8>& x) {
  const train::TrainParameters<double> drawn = backlash::thinned_bilateral_drive_gear();
  train::TrainParameters<T> p{};
  p.teeth = drawn.teeth;
  p.planets = drawn.planets;
  p.pressure_angle_rad = constant<T>(drawn.pressure_angle_rad);
  p.profile_shift = {x[0], x[1], x[2], x[3], x[4]};
  p.module_m = {x[5], x[6]};
  p.center_distance_m = x[7];
  for (T& q : p.machining_allowance) q = constant<T>(0.05);
  const auto g = train::make_train_geometry(p);
  constexpr double kFaceWidth = 8e-3;
  constexpr Elasticity kSteel{.youngs_modulus_Pa = 206e9, .poissons_ratio = 0.3};
  const auto forces = lossless_mesh_forces(*g, constant<T>(20.0));
  TrainSprings<T> springs;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto& gear1 = g->gears[static_cast<std::size_t>(train::kMeshGears[k][0])];
    const auto& gear2 = g->gears[static_cast<std::size_t>(train::kMeshGears[k][1])];
    springs.mesh_N_m[k] = kFaceWidth * mean_mesh_stiffness(make_elastic_mesh(
                                           gear1, geometry::make_tooth_form(gear1), gear2,
                                           geometry::make_tooth_form(gear2), g->meshes[k], kSteel,
                                           kSteel, T(forces.normal_N[k] * (1.0 / kFaceWidth))));
  }
  return train_stiffness(*g, springs).output_Nm_rad;
}

TEST(TrainStiffness, GradientThroughTheMeshesIsThatOfDifferences) {
  const train::TrainParameters<double> p = backlash::thinned_bilateral_drive_gear();
  const std::array<double, 8> at{p.profile_shift[0], p.profile_shift[1], p.profile_shift[2],
                                 p.profile_shift[3], p.profile_shift[4], p.module_m[0],
                                 p.module_m[1],      p.center_distance_m};
  std::array<Jet1, 8> jets;
  for (std::size_t i = 0; i < 8; ++i) jets[i] = Jet1(at[i], static_cast<int>(i));
  const Jet1 exact = loaded_stiffness(jets);
  EXPECT_NEAR(exact.a, loaded_stiffness(at), 1e-12 * exact.a);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto difference = [&](double h) {
      std::array<double, 8> up = at, down = at;
      up[i] *= 1.0 + h;
      down[i] *= 1.0 - h;
      return (loaded_stiffness(up) - loaded_stiffness(down)) / (2.0 * h);
    };
    const double expected = (4.0 * difference(1e-4) - difference(2e-4)) / 3.0;
    EXPECT_NEAR(exact.v[static_cast<int>(i)] * at[i], expected, 1e-6 * exact.a) << i;
  }
}

TEST(TrainStiffness, NamesBadInput) {
  RandomTrain random(64);
  const auto g = random.train(true);
  TrainSprings<double> springs = random_springs(random);
  springs.mesh_N_m[1] = 0.0;
  EXPECT_THROW(train_stiffness(g, springs), std::invalid_argument);
  springs.mesh_N_m[1] = 1e8;
  springs.bearings = PlanetBearings<double>{.axis = {.support_a_m = 1e-3, .support_b_m = 1e-3}};
  EXPECT_THROW(train_stiffness(g, springs), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::train_stiffness_test
