#include "strength/mesh_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "backlash/lost_motion.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::strength::mesh_forces_test {
namespace {

constexpr int kCases = 1000;  // of each sign of the ratio

struct Planar {
  double x = 0.0, y = 0.0;
};
double cross(const Planar& a, const Planar& b) { return a.x * b.y - a.y * b.x; }

/// The force of a mesh on the planet at (d, 0) and a point of its line of action, from the two base
/// circles: the line touches the planet's base circle, and passes the central gear's at its radius.
/// @param tangential_sign  of the force's component along +y
struct LineOfAction {
  Planar point, direction;
};
LineOfAction line_of_action(const train::TrainGeometry<double>& g, std::size_t mesh,
                            double tangential_sign) {
  const auto planet = static_cast<std::size_t>(mesh == train::kMeshP2R2 ? train::kP2 : train::kP1);
  const double rb_P = g.gears[planet].base_radius_m;
  const double cos_w = std::cos(g.meshes[mesh].alpha_w_rad);
  const double sin_w = std::sin(g.meshes[mesh].alpha_w_rad);
  // The sun pushes outwards, the rings inwards, whichever way they turn.
  const double radial = mesh == train::kMeshSP1 ? 1.0 : -1.0;
  const Planar u{.x = radial * sin_w, .y = tangential_sign * cos_w};
  // Both normals of u are candidates for the tangent point; the right one lies towards the sun for
  // mesh 1 and towards the ring for the others.
  const double towards = mesh == train::kMeshSP1 ? -1.0 : 1.0;
  Planar normal{.x = -u.y, .y = u.x};
  if (normal.x * towards < 0.0) normal = {.x = -normal.x, .y = -normal.y};
  return {.point = {.x = g.center_distance_m + rb_P * normal.x, .y = rb_P * normal.y},
          .direction = u};
}

TEST(MeshForces, LosslessForcesKeepPlanetAndCarrierInBalance) {
  RandomTrain random(51);
  LargestDeviation planet, tangential, output, sun, carrier;
  for (int n = 0; n < 2 * kCases; ++n) {
    const auto g = random.train(n % 2 == 0);
    const double torque = random.between(-50.0, 50.0);
    const auto f = lossless_mesh_forces(g, torque);
    const double N = g.planets;
    const std::array<double, 3> T{f.normal_N[0] * N * g.gears[train::kS].base_radius_m,
                                  f.normal_N[1] * N * g.gears[train::kR1].base_radius_m,
                                  f.normal_N[2] * N * g.gears[train::kR2].base_radius_m};
    double about_planet = 0.0, about_main = 0.0, scale = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const LineOfAction line = line_of_action(g, k, f.tangential_N[k] < 0.0 ? -1.0 : 1.0);
      const Planar arm{.x = line.point.x - g.center_distance_m, .y = line.point.y};
      const double moment = f.normal_N[k] * cross(line.point, line.direction);
      about_planet += f.normal_N[k] * cross(arm, line.direction);
      about_main += moment;
      scale += std::abs(moment);
      // The moment about the main axis is that on the central gear, with the opposite sign.
      output.see(n, N * std::abs(moment) - T[k], 1e-12 * T[k]);
    }
    planet.see(n, about_planet, 1e-12 * scale);
    carrier.see(n, about_main, 1e-12 * scale);
    tangential.see(n, f.tangential_N[0] + f.tangential_N[1] + f.tangential_N[2],
                   1e-12 * std::abs(f.tangential_N[1]));
    const double input = std::abs(torque / train::ratio(g.teeth));
    sun.see(n, T[0] - input, 1e-12 * input);
    sun.see(n, T[2] - std::abs(torque), 1e-12 * std::abs(torque));
  }
  planet.expect_allowed("moment_on_planet");
  carrier.expect_allowed("moment_about_main_axis");
  tangential.expect_allowed("tangential_forces");
  output.expect_allowed("moment_on_central_gears");
  sun.expect_allowed("torques_at_the_ends");
}

