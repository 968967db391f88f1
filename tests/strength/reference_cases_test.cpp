// Published ratings: tests/golden/kisssoft_stage_01_strength.toml, spur_pair_strength.toml,
// vdi2736_pair.toml.

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

GearGeometry<double> stage_gear(const toml::table& file, const std::string& name) {
  const toml::table& entry = *file[name].as_table();
  Gear<double> gear{.teeth = entry["teeth"].value<int>().value(),
                    .kind = name == "ring" ? GearKind::kRing : GearKind::kExternal,
                    .module_m = number(file, "module") * kMm,
                    .profile_shift = number(entry, "profile_shift"),
                    .rack = {}};
  const auto angle = make_pressure_angle(number(file, "alpha") * kPi / 180.0);
  return with_tip(gear, angle, number(entry, "tip_diameter") * kMm);
}

class StageRating {
 public:
  explicit StageRating(const toml::table& file) : file_(file) {
    const double carrier = number(file, "carrier_speed");
    const double ratio = teeth("ring") / teeth("sun");
    speeds_ = {.sun = carrier * (1.0 + ratio),
               .carrier = carrier,
               .planet_rolling = carrier * teeth("ring") / teeth("planet")};
    const TrainTurns<double> turns{.sun = speeds_.sun * minutes(),
                                   .carrier = speeds_.carrier * minutes(),
                                   .planet_rolling = speeds_.planet_rolling * minutes()};
    const LoadCycles<double> cycles =
        load_cycles(turns, file["planets"].value<int>().value(), false);
    cycles_ = {{"sun", cycles.sun}, {"planet", cycles.planet2}, {"ring", cycles.fixed_ring}};
  }

  Values values() {
    rate("sun_planet", "sun", "planet", "sun", "planet_with_sun");
    rate("planet_ring", "planet", "ring", "planet_with_ring", "ring");
    for (const auto& [name, subject] :
         {std::pair{"sun", "sun"}, {"planet", "planet_with_sun"}, {"ring", "ring"}}) {
      values_[fmt::format("load_cycles.{}", subject)] = cycles_.at(name) / 1e6;
      const auto gear = stage_gear(file_, name);
      values_[fmt::format("base_pitch_deviation.{}", subject)] =
          base_pitch_deviation(gear.gear.module_m, 2.0 * gear.reference_radius_m,
                               gear.angle.alpha_rad, 6)
              .value() /
          kUm;
    }
    return values_;
  }

 private:
  double minutes() const { return number(file_, "life") * 60.0; }
  double teeth(const std::string& name) const { return number(*file_[name].as_table(), "teeth"); }
  const Material& material(const std::string& name) const {
    const Material* found = find_material(*file_[name]["material"].value<std::string>());
    return *found;
  }
  double roughness_m(const std::string& name, const std::string& where) const {
    return number(*file_[name].as_table(), where + "_roughness") * kUm;
  }

