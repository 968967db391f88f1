// Published ratings: tests/golden/spur_pair_strength.toml, vdi2736_pair.toml, and what a mesh alone
// does not have of kisssoft_stage_01_strength.toml (the rest:
// tests/cli/published_ratings_test.cpp).

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "efficiency/mesh_loss.hpp"
#include "geometry/interference.hpp"
#include "geometry/mesh.hpp"
#include "strength/flank_strength.hpp"
#include "strength/flank_stress.hpp"
#include "strength/load_cycles.hpp"
#include "strength/load_factors.hpp"
#include "strength/plastic_gear.hpp"
#include "strength/root_strength.hpp"
#include "strength/root_stress.hpp"
#include "tests/largest_deviation.hpp"
#include "units/units.hpp"

namespace gear3k::strength::reference_cases_test {
namespace {

using geometry::Gear;
using geometry::GearGeometry;
using geometry::GearKind;
using geometry::make_mesh_geometry;
using geometry::make_pressure_angle;
using geometry::make_tooth_form;
using geometry::MeshGeometry;
using geometry::PressureAngle;

constexpr double kPi = std::numbers::pi;
constexpr double kMm = 1e-3;
constexpr double kUm = 1e-6;
constexpr double kMpa = 1e6;

using Values = std::map<std::string, double>;

toml::table golden(const std::string& name) {
  toml::table file = toml::parse_file(std::string(GEAR3K_SOURCE_DIR "/tests/golden/") + name);
  return file;
}
double number(const toml::table& table, const std::string& key) {
  return table[key].value<double>().value();
}
double item(const toml::table& table, const std::string& key, std::size_t i) {
  return (*table[key].as_array())[i].value<double>().value();
}
double half_unit(int decimals) { return 0.5000001 * std::pow(10.0, -decimals); }

GearGeometry<double> with_tip(Gear<double> gear, const PressureAngle<double>& angle,
                              double tip_diameter_m) {
  const GearGeometry<double> full = make_gear_geometry(gear, angle);
  const double sign = gear.kind == GearKind::kRing ? 1.0 : -1.0;
  gear.tip_shortening = sign * (0.5 * tip_diameter_m - full.tip_radius_m) / gear.module_m;
  return make_gear_geometry(gear, angle);
}

TEST(ReferenceRatings, CyclesAndPitchDeviationsOfTheWindTurbineStageAreThePrintedOnes) {
  const toml::table file = golden("kisssoft_stage_01_strength.toml");
  const toml::table& stage = *file["stage"].as_table();
  const auto of = [&](const char* quantity, const char* gear) {
    return number(*stage[quantity].as_table(), gear);
  };
  const double turns = number(stage, "carrier_speed") * number(stage, "life") * 60.0;
  const double ring = of("teeth", "ring");
  const LoadCycles<double> cycles =
      load_cycles<double>({.sun = turns * (1.0 + ring / of("teeth", "sun")),
                           .carrier = turns,
                           .planet_rolling = turns * ring / of("teeth", "planet")},
                          stage["planets"].value<int>().value(), false);
  LargestDeviation largest;
  for (const auto& [gear, value] :
       {std::pair{"sun", cycles.sun}, {"planet", cycles.planet2}, {"ring", cycles.fixed_ring}}) {
    largest.see(0, value / 1e6 - of("million_cycles", gear), half_unit(1));
    const auto deviation_m =
        base_pitch_deviation(number(file, "module") * kMm,
                             number(file, "module") * of("teeth", gear) * kMm, kPi / 9.0, 6);
    largest.see(0, deviation_m.value() / kUm - of("base_pitch_deviation_um", gear), half_unit(1));
  }
  largest.expect_allowed("half a digit");
}

/// A pair of two external gears of a [[case]] or of a file.
struct ExternalPair {
  std::array<GearGeometry<double>, 2> gears;
  MeshGeometry<double> mesh;
};
GearGeometry<double> case_gear(const toml::table& row, std::size_t i) {
  Gear<double> gear{.teeth = static_cast<int>(item(row, "teeth", i)),
                    .module_m = number(row, "module") * kMm,
                    .rack = {}};
  if (row.contains("profile_shift")) gear.profile_shift = item(row, "profile_shift", i);
  if (row.contains("dedendum")) gear.rack.dedendum = item(row, "dedendum", i);
  if (row.contains("root_radius")) gear.rack.root_radius = item(row, "root_radius", i);
  return with_tip(gear, make_pressure_angle(number(row, "alpha") * kPi / 180.0),
                  item(row, "tip_diameter", i) * kMm);
}
ExternalPair case_pair(const toml::table& row) {
  ExternalPair pair{.gears = {case_gear(row, 0), case_gear(row, 1)}, .mesh = {}};
  pair.mesh = make_mesh_geometry(pair.gears[0], pair.gears[1], number(row, "center_distance") * kMm)
                  .value();
  return pair;
}
Elasticity case_elasticity(const toml::table& row, std::size_t i) {
  return {.youngs_modulus_Pa = item(row, "youngs_modulus", i) * kMpa,
          .poissons_ratio = item(row, "poissons_ratio", i)};
}

TEST(ReferenceRatings, RootSectionsOfAPublishedProgramAreMetToTheirPrintedDigits) {
  int compared = 0;
  LargestDeviation largest;
  const toml::table file = golden("spur_pair_strength.toml");
  for (const toml::node& node : *file["case"].as_array()) {
    const toml::table& row = *node.as_table();
    ASSERT_NE(std::string(row["cite"].value_or("")), "");
    ASSERT_NE(std::string(row["locator"].value_or("")), "");
    const ExternalPair pair = case_pair(row);
    std::map<std::string, std::array<double, 2>> values;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& g = pair.gears[i];
      const auto form = root_form(
          g, root_section(g, make_tooth_form(g)),
          load_point(g, outer_single_contact(g, pair.mesh.base_pitch_m, pair.mesh.contact_ratio)));
      const double m = g.gear.module_m;
      values["chord_in_modules"][i] = form.section.chord_m / m;
      values["fillet_radius_in_modules"][i] = form.section.fillet_radius_m / m;
      values["load_angle"][i] = form.load.angle_rad * 180.0 / kPi;
      values["bending_arm_in_modules"][i] = form.bending_arm_m / m;
      values["form_factor"][i] = form.form_factor;
      values["stress_correction_factor"][i] = form.stress_correction_factor;
    }
    for (const auto& [name, value] : values) {
      const toml::table* expected = row[name].as_table();
      if (expected == nullptr) continue;
      const int decimals = (*expected)["decimals"].value<int>().value();
      for (std::size_t i = 0; i < (*expected)["values"].as_array()->size(); ++i) {
        const double printed = item(*expected, "values", i);
        EXPECT_NEAR(value[i], printed, half_unit(decimals))
            << std::string(row["id"].value_or("")) << " " << name << " " << i + 1;
        largest.see(compared++, value[i] - printed, half_unit(decimals));
      }
    }
  }
  EXPECT_EQ(compared, 12);
  largest.expect_allowed("12 figures, half a digit");
}

TEST(ReferenceRatings, PlasticWheelOfTheFvaExampleIsMetToItsPrintedDigits) {
  const toml::table file = golden("vdi2736_pair.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  const ExternalPair pair = case_pair(file);
  const auto& [pinion, wheel] = pair.gears;
  const auto& mesh = pair.mesh;
  const double omega = number(file, "speed") * 2.0 * kPi / 60.0;
  const double pitch_radius = pinion.base_radius_m / std::cos(mesh.alpha_w_rad);
  const double h_v =
      kPi * (1.0 / pinion.gear.teeth + 1.0 / wheel.gear.teeth) *
      efficiency::ohlendorf_factor(mesh.addendum_contact_ratio1, mesh.addendum_contact_ratio2);
  const ToothLoad<double> load{
      .tangential_N = number(file, "power") / (omega * pinion.reference_radius_m),
      .face_width_m = number(file, "face_width") * kMm};
  Values values;
  values["contact_ratio1"] = mesh.addendum_contact_ratio1;
  values["contact_ratio2"] = mesh.addendum_contact_ratio2;
  values["flank_length1"] =
      active_flank_length(pinion, active_root_length(pinion, wheel, mesh, 1)) / kMm;
  const double flank_length =
      active_flank_length(wheel, active_root_length(pinion, wheel, mesh, 2));
  values["flank_length2"] = flank_length / kMm;
  values["tooth_temperature"] =
      tooth_temperature<double>({.ambient_K = number(file, "ambient") + 273.15,
                                 .loss_W = number(file, "power") * number(file, "friction") * h_v,
                                 .face_width_m = load.face_width_m,
                                 .pinion_teeth = pinion.gear.teeth,
                                 .speed_m_s = omega * pitch_radius,
                                 .module_m = pinion.gear.module_m,
                                 .housing_resistance = number(file, "housing_resistance"),
                                 .housing_surface_m2 = number(file, "housing_surface")},
                                0.0) -
      273.15;
  values["flank_stress"] = flank_stress<double>({.gear1 = pinion,
                                                 .gear2 = wheel,
                                                 .mesh = mesh,
                                                 .elasticity1 = case_elasticity(file, 0),
                                                 .elasticity2 = case_elasticity(file, 1)},
                                                load, {})
                               .pitch_point_Pa /
                           kMpa;
  values["wear"] =
      linear_wear<double>({.torque_Nm = number(file, "wheel_torque"),
                           .revolutions = number(file, "wheel_cycles"),
                           .loss_factor = h_v,
                           .wear_coefficient_m2_N = number(file, "wear_coefficient") * 1e-9,
                           .face_width_m = load.face_width_m,
                           .teeth = wheel.gear.teeth,
                           .flank_length_m = flank_length}) /
      kUm;
  values["deformation"] = tooth_deformation(load, item(file, "youngs_modulus", 0) * kMpa,
                                            item(file, "youngs_modulus", 1) * kMpa) /
                          kMm;
  int compared = 0;
  LargestDeviation largest, root_stress;
  for (const auto& [key, node] : *file["expect"].as_table()) {
    const toml::table& row = *node.as_table();
    const std::string name(key.str());
    ASSERT_TRUE(values.contains(name)) << name;
    const double printed = number(row, "value");
    const double input = row["input_rounding_percent"].value_or(0.0) / 100.0;
    const double allowed = half_unit(row["decimals"].value<int>().value()) + input * printed;
    EXPECT_NEAR(values.at(name), printed, allowed) << name;
    largest.see(compared++, values.at(name) - printed, allowed);
  }
  EXPECT_EQ(compared, 8);
  largest.expect_allowed("8 figures, half a digit");

  const toml::table& root = *file["root"].as_table();
  Gear<double> tooth = wheel.gear;
  tooth.tip_shortening = 0.0;
  tooth.profile_shift = number(root, "profile_shift");
  tooth.rack.dedendum = number(root, "dedendum");
  tooth.rack.root_radius = number(root, "root_radius");
  const auto generated = with_tip(tooth, wheel.angle, item(file, "tip_diameter", 1) * kMm);
  const auto stress =
      plastic_root_stress(generated, root_section(generated, make_tooth_form(generated)),
                          mesh.contact_ratio, load, 1.0);
  const toml::table& expected = *root["stress"].as_table();
  const double printed = number(expected, "value");
  ASSERT_TRUE(expected["reason"].value<std::string>());
  root_stress.see(0, stress.stress_Pa / kMpa - printed,
                  number(expected, "tolerance_percent") / 100.0 * printed);
  root_stress.expect_allowed("root stress, 0.3 %");
}

}  // namespace
}  // namespace gear3k::strength::reference_cases_test
