// Built gearboxes at the ends of a range of temperature: against series of drawings that are scaled
// by hand, each with its own clearance model.

#include "design/thermal_series.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"

namespace gear3k::design::thermal_series_test {
namespace {

constexpr std::int64_t kSamples = 20'000;

Design toleranced_design() {
  Design design = io::read_design(std::string(GEAR3K_SOURCE_DIR) +
                                  "/examples/designs/ratio_96_tolerances.toml");
  design.train = resolved_parameters(design);
  design.center_distance_given = true;
  design.limits[CheckId::kOutputBacklashMax] = std::nullopt;
  design.sampling.samples = kSamples;
  return design;
}

/// Two stages of different plastics, each growing alike, in a carrier of metal.
constexpr double kFirst = 9e-5, kSecond = 4e-5, kCarrier = 2.3e-5, kDegrees = 40.0;
train::ThermalRange range_of(double degrees) {
  const train::Growth first{.expansion_1_K = kFirst};
  const train::Growth second{.expansion_1_K = kSecond};
  return {.least_K = 293.15 - degrees,
          .greatest_K = 293.15 + degrees,
          .gear = {first, first, first, second, second},
          .carrier = {.expansion_1_K = kCarrier}};
}

Design scaled(Design design, double degrees) {
  design.thermal.reset();
  design.train.module_m[0] *= 1.0 + kFirst * degrees;
  design.train.module_m[1] *= 1.0 + kSecond * degrees;
  design.train.center_distance_m *= 1.0 + kCarrier * degrees;
  return design;
}

TEST(ThermalSeries, IsThatOfADrawingScaledByHand) {
  Design design = toleranced_design();
  const auto model = clearance_model_of(design);
  ASSERT_TRUE(model);
  design.thermal = range_of(kDegrees);
  const BuiltSeries series = build_series(design, *model, kSamples, {});
  ASSERT_EQ(series.thermal.size(), 2U);
  for (const bool hot : {false, true}) {
    const double degrees = hot ? kDegrees : -kDegrees;
    const Design by_hand = scaled(design, degrees);
    const auto own = clearance_model_of(by_hand);
    ASSERT_TRUE(own);
    const ThermalSeries& end = series.thermal[hot ? 1 : 0];
    EXPECT_NEAR(end.state.temperature_K, 293.15 + degrees, 1e-12);
    const auto moved = thermal_clearance(design, *model, end.state, false);
    ASSERT_TRUE(moved);
    double largest_change = 0.0;
    for (std::size_t k = 0; k < own->middle_m.size(); ++k) {
      // The middle of the tolerances is that of the drawing here, but for second order.
      EXPECT_NEAR(moved->middle_m[k] * 1e6, own->middle_m[k] * 1e6, 0.05) << k;
      largest_change = std::max(largest_change, std::abs(own->middle_m[k] - model->middle_m[k]));
    }
    EXPECT_GT(largest_change, 10e-6);
    const BuiltSeries expected = build_series(by_hand, *own, 1000, {});
    EXPECT_NEAR(end.result.assembled.value, expected.result.assembled.value, 0.02);
    EXPECT_NEAR(end.result.lost_motion.mean_rad, expected.result.lost_motion.mean_rad,
                0.02 * expected.result.lost_motion.mean_rad);
    EXPECT_NEAR(end.result.lost_motion.deviation_rad, expected.result.lost_motion.deviation_rad,
                0.03 * expected.result.lost_motion.deviation_rad);
    // Gears of a mesh that grow alike have one base pitch: the least play is the mean one.
    EXPECT_EQ(end.jammed.count, end.result.jammed.count);
  }
  EXPECT_GT(std::abs(series.thermal[1].result.lost_motion.mean_rad -
                     series.thermal[0].result.lost_motion.mean_rad),
            0.05 * series.result.lost_motion.mean_rad);
}

TEST(ThermalSeries, JamsWhereThePlayOfTheDrawingIsGone) {
  Design design = toleranced_design();
  // Tolerances that say nothing: every gearbox is the drawn one.
  design.tolerances = backlash::Tolerances{};
  design.tolerances->center_distance_m = {.lower = -1e-10, .upper = 1e-10};
  const auto model = clearance_model_of(design);
  ASSERT_TRUE(model);
  const train::Growth plastic{.expansion_1_K = 1.2e-4}, steel{.expansion_1_K = 1.1e-5};
  design.thermal = train::ThermalRange{.least_K = 263.15,
                                       .greatest_K = 353.15,
                                       .gear = {steel, plastic, steel, plastic, steel},
                                       .carrier = steel};
  design.sampling.samples = 500;
  const BuiltSeries series = build_series(design, *model, 500, {});
  ASSERT_EQ(series.thermal.size(), 2U);
  const auto drawn = std::get<Evaluation>(evaluate(design));
  ASSERT_TRUE(drawn.thermal);
  for (std::size_t end = 0; end < 2; ++end) {
    const ThermalStateResult& state = drawn.thermal->states[end + 1];
    double least = 1.0, mean = 1.0;
    for (const ThermalMesh& mesh : state.meshes) {
      least = std::min(least, mesh.least_backlash_m);
      mean = std::min(mean, mesh.normal_backlash_m);
    }
    EXPECT_EQ(series.thermal[end].jammed.value, least > 0.0 ? 0.0 : 1.0) << end;
    EXPECT_EQ(series.thermal[end].result.jammed.value, mean > 0.0 ? 0.0 : 1.0) << end;
    if (mean > 0.0) {
      // Levers are those of the drawing.
      EXPECT_NEAR(series.thermal[end].result.lost_motion.mean_rad, state.lost_motion_rad,
                  5e-3 * state.lost_motion_rad);
    }
  }
  EXPECT_EQ(series.thermal[0].jammed.value, 0.0);
  EXPECT_EQ(series.thermal[1].jammed.value, 1.0);
}

}  // namespace
}  // namespace gear3k::design::thermal_series_test