  void rate(const std::string& mesh_name, const std::string& name1, const std::string& name2,
            const std::string& subject1, const std::string& subject2) {
    const auto g1 = stage_gear(file_, name1), g2 = stage_gear(file_, name2);
    const auto mesh = make_mesh_geometry(g1, g2, number(file_, "center_distance") * kMm).value();
    const toml::table& k = *file_[mesh_name].as_table();
    const ToothLoad<double> load{.tangential_N = number(file_, "tangential_force"),
                                 .face_width_m = number(file_, "face_width") * kMm};
    LoadFactorSet<double> factors{.application = number(file_, "application"),
                                  .mesh_load = number(file_, "mesh_load"),
                                  .dynamic = number(k, "dynamic"),
                                  .face = number(k, "face"),
                                  .transverse = number(k, "transverse")};
    const auto add = [&](const std::string& quantity, const std::string& subject, double value) {
      values_[quantity + "." + subject] = value;
    };
    const auto elastic = [](const Material& m) {
      return Elasticity{.youngs_modulus_Pa = m.youngs_modulus_Pa.value(),
                        .poissons_ratio = m.poisson_ratio.value()};
    };
    const auto flank = flank_stress<double>({.gear1 = g1,
                                             .gear2 = g2,
                                             .mesh = mesh,
                                             .elasticity1 = elastic(material(name1)),
                                             .elasticity2 = elastic(material(name2))},
                                            load, factors);
    add("zone_factor", mesh_name, flank.zone_factor);
    add("elasticity_factor", mesh_name, flank.elasticity_factor / std::sqrt(kMpa));
    add("contact_ratio_factor", mesh_name, flank.contact_ratio.value);
    add("nominal_flank_stress", mesh_name, flank.nominal_Pa / kMpa);
    const double height = std::max(std::abs(g1.tip_radius_m - g1.root_radius_m),
                                   std::abs(g2.tip_radius_m - g2.root_radius_m));
    const double k_f_beta = root_face_load_factor(factors.face, height / load.face_width_m).value;
    add("root_face_load_factor", mesh_name, k_f_beta);
    LoadFactorSet<double> root_factors = factors;
    root_factors.face = k_f_beta;

    const auto limit = [&](const std::string& name) {
      return flank_limit<double>(material(name), {}).stress_Pa;
    };
    const double speed = 2.0 * kPi / 60.0 * std::abs(speeds_.sun - speeds_.carrier) * 0.5 *
                         teeth("sun") * number(file_, "module") * kMm;
    const double reduced = pitch_point_curvature(g1, g2, mesh).reduced_m;
    for (const int which : {1, 2}) {
      const auto& g = which == 1 ? g1 : g2;
      const std::string& name = which == 1 ? name1 : name2;
      const std::string& mate = which == 1 ? name2 : name1;
      const std::string& subject = which == 1 ? subject1 : subject2;
      const toml::table& entry = *file_[name].as_table();
      const double flank_pa = which == 1 ? flank.stress1_Pa : flank.stress2_Pa;
      add("single_contact_factor", subject,
          (which == 1 ? flank.single_contact1 : flank.single_contact2).value);
      add("flank_stress", subject, flank_pa / kMpa);
      FlankCondition<double> condition{.cycles = cycles_.at(name),
                                       .softer_limit_Pa = std::min(limit(name1), limit(name2)),
                                       .reduced_radius_m = reduced,
                                       .speed_m_s = speed,
                                       .viscosity40_m2_s = number(file_, "viscosity40") * 1e-6,
                                       .own_roughness_m = roughness_m(name, "flank"),
                                       .mate_roughness_m = roughness_m(mate, "flank"),
                                       .mate_group = material(mate).group,
                                       .brinell_hardness = entry["brinell"].value<double>()};
      const auto strength = flank_strength(material(name), limit(name), condition);
      add("flank_life_factor", subject, strength.life.value);
      add("lubricant_factor", subject, strength.lubricant.value);
      add("speed_factor", subject, strength.speed.value);
      add("roughness_factor", subject, strength.roughness.value);
      add("work_hardening_factor", subject, strength.work_hardening.value);
      add("flank_strength", subject, strength.strength_Pa / kMpa);
      add("flank_safety", subject, flank_safety(strength, flank_pa));

      const auto radius = entry["virtual_root_radius"].value<double>();
      const auto section =
          radius ? virtual_rack_section(g, *radius) : root_section(g, make_tooth_form(g));
      const auto form =
          root_form(g, section,
                    load_point(g, outer_single_contact(g, mesh.base_pitch_m, mesh.contact_ratio)));
      const double m = g.gear.module_m;
      add("chord", subject, section.chord_m / kMm);
      add("chord_in_modules", subject, section.chord_m / m);
      add("fillet_radius", subject, section.fillet_radius_m / kMm);
      add("fillet_radius_in_modules", subject, section.fillet_radius_m / m);
      add("section_diameter", subject,
          2.0 * std::hypot(section.height_m, 0.5 * section.chord_m) / kMm);
      add("bending_arm", subject, form.bending_arm_m / kMm);
      add("bending_arm_in_modules", subject, form.bending_arm_m / m);
      add("load_angle", subject, form.load.angle_rad * 180.0 / kPi);
      add("form_factor", subject, form.form_factor);
      add("stress_correction_factor", subject, form.stress_correction_factor);
      const auto stress = root_stress(g, form, 1.0, load, root_factors);
      add("nominal_root_stress", subject, stress.nominal_Pa / kMpa);
      add("root_stress", subject, stress.stress_Pa / kMpa);
      const bool reversed = entry["reversed"].value_or(false);
      const auto root = root_strength<double>(
          material(name), root_limit<double>(material(name), {}).stress_Pa,
          {.cycles = cycles_.at(name),
           .notch_parameter = form.notch_parameter,
           .module_m = m,
           .root_roughness_m = roughness_m(name, "root"),
           .loading = reversed ? RootLoading::kReversed : RootLoading::kPulsating});
      add("root_life_factor", subject, root.life.value);
      add("notch_sensitivity_factor", subject, root.notch_sensitivity.value);
      add("root_surface_factor", subject, root.surface.value);
      add("root_size_factor", subject, root.size.value);
      add("reversal_factor", subject, root.reversal.value);
      add("root_strength", subject, root.strength_Pa / kMpa);
      add("root_safety", subject, root_safety(root, stress.stress_Pa));
    }
  }