TEST(MeshForces, PlanetSeesSunAndRing1OnOppositeFlanksBelowAndOnTheSameFlankAboveG2Of1) {
  RandomTrain random(52);
  for (int n = 0; n < 200; ++n) {
    const auto g = random.train(n % 2 == 0);
    const auto f = lossless_mesh_forces(g, 10.0);
    const double rb_P1 = g.gears[train::kP1].base_radius_m;
    const double rb_P2 = g.gears[train::kP2].base_radius_m;
    const double sum = n % 2 == 0 ? f.normal_N[1] - f.normal_N[0] : f.normal_N[1] + f.normal_N[0];
    EXPECT_NEAR(rb_P1 * sum, rb_P2 * f.normal_N[2], 1e-11 * rb_P2 * f.normal_N[2]) << n;
  }
}

TEST(MeshForces, LosslessForcesAreTheCoefficientsOfTheLostMotion) {
  RandomTrain random(53);
  for (int n = 0; n < 200; ++n) {
    const auto g = random.train(n % 2 == 0);
    const auto a = normal_forces_per_torque(g);
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> play{};
      play[k] = 1e-6;
      const double angle = backlash::kinematic_lost_motion(g, play)[k];
      EXPECT_NEAR(a[k] * 1e-6, angle, 1e-12 * angle) << n;
    }
  }
}

using Efficiencies = std::array<train::DriverEfficiencies<double>, 3>;

TEST(MeshForces, PowerFlowWithoutLossesGivesTheLosslessForces) {
  RandomTrain random(54);
  LargestDeviation normal, tangential;
  const Efficiencies ones{{{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}};
  for (int n = 0; n < 2 * kCases; ++n) {
    const auto g = random.train(n % 2 == 0);
    for (const bool forward : {true, false}) {
      const auto f = driven_mesh_forces(g, ones, 12.0, forward);
      ASSERT_TRUE(f);
      // Backward, R2 is driven along its motion: its teeth are loaded the other way.
      const auto closed = lossless_mesh_forces(g, forward ? 12.0 : -12.0);
      for (std::size_t k = 0; k < 3; ++k) {
        normal.see(n, f->normal_N[k] - closed.normal_N[k], 1e-11 * closed.normal_N[k]);
        tangential.see(n, f->tangential_N[k] - closed.tangential_N[k], 1e-11 * closed.normal_N[k]);
      }
    }
  }
  normal.expect_allowed("normal_forces");
  tangential.expect_allowed("tangential_forces");
}

Efficiencies random_efficiencies(RandomTrain& random, double loss) {
  Efficiencies eta{};
  for (auto& mesh : eta) {
    mesh[0] = 1.0 - loss * random.between(0.2, 1.0);
    mesh[1] = mesh[0] - 0.01 * loss;
  }
  return eta;
}

TEST(MeshForces, MeshPowersPlusLossesEqualShaftPowers) {
  RandomTrain random(55);
  LargestDeviation power, forces, tangential;
  for (int n = 0; n < 2 * kCases; ++n) {
    const auto g = random.train(n % 2 == 0);
    const Efficiencies eta = random_efficiencies(random, 0.02);
    const auto w = train::speed_ratios(g.teeth);
    for (const bool forward : {true, false}) {
      const double torque = random.between(1.0, 50.0);
      const auto flow = train::solve_power_flow(
          train::LoadedTrain<double>{.teeth = g.teeth,
                                     .efficiency = eta,
                                     .known = {},
                                     .given_end = train::End::kOutput,
                                     .given_torque_Nm = forward ? -torque : torque});
      ASSERT_TRUE(flow);
      const auto f = mesh_forces(g, *flow);
      const double N = g.planets;
      // Powers over |w_R2|, from the forces alone: of the planets on the central gears ...
      const std::array<double, 3> rb{g.gears[train::kS].base_radius_m,
                                     g.gears[train::kR1].base_radius_m,
                                     g.gears[train::kR2].base_radius_m};
      const std::array<double, 3> speed{w.sun, 0.0, 1.0};
      // ... and of their moment and tangential force on the planets.
      double on_central = 0.0, on_planets = 0.0, losses = 0.0, scale = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double T = (f.tangential_N[k] > 0.0 ? -1.0 : 1.0) * N * f.normal_N[k] * rb[k];
        forces.see(n, T - flow->mesh_torque_Nm[k], 1e-12 * std::abs(T));
        const double moment = -T - N * g.center_distance_m * f.tangential_N[k];
        on_central += T * speed[k];
        on_planets += moment * (w.planet - w.carrier) - T * w.carrier;
        losses += flow->mesh_loss_Nm[k];
        scale += std::abs(T) * (std::abs(w.carrier) + std::abs(speed[k]));
      }
      const double shafts = flow->sun_torque_Nm * w.sun + flow->output_torque_Nm;
      power.see(n, on_central + on_planets + losses, 1e-12 * scale);
      power.see(n, shafts - losses, 1e-12 * scale);
      tangential.see(n, f.tangential_N[0] + f.tangential_N[1] + f.tangential_N[2],
                     1e-12 * scale / g.center_distance_m);
    }
  }
  power.expect_allowed("powers");
  forces.expect_allowed("torques_of_forces");
  tangential.expect_allowed("tangential_forces");
}

