#include "strength/root_stress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::strength::root_stress_test {
namespace {

TEST(LoadPoint, IsWhereTheFlanksNormalCrossesTheToothsAxis) {
  // The flank's point in the tooth's frame (axis along x) and the normal by differences.
  LargestDeviation angle, height;
  RandomTrain random(61);
  for (int i = 0; i < 200; ++i) {
    const auto train = random.train(i % 2 == 0);
    for (const auto& g : train.gears) {
      if (g.tip_radius_m <= g.base_radius_m) continue;
      const double middle = 0.5 * (g.tip_radius_m + std::max(g.base_radius_m, g.root_radius_m));
      const auto at = [&](double r) {
        const double half = geometry::tooth_thickness(g, r) / (2.0 * r);
        return std::pair{r * std::cos(half), r * std::sin(half)};
      };
      const double step = 1e-5 * middle;
      const auto [x, y] = at(middle);
      const auto [x1, y1] = at(middle - step);
      const auto [x2, y2] = at(middle + step);
      // The normal is across the flank; it meets the axis y = 0.
      const double crossing = x + y * (y2 - y1) / (x2 - x1);
      const double with_axis = std::atan2(-(x2 - x1), y2 - y1);
      const double length = std::sqrt(middle * middle - g.base_radius_m * g.base_radius_m);
      const auto load = load_point(g, length);
      height.see(i, load.axis_height_m - crossing, 1e-8 * middle);
      angle.see(i, std::abs(std::tan(load.angle_rad) * std::tan(with_axis)) - 1.0, 1e-6);
    }
  }
  angle.expect_allowed("angle");
  height.expect_allowed("height");
}

TEST(RootForm, ScaledLengthsAndForcesLeaveTheStress) {
  RandomTrain random(62);
  const auto train = random.train(false);
  for (const std::size_t k : {0u, 1u, 2u}) {
    auto gear = train.gears[k].gear;
    const double s = 2.9;
    gear.module_m *= s;
    const auto big = geometry::make_gear_geometry(gear, train.gears[k].angle);
    const auto rate = [](const geometry::GearGeometry<double>& g, double pitch, double force,
                         double width) {
      const auto form = root_form(g, root_section(g, geometry::make_tooth_form(g)),
                                  load_point(g, outer_single_contact(g, pitch, 1.4)));
      return root_stress(g, form, 1.0, {.tangential_N = force, .face_width_m = width}, {})
          .stress_Pa;
    };
    const double pitch = train.meshes[0].base_pitch_m;
    EXPECT_NEAR(
        rate(big, s * pitch, 50.0 * s * s, 7e-3 * s) / rate(train.gears[k], pitch, 50.0, 7e-3), 1.0,
        1e-12)
        << k;
  }
}

TEST(OuterSingleContact, MovesFromTheTipToTheEndOfTheLastPitch) {
  RandomTrain random(63);
  const auto train = random.train(true);
  const double pitch = train.meshes[0].base_pitch_m;
  const auto& sun = train.gears[0];
  const auto& ring = train.gears[2];
  const double sun_tip = geometry::tip_curvature_radius(sun);
  const double ring_tip = geometry::tip_curvature_radius(ring);
  EXPECT_EQ(outer_single_contact(sun, pitch, 0.9), sun_tip);
  EXPECT_DOUBLE_EQ(outer_single_contact(sun, pitch, 1.4), sun_tip - 0.4 * pitch);
  EXPECT_DOUBLE_EQ(outer_single_contact(ring, pitch, 1.4), ring_tip + 0.4 * pitch);
  EXPECT_DOUBLE_EQ(outer_single_contact(sun, pitch, 2.6), sun_tip - pitch);
}

TEST(RootStress, IsProportionalToForceAndEveryFactor) {
  RandomTrain random(64);
  const auto g = random.train(true).gears[0];
  const auto form = root_form(g, root_section(g, geometry::make_tooth_form(g)),
                              load_point(g, geometry::tip_curvature_radius(g)));
  const ToothLoad<double> load{.tangential_N = 100.0, .face_width_m = 8e-3};
  const auto plain = root_stress(g, form, 1.0, load, {});
  const auto raised = root_stress(
      g, form, 1.1, load,
      {.application = 1.25, .mesh_load = 1.2, .dynamic = 1.05, .face = 1.15, .transverse = 1.02});
  EXPECT_DOUBLE_EQ(raised.nominal_Pa, 1.1 * plain.nominal_Pa);
  EXPECT_NEAR(raised.stress_Pa / plain.nominal_Pa, 1.1 * 1.25 * 1.2 * 1.05 * 1.15 * 1.02, 1e-14);
  EXPECT_DOUBLE_EQ(plain.nominal_Pa, 100.0 / (8e-3 * g.gear.module_m) * form.form_factor *
                                         form.stress_correction_factor);
  EXPECT_THROW(root_stress(g, form, 1.0, {.tangential_N = 1.0, .face_width_m = 0.0}, {}),
               std::invalid_argument);
  EXPECT_THROW(root_stress(g, form, 1.0, {.tangential_N = -1.0, .face_width_m = 1.0}, {}),
               std::invalid_argument);
}

TEST(RimFactor, HasItsBranches) {
  RandomTrain random(65);
  const auto train = random.train(true);
  const auto& sun = train.gears[0];
  const auto& ring = train.gears[2];
  const double h = sun.tip_radius_m - sun.root_radius_m;
  const double m = ring.gear.module_m;
  EXPECT_EQ(rim_factor<double>(sun, std::nullopt).value, 1.0);
  EXPECT_EQ(rim_factor<double>(sun, 1.3 * h).value, 1.0);
  EXPECT_NEAR(rim_factor<double>(sun, 0.8 * h).value, 1.6 * std::log(2.242 / 0.8), 1e-14);
  EXPECT_TRUE(rim_factor<double>(sun, 0.8 * h).in_range);
  EXPECT_FALSE(rim_factor<double>(sun, 0.4 * h).in_range);
  EXPECT_EQ(rim_factor<double>(ring, 3.6 * m).branch, "thick rim");
  EXPECT_NEAR(rim_factor<double>(ring, 2.5 * m).value, 1.15 * std::log(8.324 / 2.5), 1e-14);
  EXPECT_FALSE(rim_factor<double>(ring, 1.5 * m).in_range);
  for (const double ratio : {3.488, 3.49, 3.495, 3.4999, 3.5}) {
    const auto near_end = rim_factor<double>(ring, ratio * m);
    EXPECT_EQ(near_end.value, ratio < 3.489 ? 1.15 * std::log(8.324 / ratio) : 1.0) << ratio;
    EXPECT_GE(near_end.value, 1.0) << ratio;
  }
  EXPECT_GE(rim_factor<double>(sun, 1.19999 * h).value, 1.0);
  EXPECT_THROW(rim_factor<double>(sun, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::root_stress_test
