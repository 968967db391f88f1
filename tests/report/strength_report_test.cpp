#include "report/strength_report.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/files/design_file.hpp"
#include "io/text/csv_table.hpp"
#include "report/analysis_report.hpp"

namespace gear3k::report::strength_report_test {
namespace {

using Json = nlohmann::json;
using strength::Drive, strength::Factor, strength::MeshRating, strength::Mode,
    strength::ToothRating, strength::TrainRating;
namespace sources = strength::sources;

Factor<double> computed(double value) {
  return {.value = value, .branch = "by a formula", .source = sources::kM56};
}

/// A tooth of steel; every number is another one, and none is 0 or 1.
ToothRating<double> tooth(double base) {
  ToothRating<double> t;
  t.cycles = base + 30.0;
  // Half the chord, the height and the radius are as 3, 4 and 5.
  t.form.section = {.chord_m = (base + 1.0) * 1e-3,
                    .height_m = (base + 1.0) * 1e-3 * 2.0 / 3.0,
                    .fillet_radius_m = (base + 2.0) * 1e-3};
  t.form.load.angle_rad = (base + 3.0) * units::kDegree;
  t.form.bending_arm_m = (base + 4.0) * 1e-3;
  t.form.form_factor = base + 5.0;
  t.form.notch_parameter = base + 6.0;
  t.form.stress_correction_factor = base + 7.0;
  t.rim = computed(base + 8.0);
  t.root = {.nominal_Pa = (base + 9.0) * 1e6, .stress_Pa = (base + 10.0) * 1e6};
  t.root_strength = {.limit_Pa = (base + 11.0) * 1e6,
                     .stress_correction = computed(base + 12.0),
                     .life = computed(base + 13.0),
                     .notch_sensitivity = computed(base + 14.0),
                     .surface = computed(base + 15.0),
                     .size = computed(base + 16.0),
                     .reversal = computed(base + 17.0),
                     .strength_Pa = (base + 18.0) * 1e6};
  t.root_safety = base + 19.0;
  t.root_limit_stated = true;
  t.flank_stress_Pa = (base + 20.0) * 1e6;
  t.flank_strength = {.limit_Pa = (base + 21.0) * 1e6,
                      .life = computed(base + 22.0),
                      .lubricant = computed(base + 23.0),
                      .speed = computed(base + 24.0),
                      .roughness = computed(base + 25.0),
                      .work_hardening = computed(base + 26.0),
                      .size = computed(base + 27.0),
                      .strength_Pa = (base + 28.0) * 1e6};
  t.flank_safety = base + 29.0;
  t.flank_limit_stated = true;
  return t;
}

/// What the JSON of that tooth holds.
std::map<std::string, double> tooth_numbers(double base) {
  return {{"root_chord_mm", base + 1.0},
          {"root_section_diameter_mm", (base + 1.0) * 5.0 / 3.0},
          {"fillet_radius_mm", base + 2.0},
          {"load_angle_deg", base + 3.0},
          {"bending_arm_mm", base + 4.0},
          {"y_f", base + 5.0},
          {"notch_parameter", base + 6.0},
          {"y_s", base + 7.0},
          {"y_b", base + 8.0},
          {"sigma_f0_mpa", base + 9.0},
          {"sigma_f_mpa", base + 10.0},
          {"sigma_f_lim_mpa", base + 11.0},
          {"y_st", base + 12.0},
          {"y_nt", base + 13.0},
          {"y_delta", base + 14.0},
          {"y_r", base + 15.0},
          {"y_x", base + 16.0},
          {"y_m", base + 17.0},
          {"sigma_fg_mpa", base + 18.0},
          {"root_safety", base + 19.0},
          {"sigma_h_mpa", base + 20.0},
          {"sigma_h_lim_mpa", base + 21.0},
          {"z_nt", base + 22.0},
          {"z_l", base + 23.0},
          {"z_v", base + 24.0},
          {"z_r", base + 25.0},
          {"z_w", base + 26.0},
          {"z_x", base + 27.0},
          {"sigma_hg_mpa", base + 28.0},
          {"flank_safety", base + 29.0},
          {"cycles", base + 30.0}};
}

const std::set<std::string> kNullOfSteel{
    "root_temperature_c",   "flank_temperature_c",  "wear_um", "y_eps",
    "overload_root_safety", "overload_flank_safety"};

MeshRating<double> mesh(double base) {
  MeshRating<double> m;
  m.normal_N = base + 31.0;
  m.tangential_N = base + 32.0;
  m.face_width_m = (base + 33.0) * 1e-3;
  m.speed_m_s = base + 34.0;
  m.line_load_N_m = (base + 35.0) * 1e3;
  m.flank = {.zone_factor = base + 36.0,
             .elasticity_factor = (base + 37.0) * 1e3,
             .contact_ratio = computed(base + 38.0),
             .single_contact1 = computed(base + 39.0),
             .single_contact2 = computed(base + 40.0),
             .nominal_Pa = (base + 41.0) * 1e6,
             .pitch_point_Pa = (base + 42.0) * 1e6,
             .stress1_Pa = 0.0,
             .stress2_Pa = 0.0};
  m.factors = {.application = computed(base + 43.0),
               .mesh_load = computed(base + 44.0),
               .dynamic = computed(base + 45.0),
               .flank_face = computed(base + 46.0),
               .root_face = computed(base + 47.0),
               .flank_transverse = computed(base + 48.0),
               .root_transverse = computed(base + 49.0)};
  m.iso = {.single = (base + 51.0) * 1e9,
           .mesh_alpha = (base + 52.0) * 1e9,
           .mesh_beta = (base + 53.0) * 1e9};
  m.mean_stiffness_Pa = (base + 54.0) * 1e9;
  m.teeth = {tooth(base + 100.0), tooth(base + 200.0)};
  return m;
}

/// What the JSON of that mesh holds; its σ_H is that of gear 2.
std::map<std::string, double> mesh_numbers(double base) {
  return {{"normal_force_n", base + 31.0},
          {"tangential_force_n", base + 32.0},
          {"face_width_mm", base + 33.0},
          {"speed_m_s", base + 34.0},
          {"line_load_n_mm", base + 35.0},
          {"z_h", base + 36.0},
          {"z_e", base + 37.0},
          {"z_eps", base + 38.0},
          {"z_b", base + 39.0},
          {"z_d", base + 40.0},
          {"sigma_h0_mpa", base + 41.0},
          {"sigma_h_pitch_point_mpa", base + 42.0},
          {"sigma_h_mpa", base + 200.0 + 20.0},
          {"k_a", base + 43.0},
          {"k_gamma", base + 44.0},
          {"k_v", base + 45.0},
          {"k_h_beta", base + 46.0},
          {"k_f_beta", base + 47.0},
          {"k_h_alpha", base + 48.0},
          {"k_f_alpha", base + 49.0},
          {"c_prime_n_mm_um", base + 51.0},
          {"c_gamma_alpha_n_mm_um", base + 52.0},
          {"c_gamma_beta_n_mm_um", base + 53.0},
          {"mean_stiffness_n_mm_um", base + 54.0}};
}

strength::PlanetLoads<double> planet_loads(double base) {
  strength::PlanetLoads<double> p;
  p.plane = {{{.radial_N = base + 1.0, .tangential_N = base + 2.0},
              {.radial_N = base + 3.0, .tangential_N = base + 4.0}}};
  p.centrifugal_N = base + 5.0;
  p.tilting_couple_Nm = base + 6.0;
  p.reaction = {{{.radial_N = base + 7.0, .tangential_N = base + 8.0},
                 {.radial_N = base + 9.0, .tangential_N = base + 10.0}}};
  p.bearing_load_N = {base + 11.0, base + 12.0};
  p.bending_moment_Nm = base + 13.0;
  p.bending_position_m = (base + 14.0) * 1e-3;
  return p;
}

TrainRating<double> train_rating(double base, Drive drive) {
  TrainRating<double> r;
  r.drive = drive;
  r.torque_Nm = 20.0;
  r.mesh = {mesh(base), mesh(base + 1000.0), mesh(base + 2000.0)};
  return r;
}

/// A train whose first mesh carries more forward, the others backward.
design::Evaluation rated_train() {
  design::Evaluation e{};
  e.strength.emplace();
  design::StrengthResult& s = *e.strength;
  s.forward = train_rating(4000.0, Drive::kForward);
  s.backward = train_rating(8000.0, Drive::kBackward);
  s.backward.mesh[0].normal_N = s.forward.mesh[0].normal_N - 1.0;
  s.forward.stiffness = {.output_Nm_rad = 12345.0,
                         .input_Nm_rad = 6.5,
                         .compliance = {.mesh = {1e-6, 2e-6, 3e-6},
                                        .planet_torsion = 4e-6,
                                        .bearings = 0.0,
                                        .sun_shaft = 6e-6,
                                        .ring2 = 7e-6}};
  s.capacity_forward = strength::Capacity<double>{
      .torque_Nm = 27.5, .governing = {.mesh = 0, .member = 0, .mode = Mode::kFlank}};
  s.capacity_backward = strength::Capacity<double>{
      .torque_Nm = 25.25, .governing = {.mesh = 1, .member = 1, .mode = Mode::kRoot}};
  return e;
}

Json json_of(const design::Evaluation& e) { return Json::parse(strength_fields(e).json().text()); }

void expect_numbers(const Json& json, const std::map<std::string, double>& numbers) {
  for (const auto& [key, value] : numbers) {
    ASSERT_TRUE(json.contains(key)) << key;
    ASSERT_TRUE(json[key].is_number()) << key << " " << json[key];
    EXPECT_NEAR(json[key].get<double>(), value, 1e-12 * value) << key;
  }
}

TEST(StrengthReport, IsNullAndSilentWithoutARating) {
  const auto e = std::get<design::PairEvaluation>(design::evaluate(
      io::read_pair(std::string(GEAR3K_SOURCE_DIR) + "/examples/pairs/dry_steel_pair.toml")));
  ASSERT_FALSE(e.strength.has_value());
  EXPECT_TRUE(Json::parse(analysis_json(e).text()).at("strength").is_null());
  EXPECT_EQ(analysis_csv(e).find("sigma_f"), std::string::npos);
  EXPECT_EQ(strength_table(e), "");
  EXPECT_EQ(strength_table(design::Evaluation{}), "");
  EXPECT_NE(analysis_table(e).find("Not checked: strength (no [strength])"), std::string::npos);
}

TEST(StrengthReport, MeshesAreInTheDirectionOfTheGreaterForceAndHoldBoth) {
  const Json json = json_of(rated_train());
  ASSERT_EQ(json["meshes"].size(), 3U);
  constexpr std::array<const char*, 3> kNames{"S-P1", "P1-R1", "P2-R2"};
  for (const std::size_t k : {0U, 1U, 2U}) {
    const Json& m = json["meshes"][k];
    const double base = (k == 0 ? 4000.0 : 8000.0) + 1000.0 * static_cast<double>(k);
    EXPECT_EQ(m["name"], kNames[k]);
    EXPECT_EQ(m["direction"], k == 0 ? "forward" : "backward");
    expect_numbers(m, mesh_numbers(base));
    EXPECT_EQ(m["normal_force_forward_n"], 4031.0 + 1000.0 * static_cast<double>(k));
    EXPECT_EQ(m["normal_force_backward_n"], k == 0 ? 4030.0 : base + 31.0);
    EXPECT_EQ(m["c_prime_in_range"], true);
    EXPECT_TRUE(m["deformation_um"].is_null());
  }
}

TEST(StrengthReport, ForcesThatDifferByRoundingAreForward) {
  design::Evaluation e = rated_train();
  design::StrengthResult& s = *e.strength;
  s.backward.mesh[2].normal_N = s.forward.mesh[2].normal_N * (1.0 + 1e-14);
  const Json json = json_of(e);
  EXPECT_EQ(json["meshes"][2]["direction"], "forward");
  expect_numbers(json["meshes"][2], mesh_numbers(6000.0));
}

TEST(StrengthReport, TeethHoldEveryFigureByItsNameAndNullForWhatSteelLacks) {
  const Json json = json_of(rated_train());
  ASSERT_EQ(json["teeth"].size(), 6U);
  const std::vector<std::pair<std::string, std::string>> of{{"S-P1", "S"},   {"S-P1", "P1"},
                                                            {"P1-R1", "P1"}, {"P1-R1", "R1"},
                                                            {"P2-R2", "P2"}, {"P2-R2", "R2"}};
  const std::set<std::string> names{
      "gear",           "mesh",    "direction",     "section_on_fillet",
      "notch_in_range", "plastic", "limit_in_range"};
  for (std::size_t k = 0; k < of.size(); ++k) {
    const Json& t = json["teeth"][k];
    const std::size_t place = k / 2;
    const double base = (k < 2 ? 4000.0 : 8000.0) + 1000.0 * static_cast<double>(place) +
                        (k % 2 == 0 ? 100.0 : 200.0);
    EXPECT_EQ(t["mesh"], of[k].first);
    EXPECT_EQ(t["gear"], of[k].second);
    EXPECT_EQ(t["direction"], k < 2 ? "forward" : "backward");
    const auto numbers = tooth_numbers(base);
    expect_numbers(t, numbers);
    for (const auto& [key, value] : t.items()) {
      EXPECT_EQ(value.is_null(), kNullOfSteel.contains(key)) << key;
      EXPECT_TRUE(names.contains(key) || numbers.contains(key) || kNullOfSteel.contains(key))
          << key;
    }
  }
}

TEST(StrengthReport, WithoutALimitThereIsNoSafetyAndNoFactorOfIt) {
  design::Evaluation e = rated_train();
  ToothRating<double>& t = e.strength->forward.mesh[0].teeth[0];
  t.root_strength = {};
  t.root_safety = 0.0;
  t.root_limit_stated = false;
  t.flank_strength = {};
  t.flank_limit_stated = false;
  const Json json = json_of(e);
  const Json& shown = json["teeth"][0];
  for (const char* key : {"sigma_f_lim_mpa", "y_st", "y_nt", "y_delta", "y_r", "y_x", "y_m",
                          "sigma_fg_mpa", "root_safety", "sigma_h_lim_mpa", "z_nt", "z_l", "z_v",
                          "z_r", "z_w", "z_x", "sigma_hg_mpa", "flank_safety"}) {
    EXPECT_TRUE(shown.at(key).is_null()) << key;
  }
  EXPECT_EQ(shown["sigma_f_mpa"], 4110.0);
  for (const Json& factor : json["factors"]) {
    EXPECT_FALSE(factor["mesh"] == "S-P1" && factor["gear"] == "S" && factor["name"] == "y_x");
  }
  EXPECT_NE(strength_table(e).find("none"), std::string::npos);
}

TEST(StrengthReport, TeethOfPlasticHaveTemperatureAndWear) {
  design::Evaluation e = rated_train();
  MeshRating<double>& m = e.strength->forward.mesh[0];
  ToothRating<double>& t = m.teeth[1];
  t.plastic = true;
  t.root_temperature_K = 273.15 + 51.5;
  t.flank_temperature_K = 273.15 + 62.25;
  t.wear_m = 40.5e-6;
  t.contact_ratio_factor = 0.75;
  t.overload_root_safety = 3.5;
  t.overload_flank_safety = 2.5;
  m.deformation_m = 12.5e-6;
  const Json json = json_of(e);
  expect_numbers(json["teeth"][1], {{"root_temperature_c", 51.5},
                                    {"flank_temperature_c", 62.25},
                                    {"wear_um", 40.5},
                                    {"y_eps", 0.75},
                                    {"overload_root_safety", 3.5},
                                    {"overload_flank_safety", 2.5}});
  EXPECT_EQ(json["teeth"][1]["plastic"], true);
  EXPECT_NEAR(json["meshes"][0]["deformation_um"].get<double>(), 12.5, 1e-12);
  const std::string text = strength_table(e);
  EXPECT_NE(text.find("\nTeeth of plastic ("), std::string::npos) << text;
  EXPECT_NE(text.find("51.5 C  62.2 C  0.7500  40.50 um"), std::string::npos) << text;
  EXPECT_NE(text.find("S_F overload"), std::string::npos) << text;
  EXPECT_EQ(strength_table(rated_train()).find("plastic"), std::string::npos);
}

TEST(StrengthReport, CapacityIsTheSmallerOfBothDirectionsAndSaysWhatGoverns) {
  design::Evaluation e = rated_train();
  e.total_mass_kg = 0.5;
  const Json json = json_of(e);
  EXPECT_EQ(json["output_torque_nm"], 20.0);
  EXPECT_EQ(json["capacity_nm"], 25.25);
  EXPECT_EQ(json["capacity_forward_nm"], 27.5);
  EXPECT_EQ(json["capacity_backward_nm"], 25.25);
  EXPECT_EQ(json["torque_density_nm_per_kg"], 50.5);
  const Json backward =
      Json::parse(R"({"gear": "R1", "mesh": "P1-R1", "mode": "root", "direction": "backward"})");
  EXPECT_EQ(json["governing"], backward);
  EXPECT_EQ(json["governing_backward"], backward);
  EXPECT_EQ(json["governing_forward"], Json::parse(R"({"gear": "S", "mesh": "S-P1", "mode": "flank",
                            "direction": "forward"})"));
}

TEST(StrengthReport, TheDensityOfTheGearsAloneCountsEveryPlanet) {
  design::Evaluation e = rated_train();
  EXPECT_TRUE(json_of(e)["gears_torque_density_nm_per_kg"].is_null());
  e.parts = {{.name = "S", .count = 1, .mass_kg = 0.1, .inertia_kgm2 = {}},
             {.name = "P1", .count = 3, .mass_kg = 0.1, .inertia_kgm2 = {}},
             {.name = "P2", .count = 3, .mass_kg = 0.05, .inertia_kgm2 = {}},
             {.name = "R1", .count = 1, .mass_kg = 0.2, .inertia_kgm2 = {}},
             {.name = "R2", .count = 1, .mass_kg = 0.25, .inertia_kgm2 = {}},
             {.name = "carrier", .count = 1, .mass_kg = 7.0, .inertia_kgm2 = {}}};
  // 0.1 + 3 (0.1 + 0.05) + 0.2 + 0.25 = 1 kg
  EXPECT_NEAR(json_of(e)["gears_torque_density_nm_per_kg"].get<double>(), 25.25, 1e-12);
  EXPECT_NE(strength_table(e).find("of the gears alone 25.25 N m/kg, of 1 kg"), std::string::npos);
  e.parts[3].mass_kg.reset();
  EXPECT_TRUE(json_of(e)["gears_torque_density_nm_per_kg"].is_null());
}

TEST(StrengthReport, WhatIsNotJudgedIsNull) {
  design::Evaluation e = rated_train();
  Json json = json_of(e);
  EXPECT_TRUE(json["torque_density_nm_per_kg"].is_null()) << "without a mass";
  EXPECT_NE(strength_table(e).find("not known: lacks the mass of a part"), std::string::npos);
  e.strength->capacity_backward.reset();
  json = json_of(e);
  EXPECT_TRUE(json["capacity_nm"].is_null());
  EXPECT_EQ(json["capacity_forward_nm"], 27.5);
  for (const char* key : {"capacity_backward_nm", "governing", "governing_backward", "planet"}) {
    EXPECT_TRUE(json.at(key).is_null()) << key;
  }
  e.strength->capacity_forward.reset();
  EXPECT_NE(strength_table(e).find("not judged\n"), std::string::npos);
}

TEST(StrengthReport, StiffnessHasItsCompliancesByPart) {
  const Json json = json_of(rated_train());
  EXPECT_EQ(json["stiffness"], Json::parse(R"({"output_nm_per_rad": 12345.0,
    "input_nm_per_rad": 6.5, "compliance_rad_per_nm": {"S-P1": 1e-6, "P1-R1": 2e-6,
    "P2-R2": 3e-6, "planet_torsion": 4e-6, "bearings": 0.0, "sun_shaft": 6e-6, "ring2": 7e-6}})"));
  design::Evaluation without = rated_train();
  without.strength->forward.stiffness.reset();
  EXPECT_TRUE(json_of(without)["stiffness"].is_null());
}

TEST(StrengthReport, PlanetHasItsLoadsInBothDirections) {
  design::Evaluation e = rated_train();
  e.strength->forward.planet = planet_loads(100.0);
  e.strength->backward.planet = planet_loads(200.0);
  e.strength->backward.pin_stress_Pa = 215e6;
  const Json json = json_of(e);
  EXPECT_EQ(json["planet"]["forward"], Json::parse(R"({
    "plane_forces": [{"plane": "P1", "radial_n": 101.0, "tangential_n": 102.0},
                     {"plane": "P2", "radial_n": 103.0, "tangential_n": 104.0}],
    "centrifugal_n": 105.0, "tilting_couple_nm": 106.0,
    "reactions": [{"support": "A", "radial_n": 107.0, "tangential_n": 108.0},
                  {"support": "B", "radial_n": 109.0, "tangential_n": 110.0}],
    "bearing_load_n": [111.0, 112.0], "bending_moment_nm": 113.0, "bending_position_mm": 114.0,
    "pin_stress_mpa": null})"));
  EXPECT_EQ(json["planet"]["backward"]["tilting_couple_nm"], 206.0);
  EXPECT_EQ(json["planet"]["backward"]["pin_stress_mpa"], 215.0);
  const std::string text = strength_table(e);
  EXPECT_NE(text.find("planet bearings, backward"), std::string::npos) << text;
  EXPECT_NE(text.find("A 211.0 N, B 212.0 N (tilting couple 206 N m, pin bending moment 213 N m, "
                      "215.0 N/mm2)"),
            std::string::npos)
      << text;
}

TEST(StrengthReport, EveryFactorHasItsBranchAndSource) {
  design::Evaluation e = rated_train();
  Factor<double>& dynamic = e.strength->forward.mesh[0].factors.dynamic;
  dynamic = {.value = 1.5, .branch = "method C", .source = sources::kMekanika, .in_range = false};
  const Json json = json_of(e);
  std::map<std::string, int> count;
  for (const Json& factor : json["factors"]) ++count[factor.at("name").get<std::string>()];
  for (const char* name : {"k_a", "k_gamma", "k_v", "k_h_beta", "k_f_beta", "k_h_alpha",
                           "k_f_alpha", "z_eps", "z_b", "z_d"}) {
    EXPECT_EQ(count[name], 3) << name;
  }
  for (const char* name : {"y_b", "y_st", "y_nt", "y_delta", "y_r", "y_x", "y_m", "z_nt", "z_l",
                           "z_v", "z_r", "z_w", "z_x"}) {
    EXPECT_EQ(count[name], 6) << name;
  }
  EXPECT_EQ(json["factors"][2],
            Json::parse(R"json({"name": "k_v", "mesh": "S-P1", "gear": null, "value": 1.5,
                            "branch": "method C", "source": "hakangunes258/mekanika (ISO 6336:2006)",
                            "in_range": false
})json"));
  const auto shift = std::ranges::find_if(json["factors"], [](const Json& f) {
    return f["name"] == "y_m" && f["mesh"] == "P2-R2" && f["gear"] == "R2";
  });
  ASSERT_NE(shift, json["factors"].end());
  EXPECT_EQ(shift->at("value"), 10000.0 + 200.0 + 17.0);
}

TEST(StrengthReport, CsvHoldsTheNumbersOfTheJson) {
  design::Evaluation e = rated_train();
  e.strength->forward.planet = planet_loads(100.0);
  e.strength->backward.planet = planet_loads(200.0);
  const Json json = json_of(e);
  const io::CsvTable table =
      io::parse_csv(kRowsHeader + strength_fields(e).csv_rows(), "strength.csv");
  std::map<std::string, double> csv;
  for (const auto& row : table.rows) {
    const auto key = table.text(row, "item").value() + "/" + table.text(row, "quantity").value();
    EXPECT_FALSE(csv.contains(key)) << key;
    csv[key] = table.number(row, "value").value();
  }
  EXPECT_EQ(csv.at("train/rated_output_torque"), 20.0);
  EXPECT_EQ(csv.at("train/torque_capacity"), 25.25);
  EXPECT_EQ(csv.at("train/output_stiffness"), 12345.0);
  EXPECT_EQ(csv.at("train/compliance S-P1"), 1e-6);
  EXPECT_EQ(csv.at("planet backward/bearing_load B"), 212.0);
  EXPECT_EQ(csv.at("P1-R1/sigma_h0"), json["meshes"][1]["sigma_h0_mpa"]);
  EXPECT_EQ(csv.at("P1-R1/k_h_beta"), json["meshes"][1]["k_h_beta"]);
  EXPECT_EQ(csv.at("P2-R2, R2/sigma_f"), json["teeth"][5]["sigma_f_mpa"]);
  EXPECT_EQ(csv.at("P2-R2, R2/z_w"), json["teeth"][5]["z_w"]);
  EXPECT_EQ(csv.at("S-P1, S/root_safety"), json["teeth"][0]["root_safety"]);
  EXPECT_FALSE(csv.contains("S-P1, S/wear"));
}

TEST(StrengthReport, TableShowsEachToothAndWhatGoverns) {
  const std::string text = strength_table(rated_train());
  EXPECT_EQ(text.find("\nStrength at 20 N m at R2"), 0U) << text;
  EXPECT_NE(text.find("  S-P1   S          4031.0        4030.0   4110.0   4119.000   4120.0   "
                      "4129.000\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("9229.000  root\n"), std::string::npos) << text;
  EXPECT_NE(text.find("25.25 N m: forward 27.5 N m (flank of S in S-P1), backward 25.25 N m (root "
                      "of R1 in P1-R1)"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("12345 N m/rad at the output (sun locked), 6.5 N m/rad at the sun"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("not stated, taken as rigid  planet bearings\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("taken as 1"), std::string::npos) << text;
}

TEST(StrengthReport, TableNamesWhatIsNotStatedOnceWithItsReason) {
  design::Evaluation e = rated_train();
  const Factor<double> no_grade{.branch = "accuracy grade not stated",
                                .source = sources::kNotStated};
  for (TrainRating<double>* rating : {&e.strength->forward, &e.strength->backward}) {
    for (MeshRating<double>& m : rating->mesh) {
      m.factors.dynamic = no_grade;
      m.factors.flank_transverse = no_grade;
      for (ToothRating<double>& t : m.teeth) {
        t.flank_strength.roughness = {.branch = "roughness not stated",
                                      .source = sources::kNotStated};
      }
    }
  }
  const std::string text = strength_table(e);
  EXPECT_NE(text.find("not stated, taken as 1      K_v, K_Halpha (accuracy grade not stated)\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("                              Z_R (roughness not stated)\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("\n  Z_R "), std::string::npos) << "1 is no row of the factors\n" << text;
}

TEST(StrengthReport, FactorsOfOneCaseAreOneRow) {
  design::Evaluation e = rated_train();
  for (TrainRating<double>* rating : {&e.strength->forward, &e.strength->backward}) {
    for (MeshRating<double>& m : rating->mesh) {
      m.factors.application = {.value = 1.25, .branch = "stated", .source = sources::kInput};
      m.factors.mesh_load = {.branch = "stated", .source = sources::kInput};
    }
  }
  e.strength->forward.mesh[0].factors.dynamic = {
      .value = 1.5, .branch = "method C", .source = sources::kM56, .in_range = false};
  const std::string text = strength_table(e);
  EXPECT_EQ(text.find("\n  K_gamma "), std::string::npos) << text;
  const auto row = text.find("\n  K_A ");
  ASSERT_NE(row, std::string::npos) << text;
  EXPECT_EQ(text.find("\n  K_A ", row + 1), std::string::npos) << text;
  const std::string line = text.substr(row + 1, text.find('\n', row + 1) - row - 1);
  EXPECT_NE(line.find(" 1.2500  all "), std::string::npos) << line;
  EXPECT_NE(line.find("stated"), std::string::npos) << line;
  EXPECT_NE(text.find("1.5000  S-P1 "), std::string::npos) << text;
  EXPECT_NE(text.find("9045.0000 to 10045.0000  P1-R1, P2-R2 "), std::string::npos) << text;
  EXPECT_NE(text.find("method C (out of its range)"), std::string::npos) << text;
  // Rows of one symbol stand together.
  const auto slow = text.find("\n  K_v ");
  const auto next = text.find('\n', slow + 1);
  EXPECT_EQ(text.compare(next, 6, "\n  K_v"), 0) << text;
}

TEST(StrengthReport, ALockedDirectionIsSaid) {
  design::Evaluation e = rated_train();
  EXPECT_EQ(json_of(e)["locks_backward"], false);
  e.strength->backward.locked = true;
  EXPECT_EQ(json_of(e)["locks_backward"], true);
  EXPECT_EQ(json_of(e)["locks_forward"], false);
  const std::string text = strength_table(e);
  EXPECT_NE(text.find("driven backward"), std::string::npos) << text;
  EXPECT_EQ(text.find("driven forward"), std::string::npos) << text;
}

TEST(StrengthReport, APairHasItsMeshTeethAndTorque) {
  design::PairEvaluation e{};
  e.mesh.name = "1-2";
  e.gears.resize(2);
  e.gears[0].name = "1";
  e.gears[1].name = "2";
  e.gears[0].base_diameter_m = 0.04;
  e.strength = mesh(500.0);
  const Json json = Json::parse(strength_fields(e).json().text());
  EXPECT_NEAR(json["torque_nm"].get<double>(), 531.0 * 0.02, 1e-11);
  ASSERT_EQ(json["meshes"].size(), 1U);
  EXPECT_EQ(json["meshes"][0]["name"], "1-2");
  EXPECT_FALSE(json["meshes"][0].contains("direction"));
  EXPECT_FALSE(json["meshes"][0].contains("normal_force_backward_n"));
  expect_numbers(json["meshes"][0], mesh_numbers(500.0));
  ASSERT_EQ(json["teeth"].size(), 2U);
  expect_numbers(json["teeth"][1], tooth_numbers(700.0));
  EXPECT_EQ(json["teeth"][1]["gear"], "2");
  EXPECT_EQ(json["factors"].size(), 10U + 2U * 13U);
  const std::string text = strength_table(e);
  EXPECT_EQ(text.find("\nStrength at 10.62 N m on gear 1 (N, N/mm2)\n"), 0U) << text;
  EXPECT_NE(text.find("\n  1-2   1     531.0"), std::string::npos) << text;
  EXPECT_EQ(text.find("governs"), std::string::npos) << text;
  EXPECT_NE(strength_fields(e).csv_rows().find("\"1-2, 2\",root_safety,719,,,\n"),
            std::string::npos);
}

// What one gear states is not said to be missing of it.
TEST(StrengthReport, NamesTheGearsForWhichAFactorIsNotStated) {
  design::Design d = io::read_design(GEAR3K_SOURCE_DIR "/examples/designs/loaded.toml");
  const auto table = [&] { return strength_table(std::get<design::Evaluation>(evaluate(d))); };
  EXPECT_NE(table().find("Y_NT, Z_NT (no life stated"), std::string::npos);
  d.rating->gear_teeth[train::kS].cycles = 1e5;
  EXPECT_NE(table().find("Y_NT, Z_NT of P1, R1, P2, R2 (no life stated"), std::string::npos);
  // Z_R wants the roughness of both: known in mesh S-P1 alone.
  for (const std::size_t gear : {train::kS, train::kP1}) {
    d.rating->gear_teeth[gear].flank_roughness_m = 3e-6;
  }
  EXPECT_NE(table().find("Z_R of P1 in P1-R1, R1, P2, R2 (roughness"), std::string::npos)
      << table();
}

}  // namespace
}  // namespace gear3k::report::strength_report_test