TEST(MeshForces, ForwardAndBackwardForcesMeetAsFrictionVanishes) {
  RandomTrain random(56);
  for (int n = 0; n < 2 * kCases; ++n) {
    const auto g = random.train(n % 2 == 0);
    double before = 0.0;
    RandomTrain same(100U + static_cast<unsigned>(n));
    const Efficiencies scale = random_efficiencies(same, 1.0);
    // Where two nearly equal torques balance, a small loss is a large share.
    const double sensitivity = 1.0 / std::abs(1.0 - train::g2(g.teeth));
    for (const double mu : {1e-4, 1e-5, 1e-6}) {
      Efficiencies eta{};
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 2; ++i) eta[k][i] = 1.0 - mu * (1.0 - scale[k][i]);
      }
      const auto forward = driven_mesh_forces(g, eta, 10.0, true);
      const auto backward = driven_mesh_forces(g, eta, 10.0, false);
      ASSERT_TRUE(forward && backward);
      double apart = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double f = forward->normal_N[k];
        apart = std::max(apart, std::abs(f - backward->normal_N[k]) / f);
      }
      EXPECT_LE(apart, 10.0 * mu * sensitivity) << n;
      if (before > 0.0) {
        EXPECT_LE(apart, 0.2 * before) << n;
      }
      before = apart;
    }
  }
}

TEST(MeshForces, DerivativesAreThoseOfDifferences) {
  RandomTrain random(57);
  for (int n = 0; n < 40; ++n) {
    train::TrainParameters<double> p{};
    p.teeth = random.teeth(n % 2 == 0);
    p.pressure_angle_rad = 0.35;
    p.module_m = {0.7e-3, 0.7e-3 * (p.teeth.R1 - p.teeth.P1) / (p.teeth.R2 - p.teeth.P2)};
    p.center_distance_m = 0.5 * p.module_m[0] * (p.teeth.R1 - p.teeth.P1) * 1.03;
    const auto force = [&](auto torque, auto module, auto distance) {
      using T = decltype(torque);
      train::TrainParameters<T> q{};
      q.teeth = p.teeth;
      q.pressure_angle_rad = constant<T>(p.pressure_angle_rad);
      q.module_m = {module, constant<T>(p.module_m[1])};
      q.center_distance_m = distance;
      const auto g = train::make_train_geometry(q);
      std::array<train::DriverEfficiencies<T>, 3> eta{};
      for (auto& mesh : eta) mesh = {constant<T>(0.995), constant<T>(0.994)};
      const auto f = driven_mesh_forces(*g, eta, torque, false);
      const auto lossless = lossless_mesh_forces(*g, torque);
      T sum = constant<T>(0.0);
      for (std::size_t k = 0; k < 3; ++k) {
        sum = sum + f->normal_N[k] * (1.0 + static_cast<double>(k)) + 0.3 * f->tangential_N[k] +
              0.7 * lossless.tangential_N[k];
      }
      return sum;
    };
    const double m = p.module_m[0], d = p.center_distance_m, torque = 9.0;
    const Jet1 exact = force(Jet1(torque, 0), Jet1(m, 1), Jet1(d, 2));
    const double h = 1e-5;
    const auto slope = [&](double dt, double dm, double dd) {
      return (force(torque + dt, m + dm, d + dd) - force(torque - dt, m - dm, d - dd)) / (2.0 * h);
    };
    const double size = std::abs(exact.a);
    EXPECT_NEAR(exact.v[0] * torque, slope(h * torque, 0.0, 0.0), 1e-6 * size);
    EXPECT_NEAR(exact.v[1] * m, slope(0.0, h * m, 0.0), 1e-6 * size);
    EXPECT_NEAR(exact.v[2] * d, slope(0.0, 0.0, h * d), 1e-6 * size);
  }
}

}  // namespace
}  // namespace gear3k::strength::mesh_forces_test
