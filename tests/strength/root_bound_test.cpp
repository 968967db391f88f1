// The table of rack-cut sections against the rated section, and that no tooth inside a range asks
// for less than the range does.

#include "strength/root_bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "strength/root_section.hpp"
#include "strength/root_strength.hpp"
#include "strength/root_stress.hpp"
#include "tests/random_numbers.hpp"

namespace gear3k::strength::root_bound_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// A gear whose table is made, and its greatest shift.
struct Case {
  geometry::GearGeometry<double> gear;
  double greatest_shift = 0.0;
};
Case random_case(RandomNumbers& random) {
  const int teeth = random.count(9, 60);
  const double alpha = random.between(18.0, 25.0) * kPi / 180.0;
  const double sine = std::sin(alpha);
  const double root_radius = random.between(0.1, 0.38);
  // Above undercut, as a search's shifts are.
  const double least =
      std::max(-0.5, 1.25 - root_radius * (1.0 - sine) - 0.5 * teeth * sine * sine);
  const double first = least + random.between(0.0, 0.8);
  return {.gear = geometry::make_gear_geometry<double>(
              {.teeth = teeth,
               .module_m = random.between(0.4e-3, 3e-3),
               .profile_shift = first,
               .machining_allowance = random.between(0.0, 0.05),
               .rack = {.root_radius = root_radius}},
              geometry::make_pressure_angle(alpha)),
          .greatest_shift = first + random.between(0.1, 1.2)};
}

geometry::GearGeometry<double> at_shift(const Case& c, double shift) {
  geometry::Gear<double> gear = c.gear.gear;
  gear.profile_shift = shift;
  return geometry::make_gear_geometry(gear, c.gear.angle);
}

TEST(RootTable, HasTheRatedSectionsAtItsKnotsAndTheyAreMonotone) {
  RandomNumbers random(11);
  int knots = 0, beyond = 0;
  for (int n = 0; n < 40; ++n) {
    const Case c = random_case(random);
    const RootTable table = make_root_table(c.gear, c.greatest_shift);
    ASSERT_FALSE(table.knots.empty()) << n;
    const double m = c.gear.gear.module_m;
    for (std::size_t k = 0; k < table.knots.size(); ++k) {
      const auto gear = at_shift(c, table.least_shift + static_cast<double>(k) * table.step);
      const auto section = root_section(gear, geometry::make_tooth_form(gear));
      EXPECT_TRUE(section.on_fillet);
      EXPECT_NEAR(table.knots[k].chord, section.chord_m / m, 1e-10);
      EXPECT_NEAR(table.knots[k].height, section.height_m / m, 1e-10);
      EXPECT_NEAR(table.knots[k].curvature_radius, section.fillet_radius_m / m, 1e-10);
      if (k == 0) continue;
      EXPECT_GT(table.knots[k].chord, table.knots[k - 1].chord);
      EXPECT_GT(table.knots[k].height, table.knots[k - 1].height);
      const bool falls = table.least_center + static_cast<double>(k) * table.step <= 0.0;
      if (falls) {
        EXPECT_LT(table.knots[k].curvature_radius, table.knots[k - 1].curvature_radius);
      }
      beyond += falls ? 0 : 1;
      ++knots;
    }
  }
  EXPECT_GT(knots, 2000);
  EXPECT_GT(beyond, 100);
}

TEST(RootTable, IsEmptyWhereTheFlankReachesBeyondTheSection) {
  const auto undercut = geometry::make_gear_geometry<double>(
      {.teeth = 8, .module_m = 1e-3, .profile_shift = -0.8, .rack = {.root_radius = 0.1}},
      geometry::make_pressure_angle(kPi / 9.0));
  const auto form = geometry::make_tooth_form(undercut);
  ASSERT_TRUE(form.undercut);
  if (form.form_normal_angle_rad >= kExternalTangentAngle_rad) {
    EXPECT_TRUE(make_root_table(undercut, 0.5).knots.empty());
  } else {
    EXPECT_TRUE(root_section(undercut, form).on_fillet);
  }
}

