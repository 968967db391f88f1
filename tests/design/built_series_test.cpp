#include "design/built_series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/backlash/toleranced_train.hpp"

namespace gear3k::design::built_series_test {
namespace {

/// Teeth thin enough for room in every mesh.
Design thinned_design() {
  Design design;
  design.name = "thinned";
  design.train = backlash::thinned_bilateral_drive_gear();
  design.center_distance_given = true;
  design.sampling = {.samples = 4000, .seed = 11};
  return design;
}

BuiltSeries series_of(const Design& design, std::uint64_t share_samples = 2000) {
  return build_series(design, clearance_model_of(design).value(), share_samples, {});
}

class AlikePlanets : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Planets, AlikePlanets, testing::Values(1, 2, 3));

TEST_P(AlikePlanets, ShareTheTorqueEvenlyAndLeaveNoRoom) {
  Design design = thinned_design();
  design.train.planets = GetParam();
  design.tolerances.emplace();
  for (const int gear : {train::kS, train::kR1, train::kR2}) {
    design.tolerances->gears[static_cast<std::size_t>(gear)].tooth_thickness_m = {.lower = -10e-6,
                                                                                  .upper = 5e-6};
  }
  const BuiltSeries series = series_of(design);
  EXPECT_EQ(series.rooms.samples, 4000U);
  EXPECT_NEAR(series.rooms.greatest_share, 1.0 / GetParam(), 1e-12);
  ASSERT_EQ(series.rooms.median_m.size(), static_cast<std::size_t>(GetParam()));
  for (const double room : series.rooms.percent95_m) EXPECT_NEAR(room, 0.0, 1e-15);
}

TEST(BuiltSeries, OnePlanetCarriesAndTheOthersFollowByRank) {
  Design design = thinned_design();
  design.tolerances.emplace();
  design.tolerances->pin_position_m = 12e-6;
  const BuiltSeries series = series_of(design);
  const FirstContactRooms& rooms = series.rooms;
  ASSERT_EQ(rooms.median_m.size(), 3U);
  ASSERT_EQ(rooms.percent95_m.size(), 3U);
  EXPECT_GT(rooms.greatest_share, 0.5);
  EXPECT_NEAR(rooms.percent95_m[0], 0.0, 1e-15);
  EXPECT_TRUE(std::ranges::is_sorted(rooms.median_m));
  EXPECT_TRUE(std::ranges::is_sorted(rooms.percent95_m));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(rooms.median_m[k], rooms.percent95_m[k]);
  EXPECT_GT(rooms.median_m[1], 0.0);
}

TEST(BuiltSeries, RoomsAreAsLargeAsTheDeviationsThatMakeThem) {
  // With twice the deviations every room is twice as large, as long as every gearbox assembles.
  Design design = thinned_design();
  design.tolerances.emplace();
  design.tolerances->planet_phase_rad = {.lower = -1e-4, .upper = 1e-4};
  const FirstContactRooms once = series_of(design).rooms;
  design.tolerances->planet_phase_rad = {.lower = -2e-4, .upper = 2e-4};
  const FirstContactRooms twice = series_of(design).rooms;
  ASSERT_EQ(once.samples, 4000U);
  ASSERT_EQ(twice.samples, 4000U);
  for (std::size_t k = 1; k < 3; ++k) {
    EXPECT_NEAR(twice.median_m[k], 2.0 * once.median_m[k], 1e-6 * once.median_m[k]);
    EXPECT_NEAR(twice.percent95_m[k], 2.0 * once.percent95_m[k], 1e-6 * once.percent95_m[k]);
  }
}

TEST(BuiltSeries, IsOfTheDesignsOwnLimitScatterAndSampling) {
  Design design = thinned_design();
  design.tolerances.emplace();
  design.tolerances->gears[train::kR2].tooth_thickness_m = {.lower = -10e-6, .upper = 10e-6};
  design.tolerances->scatter = backlash::Scatter::kUniform;
  design.limits[CheckId::kOutputBacklashMax].reset();
  const BuiltSeries free = series_of(design);
  EXPECT_FALSE(free.limit_rad);
  EXPECT_EQ(free.result.yield.count, free.result.assembled.count);
  // Half of what it does without a limit: half of a symmetric distribution.
  design.limits[CheckId::kOutputBacklashMax] = free.result.worst.middle_rad;
  const BuiltSeries limited = series_of(design);
  EXPECT_EQ(limited.limit_rad, free.result.worst.middle_rad);
  EXPECT_EQ(limited.seed, 11U);
  EXPECT_EQ(limited.scatter.scatter, backlash::Scatter::kUniform);
  EXPECT_EQ(limited.result.samples, 4000U);
  EXPECT_NEAR(limited.result.yield.value, 0.5, 5.0 * 0.5 / std::sqrt(4000.0));
  EXPECT_EQ(limited.shares.samples, 2000U);
  EXPECT_EQ(limited.shares.sources.size(), limited.model.sources.size());
}

TEST(BuiltSeries, OfGearboxesThatAllJamHasNoRooms) {
  Design design = thinned_design();
  design.train.machining_allowance.fill(0.0);
  design.tolerances.emplace();
  design.tolerances->gears[train::kR2].tooth_thickness_m = {.lower = 200e-6, .upper = 210e-6};
  const BuiltSeries series = series_of(design);
  EXPECT_EQ(series.result.jammed.count, 4000U);
  EXPECT_EQ(series.rooms.samples, 0U);
  EXPECT_EQ(series.rooms.greatest_share, 0.0);
}

TEST(BuiltSeries, NeedsTolerances) {
  Design design = thinned_design();
  EXPECT_FALSE(clearance_model_of(design));
  EXPECT_FALSE(table_series(design));
}

TEST(TableSeries, TakesNoMoreGearboxesThanATableNeeds) {
  Design design = thinned_design();
  design.tolerances.emplace();
  design.tolerances->pin_position_m = 10e-6;
  design.sampling.samples = 1'000'000'000;
  const auto series = table_series(design);
  ASSERT_TRUE(series);
  EXPECT_EQ(series->result.samples, 200'000U);
  EXPECT_EQ(series->shares.samples, 20'000U);
  design.sampling.samples = 1500;
  const auto few = table_series(design);
  ASSERT_TRUE(few);
  EXPECT_EQ(few->result.samples, 1500U);
  EXPECT_EQ(few->shares.samples, 1500U);
}

}  // namespace
}  // namespace gear3k::design::built_series_test
