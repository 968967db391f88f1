// Commands, formats, files and exit codes that users' scripts rely on.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::contract_test {
namespace {

using nlohmann::json;
using test::example, test::lines_of, test::ProgramResult, test::replaced, test::RunningProgram,
    test::Workplace;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kInterrupted = 130;

/// Half a unit of the last decimal that a source prints.
double half_unit(int decimals) { return 0.5 * std::pow(10.0, -decimals); }

/// Rounding of a handful of operations on a value of this size.
double rounding(double size) { return 1e-13 * std::abs(size); }

json json_of(const Workplace& place, const std::vector<std::string>& arguments) {
  const ProgramResult result = place.run(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

json analysis_of(const std::string& design) {
  const Workplace place;
  place.write("gear.toml", design);
  return json_of(place, {"analyze", "gear.toml", "--format", "json"});
}

enum class Type { kNumber, kInteger, kBoolean, kText, kObject, kList };

bool has_type(const json& value, Type type) {
  switch (type) {
    case Type::kNumber:
      return value.is_number();
    case Type::kInteger:
      return value.is_number_integer();
    case Type::kBoolean:
      return value.is_boolean();
    case Type::kText:
      return value.is_string();
    case Type::kObject:
      return value.is_object();
    case Type::kList:
      return value.is_array();
  }
  return false;
}

void expect_keys(const json& object, const std::map<std::string, Type>& keys) {
  for (const auto& [key, type] : keys) {
    ASSERT_TRUE(object.contains(key)) << key;
    EXPECT_TRUE(has_type(object.at(key), type)) << key << " = " << object.at(key);
  }
}

void expect_mesh(const json& mesh) {
  expect_keys(mesh, {{"name", Type::kText},
                     {"working_pressure_angle_deg", Type::kNumber},
                     {"zero_backlash_center_distance_mm", Type::kNumber},
                     {"contact_ratio", Type::kNumber},
                     {"approach_contact_ratio", Type::kNumber},
                     {"recess_contact_ratio", Type::kNumber},
                     {"normal_backlash_um", Type::kNumber},
                     {"efficiency_forward", Type::kNumber},
                     {"efficiency_backward", Type::kNumber}});
  EXPECT_NEAR(mesh.at("approach_contact_ratio").get<double>() +
                  mesh.at("recess_contact_ratio").get<double>(),
              mesh.at("contact_ratio").get<double>(), rounding(10.0));
}

void expect_check(const json& check) {
  static const std::set<std::string> kUnits{"", "module", "mm", "um", "arcmin", "deg"};
  expect_keys(check, {{"name", Type::kText},
                      {"margin", Type::kNumber},
                      {"unit", Type::kText},
                      {"ok", Type::kBoolean}});
  EXPECT_TRUE(kUnits.contains(check.at("unit").get<std::string>())) << check;
  for (const char* subject : {"mesh", "gear"}) {
    if (check.contains(subject)) {
      EXPECT_TRUE(check.at(subject).is_string()) << check;
    }
  }
}

void expect_tool(const json& result) {
  expect_keys(result, {{"tool", Type::kObject}});
  expect_keys(result.at("tool"), {{"version", Type::kText}, {"git", Type::kText}});
}

/// Diameters of a gear with full teeth of the standard rack (1.0, 1.25) at 20 degrees.
void expect_gear(const json& gear, double module_mm, int teeth, double shift, bool ring) {
  expect_keys(gear, {{"name", Type::kText},
                     {"teeth", Type::kInteger},
                     {"pitch_diameter_mm", Type::kNumber},
                     {"base_diameter_mm", Type::kNumber},
                     {"tip_diameter_mm", Type::kNumber},
                     {"root_diameter_mm", Type::kNumber},
                     {"tip_thickness_mm", Type::kNumber}});
  const double pitch = module_mm * teeth;
  const double outwards = ring ? -1.0 : 1.0;
  EXPECT_EQ(gear.at("teeth"), teeth);
  EXPECT_NEAR(gear.at("pitch_diameter_mm").get<double>(), pitch, rounding(pitch));
  EXPECT_NEAR(gear.at("base_diameter_mm").get<double>(), pitch * std::cos(20.0 * kDegree),
              rounding(pitch));
  EXPECT_NEAR(gear.at("tip_diameter_mm").get<double>(),
              pitch + 2.0 * module_mm * (shift + outwards), rounding(pitch));
  EXPECT_NEAR(gear.at("root_diameter_mm").get<double>(),
              pitch + 2.0 * module_mm * (shift - 1.25 * outwards), rounding(pitch));
  EXPECT_GT(gear.at("tip_thickness_mm"), 0.0);
  EXPECT_LT(gear.at("tip_thickness_mm"), std::numbers::pi * module_mm);
}

// --- analyze

struct Prototype {
  std::string name, file;
  double stated_ratio;                     ///< three decimals
  std::array<double, 3> zero_backlash_mm;  ///< four decimals
  std::array<double, 2> module_mm;
  std::array<int, 5> teeth;
  std::array<double, 5> shift;
};

void PrintTo(const Prototype& prototype, std::ostream* stream) { *stream << prototype.name; }

Prototype low_backlash() {
  return {.name = "LowBacklash",
          .file = "designs/low_backlash_prototype.toml",
          .stated_ratio = 95.907,
          .zero_backlash_mm = {16.2077, 16.1813, 16.1752},
          .module_mm = {0.59, 0.58},
          .teeth = {14, 40, 94, 36, 92},
          .shift = {0.5, 0.0, 0.45, 0.4, 0.29}};
}
Prototype bilateral() {
  return {.name = "Bilateral",
          .file = "designs/bilateral_drive_gear.toml",
          .stated_ratio = 96.242,
          .zero_backlash_mm = {21.2679, 21.2679, 21.2687},
          .module_mm = {0.8, 0.8467},
          .teeth = {12, 39, 90, 32, 81},
          .shift = {0.476, 0.762, 2.0, 0.536, 1.21}};
}

class PublishedPrototype : public testing::TestWithParam<Prototype> {};

TEST_P(PublishedPrototype, AnalysisHasEveryKeyOfTheContractWithItsType) {
  const json result = analysis_of(example(GetParam().file));
  expect_tool(result);
  expect_keys(result, {{"name", Type::kText},
                       {"ratio", Type::kNumber},
                       {"g1", Type::kNumber},
                       {"g2", Type::kNumber},
                       {"center_distance_mm", Type::kNumber},
                       {"efficiency", Type::kObject},
                       {"meshes", Type::kList},
                       {"gears", Type::kList},
                       {"backlash", Type::kObject},
                       {"assembly", Type::kObject},
                       {"checks", Type::kList}});
  expect_keys(
      result.at("efficiency"),
      {{"forward", Type::kNumber}, {"backward", Type::kNumber}, {"backdrivable", Type::kBoolean}});
  expect_keys(result.at("backlash"), {{"paper_arcmin", Type::kNumber},
                                      {"kinematic_arcmin", Type::kNumber},
                                      {"input_kinematic_arcmin", Type::kNumber}});
  expect_keys(result.at("assembly"), {{"equal_spacing", Type::kBoolean},
                                      {"identical_planets", Type::kBoolean},
                                      {"planet_phase_deg", Type::kList}});
  ASSERT_TRUE(result.contains("inertia"));
  EXPECT_TRUE(result.at("inertia").is_null()) << "neither face widths nor inertias are known";
  ASSERT_GT(result.at("checks").size(), 0U);
  for (const json& check : result.at("checks")) expect_check(check);
}

TEST_P(PublishedPrototype, RatioAndCentreDistancesAreThePublishedOnes) {
  const Prototype& p = GetParam();
  const json result = analysis_of(example(p.file));
  const auto& z = p.teeth;
  const double g1 = static_cast<double>(z[2]) / z[0];
  const double g2 = static_cast<double>(z[3]) * z[2] / (static_cast<double>(z[1]) * z[4]);
  EXPECT_NEAR(result.at("g1").get<double>(), g1, rounding(g1));
  EXPECT_NEAR(result.at("g2").get<double>(), g2, rounding(g2));
  EXPECT_NEAR(result.at("ratio").get<double>(), (1.0 + g1) / (1.0 - g2), 1e-10);
  EXPECT_NEAR(result.at("ratio").get<double>(), p.stated_ratio, half_unit(3));
  static constexpr std::array<const char*, 3> kMeshes{"S-P1", "P1-R1", "P2-R2"};
  ASSERT_EQ(result.at("meshes").size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const json& mesh = result.at("meshes")[k];
    expect_mesh(mesh);
    EXPECT_EQ(mesh.at("name"), kMeshes[k]);
    EXPECT_NEAR(mesh.at("zero_backlash_center_distance_mm").get<double>(), p.zero_backlash_mm[k],
                half_unit(4));
  }
  EXPECT_NEAR(result.at("center_distance_mm").get<double>(), p.zero_backlash_mm[1], half_unit(4))
      << "without center_distance_mm, that of mesh P1-R1";
}

TEST_P(PublishedPrototype, GearsHaveTheDiametersOfTheRack) {
  const Prototype& p = GetParam();
  const json result = analysis_of(example(p.file));
  static constexpr std::array<const char*, 5> kGears{"S", "P1", "R1", "P2", "R2"};
  ASSERT_EQ(result.at("gears").size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    const json& gear = result.at("gears")[k];
    EXPECT_EQ(gear.at("name"), kGears[k]);
    expect_gear(gear, p.module_mm[k < 3 ? 0 : 1], p.teeth[k], p.shift[k], k == 2 || k == 4);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, PublishedPrototype, testing::Values(low_backlash(), bilateral()),
                         [](const auto& param) { return param.param.name; });

TEST(Analyze, LowBacklashPrototypeHasThePublishedEfficienciesByEitherLossModel) {
  struct Case {
    const char* model;
    double forward, backward;
    int decimals;
  };
  const std::string at_mesh2 = replaced(example(low_backlash().file), "planets = 3\n",
                                        "planets = 3\ncenter_distance_mm = 16.1813\n");
  for (const Case& c : {Case{"ohlendorf", 0.8761, 0.8630, 4}, Case{"sliding", 0.881, 0.869, 3}}) {
    const json result = analysis_of(replaced(at_mesh2, "sliding", c.model));
    const json& efficiency = result.at("efficiency");
    EXPECT_NEAR(efficiency.at("forward").get<double>(), c.forward, half_unit(c.decimals))
        << c.model;
    EXPECT_NEAR(efficiency.at("backward").get<double>(), c.backward, half_unit(c.decimals))
        << c.model;
    EXPECT_EQ(efficiency.at("backdrivable"), true);
    EXPECT_EQ(result.at("center_distance_mm"), 16.1813);
  }
}

TEST(Analyze, LowBacklashPrototypeFitsThreePlanetsAThirdOfADegreeApart) {
  const json assembly = analysis_of(example(low_backlash().file)).at("assembly");
  EXPECT_EQ(assembly.at("equal_spacing"), true);
  EXPECT_EQ(assembly.at("identical_planets"), false);
  ASSERT_EQ(assembly.at("planet_phase_deg").size(), 3U);
  std::vector<double> phases;
  for (const json& phase : assembly.at("planet_phase_deg")) {
    phases.push_back(std::fmod(phase.get<double>() + 1.0 + 1e-9, 1.0));
  }
  std::sort(phases.begin(), phases.end());
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(phases[k], static_cast<double>(k) / 3.0, 1e-8);
  }
}

TEST(Analyze, BilateralDriveGearFitsThreeIdenticalPlanets) {
  const json assembly = analysis_of(example(bilateral().file)).at("assembly");
  EXPECT_EQ(assembly.at("equal_spacing"), true);
  EXPECT_EQ(assembly.at("identical_planets"), true);
}

TEST(Analyze, NegativeBacklashIsAFailedCheckNotAnError) {
  // At mesh P1-R1's distance the two others interfere, one of them by 20 um.
  const json result = analysis_of(example(low_backlash().file));
  std::map<std::string, double> interference_um;
  for (const json& check : result.at("checks")) {
    if (check.at("name") != "normal_backlash" || check.at("ok") == true) continue;
    EXPECT_EQ(check.at("unit"), "um");
    interference_um[check.at("mesh").get<std::string>()] = -check.at("margin").get<double>();
  }
  ASSERT_EQ(interference_um.size(), 2U);
  EXPECT_NEAR(interference_um.at("S-P1"), 20.0, half_unit(0));
  EXPECT_GT(interference_um.at("P2-R2"), 0.0);
  EXPECT_NEAR(result.at("meshes")[0].at("normal_backlash_um").get<double>(),
              -interference_um.at("S-P1"), 1e-9);
  EXPECT_NEAR(result.at("meshes")[2].at("normal_backlash_um").get<double>(),
              -interference_um.at("P2-R2"), 1e-9);
}

TEST(Analyze, InertiaIsKineticEnergyWhenAllBodiesAreKnown) {
  constexpr double kSun = 1e-6, kStep1 = 4e-6, kStep2 = 3e-6, kMass = 0.08, kCarrier = 5e-5,
                   kRing2 = 9e-4;
  const json result = analysis_of(example(bilateral().file) +
                                  "[inertia]\nS_kgm2 = 1e-6\nP1_kgm2 = 4e-6\nP2_kgm2 = 3e-6\n"
                                  "planet_mass_kg = 0.08\ncarrier_kgm2 = 5e-5\nR2_kgm2 = 9e-4\n");
  const json& inertia = result.at("inertia");
  expect_keys(inertia, {{"backward_kgm2", Type::kNumber},
                        {"forward_kgm2", Type::kNumber},
                        {"lossless_kgm2", Type::kNumber},
                        {"paper_kgm2", Type::kNumber}});
  // Speeds for an output speed of 1: R1 is at rest.
  const auto sun = result.at("ratio").get<double>();
  const double carrier = sun / (1.0 + 90.0 / 12.0);
  const double planet = carrier * (1.0 - 90.0 / 39.0);
  const double orbit = carrier * 1e-3 * result.at("center_distance_mm").get<double>();
  const double expected = kSun * sun * sun +
                          3.0 * ((kStep1 + kStep2) * planet * planet + kMass * orbit * orbit) +
                          kCarrier * carrier * carrier + kRing2;
  EXPECT_NEAR(inertia.at("lossless_kgm2").get<double>(), expected, 1e-11 * expected);
  EXPECT_NE(inertia.at("backward_kgm2"), inertia.at("lossless_kgm2"));
}

TEST(Analyze, StrictEndsWithThreeWhenACheckFailsAndPrintsTheResultAllTheSame) {
  const Workplace place;
  place.write("gear.toml", example(low_backlash().file));
  const ProgramResult loose = place.run({"analyze", "gear.toml"});
  const ProgramResult strict = place.run({"analyze", "gear.toml", "--strict"});
  EXPECT_EQ(loose.exit_code, 0);
  EXPECT_EQ(strict.exit_code, 3);
  EXPECT_EQ(strict.out, loose.out);
  EXPECT_NE(strict.out.find("FAILED"), std::string::npos);
}

TEST(Analyze, StrictEndsWithZeroWhenEveryCheckPasses) {
  const Workplace place;
  place.write("gear.toml", example(bilateral().file));
  EXPECT_EQ(place.run({"analyze", "gear.toml", "--strict"}).exit_code, 0);
}

// 16 um of thinning a tooth leave play at 20 C; plastic planets that are 3 mm/m larger do not.
TEST(Analyze, StrictRefusesAPlasticGearThatJamsWhenItIsWarm) {
  const Workplace place;
  std::string text = example(bilateral().file);
  for (std::size_t at = text.find("teeth = "); at != std::string::npos;
       at = text.find("teeth = ", at + 40)) {
    text.insert(at, "machining_allowance = 0.02\n");
  }
  place.write("cold.toml", text);
  EXPECT_EQ(place.run({"analyze", "cold.toml", "--strict"}).exit_code, 0);
  const std::string steel_but =
      "S.expansion_1_k = 11e-6\nR1.expansion_1_k = 20e-6\nR2.expansion_1_k = 20e-6\n"
      "carrier.expansion_1_k = 11e-6\nP1.expansion_1_k = 90e-6\nP2.expansion_1_k = 90e-6\n";
  place.write("warm.toml", text + "\n[thermal]\ntemperature_c = [20.0, 60.0]\n" + steel_but);
  const ProgramResult warm = place.run({"analyze", "warm.toml", "--strict", "--full"});
  EXPECT_EQ(warm.exit_code, 3) << warm.err;
  const std::string first = place.run({"analyze", "warm.toml"}).out;
  EXPECT_NE(first.find("  temperature  least backlash -"), std::string::npos) << first;
  EXPECT_NE(first.find("none, above: "), std::string::npos) << first;
  for (const char* said : {"S-P1 at 60 C", "first jams below at", "thermal_backlash"}) {
    EXPECT_NE(warm.out.find(said), std::string::npos) << said;
  }
  const ProgramResult loose = place.run({"analyze", "warm.toml", "--format", "json"});
  EXPECT_EQ(loose.exit_code, 0);
  const json result = json::parse(loose.out);
  const json& thermal = result.at("thermal");
  ASSERT_EQ(thermal.at("states").size(), 3U);
  EXPECT_EQ(thermal.at("states")[2].at("temperature_c"), 60.0);
  EXPECT_GT(thermal.at("states")[1].at("meshes")[0].at("least_backlash_um"), 0.0);
  EXPECT_LT(thermal.at("states")[2].at("meshes")[0].at("least_backlash_um"), 0.0);
  const auto jams_c = thermal.at("jams")[0].at("above_c").get<double>();
  EXPECT_GT(jams_c, 20.0);
  EXPECT_LT(jams_c, 60.0);
}

TEST(Analyze, TableSaysThatTheCentreDistanceWasChosenByTheProgram) {
  const Workplace place;
  place.write("free.toml", example(bilateral().file));
  place.write("given.toml", replaced(example(bilateral().file), "planets = 3\n",
                                     "planets = 3\ncenter_distance_mm = 21.268\n"));
  const std::string note = "zero-backlash distance";
  const std::string free = place.run({"analyze", "free.toml", "--full"}).out;
  const std::string given = place.run({"analyze", "given.toml", "--full"}).out;
  const auto line_of = [](const std::string& text) {
    for (const std::string& line : lines_of(text)) {
      if (line.find("centre distance") != std::string::npos) return line;
    }
    return std::string();
  };
  EXPECT_NE(line_of(free).find(note), std::string::npos) << line_of(free);
  EXPECT_NE(line_of(given).find("21.2680 mm"), std::string::npos) << line_of(given);
  EXPECT_EQ(line_of(given).find(note), std::string::npos) << line_of(given);
}

TEST(Analyze, SensitivitiesForetellWhatAChangedFileGives) {
  const std::string text = example(bilateral().file);
  const json before = analysis_of(text);
  const json after = analysis_of(
      replaced(text, "profile_shift = 0.536", "profile_shift = 0.5361"));  // P2, one step/100
  const json& rows = before.at("sensitivities");
  ASSERT_GT(rows.size(), 15U);
  const auto row = std::ranges::find_if(
      rows, [](const json& r) { return r.at("input") == "gears.P2.profile_shift"; });
  ASSERT_NE(row, rows.end());
  expect_keys(*row, {{"unit", Type::kText},
                     {"stated", Type::kBoolean},
                     {"value", Type::kNumber},
                     {"step", Type::kNumber},
                     {"d_eta_f", Type::kNumber},
                     {"d_eta_b", Type::kNumber},
                     {"d_lost_motion_arcmin", Type::kNumber},
                     {"d_margin", Type::kList}});
  EXPECT_EQ(row->at("value"), 0.536);
  // The rest of the series, at a hundredth of the step, is far below a percent of the change.
  const auto expect_foretold = [&](const char* field, const char* group, const char* number) {
    const double change =
        after.at(group).at(number).get<double>() - before.at(group).at(number).get<double>();
    EXPECT_NEAR(row->at(field).get<double>() * 1e-4, change, 1e-2 * std::abs(change)) << field;
  };
  expect_foretold("d_eta_f", "efficiency", "forward");
  expect_foretold("d_eta_b", "efficiency", "backward");
  expect_foretold("d_lost_motion_arcmin", "backlash", "kinematic_arcmin");
  ASSERT_EQ(before.at("tightest_checks").size(), 5U);
  EXPECT_EQ(row->at("d_margin").size(), 5U);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto effect = [&](std::size_t k) {
      return std::abs(rows[k].at("d_eta_b").get<double>() * rows[k].at("step").get<double>());
    };
    EXPECT_GE(effect(i - 1), effect(i)) << rows[i].at("input");
  }
}

TEST(Analyze, TableHasTheSensitivitiesAndWhatMovesTheTightestChecks) {
  const Workplace place;
  place.write("gear.toml", example(bilateral().file));
  const std::string table = place.run({"analyze", "gear.toml", "--full"}).out;
  const auto sensitivities = table.find("\nSensitivities (");
  const auto tightest = table.find("\nTightest checks (");
  ASSERT_NE(sensitivities, std::string::npos);
  ASSERT_NE(tightest, std::string::npos);
  for (const char* input : {"friction.coefficient ", "gears.R1.profile_shift ",
                            "center_distance_mm (not stated) ", "stage2.module_mm "}) {
    const auto at = table.find(input, sensitivities);
    EXPECT_LT(at, tightest) << input;
  }
}

// --- mesh

TEST(Mesh, PairHasTheMeshGearsAndChecksOfAnAnalysis) {
  const Workplace place;
  place.write("pair.toml", example("pair_internal.toml"));
  const json result = json_of(place, {"mesh", "pair.toml", "--format", "json"});
  expect_tool(result);
  expect_keys(result, {{"meshes", Type::kList}, {"gears", Type::kList}, {"checks", Type::kList}});
  ASSERT_EQ(result.at("meshes").size(), 1U);
  const json& mesh = result.at("meshes")[0];
  expect_mesh(mesh);
  ASSERT_EQ(result.at("gears").size(), 2U);
  expect_gear(result.at("gears")[0], 3.0, 16, 0.0, false);
  expect_gear(result.at("gears")[1], 3.0, 24, 0.5, true);
  for (const json& check : result.at("checks")) expect_check(check);
  // inv alpha_w = inv alpha + 2 tan alpha (x2 - x1)/(z2 - z1),  a = m (z2 - z1)/2 cos/cos.
  const double alpha = 20.0 * kDegree;
  const double working = mesh.at("working_pressure_angle_deg").get<double>() * kDegree;
  EXPECT_NEAR(std::tan(working) - working,
              std::tan(alpha) - alpha + 2.0 * std::tan(alpha) * 0.5 / 8.0, 1e-13);
  EXPECT_NEAR(mesh.at("zero_backlash_center_distance_mm").get<double>(),
              12.0 * std::cos(alpha) / std::cos(working), 1e-11);
}

// --- formats and destinations

struct Printing {
  std::string command, file, content;
};

std::vector<Printing> printing_commands() {
  return {{"analyze", "gear.toml", example(bilateral().file)},
          {"mesh", "pair.toml", example("pair_internal.toml")},
          {"search", "spec.toml", example("rp96.toml")},
          {"reproduce", "", ""}};
}

std::vector<std::string> arguments_of(const Printing& p, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{p.command};
  if (!p.file.empty()) arguments.push_back(p.file);
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class EveryFormat : public testing::TestWithParam<std::string> {};

TEST_P(EveryFormat, OutHoldsTheBytesThatStdoutWouldGet) {
  for (const Printing& p : printing_commands()) {
    const Workplace place;
    if (!p.file.empty()) place.write(p.file, p.content);
    const ProgramResult printed = place.run(arguments_of(p, {"--format", GetParam()}));
    const ProgramResult written =
        place.run(arguments_of(p, {"--format", GetParam(), "--out", "result"}));
    EXPECT_EQ(printed.exit_code, 0) << printed.err;
    EXPECT_EQ(written.exit_code, 0) << written.err;
    EXPECT_TRUE(printed.out.ends_with('\n')) << p.command;
    EXPECT_EQ(written.out, "") << p.command;
    EXPECT_EQ(place.read("result"), printed.out) << p.command;
    EXPECT_EQ(place.listing().size(), p.file.empty() ? 1U : 2U) << "a temporary file is left";
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryFormat, testing::Values("table", "json", "csv"),
                         [](const auto& param) { return param.param; });

TEST(Formats, TableIsTheDefault) {
  for (const Printing& p : printing_commands()) {
    const Workplace place;
    if (!p.file.empty()) place.write(p.file, p.content);
    EXPECT_EQ(place.run(arguments_of(p, {})).out,
              place.run(arguments_of(p, {"--format", "table"})).out)
        << p.command;
  }
}

TEST(Formats, JsonParsesAndCsvHasARectangle) {
  for (const Printing& p : printing_commands()) {
    const Workplace place;
    if (!p.file.empty()) place.write(p.file, p.content);
    EXPECT_TRUE(json::accept(place.run(arguments_of(p, {"--format", "json"})).out)) << p.command;
    const std::string csv = place.run(arguments_of(p, {"--format", "csv"})).out;
    io::CsvTable table;
    EXPECT_NO_THROW(table = io::parse_csv(csv, p.command));
    EXPECT_GT(table.header.size(), 1U) << p.command;
    EXPECT_GT(table.rows.size(), 0U) << p.command;
  }
}

TEST(Formats, CsvAndJsonOfAnAnalysisAgree) {
  const Workplace place;
  place.write("gear.toml", example(bilateral().file));
  const json result = json_of(place, {"analyze", "gear.toml", "--format", "json"});
  const io::CsvTable csv =
      io::parse_csv(place.run({"analyze", "gear.toml", "--format", "csv"}).out, "csv");
  const auto value = [&](const std::string& item, const std::string& quantity) {
    for (const auto& row : csv.rows) {
      if (csv.text(row, "item") == item && csv.text(row, "quantity") == quantity) {
        return csv.number(row, "value").value_or(std::nan(""));
      }
    }
    return std::nan("");
  };
  EXPECT_EQ(value("train", "ratio"), result.at("ratio").get<double>());
  EXPECT_EQ(value("train", "efficiency_backward"),
            result.at("efficiency").at("backward").get<double>());
  EXPECT_EQ(value("P2-R2", "contact_ratio"),
            result.at("meshes")[2].at("contact_ratio").get<double>());
  EXPECT_EQ(value("R2", "root_diameter"),
            result.at("gears")[4].at("root_diameter_mm").get<double>());
  const json& most = result.at("sensitivities")[0];
  EXPECT_EQ(value(most.at("input").get<std::string>(), "d_eta_b"),
            most.at("d_eta_b").get<double>());
}

TEST(Quiet, PrintsNothingOnStderrWhenAllIsWell) {
  for (const Printing& p : printing_commands()) {
    const Workplace place;
    if (!p.file.empty()) place.write(p.file, p.content);
    const ProgramResult result = place.run(arguments_of(p, {"--quiet"}));
    EXPECT_EQ(result.exit_code, 0) << p.command;
    EXPECT_EQ(result.err, "") << p.command;
    EXPECT_NE(result.out, "") << p.command;
  }
}

TEST(FullDevice, IsAnErrorNotSilence) {
  const Workplace place;
  place.write("gear.toml", example(bilateral().file));
  place.write("pair.toml", example("pair_internal.toml"));
  place.write("spec.toml", example("rp96.toml"));
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"analyze", "gear.toml"},
        {"mesh", "pair.toml", "--format", "json"},
        {"search", "spec.toml", "--format", "csv", "--quiet"},
        {"reproduce"},
        {"keys"},
        {"new", "task"},
        {"manual"},
        {"completion"},
        {"optimize", "spec.toml", "--out", "out", "--quiet"},
        {"--help"}}) {
    const ProgramResult result = place.run(arguments, "/dev/full");
    EXPECT_EQ(result.signal, 0) << arguments[0];
    EXPECT_NE(result.exit_code, 0) << arguments[0];
    EXPECT_NE(result.err.find("stdout"), std::string::npos) << arguments[0] << ": " << result.err;
  }
}

TEST(FullDevice, AsAFileIsAnErrorThatNamesIt) {
  const Workplace place;
  place.write("gear.toml", example(bilateral().file));
  const ProgramResult result = place.run({"analyze", "gear.toml", "--out", "/dev/full/x"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("/dev/full/x: cannot be written"), std::string::npos) << result.err;
}

// --- help and keys

/// Paths of the keys in one table of docs/keys.md.
std::vector<std::string> documented_keys(const std::string& file_kind) {
  const std::string all =
      test::read_text(std::filesystem::path(GEAR3K_SOURCE_DIR) / "docs/keys.md");
  std::vector<std::string> keys;
  bool inside = false;
  for (const std::string& line : lines_of(all)) {
    if (line.starts_with("## ")) inside = line == "## " + file_kind;
    if (!inside || !line.starts_with("| `")) continue;
    keys.push_back(line.substr(3, line.find('`', 3) - 3));
  }
  return keys;
}

TEST(Help, OfEveryCommandSaysWhereItsKeysAre) {
  struct Command {
    std::string name, file_kind;
  };
  const Workplace place;
  for (const Command& c :
       {Command{"analyze", "DESIGN.toml"}, Command{"mesh", "PAIR.toml"},
        Command{"search", "SPEC.toml"}, Command{"optimize", "SPEC.toml"},
        Command{"actuator", "ACTUATOR.toml"}, Command{"map", "DESIGN.toml"},
        Command{"tolerances", "DESIGN.toml"}, Command{"simulate", "SCENARIO.toml"}}) {
    const ProgramResult result = place.run({c.name, "--help"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_NE(result.out.find("Keys of " + c.file_kind), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("gear3k keys WORD"), std::string::npos) << result.out;
    for (const char* option : {"--format", "--quiet", "--threads", "--out", "--help"}) {
      EXPECT_NE(result.out.find(option), std::string::npos) << c.name << ": " << option;
    }
  }
  const std::string keys = place.run({"keys"}).out;
  for (const std::string file_kind : {"DESIGN.toml", "PAIR.toml", "SPEC.toml"}) {
    const auto documented = documented_keys(file_kind);
    EXPECT_GT(documented.size(), 10U) << file_kind;
    for (const std::string& key : documented) {
      EXPECT_NE(keys.find("`" + key + "`"), std::string::npos) << file_kind << ": " << key;
    }
  }
  EXPECT_EQ(place.listing().size(), 0U);
}

TEST(Help, OfTheProgramNamesEveryCommandAndTheExitCodesAndThatOfACommandFitsAScreen) {
  const Workplace place;
  const ProgramResult result = place.run({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* word : {"analyze", "mesh", "search", "optimize", "reproduce", "0 done",
                           "1 usage", "2 invalid input", "3 no feasible design"}) {
    EXPECT_NE(result.out.find(word), std::string::npos) << word;
  }
  EXPECT_LE(lines_of(result.out).size(), 30U) << result.out;
  for (const std::string& line : lines_of(result.out)) EXPECT_LE(line.size(), 100U) << line;
  for (const char* command :
       {"analyze", "mesh", "compare", "search", "optimize", "map", "tolerances", "diagnose",
        "export", "actuator", "reproduce", "simulate", "sweep", "atlas", "new", "keys", "manual",
        "completion"}) {
    const ProgramResult help = place.run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_LE(lines_of(help.out).size(), 25U) << command;
    for (const std::string& line : lines_of(help.out)) EXPECT_LE(line.size(), 100U) << line;
  }
}

TEST(Keys, AreTheDocumentedOnes) {
  const ProgramResult result = Workplace().run({"keys"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out, test::read_text(std::filesystem::path(GEAR3K_SOURCE_DIR) / "docs/keys.md"));
}

TEST(Version, IsOneLine) {
  const ProgramResult result = Workplace().run({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(lines_of(result.out).size(), 1U);
  EXPECT_TRUE(result.out.starts_with("gear3k ")) << result.out;
}

// --- search

TEST(Search, OfRp96HasARowForEachOfThe654ToothSets) {
  const Workplace place;
  place.write("spec.toml", example("rp96.toml"));
  const ProgramResult result = place.run({"search", "spec.toml", "--format", "csv"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const io::CsvTable csv = io::parse_csv(result.out, "csv");
  EXPECT_EQ(csv.rows.size(), 654U);
  std::set<std::vector<std::string>> different;
  for (const auto& row : csv.rows) {
    std::vector<std::string> teeth(row.fields.begin(), row.fields.begin() + 5);
    EXPECT_TRUE(different.insert(teeth).second) << "line " << row.line << " repeats a set";
    const double ratio = csv.number(row, "ratio").value_or(0.0);
    EXPECT_LE(std::abs(ratio / 96.2 - 1.0), 0.005) << "line " << row.line;
  }
  const json counted = json_of(place, {"search", "spec.toml", "--format", "json"});
  EXPECT_EQ(counted.at("search").at("candidates"), 654);
  EXPECT_EQ(counted.at("sets").size(), 654U);
}

TEST(Search, RejectionCountsAddUp) {
  const Workplace place;
  place.write("spec.toml", example("rp96.toml"));
  const json search = json_of(place, {"search", "spec.toml", "--format", "json"}).at("search");
  long long rejected = 0;
  for (const auto& [reason, count] : search.at("rejected").items()) {
    EXPECT_NE(reason, "");
    rejected += count.get<long long>();
  }
  EXPECT_EQ(search.at("within_ratio").get<long long>(),
            search.at("candidates").get<long long>() + rejected);
}

TEST(Search, TopLimitsTheTable) {
  const Workplace place;
  place.write("spec.toml", example("rp96.toml"));
  const auto all = lines_of(place.run({"search", "spec.toml", "--top", "1000"}).out);
  const auto five = lines_of(place.run({"search", "spec.toml", "--top", "5"}).out);
  EXPECT_GT(all.size(), 654U);
  EXPECT_LT(five.size(), 12U);
}

// --- optimize

constexpr const char* kRefinedColumns =
    "zS,zP1,zR1,zP2,zR2,status,reason,ratio,eta_b,eta_f,backlash_arcmin,xS,xP1,xR1,xP2,xR2,m1_mm,"
    "m2_mm,center_distance_mm,eps1,eps2,eps3,eta_b_bound,kkt_residual";

const std::vector<std::string> kResultFiles{"best.toml", "pareto.csv", "refined.csv",
                                            "summary.json"};

/// Names of what a folder holds, sorted.
std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// examples/ratio-96.toml over few tooth sets.
std::string small_task() {
  return replaced(replaced(replaced(example("ratio-96.toml"), "S = [10, 24]", "S = [13, 14]"),
                           "P1 = [18, 70]", "P1 = [40, 60]"),
                  "P2 = [18, 70]", "P2 = [30, 60]");
}

TEST(Optimize, OfRp96WritesTheFourFilesAndReachesTheReferenceValues) {
  const Workplace place;
  place.write("spec.toml", example("rp96.toml"));
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(names_in(place.file("out")), kResultFiles);
  const io::CsvTable refined = io::parse_csv(place.read("out/refined.csv"), "refined.csv");
  EXPECT_EQ(refined.rows.size(), 654U);
  std::size_t feasible = 0;
  double best = 0.0;
  for (const auto& row : refined.rows) {
    if (refined.text(row, "status") != "optimal") continue;
    ++feasible;
    best = std::max(best, refined.number(row, "eta_b").value_or(0.0));
  }
  EXPECT_GE(feasible, 428U);
  EXPECT_GE(best, 0.94340);
}

TEST(Optimize, RowsOfRefinedCsvFollowTheContract) {
  static const std::set<std::string> kStatus{"optimal", "no_feasible_found", "infeasible",
                                             "bounded", "failed"};
  const Workplace place;
  place.write("spec.toml", small_task());
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "out", "--quiet"}).exit_code, 0);
  for (const char* file : {"out/refined.csv", "out/pareto.csv"}) {
    const std::string text = place.read(file);
    const std::string header = lines_of(text).front();
    EXPECT_TRUE(header == kRefinedColumns || header.starts_with(std::string(kRefinedColumns) + ","))
        << header;
    const io::CsvTable table = io::parse_csv(text, file);
    EXPECT_GT(table.rows.size(), 0U);
    for (const auto& row : table.rows) {
      const std::string status = table.text(row, "status").value_or("");
      EXPECT_TRUE(kStatus.contains(status)) << file << ":" << row.line << ": " << status;
      const bool optimal = status == "optimal";
      EXPECT_NE(table.text(row, "reason").has_value(), optimal) << file << ":" << row.line;
      for (const char* column : {"eta_b", "eta_f", "backlash_arcmin", "xS", "xR2", "m1_mm", "m2_mm",
                                 "center_distance_mm", "eps1", "eps2", "eps3", "kkt_residual"}) {
        EXPECT_EQ(table.number(row, column).has_value(), optimal)
            << file << ":" << row.line << ": " << column;
      }
      const auto z = [&](const char* column) { return table.number(row, column).value_or(0.0); };
      const double ratio =
          (1.0 + z("zR1") / z("zS")) / (1.0 - z("zP2") * z("zR1") / (z("zP1") * z("zR2")));
      EXPECT_NEAR(z("ratio"), ratio, 1e-10) << file << ":" << row.line;
      if (!optimal) continue;
      // Limits of the task, each within 1e-6 of its scale.
      constexpr double kFeasible = 1e-6;
      EXPECT_LE(z("backlash_arcmin"), 8.0 * (1.0 + kFeasible));
      for (const char* epsilon : {"eps1", "eps2", "eps3"}) {
        EXPECT_GE(z(epsilon), 1.2 - kFeasible);
        EXPECT_LE(z(epsilon), 2.5 + kFeasible);
      }
      for (const char* module : {"m1_mm", "m2_mm"}) {
        EXPECT_GE(z(module), 0.5 - kFeasible);
        EXPECT_LE(z(module), 1.0 + kFeasible);
      }
      for (const char* shift : {"xS", "xP1", "xR1", "xP2", "xR2"}) {
        EXPECT_GE(z(shift), 0.0 - kFeasible);
        EXPECT_LE(z(shift), 1.0 + kFeasible);
      }
    }
  }
}

TEST(Optimize, ParetoRowsAreRefinedRowsAndNoneBeatsAnother) {
  const Workplace place;
  place.write("spec.toml", small_task());
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "out", "--quiet"}).exit_code, 0);
  const auto refined_lines = lines_of(place.read("out/refined.csv"));
  const std::set<std::string> refined(refined_lines.begin(), refined_lines.end());
  for (const std::string& line : lines_of(place.read("out/pareto.csv"))) {
    EXPECT_TRUE(refined.contains(line)) << line;
  }
  const io::CsvTable pareto = io::parse_csv(place.read("out/pareto.csv"), "pareto.csv");
  const auto costs = [&](const io::CsvTable::Row& row) {
    return std::array<double, 4>{-pareto.number(row, "eta_b").value(),
                                 -pareto.number(row, "eta_f").value(),
                                 pareto.number(row, "backlash_arcmin").value(),
                                 pareto.number(row, "ring_root_diameter_mm").value()};
  };
  for (const auto& a : pareto.rows) {
    for (const auto& b : pareto.rows) {
      if (a.line == b.line) continue;
      const bool no_worse = std::ranges::equal(costs(a), costs(b), std::less_equal<>());
      EXPECT_FALSE(no_worse) << "line " << a.line << " beats or equals line " << b.line;
    }
  }
}

TEST(Optimize, SummaryCountsEverySetAndSaysHowTheRunWasMade) {
  const Workplace place;
  place.write("spec.toml", replaced(small_task(), "seed = 1", "seed = 77"));
  ASSERT_EQ(
      place.run({"optimize", "spec.toml", "--out", "out", "--threads", "2", "--quiet"}).exit_code,
      0);
  const json summary = json::parse(place.read("out/summary.json"));
  expect_tool(summary);
  expect_keys(summary, {{"status", Type::kObject},
                        {"reasons", Type::kObject},
                        {"wall_time_s", Type::kNumber},
                        {"threads", Type::kInteger},
                        {"seed", Type::kInteger}});
  EXPECT_EQ(summary.at("seed"), 77);
  EXPECT_EQ(summary.at("threads"), 2);
  EXPECT_GT(summary.at("wall_time_s"), 0.0);
  std::map<std::string, std::size_t> status, reasons;
  const io::CsvTable refined = io::parse_csv(place.read("out/refined.csv"), "refined.csv");
  for (const auto& row : refined.rows) {
    const std::string word = refined.text(row, "status").value_or("");
    ++status[word];
    if (word != "optimal") ++reasons[word + " " + refined.text(row, "reason").value_or("")];
  }
  for (const char* word : {"optimal", "no_feasible_found", "infeasible", "bounded", "failed"}) {
    EXPECT_EQ(summary.at("status").at(word), status[word]) << word;
  }
  std::size_t listed = 0;
  for (const auto& [word, counts] : summary.at("reasons").items()) {
    for (const auto& [reason, count] : counts.items()) {
      std::string key = word;
      key += " " + reason;
      EXPECT_EQ(count, reasons[key]) << key;
      ++listed;
    }
  }
  EXPECT_EQ(listed, reasons.size());
}

TEST(Optimize, BestDesignPassesEveryCheckWhenReadBackAndIsTheBestRow) {
  const Workplace place;
  place.write("spec.toml", small_task());
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "out", "--quiet"}).exit_code, 0);
  const ProgramResult again =
      place.run({"analyze", "out/best.toml", "--strict", "--format", "json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json analysis = json::parse(again.out);
  const io::CsvTable refined = io::parse_csv(place.read("out/refined.csv"), "refined.csv");
  const io::CsvTable::Row* best = nullptr;
  for (const auto& row : refined.rows) {
    if (refined.text(row, "status") != "optimal") continue;
    if (best == nullptr || *refined.number(row, "eta_b") > *refined.number(*best, "eta_b")) {
      best = &row;
    }
  }
  ASSERT_NE(best, nullptr);
  static constexpr std::array<const char*, 5> kTeeth{"zS", "zP1", "zR1", "zP2", "zR2"};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(analysis.at("gears")[k].at("teeth").get<double>(), *refined.number(*best, kTeeth[k]));
  }
  EXPECT_NEAR(analysis.at("efficiency").at("backward").get<double>(),
              *refined.number(*best, "eta_b"), 1e-12);
  EXPECT_NEAR(analysis.at("efficiency").at("forward").get<double>(),
              *refined.number(*best, "eta_f"), 1e-12);
  EXPECT_NEAR(analysis.at("backlash").at("kinematic_arcmin").get<double>(),
              *refined.number(*best, "backlash_arcmin"), 1e-7);
  // Every limit that the task states is among the checks of the file.
  std::set<std::string> names;
  for (const json& check : analysis.at("checks")) names.insert(check.at("name").get<std::string>());
  for (const char* name :
       {"undercut", "tip_thickness", "involute_interference", "planet_gap", "contact_ratio_min",
        "contact_ratio_max", "normal_backlash", "output_backlash_max", "ring_root_diameter",
        "equal_spacing", "identical_planets"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
}

TEST(Optimize, MaximisesTheObjectiveThatWasAskedFor) {
  const Workplace place;
  place.write("spec.toml", replaced(small_task(), "backward_efficiency", "forward_efficiency"));
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "out", "--quiet"}).exit_code, 0);
  const io::CsvTable refined = io::parse_csv(place.read("out/refined.csv"), "refined.csv");
  double best = 0.0;
  for (const auto& row : refined.rows) {
    best = std::max(best, refined.number(row, "eta_f").value_or(0.0));
  }
  const json analysis = json_of(place, {"analyze", "out/best.toml", "--format", "json"});
  EXPECT_NEAR(analysis.at("efficiency").at("forward").get<double>(), best, 1e-12);
}

TEST(Optimize, FilesDoNotDependOnTheNumberOfThreads) {
  const Workplace place;
  place.write("spec.toml", example("rp96.toml"));
  std::vector<json> summaries;
  for (const char* threads : {"1", "2", "4"}) {
    const std::string folder = std::string("out") + threads;
    const ProgramResult result =
        place.run({"optimize", "spec.toml", "--out", folder, "--threads", threads, "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    for (const char* file : {"best.toml", "refined.csv", "pareto.csv"}) {
      EXPECT_TRUE(place.read(folder + "/" + file) == place.read(std::string("out1/") + file))
          << file << " differs at " << threads << " threads";
    }
    summaries.push_back(json::parse(place.read(folder + "/summary.json")));
    EXPECT_EQ(summaries.back().at("threads"), std::stoi(threads));
    summaries.back().erase("wall_time_s");
    summaries.back().erase("threads");
    EXPECT_EQ(summaries.back(), summaries.front()) << threads;
  }
}

TEST(Optimize, MakesTheFolderWithItsParentsAndReplacesTheFilesOfAnEarlierRun) {
  const Workplace place;
  place.write("spec.toml", small_task());
  const std::vector<std::string> arguments{"optimize", "spec.toml", "--out", "a/b/out", "--quiet"};
  ASSERT_EQ(place.run(arguments).exit_code, 0);
  EXPECT_EQ(names_in(place.file("a/b/out")), kResultFiles);
  const std::string best = place.read("a/b/out/best.toml");
  for (const std::string& name : kResultFiles) place.write("a/b/out/" + name, "earlier");
  std::vector<std::string> again = arguments;
  again.emplace_back("--force");
  ASSERT_EQ(place.run(again).exit_code, 0);
  EXPECT_EQ(names_in(place.file("a/b/out")), kResultFiles);
  EXPECT_EQ(place.read("a/b/out/best.toml"), best);
  for (const std::string& name : kResultFiles) {
    EXPECT_NE(place.read("a/b/out/" + name), "earlier") << name;
  }
}

TEST(Optimize, PrintsTheBestDesignAndThePathsOfItsFiles) {
  const Workplace place;
  place.write("spec.toml", small_task());
  const ProgramResult table = place.run({"optimize", "spec.toml", "--out", "out"});
  ASSERT_EQ(table.exit_code, 0);
  EXPECT_NE(table.err, "") << "counts of sets by status are talk";
  EXPECT_NE(table.out.find("out: "), std::string::npos);
  for (const std::string& name : kResultFiles) {
    EXPECT_NE(table.out.find(name), std::string::npos) << name;
  }
  const std::string analysis = place.run({"analyze", "out/best.toml"}).out;
  EXPECT_TRUE(table.out.starts_with(analysis));
  const ProgramResult csv =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--quiet", "--format", "csv"});
  EXPECT_EQ(csv.out, place.read("out/refined.csv"));
  EXPECT_EQ(csv.err, "");
  const ProgramResult summary = place.run(
      {"optimize", "spec.toml", "--out", "out", "--force", "--quiet", "--format", "json"});
  EXPECT_EQ(summary.out, place.read("out/summary.json"));
}

// --- Ctrl-C

using std::chrono::milliseconds, std::chrono::seconds;

/// Runs a task, interrupts it while it works, and waits for its end.
std::optional<ProgramResult> interrupted(const Workplace& place,
                                         const std::vector<std::string>& arguments,
                                         milliseconds working, milliseconds limit) {
  RunningProgram program = place.start(arguments);
  if (!program.wait_until_it_catches(SIGINT, seconds(10))) {
    ADD_FAILURE() << "no handler for Ctrl-C";
    return std::nullopt;
  }
  std::this_thread::sleep_for(working);
  program.send(SIGINT);
  return program.wait(limit);
}

/// Files of an interrupted run in out/: each whole, all of the same run.
void expect_consistent_files(const Workplace& place) {
  const json summary = json::parse(place.read("out/summary.json"));
  const io::CsvTable refined = io::parse_csv(place.read("out/refined.csv"), "refined.csv");
  const io::CsvTable pareto = io::parse_csv(place.read("out/pareto.csv"), "pareto.csv");
  EXPECT_EQ(summary.at("interrupted"), true);
  // Sets that are proven infeasible have rows without having been refined.
  const auto solved = std::ranges::count_if(
      refined.rows, [&](const auto& row) { return refined.text(row, "status") != "infeasible"; });
  EXPECT_EQ(summary.at("refined"), solved);
  EXPECT_LT(summary.at("refined").get<long long>(),
            summary.at("search").at("candidates").get<long long>());
  EXPECT_EQ(summary.at("pareto"), pareto.rows.size());
  const bool found = std::ranges::any_of(
      refined.rows, [&](const auto& row) { return refined.text(row, "status") == "optimal"; });
  std::vector<std::string> expected = kResultFiles;
  if (!found) expected.erase(expected.begin());
  // A best.toml of another run is set aside, where there was one.
  std::vector<std::string> names = names_in(place.file("out"));
  std::erase(names, "best.toml.previous");
  EXPECT_EQ(std::erase(names, "optimize.journal"), 1U) << "--resume needs it";
  EXPECT_EQ(names, expected);
  if (found) {
    EXPECT_EQ(place.run({"analyze", "out/best.toml", "--strict"}).exit_code, 0);
  }
}

TEST(Interrupt, OfALongRunKeepsWhatIsDone) {
  const Workplace place;
  place.write("spec.toml",
              replaced(replaced(example("ratio-96.toml"), "starts = 4", "starts = 100"),
                       "S = [10, 24]", "S = [10, 60]"));
  std::filesystem::create_directory(place.file("out"));
  place.write("out/best.toml", "# of an earlier run\n");
  const auto result = interrupted(place, {"optimize", "spec.toml", "--out", "out"},
                                  milliseconds(1000), milliseconds(3000));
  ASSERT_TRUE(result) << "still running three seconds after Ctrl-C";
  EXPECT_EQ(result->signal, 0);
  EXPECT_EQ(result->exit_code, kInterrupted);
  EXPECT_NE(result->err.find("interrupted"), std::string::npos) << result->err;
  expect_consistent_files(place);
  const bool found = !json::parse(place.read("out/summary.json")).at("best").is_null();
  EXPECT_EQ(result->out.rfind("Stopped: ", 0) == 0, found) << result->out;
}

TEST(OptimizeFolder, OfAnEarlierRunIsReplacedByForceAlone) {
  const Workplace place;
  std::string spec = replaced(example("ratio-96.toml"), "S = [10, 24]", "S = [12, 12]");
  spec = replaced(spec, "P1 = [18, 70]", "P1 = [64, 64]");
  place.write("spec.toml", spec);
  const std::vector<std::string> command{"optimize", "spec.toml", "--out", "out", "--quiet"};
  ASSERT_EQ(place.run(command).exit_code, 0);
  const std::string before = place.read("out/summary.json");
  place.write("spec.toml", replaced(spec, "[64, 64]", "[63, 64]"));
  const ProgramResult refused = place.run(command);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("holds the result of an earlier run (out/summary.json): allowed: "
                             "another folder, --force"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(place.read("out/summary.json"), before);
  std::vector<std::string> forced = command;
  forced.emplace_back("--force");
  EXPECT_EQ(place.run(forced).exit_code, 0);
  EXPECT_NE(place.read("out/summary.json"), before);
}

TEST(Interrupt, IsPromptWithinOneToothSetOfManyStartsAndModules) {
  const Workplace place;
  const std::string series =
      "{ series = [0.5, 0.52, 0.54, 0.56, 0.58, 0.6, 0.62, 0.64, 0.66, 0.68, 0.7, 0.72, 0.74, "
      "0.76, "
      "0.78, 0.8, 0.82, 0.84, 0.86, 0.88] }";
  std::string spec = replaced(example("ratio-96.toml"), "starts = 4", "starts = 1000");
  for (int stage = 0; stage < 2; ++stage) {
    spec = replaced(spec, "{ min = 0.5, max = 1.0 }", series);
  }
  place.write("spec.toml", spec);
  const auto result = interrupted(place, {"optimize", "spec.toml", "--out", "out", "--quiet"},
                                  milliseconds(500), milliseconds(3000));
  ASSERT_TRUE(result) << "still running three seconds after Ctrl-C";
  EXPECT_EQ(result->signal, 0);
  EXPECT_EQ(result->exit_code, kInterrupted);
  expect_consistent_files(place);
}

TEST(Interrupt, OfASearchPrintsNoRanking) {
  const Workplace place;
  std::string spec = example("rp96.toml");
  spec = replaced(spec, "S = [10, 20]", "S = [4, 500]");
  spec = replaced(spec, "P1 = [20, 60]", "P1 = [4, 500]");
  spec = replaced(spec, "P2 = [20, 60]", "P2 = [4, 500]");
  spec = replaced(spec, "R1_max = 120", "R1_max = 2000");
  spec = replaced(spec, "R2_max = 120", "R2_max = 2000");
  spec = replaced(spec, "tolerance = 0.005", "tolerance = 0.00001");
  place.write("spec.toml", spec);
  const auto result = interrupted(place, {"search", "spec.toml", "--out", "sets.txt"},
                                  milliseconds(300), milliseconds(3000));
  ASSERT_TRUE(result) << "still running three seconds after Ctrl-C";
  EXPECT_EQ(result->signal, 0);
  EXPECT_EQ(result->exit_code, kInterrupted);
  EXPECT_EQ(result->out, "");
  EXPECT_NE(result->err.find("interrupted"), std::string::npos) << result->err;
  EXPECT_FALSE(place.has("sets.txt"));
}

}  // namespace
}  // namespace gear3k::contract_test