/// Y_F Y_S/Y_δ of a tooth loaded at a contact ratio, by the functions that rate it.
double rated_factor(const geometry::GearGeometry<double>& gear, double contact_ratio,
                    const RootNeed& need) {
  const auto form = geometry::make_tooth_form(gear);
  const double pitch_m = 2.0 * kPi * gear.base_radius_m / gear.gear.teeth;
  const double length_m = need.plastic ? geometry::tip_curvature_radius(gear)
                                       : outer_single_contact(gear, pitch_m, contact_ratio);
  const auto rated = root_form(gear, root_section(gear, form), load_point(gear, length_m));
  const double rho = need.slip_layer_mm;
  const double support = (1.0 + std::sqrt(0.2 * rho * (1.0 + 2.0 * rated.notch_parameter))) /
                         (1.0 + std::sqrt(1.2 * rho));
  return rated.form_factor * rated.stress_correction_factor / support *
         (need.plastic ? 0.25 + 0.75 / std::max(1.0, contact_ratio) : 1.0);
}

TEST(LeastRootModule, IsBelowThatOfEveryToothInItsRange) {
  RandomNumbers random(12);
  int teeth = 0;
  double closest = 0.0;
  for (int n = 0; n < 60; ++n) {
    const Case c = random_case(random);
    const RootTable table = make_root_table(c.gear, c.greatest_shift);
    const double end = table.least_shift + static_cast<double>(table.knots.size() - 1) * table.step;
    for (int trial = 0; trial < 60; ++trial) {
      const RootNeed need{.load_m2 = 1.0,
                          .slip_layer_mm = random.between(0.0, 1.0) < 0.3 ? 0.0281 : 0.0,
                          .plastic = random.between(0.0, 1.0) < 0.3};
      const double width = std::pow(10.0, random.between(-6.0, -0.3));
      const double from = random.between(table.least_shift, end);
      const double to = std::min(end, from + width);
      const double ratio_from = random.between(0.8, 2.4);
      const double ratio_to = ratio_from + width;
      const double m = c.gear.gear.module_m;
      // A mate that lets the ratio, the tip and the point of contact be what they are.
      const auto tip = [&](double x) { return geometry::tip_curvature_radius(at_shift(c, x)) / m; };
      const double pitch = kPi * c.gear.angle.cos;
      const double least =
          least_root_module2(table, need,
                             {.least_shift = from,
                              .greatest_shift = to,
                              .least_tip = tip(from),
                              .greatest_tip = tip(to),
                              .least_by_mate = tip(from) - (ratio_to - 1.0) * pitch,
                              .greatest_by_mate = tip(to) - (ratio_from - 1.0) * pitch,
                              .least_contact_ratio = ratio_from,
                              .greatest_contact_ratio = ratio_to});
      for (const double share : {0.0, 0.3, 0.7, 1.0}) {
        for (const double ratio_share : {0.0, 0.6, 1.0}) {
          const auto gear = at_shift(c, from + share * (to - from));
          const double factor =
              rated_factor(gear, ratio_from + ratio_share * (ratio_to - ratio_from), need);
          EXPECT_LE(least, factor * (1.0 + 1e-12)) << n << " " << trial;
          closest = std::max(closest, least / factor);
          ++teeth;
        }
      }
    }
  }
  EXPECT_GT(teeth, 40000);
  EXPECT_GT(closest, 0.97) << "narrow ranges hardly bound their teeth";
}

TEST(LeastRootModule, IsNothingBeyondTheTable) {
  RandomNumbers random(13);
  const Case c = random_case(random);
  const RootTable table = make_root_table(c.gear, c.greatest_shift);
  const RootRange inside{.least_shift = table.least_shift,
                         .greatest_shift = table.least_shift + table.step,
                         .least_tip = 5.0,
                         .greatest_tip = 5.1,
                         .least_by_mate = 4.0,
                         .greatest_by_mate = 4.1,
                         .least_contact_ratio = 1.2,
                         .greatest_contact_ratio = 1.5};
  RootRange outside = inside;
  outside.least_shift -= 0.1;
  EXPECT_EQ(least_root_module2(table, {.load_m2 = 1.0}, outside), 0.0);
  EXPECT_EQ(least_root_module2(table, {}, inside), 0.0);
  EXPECT_EQ(least_root_module2({}, {.load_m2 = 1.0}, inside), 0.0);
}

}  // namespace
}  // namespace gear3k::strength::root_bound_test
