#include "train/thermal_growth.hpp"

#include <gtest/gtest.h>

#include "tests/random_train.hpp"

namespace gear3k::train::thermal_growth_test {
namespace {

TEST(GrowthFactor, AddsTheStrainsOfTemperatureAndMoisture) {
  const Growth part{.expansion_1_K = 1.2e-4, .swelling = {.dry = -0.001, .wet = 0.003}};
  EXPECT_EQ(growth_factor(part, 293.15, {.temperature_K = 293.15}), 1.0);
  // 40 K at 120e-6: 4.8 mm on a metre; with moisture 3 mm more or 1 mm less.
  EXPECT_NEAR(growth_factor(part, 293.15, {.temperature_K = 333.15}), 1.0048, 1e-15);
  EXPECT_NEAR(growth_factor(part, 293.15, {333.15, Moisture::kWet}), 1.0078, 1e-15);
  EXPECT_NEAR(growth_factor(part, 293.15, {253.15, Moisture::kDry}), 0.9942, 1e-15);
}

TEST(ThermalRange, HasFourEndsWhereAnythingSwellsAndTwoElse) {
  ThermalRange range{.least_K = 250.0, .greatest_K = 350.0};
  ASSERT_EQ(end_count(range), 2);
  EXPECT_EQ(end_state(range, 0).temperature_K, 250.0);
  EXPECT_EQ(end_state(range, 1).temperature_K, 350.0);
  EXPECT_EQ(end_state(range, 1).moisture, Moisture::kDrawn);
  range.carrier.swelling.wet = 1e-3;
  ASSERT_EQ(end_count(range), 4);
  for (int end = 0; end < 4; ++end) {
    EXPECT_EQ(end_state(range, end).temperature_K, end < 2 ? 250.0 : 350.0);
    EXPECT_EQ(end_state(range, end).moisture, end % 2 == 0 ? Moisture::kDry : Moisture::kWet);
  }
}

TEST(GrownGear, IsTheGearOfTheGrownModule) {
  RandomTrain random(1);
  for (int i = 0; i < 100; ++i) {
    const auto train = random.train(true);
    const double factor = random.between(0.99, 1.02);
    for (const auto& gear : train.gears) {
      geometry::Gear<double> larger = gear.gear;
      larger.module_m *= factor;
      const auto expected = geometry::make_gear_geometry(larger, gear.angle);
      const auto grown = grown_gear(gear, factor);
      EXPECT_DOUBLE_EQ(grown.gear.module_m, larger.module_m);
      EXPECT_DOUBLE_EQ(grown.base_radius_m, expected.base_radius_m);
      EXPECT_DOUBLE_EQ(grown.tip_radius_m, expected.tip_radius_m);
      EXPECT_DOUBLE_EQ(grown.root_radius_m, expected.root_radius_m);
    }
  }
}

}  // namespace
}  // namespace gear3k::train::thermal_growth_test
