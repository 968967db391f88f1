#include "backlash/turn_orders.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/backlash/built_gearbox.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::backlash::turn_orders_test {
namespace {

constexpr double kPi = std::numbers::pi;

train::TrainParameters<double> gearbox(int planets) {
  train::TrainParameters<double> p{};
  p.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  p.planets = planets;
  p.pressure_angle_rad = kPi / 9.0;
  p.module_m = {0.8e-3, 0.8e-3 * 51.0 / 49.0};
  p.center_distance_m = 20.5e-3;
  for (double& q : p.machining_allowance) q = 0.1;
  return p;
}

struct Fitted {
  Turn turn;
  std::vector<OrderFit> fits{};
};
/// Eccentricity of one gear, and of none else, on planet 0 where it is a planet's.
Fitted eccentric(int gear, int planets, double e_m) {
  const auto p = gearbox(planets);
  Tolerances tolerances;
  tolerances.gears[static_cast<std::size_t>(gear)].runout_m = 2.0 * e_m;
  const auto model = clearance_model(p, tolerances);
  std::vector<DeviationValue> values(model->deviations.size());
  values[0] = {.x_m = 0.6 * e_m, .y_m = 0.8 * e_m};
  const auto window = turn_window(p.teeth);
  Fitted result{.turn = turn(model->levers, TurningPlays(*model, p.teeth, values), window)};
  result.fits = turn_orders(result.turn, turn_order_list(p.teeth, planets, window.revolutions));
  return result;
}

const OrderPart& strongest(const OrderFit& fit) {
  return *std::ranges::max_element(fit.parts, {}, &OrderPart::amplitude_rad);
}

TEST(TurnOrders, OneEccentricBodyLeavesItsOrderAgainstTheCarrierOnly) {
  constexpr double kE = 10e-6;
  struct Case {
    int gear;
    const char* body;
  };
  const auto t = *make_train_geometry(gearbox(1));
  const double ratio = std::abs(train::ratio(t.teeth));
  for (const Case& c : {Case{train::kS, "sun"}, Case{train::kP2, "planet"},
                        Case{train::kR1, "carrier"}, Case{train::kR2, "output"}}) {
    const auto [turn, fits] = eccentric(c.gear, 1, kE);
    ASSERT_EQ(fits.size(), 3U);
    const double g1 = 90.0 / 12.0;
    const double g2 = 32.0 * 90.0 / (39.0 * 81.0);
    const double lever = c.gear == train::kS ? ratio * t.gears[train::kS].base_radius_m
                         : c.gear == train::kR1
                             ? (1.0 + g1) / (g1 + g2) * t.gears[train::kR1].base_radius_m
                             : t.gears[train::kR2].base_radius_m;
    const std::size_t mesh = c.gear == train::kS ? 0 : c.gear == train::kR1 ? 1 : 2;
    const std::array<double, 3> expected{2.0 * kE * std::sin(t.meshes[mesh].alpha_w_rad) / lever,
                                         kE / lever, kE / lever};
    for (std::size_t q = 0; q < 3; ++q) {
      const OrderPart& part = strongest(fits[q]);
      EXPECT_EQ(part.order.of.body, c.body) << kTurnQuantityNames[q];
      EXPECT_EQ(part.order.multiple, 1);
      EXPECT_TRUE(part.order.of.rolling || c.gear == train::kR1);
      EXPECT_NEAR(part.amplitude_rad, expected[q], 1e-9 * expected[q]);
      EXPECT_NEAR(part.share, 1.0, 1e-9);
      EXPECT_NEAR(fits[q].rest, 0.0, 1e-12);
      for (const OrderPart& other : fits[q].parts) {
        if (&other == &part) continue;
        EXPECT_LT(other.amplitude_rad, 1e-9 * expected[q]) << other.order.order();
      }
    }
  }
}

TEST(TurnOrders, SunBetweenThreeAlikePlanetsLeavesItsOrderThreeTimesOver) {
  // What the tightest of three planets lets move repeats with each of them.
  const auto [turn, fits] = eccentric(train::kS, 3, 10e-6);
  ASSERT_EQ(fits.size(), 3U);
  for (const OrderFit& fit : fits) {
    const OrderPart& part = strongest(fit);
    EXPECT_EQ(part.order.of.body, "sun");
    EXPECT_TRUE(part.order.of.rolling);
    EXPECT_EQ(part.order.multiple, 3);
    EXPECT_GT(part.share, 0.8);
  }
}

TEST(TurnOrders, SinusoidsAreFoundWithAmplitudePhaseAndShare) {
  RandomSubject random(101);
  LargestDeviation largest;
  for (int i = 0; i < 10; ++i) {
    const auto z = random.teeth(i % 2 == 0);
    const auto window = turn_window(z);
    const auto list = turn_order_list(z, 3, window.revolutions);
    std::vector<double> amplitude, phase;
    amplitude.reserve(list.size());
    phase.reserve(list.size());
    for (std::size_t k = 0; k < list.size(); ++k) {
      amplitude.push_back(random.between(1e-6, 1e-4));
      phase.push_back(random.between(-kPi, kPi));
    }
    Turn turn{.window = window};
    for (std::size_t s = 0; s < window.samples; ++s) {
      const double angle = 2.0 * kPi * window.revolutions * static_cast<double>(s) /
                           static_cast<double>(window.samples);
      double value = 3e-3;
      for (std::size_t k = 0; k < list.size(); ++k) {
        value += amplitude[k] * std::cos(list[k].order() * angle - phase[k]);
      }
      turn.points.push_back({.angle_rad = angle, .range = {.lower_rad = 0.0, .upper_rad = value}});
    }
    const auto fits = turn_orders(turn, list);
    ASSERT_EQ(fits.size(), 3U);
    const OrderFit& fit = fits[static_cast<std::size_t>(TurnQuantity::kLostMotion)];
    EXPECT_NEAR(fit.mean_rad, 3e-3, 1e-10);
    EXPECT_NEAR(fit.rest, 0.0, 1e-12);
    double shares = fit.rest;
    for (std::size_t k = 0; k < list.size(); ++k) {
      const OrderPart& part = fit.parts[k];
      largest.see(i, part.amplitude_rad - amplitude[k], 1e-11);
      largest.see(i, std::remainder(part.phase_rad - phase[k], 2.0 * kPi) * amplitude[k], 1e-11);
      shares += part.share;
      EXPECT_NEAR(part.share, 0.5 * amplitude[k] * amplitude[k] / fit.variance_rad2, 0.1);
    }
    EXPECT_NEAR(shares, 1.0, 1e-9);
  }
  largest.expect_allowed("amplitude");
}

TEST(TurnOrders, WhatNoOrderExplainsIsTheRest) {
  // A step and a sinusoid of an order that is none of the bodies'.
  const train::ToothSet z{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  const auto window = turn_window(z);
  Turn turn{.window = window};
  for (std::size_t s = 0; s < window.samples; ++s) {
    const double angle = 2.0 * kPi * window.revolutions * static_cast<double>(s) /
                         static_cast<double>(window.samples);
    turn.points.push_back(
        {.angle_rad = angle, .range = {.lower_rad = 0.0, .upper_rad = std::cos(333.25 * angle)}});
  }
  const auto fits = turn_orders(turn, turn_order_list(z, 3, window.revolutions));
  ASSERT_EQ(fits.size(), 3U);
  EXPECT_GT(fits[0].rest, 0.99);
}

TEST(TurnOrders, JammedAnglesAreLeftOutAndTooFewGiveNone) {
  const train::ToothSet z{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  const auto window = turn_window(z);
  const auto list = turn_order_list(z, 3, window.revolutions);
  Turn turn{.window = window};
  const double order = list.front().order();
  for (std::size_t s = 0; s < window.samples; ++s) {
    const double angle = 2.0 * kPi * window.revolutions * static_cast<double>(s) /
                         static_cast<double>(window.samples);
    const bool jams = s % 3 == 0;
    turn.points.push_back({.angle_rad = angle,
                           .range = {.lower_rad = 0.0,
                                     .upper_rad = jams ? 77.0 : 1.0 + 0.5 * std::sin(order * angle),
                                     .margin_m = jams ? -1e-6 : 1e-6}});
    turn.jammed += jams ? 1U : 0U;
  }
  const auto fits = turn_orders(turn, list);
  ASSERT_EQ(fits.size(), 3U);
  EXPECT_NEAR(fits[0].parts.front().amplitude_rad, 0.5, 1e-10);
  EXPECT_NEAR(fits[0].rest, 0.0, 1e-12);
  turn.points.resize(60);
  turn.jammed = 20;
  EXPECT_TRUE(turn_orders(turn, list).empty());
}

TEST(TurnOrderList, StartsWithTheOrdersOfShaftsAndKeepsTellableOnesOnly) {
  RandomSubject random(102);
  for (int i = 0; i < 100; ++i) {
    const auto z = random.teeth(i % 2 == 0);
    const auto window = turn_window(z);
    const auto list = turn_order_list(z, 4, window.revolutions);
    ASSERT_FALSE(list.empty());
    EXPECT_EQ(list.front().order(), train::shaft_orders(z).front().order);
    for (std::size_t a = 0; a < list.size(); ++a) {
      EXPECT_GE(list[a].order() * window.revolutions, 1.0 - 1e-9);
      for (std::size_t b = 0; b < a; ++b) {
        EXPECT_GE(std::abs(list[a].order() - list[b].order()) * window.revolutions, 1.0 - 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace gear3k::backlash::turn_orders_test