  const toml::table& file_;
  TrainTurns<double> speeds_;
  std::map<std::string, double> cycles_;
  Values values_;
};

TEST(ReferenceRatings, EveryFigureOfTheWindTurbineStageIsMetToItsPrintedDigits) {
  const toml::table file = golden("kisssoft_stage_01_strength.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const Values values = StageRating(file).values();
  int compared = 0;
  for (const toml::node& node : *file["expect"].as_array()) {
    const toml::table& row = *node.as_table();
    const std::string quantity = row["quantity"].value_or("");
    const int decimals = row["decimals"].value_or(file["decimals"].value<int>().value());
    const auto percent = row["tolerance_percent"].value<double>();
    ASSERT_TRUE(!percent || row["reason"].value<std::string>()) << quantity;
    for (const auto& [key, value] : row) {
      const std::string subject(key.str());
      if (subject == "quantity" || subject == "decimals" || subject == "tolerance_percent" ||
          subject == "reason") {
        continue;
      }
      const std::string name = fmt::format("{}.{}", quantity, subject);
      ASSERT_TRUE(values.contains(name)) << name;
      const double printed = value.value<double>().value();
      const double tolerance = percent ? *percent / 100.0 * printed : half_unit(decimals);
      EXPECT_NEAR(values.at(name), printed, tolerance) << name;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 123);
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

TEST(ReferenceRatings, SpurPairsOfPublishedProgramsAreMetToTheirPrintedDigits) {
  int compared = 0;
  const toml::table file = golden("spur_pair_strength.toml");
  for (const toml::node& node : *file["case"].as_array()) {
    const toml::table& row = *node.as_table();
    ASSERT_NE(std::string(row["cite"].value_or("")), "");
    ASSERT_NE(std::string(row["locator"].value_or("")), "");
    const ExternalPair pair = case_pair(row);
    std::map<std::string, std::array<double, 2>> values;
    ToothLoad<double> load{.tangential_N = row["tangential_force"].value_or(0.0),
                           .face_width_m = row["face_width"].value_or(1.0) * kMm};
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
      values["nominal_root_stress"][i] = root_stress(g, form, 1.0, load, {}).nominal_Pa / kMpa;
    }
    if (row.contains("youngs_modulus")) {
      values["nominal_flank_stress"][0] =
          flank_stress<double>({.gear1 = pair.gears[0],
                                .gear2 = pair.gears[1],
                                .mesh = pair.mesh,
                                .elasticity1 = case_elasticity(row, 0),
                                .elasticity2 = case_elasticity(row, 1)},
                               load, {})
              .nominal_Pa /
          kMpa;
    }
    for (const auto& [name, value] : values) {
      const toml::table* expected = row[name].as_table();
      if (expected == nullptr) continue;
      const int decimals = (*expected)["decimals"].value<int>().value();
      for (std::size_t i = 0; i < (*expected)["values"].as_array()->size(); ++i) {
        const double printed = item(*expected, "values", i);
        const double input = (*expected)["input_rounding_percent"].value_or(0.0) / 100.0;
        EXPECT_NEAR(value[i], printed, half_unit(decimals) + input * printed)
            << std::string(row["id"].value_or("")) << " " << name << " " << i + 1;
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 7 + 12);
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
  for (const auto& [key, node] : *file["expect"].as_table()) {
    const toml::table& row = *node.as_table();
    const std::string name(key.str());
    ASSERT_TRUE(values.contains(name)) << name;
    const double printed = number(row, "value");
    const double input = row["input_rounding_percent"].value_or(0.0) / 100.0;
    EXPECT_NEAR(values.at(name), printed,
                half_unit(row["decimals"].value<int>().value()) + input * printed)
        << name;
    ++compared;
  }
  EXPECT_EQ(compared, 8);

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
  EXPECT_NEAR(stress.stress_Pa / kMpa, printed,
              number(expected, "tolerance_percent") / 100.0 * printed);
}

}  // namespace
}  // namespace gear3k::strength::reference_cases_test
