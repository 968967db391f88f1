#include "strength/locked_train.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"
#include "tests/strength/spring_network.hpp"

namespace gear3k::strength::locked_train_test {
namespace {

std::array<double, 3> compliances(const TrainSprings<double>& springs) {
  return {1.0 / springs.mesh_N_m[0], 1.0 / springs.mesh_N_m[1], 1.0 / springs.mesh_N_m[2]};
}

TEST(LockedTrain, AnglesUnderTorqueAndCouplesAreThoseOfANetworkOfSprings) {
  RandomTrain random(571);
  LargestDeviation angles;
  for (int n = 0; n < 400; ++n) {
    auto g = random.train(n % 2 == 0);
    g.planets = random.count(1, 5);
    const TrainSprings<double> springs = random_springs(random);
    const LockedCompliance c = locked_compliance(locked_train(g, springs), compliances(springs));
    const SpringNetwork network(g, springs);
    // Each load on its bodies; each angle read from them.
    const auto body_angle = [&](const SpringNetwork::Vector& x, int body) {
      return static_cast<double>(x(body));
    };
    const std::array<int, 3> planet_step{0, 0, 1};
    for (std::size_t load = 0; load < c.size(); ++load) {
      SpringNetwork::Vector torque = SpringNetwork::Vector::Zero(network.unknowns());
      if (load == 0) {
        torque(SpringNetwork::kOutput) = 1.0L;
      } else {
        for (int p = 0; p < g.planets; ++p) {
          torque(SpringNetwork::planet_angle(p, planet_step[load - 1])) = 1.0L / g.planets;
        }
        // Planets' angles count against the carrier.
        torque(SpringNetwork::kCarrier) += 1.0L;
        if (load == 1) torque(SpringNetwork::kSun) -= 1.0L;
        if (load == 3) torque(SpringNetwork::kRing2) -= 1.0L;
      }
      const auto x = network.displacements(torque, SpringNetwork::kInput);
      const double carrier = body_angle(x, SpringNetwork::kCarrier);
      const double planet1 = carrier + body_angle(x, SpringNetwork::planet_angle(0, 0));
      const double planet2 = carrier + body_angle(x, SpringNetwork::planet_angle(0, 1));
      const std::array<double, 4> angle{body_angle(x, SpringNetwork::kOutput),
                                        planet1 - body_angle(x, SpringNetwork::kSun), planet1,
                                        planet2 - body_angle(x, SpringNetwork::kRing2)};
      for (std::size_t i = 0; i < c.size(); ++i) {
        angles.see(n, c[i][load] - angle[i], 1e-9 * std::sqrt(c[i][i] * c[load][load]));
      }
    }
  }
  angles.expect_allowed("angles");
}

TEST(LockedTrain, WithoutCouplesGivesTheStiffnessOfTheOutput) {
  RandomTrain random(572);
  LargestDeviation stiffness;
  for (int n = 0; n < 400; ++n) {
    const auto g = random.train(n % 2 == 0);
    const TrainSprings<double> springs = random_springs(random);
    const LockedCompliance c = locked_compliance(locked_train(g, springs), compliances(springs));
    stiffness.see(n, c[0][0] * train_stiffness(g, springs).output_Nm_rad - 1.0, 1e-12);
  }
  stiffness.expect_allowed("stiffness");
}

}  // namespace
}  // namespace gear3k::strength::locked_train_test
