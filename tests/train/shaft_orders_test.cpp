#include "train/shaft_orders.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <vector>

namespace gear3k::train::shaft_orders_test {
namespace {

/// Orders of a body, in the order of the list: relative to the carrier, absolute.
std::vector<double> orders_of(const std::vector<ShaftOrder>& list, const std::string& body) {
  std::vector<double> result;
  result.reserve(list.size());
  for (const ShaftOrder& order : list) {
    if (order.body == body) result.push_back(order.order);
  }
  return result;
}

TEST(ShaftOrders, OfTheLowBacklashGearAreThePrintedOnes) {
  const auto list = shaft_orders({.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92});
  constexpr double kHalfDigit = 0.05;
  const auto sun = orders_of(list, "sun");
  ASSERT_EQ(sun.size(), 2U);
  EXPECT_NEAR(sun[0], 83.5, kHalfDigit);
  EXPECT_NEAR(sun[1], 95.9, kHalfDigit);
  const auto planet = orders_of(list, "planet");
  ASSERT_EQ(planet.size(), 2U);
  EXPECT_NEAR(planet[0], 29.2, kHalfDigit);
  EXPECT_NEAR(planet[1], 16.8, kHalfDigit);
  const auto carrier = orders_of(list, "carrier");
  ASSERT_EQ(carrier.size(), 1U);
  EXPECT_NEAR(carrier[0], 12.4, kHalfDigit);
}

/// Whole revolutions after which every tooth is back in its place, and teeth that meshed until
/// then: with the carrier held P1 turns by S R1 R2 revolutions, then all turns back with R1.
struct Revolutions {
  long long sun, planet, carrier, output;                 // absolute
  long long sun_rolling, planet_rolling, output_rolling;  // relative to the carrier
  long long teeth_s_p1, teeth_p1_r1, teeth_p2_r2;         // that passed each mesh
};
Revolutions roll(const ToothSet& z) {
  const long long turns = 1LL * z.S * z.R1 * z.R2;
  Revolutions r{};
  r.planet_rolling = turns;
  r.teeth_s_p1 = turns * z.P1;
  r.teeth_p1_r1 = turns * z.P1;
  r.teeth_p2_r2 = turns * z.P2;
  r.sun_rolling = -r.teeth_s_p1 / z.S;  // an external mesh reverses
  const long long ring = r.teeth_p1_r1 / z.R1;
  r.output_rolling = r.teeth_p2_r2 / z.R2;
  r.carrier = -ring;  // brings R1 to rest
  r.sun = r.sun_rolling + r.carrier;
  r.planet = r.planet_rolling + r.carrier;
  r.output = r.output_rolling + r.carrier;
  return r;
}

TEST(ShaftOrders, AreCountedRevolutions) {
  // The last two: the output turns against the input; a low ratio.
  for (const ToothSet& z : {ToothSet{.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92},
                            ToothSet{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81},
                            ToothSet{.S = 18, .P1 = 30, .R1 = 78, .P2 = 36, .R2 = 84},
                            ToothSet{.S = 20, .P1 = 20, .R1 = 60, .P2 = 35, .R2 = 75}}) {
    const Revolutions r = roll(z);
    const auto per_output = [&](long long n) {
      return std::abs(static_cast<double>(n) / static_cast<double>(r.output));
    };
    constexpr double kRounding = 1e-12;
    const auto expect = [&](const auto& list, const char* body, std::vector<long long> counts) {
      const auto orders = orders_of(list, body);
      ASSERT_EQ(orders.size(), counts.size()) << body;
      for (std::size_t k = 0; k < counts.size(); ++k) {
        EXPECT_NEAR(orders[k], per_output(counts[k]), kRounding * per_output(counts[k]) + 1e-13)
            << body;
      }
    };
    const auto shafts = shaft_orders(z);
    expect(shafts, "sun", {r.sun_rolling, r.sun});
    expect(shafts, "planet", {r.planet_rolling, r.planet});
    expect(shafts, "carrier", {r.carrier});
    expect(shafts, "output", {r.output_rolling, r.output});
    const auto meshes = mesh_orders(z);
    expect(meshes, "stage 1", {r.teeth_p1_r1});
    expect(meshes, "stage 2", {r.teeth_p2_r2});
    EXPECT_EQ(r.teeth_s_p1, r.teeth_p1_r1);  // one order for both meshes of stage 1
  }
}

TEST(ShaftOrders, StandOnce) {
  const ToothSet z{.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92};
  const auto list = shaft_orders(z);
  std::set<long long> seen;
  for (const ShaftOrder& order : list) seen.insert(std::llround(order.order * 1e6));
  EXPECT_EQ(seen.size(), list.size());
}

}  // namespace
}  // namespace gear3k::train::shaft_orders_test
