#include "strength/planet_loads.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::strength::planet_loads_test {
namespace {

PlanetAxis<double> random_axis(RandomTrain& random) {
  return {.plane1_m = random.between(-10e-3, 10e-3),
          .plane2_m = random.between(-10e-3, 30e-3),
          .support_a_m = random.between(-20e-3, 0.0),
          .support_b_m = random.between(5e-3, 40e-3),
          .mass_center_m = random.between(-10e-3, 30e-3)};
}

TEST(PlanetLoads, ForcesAndMomentsOnThePlanetAreInBalance) {
  RandomTrain random(71);
  LargestDeviation force, moment, couple;
  for (int n = 0; n < 2000; ++n) {
    const auto g = random.train(n % 2 == 0);
    const PlanetAxis<double> axis = random_axis(random);
    const auto forces = lossless_mesh_forces(g, random.between(-40.0, 40.0));
    const double mass = random.between(0.0, 0.2), speed = random.between(-50.0, 50.0);
    const auto p = planet_loads(g, forces, axis, mass, speed);
    EXPECT_NEAR(p.centrifugal_N, mass * g.center_distance_m * speed * speed,
                1e-14 * p.centrifugal_N);
    // In a plane through the axis, radial and tangential, about any point.
    const double origin = random.between(-0.1, 0.1);
    const double scale = forces.normal_N[0] + forces.normal_N[1] + forces.normal_N[2] +
                         p.centrifugal_N + p.bearing_load_N[0] + p.bearing_load_N[1];
    const auto& a = p.reaction[0];
    const auto& b = p.reaction[1];
    force.see(n,
              p.plane[0].radial_N + p.plane[1].radial_N + p.centrifugal_N + a.radial_N + b.radial_N,
              1e-12 * scale);
    force.see(n,
              p.plane[0].tangential_N + p.plane[1].tangential_N + a.tangential_N + b.tangential_N,
              1e-12 * scale);
    moment.see(n,
               p.plane[0].radial_N * (axis.plane1_m - origin) +
                   p.plane[1].radial_N * (axis.plane2_m - origin) +
                   p.centrifugal_N * (axis.mass_center_m - origin) +
                   a.radial_N * (axis.support_a_m - origin) +
                   b.radial_N * (axis.support_b_m - origin),
               1e-12 * scale * 0.1);
    moment.see(n,
               p.plane[0].tangential_N * (axis.plane1_m - origin) +
                   p.plane[1].tangential_N * (axis.plane2_m - origin) +
                   a.tangential_N * (axis.support_a_m - origin) +
                   b.tangential_N * (axis.support_b_m - origin),
               1e-12 * scale * 0.1);
    // The planes' tangential forces are a couple: so are the bearings'.
    couple.see(n, a.tangential_N + b.tangential_N, 1e-12 * scale);
    couple.see(n, p.tilting_couple_Nm + b.tangential_N * (axis.support_b_m - axis.support_a_m),
               1e-12 * scale * 0.1);
  }
  force.expect_allowed("forces");
  moment.expect_allowed("moments");
  couple.expect_allowed("tilting_couple");
}

TEST(PlanetLoads, PlaneForcesHaveTheirSigns) {
  RandomTrain random(72);
  for (const bool below : {true, false}) {
    const auto g = random.train(below);
    const auto f = lossless_mesh_forces(g, 10.0);
    const auto plane = plane_forces(g, f);
    const auto cos = [&](std::size_t k) { return std::cos(g.meshes[k].alpha_w_rad); };
    const auto sin = [&](std::size_t k) { return std::sin(g.meshes[k].alpha_w_rad); };
    const double s1 = below ? 1.0 : -1.0;
    EXPECT_NEAR(plane[0].tangential_N, s1 * f.normal_N[0] * cos(0) + f.normal_N[1] * cos(1), 1e-9);
    EXPECT_NEAR(plane[1].tangential_N, -f.normal_N[2] * cos(2), 1e-9);
    EXPECT_NEAR(plane[0].radial_N, f.normal_N[0] * sin(0) - f.normal_N[1] * sin(1), 1e-9);
    EXPECT_NEAR(plane[1].radial_N, -f.normal_N[2] * sin(2), 1e-9);
  }
}

TEST(PlanetLoads, BendingMomentIsTheGreatestAlongThePin) {
  RandomTrain random(73);
  for (int n = 0; n < 200; ++n) {
    const auto g = random.train(n % 2 == 0);
    const PlanetAxis<double> axis = random_axis(random);
    const auto p = planet_loads(g, lossless_mesh_forces(g, 20.0), axis, 0.1, 30.0);
    const auto moment_at = [&](double z) {
      double radial = 0.0, tangential = 0.0;
      const auto add = [&](double at, double r, double t) {
        radial += r * std::max(0.0, z - at);
        tangential += t * std::max(0.0, z - at);
      };
      add(axis.plane1_m, p.plane[0].radial_N, p.plane[0].tangential_N);
      add(axis.plane2_m, p.plane[1].radial_N, p.plane[1].tangential_N);
      add(axis.mass_center_m, p.centrifugal_N, 0.0);
      add(axis.support_a_m, p.reaction[0].radial_N, p.reaction[0].tangential_N);
      add(axis.support_b_m, p.reaction[1].radial_N, p.reaction[1].tangential_N);
      return std::hypot(radial, tangential);
    };
    constexpr int kPlaces = 8000;
    double greatest = 0.0;
    for (int i = 0; i <= kPlaces; ++i) {
      greatest = std::max(greatest, moment_at(-20e-3 + i * 60e-3 / kPlaces));
    }
    EXPECT_NEAR(p.bending_moment_Nm, moment_at(p.bending_position_m), 1e-12 * greatest);
    EXPECT_NEAR(p.bending_moment_Nm, greatest, 3e-3 * greatest);
    EXPECT_GE(p.bending_moment_Nm, (1.0 - 1e-12) * greatest);
  }
}

TEST(PlanetLoads, PinStressByHandAndBadInputNamed) {
  EXPECT_NEAR(pin_bending_stress(1.0, 4e-3), 32.0 / (std::numbers::pi * 64e-9), 1e-3);
  EXPECT_THROW(pin_bending_stress(1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(check_planet_axis<double>({.support_a_m = 2e-3, .support_b_m = 2e-3}),
               std::invalid_argument);
  EXPECT_THROW(check_planet_axis<double>(
                   {.plane1_m = std::numeric_limits<double>::quiet_NaN(), .support_b_m = 2e-3}),
               std::invalid_argument);
}

TEST(PlanetLoads, DerivativesAreThoseOfDifferences) {
  RandomTrain random(74);
  for (int n = 0; n < 40; ++n) {
    const train::ToothSet z = random.teeth(n % 2 == 0);
    const auto loads = [&](const auto& x) {
      using T = std::decay_t<decltype(x[0])>;
      train::TrainParameters<T> p{};
      p.teeth = z;
      p.pressure_angle_rad = x[2];
      p.module_m = {x[0], constant<T>(0.7e-3 * (z.R1 - z.P1) / (z.R2 - z.P2))};
      p.center_distance_m = x[1];
      const auto g = train::make_train_geometry(p);
      const PlanetAxis<T> axis{.plane1_m = constant<T>(0.0),
                               .plane2_m = 9e-3 * x[4],
                               .support_a_m = constant<T>(-4e-3),
                               .support_b_m = 14e-3 * x[5],
                               .mass_center_m = constant<T>(4e-3)};
      const auto l =
          planet_loads(*g, lossless_mesh_forces(*g, x[3]), axis, T(0.05 * x[4]), constant<T>(40.0));
      return std::array<T, 4>{l.bearing_load_N[0], l.bearing_load_N[1],
                              pin_bending_stress(l.bending_moment_Nm, T(4e-3 * x[5])),
                              l.tilting_couple_Nm};
    };
    const std::array<double, 6> at{0.7e-3, 0.5 * 0.7e-3 * (z.R1 - z.P1) * 1.03, 0.35, 9.0, 1.0,
                                   1.0};
    std::array<Jet1, 6> jets;
    for (std::size_t i = 0; i < 6; ++i) jets[i] = Jet1(at[i], static_cast<int>(i));
    const auto exact = loads(jets);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto moved = [&](double h) {
        std::array<double, 6> x = at;
        x[i] *= 1.0 + h;
        return loads(x);
      };
      const double h = 2e-5;
      const auto up = moved(h), down = moved(-h);
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(exact[k].v[static_cast<int>(i)] * at[i], (up[k] - down[k]) / (2.0 * h),
                    1e-6 * std::abs(exact[k].a))
            << n << ' ' << i << ' ' << k;
      }
    }
  }
}

}  // namespace
}  // namespace gear3k::strength::planet_loads_test
