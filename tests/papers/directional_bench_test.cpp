// The thesis's bench in `reproduce`, against its equations written anew and a motion integrated by
// hand.
#include "papers/directional_bench.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "papers/published_sources.hpp"
#include "papers/reproduce.hpp"

namespace gear3k::papers::directional_bench_test {
namespace {

const PublishedSources& sources() {
  static const PublishedSources kSources = published_sources();
  return kSources;
}

const DirectionalBench& bench() {
  static const DirectionalBench kBench =
      directional_bench(sources().thesis, sources().directional_bench);
  return kBench;
}

// Table 3.1 by hand at two pairs; J1 of the motor 1.81e-5 kg m2, J2 of the other one.
TEST(DirectionalBench, FeltInertiaIsThatOfItsEquations) {
  const double j = 1.81e-5;
  ASSERT_EQ(bench().felt.size(), 15U);
  const FeltGears& far = gears_of(bench().felt, 16, 120);
  EXPECT_NEAR(far.speeding_up_kgm2, j + 56.25 * j / (1.0 - 0.179), 1e-15);
  EXPECT_NEAR(far.slowing_down_kgm2, j + 56.25 * j * (1.0 - 0.013), 1e-15);
  const FeltGears& near = gears_of(bench().felt, 40, 80);
  EXPECT_NEAR(near.speeding_up_kgm2, j + 4.0 * j / (1.0 - 0.075), 1e-15);
  EXPECT_NEAR(near.slowing_down_kgm2, j + 4.0 * j * (1.0 - 0.078), 1e-15);
  // Held torque: moving with it eta_f tau, pushed back tau/eta_b, whatever tau.
  for (const HeldTorque& h : bench().held) {
    const FeltGears& g = gears_of(bench().felt, h.pinion, h.gear);
    EXPECT_NEAR(h.moving_with_Nm, g.forward * h.motor_Nm * h.gear / h.pinion, 1e-12);
    EXPECT_NEAR(h.pushed_back_Nm, h.motor_Nm * h.gear / h.pinion / g.backward, 1e-12);
    const double width = 1.0 / g.backward - g.forward, mean = 0.5 * (1.0 / g.backward + g.forward);
    EXPECT_NEAR(g.transparency, width / mean, 1e-11);
  }
}

TEST(DirectionalBench, SimulatedSlopesAndInertiasAreThoseOfTheLosses) {
  const SlopeLosses slopes = slope_losses(bench().load);
  EXPECT_NEAR(slopes.forward, 0.001, 1e-6);
  EXPECT_NEAR(slopes.backward, 0.167, 1e-6);
  const SpringSlopes spring =
      spring_slopes(bench().push, sources().directional_bench.push.control_stiffness_Nm_rad);
  // Damping and inertia of a motion that is slow, not quasi-static.
  EXPECT_NEAR(spring.pushed_in, 1.0 / 0.833, 1e-3);
  EXPECT_NEAR(spring.let_out, 0.999, 1e-3);
  for (const ComparedRow& row : bench().rows) {
    if (!row.equations || !row.quantity.starts_with("inertia")) continue;
    EXPECT_NEAR(*row.exact, *row.equations, 1e-9 * *row.equations) << row.quantity;
  }
}

struct Braking {
  std::vector<double> speed;
  double backward = 0.0, opposite = 0.0;  // shares of the time
};

/// Eqs. 2.6 and 2.7 at the motor's shaft by Heun's method, at steps of 10 us; whichever of the two
/// has a mesh torque of its own sign holds.
Braking by_equations(double loss1, double loss2) {
  const double j1 = 1.81e-5, n = 6.25, j2 = (1.81e-5 + 7.07e-4) / (n * n);
  const double d1 = 0.0369 * 0.234 / 639.838;
  int steps = 0, backward = 0, opposite = 0;
  Braking run;
  const auto slope = [&](double t, double w) {
    const double tau = 0.05 * std::cos(2.0 * std::numbers::pi * t);
    const double forward =
        ((1.0 - loss1) * tau - (1.0 - loss1) * d1 * w) / ((1.0 - loss1) * j1 + j2);
    const double driven = (tau - d1 * w) / (j1 + (1.0 - loss2) * j2);
    return std::pair(forward * w >= 0.0 ? forward : driven, forward * w >= 0.0);
  };
  const double h = 1e-5;
  double w = 0.0;
  for (int k = 0; k <= 300000; ++k) {
    const double t = k * h;
    if (k % 300 == 0) run.speed.push_back(w / n);
    const auto [a, forward] = slope(t, w);
    ++steps;
    if (!forward) ++backward;
    if (!forward && std::cos(2.0 * std::numbers::pi * t) * w > 0.0) ++opposite;
    w += 0.5 * h * (a + slope(t + h, w + h * a).first);
  }
  run.backward = static_cast<double>(backward) / steps;
  run.opposite = static_cast<double>(opposite) / steps;
  return run;
}

TEST(DirectionalBench, BrakingIsThatOfItsEquationsByHand) {
  const Braking directional = by_equations(0.001, 0.167), fixed = by_equations(0.084, 0.084);
  double difference = 0.0, speed = 0.0;
  for (std::size_t k = 0; k < directional.speed.size(); ++k) {
    difference += std::pow(directional.speed[k] - fixed.speed[k], 2);
    speed += std::pow(directional.speed[k], 2);
  }
  EXPECT_NEAR(bench().braking.speed_error, std::sqrt(difference / speed), 2e-4);
  EXPECT_NEAR(bench().braking.backward_share, directional.backward, 2e-3);
  EXPECT_NEAR(bench().braking.opposite_share, directional.opposite, 2e-3);
  const double last = bench().braking.directional.end.sides.output_rad_s;
  EXPECT_NEAR(std::abs(last), std::abs(directional.speed.back()), 1e-2);
}

TEST(DirectionalBench, AtTheEvenWidthBothPairsFeelAlike) {
  const double b = bench().even_width_m;
  const auto felt = [&](int pinion, int gear, double loss) {
    const auto disc = [&](int teeth) {
      const double r = 0.25e-3 * teeth, mass = 7830.0 * std::numbers::pi * r * r * b;
      return mass * r * r / 2.0;
    };
    return 25.0 * (1.81e-5 + disc(pinion)) / (1.0 - loss) + disc(gear);
  };
  EXPECT_NEAR(felt(16, 80, 0.163), felt(24, 120, 0.142), 1e-15);
  EXPECT_GT(b, 1e-3);
}

TEST(DirectionalBench, LedgerOfTheThesisGoesOnWithIt) {
  const Reproduction r = reproduce(sources());
  const auto& ledger = r.thesis.ledger;
  ASSERT_GT(ledger.size(), bench().ledger.size());
  for (std::size_t k = 0; k < ledger.size(); ++k) {
    EXPECT_EQ(ledger[k].number, static_cast<int>(k) + 1);
  }
  EXPECT_EQ(ledger.back().where, bench().ledger.back().where);
}

}  // namespace
}  // namespace gear3k::papers::directional_bench_test
