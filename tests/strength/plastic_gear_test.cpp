#include "strength/plastic_gear.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/random_train.hpp"

namespace gear3k::strength::plastic_gear_test {
namespace {

ToothHeat<double> heat() {
  return {.ambient_K = 293.15,
          .loss_W = 10.19,
          .face_width_m = 14e-3,
          .pinion_teeth = 16,
          .speed_m_s = 1.92,
          .module_m = 4.5e-3};
}

TEST(ToothTemperature, IsThatOfAPrintedReportToItsDegrees) {
  // cfernandesFEUP/GEARpie REPORT/C14.txt (2d87d6b): 10.19 W at 1.92 m/s in 20 C, open, 77 C at the
  // flank and 28 C at the root, with the coefficients of a steel mate.
  const HeatTransfer k = heat_transfer(PlasticMate::kSteel);
  EXPECT_NEAR(tooth_temperature(heat(), k.flank) - 273.15, 77.0, 0.5);
  EXPECT_NEAR(tooth_temperature(heat(), k.root) - 273.15, 28.0, 0.5);
}

TEST(ToothTemperature, AtRestIsTheHousings) {
  auto h = heat();
  h.speed_m_s = 0.0;
  h.housing_resistance = 0.06;
  h.housing_surface_m2 = 0.03;
  EXPECT_NEAR(tooth_temperature(h, 9000.0), 293.15 + 10.19 * 2.0, 1e-9);
  h.duty = 0.5;
  EXPECT_NEAR(tooth_temperature(h, 0.0), 293.15 + 10.19 * 2.0 * std::pow(0.5, 0.64), 1e-9);
  h.loss_W = -1.0;
  EXPECT_THROW(tooth_temperature(h, 0.0), std::invalid_argument);
  h = heat();
  h.face_width_m = 0.0;
  EXPECT_THROW(tooth_temperature(h, 0.0), std::invalid_argument);
}

TEST(PlasticRootStress, IsTheLewisStressWithItsNotchAndContactRatio) {
  RandomTrain random(71);
  const auto g = random.train(true).gears[1];
  const auto section = root_section(g, geometry::make_tooth_form(g));
  const ToothLoad<double> load{.tangential_N = 40.0, .face_width_m = 8e-3};
  const auto stress = plastic_root_stress(g, section, 1.5, load, 1.25);
  // Lewis' beam, loaded at the tip.
  const auto form = root_form(g, section, load_point(g, geometry::tip_curvature_radius(g)));
  const double lewis_Pa = 40.0 / (8e-3 * g.gear.module_m) * form.form_factor;
  EXPECT_NEAR(stress.stress_Pa, 1.25 * lewis_Pa * form.stress_correction_factor * 0.75,
              1e-9 * stress.stress_Pa);
  // No pair shares the load below a contact ratio of 1.
  for (const double epsilon : {1.0, 0.3, -0.4}) {
    EXPECT_EQ(plastic_root_stress(g, section, epsilon, load, 1.0).contact_ratio_factor, 1.0);
  }
  EXPECT_DOUBLE_EQ(plastic_root_safety(30e6, 20e6), 3.0);
  EXPECT_DOUBLE_EQ(plastic_flank_safety(30e6, 20e6), 1.5);
  EXPECT_DOUBLE_EQ(plastic_peak_safety(70e6, 70e6), 2.0);
}

TEST(ActiveFlank, IsAsLongAsItsInvolute) {
  // Length of an involute between two of its radii of curvature, summed along the curve.
  RandomTrain random(72);
  const auto g = random.train(true).gears[1];
  const double tip = geometry::tip_curvature_radius(g), root = 0.4 * tip;
  double length = 0.0;
  const int pieces = 20000;
  const auto at = [&](int i) {
    const double roll = (root + (tip - root) * i / pieces) / g.base_radius_m;
    return std::pair{g.base_radius_m * (std::cos(roll) + roll * std::sin(roll)),
                     g.base_radius_m * (std::sin(roll) - roll * std::cos(roll))};
  };
  for (int i = 0; i < pieces; ++i) {
    const auto [x1, y1] = at(i);
    const auto [x2, y2] = at(i + 1);
    length += std::hypot(x2 - x1, y2 - y1);
  }
  EXPECT_NEAR(active_flank_length(g, root) / length, 1.0, 1e-8);
}

TEST(LinearWear, IsTheFrictionWorkTimesTheWearCoefficientOverTheFlanks) {
  const double power_work_j = 2.0 * 3.14159265358979 * 8.0 * 1e6;  // T 2π N
  const double wear = linear_wear<double>({.torque_Nm = 8.0,
                                           .revolutions = 1e6,
                                           .loss_factor = 0.06,
                                           .wear_coefficient_m2_N = 1e-15,
                                           .face_width_m = 15e-3,
                                           .teeth = 52,
                                           .flank_length_m = 1.3e-3});
  EXPECT_NEAR(wear, power_work_j * 0.06 * 1e-15 / (15e-3 * 52 * 1.3e-3), 1e-12 * wear);
  EXPECT_THROW(linear_wear<double>({}), std::invalid_argument);
}

TEST(ToothDeformation, IsThatOfTheSofterGear) {
  EXPECT_NEAR(tooth_deformation<double>({.tangential_N = 300.0, .face_width_m = 10e-3}, 2e9, 2e9),
              7.5 * 300.0 / 10e-3 * 1e-9, 1e-18);
  EXPECT_THROW(tooth_deformation<double>({.tangential_N = 300.0, .face_width_m = 10e-3}, 0.0, 2e9),
               std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::plastic_gear_test
