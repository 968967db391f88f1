// --model on analyze, map and optimize: exit codes, messages, files.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "io/text/csv_table.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::model_test {
namespace {

using nlohmann::json;
using test::example, test::ProgramResult, test::replaced, test::Workplace;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string bilateral() { return example("designs/bilateral_drive_gear.toml"); }
std::string at_point() {
  return bilateral() +
         "\n[operating_point]\nsun_speed_rpm = 600.0\noutput_torque_nm = 20.0\ntemperature_c = "
         "30.0\n";
}

const std::string kDrag = R"([transmission]
name = "bilateral drive gear"
[transmission.range]
sun_speed_rpm = [200, 1000]
output_torque_nm = [5, 50]
temperature_c = [25, 45]
[transmission.causes.drag_constant]
form = "sun"
body = "sun"
torque_nm = 0.01
torque_nm_sd = 0.001
[transmission.causes.sensor_gain]
form = "gain"
gain_error = 0.02
)";
const std::string kClearance = R"([lost_motion.causes.clearance]
form = "constant"
extra_lost_motion_arcmin = 2.5
[lost_motion.causes.compliance]
form = "output"
compliance_arcmin_per_nm = 0.1
)";

json analysis(const Workplace& place, std::vector<std::string> more = {}) {
  std::vector<std::string> words{"analyze", "gear.toml", "--format", "json"};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramResult result = place.run(words);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

TEST(ModelOption, SunDragIsInTheTorqueAtTheOperatingPointAndTheSensorIsNot) {
  const Workplace place;
  place.write("gear.toml", at_point());
  place.write("model.toml", kDrag);
  const json plain = analysis(place);
  const json with = analysis(place, {"--model", "model.toml"});
  const auto torque = [](const json& data, const char* direction) {
    return data.at("operating_point").at(direction).at("sun_torque_nm").get<double>();
  };
  EXPECT_NEAR(torque(with, "forward") - torque(plain, "forward"), 0.01, 1e-12);
  EXPECT_NEAR(torque(with, "backward") - torque(plain, "backward"), -0.01, 1e-12);
  EXPECT_FALSE(plain.contains("model"));
  EXPECT_EQ(with.at("model").at("file"), "model.toml");
  ASSERT_EQ(with.at("model").at("causes").size(), 2U);
  const json& drag = with.at("model").at("causes").at(0);
  EXPECT_EQ(drag.at("id"), "drag_constant");
  EXPECT_EQ(drag.at("parameters").at(0).at("value"), 0.01);
  EXPECT_EQ(drag.at("parameters").at(0).at("sd"), 0.001);
  EXPECT_TRUE(drag.at("changes_gearbox").get<bool>());
  EXPECT_FALSE(with.at("model").at("causes").at(1).at("changes_gearbox").get<bool>());
}

TEST(ModelOption, LostMotionIsTheRigidOneWithClearanceAndWindUp) {
  const Workplace place;
  place.write("gear.toml", at_point());
  place.write("model.toml", kClearance);
  const json plain = analysis(place).at("backlash");
  const json with = analysis(place, {"--model", "model.toml"}).at("backlash");
  EXPECT_FALSE(plain.contains("measured_arcmin"));
  EXPECT_EQ(with.at("kinematic_arcmin"), plain.at("kinematic_arcmin"));
  EXPECT_NEAR(with.at("measured_arcmin").get<double>(),
              plain.at("kinematic_arcmin").get<double>() + 2.5 + 2.0 * 20.0 * 0.1, 1e-9);
  const std::string screen = place.run({"analyze", "gear.toml", "--model", "model.toml"}).out;
  EXPECT_TRUE(contains(screen, fmt::format(", measured {:.2f} with the model (between +T and -T)",
                                           with.at("measured_arcmin").get<double>())))
      << screen;
}

TEST(ModelOption, LeavingTheRangeAndAnotherGearboxAreToldOnStderrAndInTheNotes) {
  const Workplace place;
  place.write("gear.toml", replaced(at_point(), "sun_speed_rpm = 600.0", "sun_speed_rpm = 1500.0"));
  place.write("model.toml", replaced(kDrag, "bilateral drive gear", "another gear"));
  const ProgramResult result =
      place.run({"analyze", "gear.toml", "--model", "model.toml", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0);
  const std::string notes = json::parse(result.out).at("notes").dump();
  for (const char* part : {"200 to 1000 rpm, by 500 rpm above", "another gear"}) {
    EXPECT_TRUE(contains(result.err, part)) << result.err;
    EXPECT_TRUE(contains(notes, part)) << notes;
  }
  EXPECT_EQ(place.run({"analyze", "gear.toml", "--model", "model.toml", "--quiet"}).err, "");
}

/// A sun drag that could as well be the sensor, and one friction that no gearbox shows.
std::string doubtful() {
  return replaced(replaced(kDrag, "[transmission.range]",
                           "verdict = \"ambiguous\"\n[transmission.range]"),
                  "body = \"sun\"\n",
                  "body = \"sun\"\nalternatives = [\"sensor_offset\", \"drag_viscous\"]\n") +
         "[transmission.causes.friction_direction]\nform = \"forward_backward\"\nasymmetry = "
         "-0.985\n";
}

TEST(ModelOption, ADoubtfulModelIsToldWhereverItIsUsed) {
  const Workplace place;
  place.write("gear.toml", at_point());
  place.write("model.toml", doubtful());
  for (const char* command : {"analyze", "map"}) {
    const ProgramResult result =
        place.run({command, "gear.toml", "--model", "model.toml", "--format", "json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const std::string notes = json::parse(result.out).at("notes").dump();
    for (const char* part :
         {"the diagnosis of transmission was ambiguous: drag_constant could as well be "
          "sensor_offset or drag_viscous",
          "friction_direction: asymmetry -0.985 is outside the plausible -0.98 to 0.98: "
          "distrust"}) {
      EXPECT_TRUE(contains(result.err, part)) << result.err;
      EXPECT_TRUE(contains(notes, part)) << notes;
    }
  }
  place.write("model.toml", kDrag);
  EXPECT_EQ(place.run({"analyze", "gear.toml", "--model", "model.toml"}).err, "")
      << "of a model that states no verdict nothing is known";
}

TEST(ModelOption, WithoutAnOperatingPointTheMiddleOfTheModelsRangeIsTakenAndSaid) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  place.write("model.toml", kDrag);
  const json with = analysis(place, {"--model", "model.toml"});
  EXPECT_EQ(with.at("operating_point").at("sun_speed_rpm"), 600.0);
  EXPECT_EQ(with.at("operating_point").at("output_torque_nm"), 27.5);
  EXPECT_TRUE(contains(with.at("notes").dump(), "the middle of the model's range is taken"));
}

TEST(ModelOption, ABadModelIsInvalidInputWithItsLines) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  place.write("model.toml", replaced(kDrag, "causes.drag_constant", "causes.drag_constnt"));
  for (const char* command : {"analyze", "map"}) {
    const ProgramResult result = place.run({command, "gear.toml", "--model", "model.toml"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(contains(result.err, "model.toml:7:")) << result.err;
    EXPECT_TRUE(contains(result.err, "did you mean drag_constant?")) << result.err;
  }
  EXPECT_EQ(place.run({"analyze", "gear.toml", "--model", "none.toml"}).exit_code, 2);
  EXPECT_EQ(place.run({"analyze", "gear.toml", "--model", ""}).exit_code, 1);
}

TEST(ModelOption, AModelOfABlackBoxsShaftsIsRefused) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  place.write("model.toml",
              "[transmission.causes.friction_load]\nform = \"about_middle\"\nexponent = 0.1\n"
              "reference_load_nm = 20.0\n");
  const ProgramResult result = place.run({"analyze", "gear.toml", "--model", "model.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "friction_load: measured on a black box")) << result.err;
}

TEST(ModelOption, SearchAndExportDoNotTakeIt) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  EXPECT_EQ(place.run({"search", "gear.toml", "--model", "m.toml"}).exit_code, 1);
  EXPECT_EQ(place.run({"export", "gear.toml", "--svg", "x", "--model", "m.toml"}).exit_code, 1);
}

TEST(ModelOption, TheMapsNoLoadTorqueIsTheModelsDrag) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  place.write("model.toml", kDrag);
  const ProgramResult result =
      place.run({"map", "gear.toml", "--model", "model.toml", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_NEAR(data.at("breakaway").at("sun").at("torque_nm").get<double>(), 0.01, 1e-12);
  EXPECT_EQ(data.at("model").at("file"), "model.toml");
  // 20 °C of a design without operating point against 25 to 45 °C.
  EXPECT_TRUE(contains(result.err, "by 5 C below")) << result.err;
}

/// One tooth set.
std::string one_set() {
  return R"([ratio]
target = 96.242
tolerance = 0.0001
[teeth]
S = [12, 12]
P1 = [39, 39]
R1_max = 90
P2 = [32, 32]
R2_max = 81
[module]
stage1_mm = { min = 0.5, max = 1.0 }
stage2_mm = { min = 0.5, max = 1.0 }
[size]
max_ring_root_diameter_mm = 80.0
[backlash]
max_output_arcmin = 12.0
[friction]
coefficient = 0.1
[solver]
starts = 2
)";
}

TEST(ModelOption, OptimizeAppendsTheEfficienciesWithTheModel) {
  const Workplace place;
  place.write("spec.toml", one_set());
  place.write("point.toml", one_set() +
                                "[operating_point]\nsun_speed_rpm = 600\noutput_torque_nm = 20\n"
                                "temperature_c = 30\n");
  place.write("model.toml", kDrag);
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "plain"}).exit_code, 0);
  const ProgramResult result =
      place.run({"optimize", "point.toml", "--out", "out", "--model", "model.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // An operating point without a model changes nothing, and that is said.
  const ProgramResult unread = place.run({"optimize", "point.toml", "--out", "point"});
  ASSERT_EQ(unread.exit_code, 0);
  EXPECT_EQ(place.read("point/refined.csv"), place.read("plain/refined.csv"));
  EXPECT_TRUE(contains(unread.out, "Note: [operating_point] is read by a search with --model or"));
  EXPECT_FALSE(contains(result.out, "Note: [operating_point] is read by"));
  EXPECT_TRUE(contains(place.read("point/best.toml"), "sun_speed_rpm = 600.0"));
  const io::CsvTable table = io::parse_csv(place.read("out/refined.csv"), "refined.csv");
  ASSERT_EQ(table.rows.size(), 1U);
  const double eta_f = table.number(table.rows[0], "eta_f_model").value();
  // best.toml is the plain design; analysed with the model at the point it has that efficiency.
  EXPECT_FALSE(contains(place.read("out/best.toml"), "drag"));
  const ProgramResult checked =
      place.run({"analyze", "out/best.toml", "--model", "model.toml", "--format", "json"});
  const json forward = json::parse(checked.out).at("operating_point").at("forward");
  EXPECT_NEAR(forward.at("efficiency").get<double>(), eta_f, 1e-9);
  EXPECT_LT(eta_f, table.number(table.rows[0], "eta_f").value());
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("model").at("file"), "model.toml");
  EXPECT_FALSE(json::parse(place.read("plain/summary.json")).contains("model"));
}

TEST(ModelOption, OptimizeComparesTheBestDesignsWithoutAndWithTheModel) {
  const Workplace place;
  const std::string point =
      "[operating_point]\nsun_speed_rpm = 600\noutput_torque_nm = 20\ntemperature_c = 30\n";
  place.write("spec.toml", one_set() + point);
  place.write("model.toml", kDrag);
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--model", "model.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "does not change the best design: gain 0")) << result.out;
  const json change = json::parse(place.read("out/summary.json")).at("model_change");
  EXPECT_EQ(change.at("objective"), "backward_efficiency");
  EXPECT_EQ(change.at("same_design"), true);
  EXPECT_EQ(change.at("gain").at("value"), 0.0);
  EXPECT_EQ(change.at("operating_point").at("sun_speed_rpm"), 600.0);
  // Both are what analyze says of them.
  const ProgramResult checked =
      place.run({"analyze", "out/best.toml", "--model", "model.toml", "--format", "json"});
  const json analysed = json::parse(checked.out).at("operating_point");
  for (const char* design : {"before", "after"}) {
    EXPECT_NEAR(change.at(design).at("eta_b_model").get<double>(),
                analysed.at("backward").at("efficiency").get<double>(), 1e-12);
    const json interval = change.at(design).at("eta_b_model_ci90");
    EXPECT_LT(interval[0], change.at(design).at("eta_b_model"));
    EXPECT_GT(interval[1], change.at(design).at("eta_b_model"));
  }
  // Without a model there is nothing to compare, and nothing of it on stdout.
  const ProgramResult plain = place.run({"optimize", "spec.toml", "--out", "plain"});
  EXPECT_TRUE(json::parse(place.read("plain/summary.json")).at("model_change").is_null());
  EXPECT_FALSE(contains(plain.out, "What the model changes"));
}

TEST(ModelOption, OptimizeOfAListOfObjectivesSaysThatItComparesNothing) {
  const Workplace place;
  place.write("spec.toml",
              "objective = [\"outer_diameter\", \"lost_motion\"]\npareto.points = 2\n" + one_set());
  place.write("model.toml", kDrag);
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--model", "model.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "What the model changes: not known, a list of objectives"))
      << result.out;
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_TRUE(summary.at("model_change").is_null());
  EXPECT_TRUE(
      contains(summary.at("model_change_missing").get<std::string>(), "a list of objectives"));
}

TEST(ModelOption, OptimizeKeepsTheLimitOfLostMotionWithTheModelsClearance) {
  const Workplace place;
  place.write("spec.toml", one_set());
  place.write("model.toml", replaced(kClearance, "0.1", "0.0"));
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--model", "model.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "2.5 arcmin that the model adds")) << result.err;
  const io::CsvTable table = io::parse_csv(place.read("out/refined.csv"), "refined.csv");
  EXPECT_LE(table.number(table.rows[0], "backlash_arcmin").value(), 9.5 + 1e-4);
  EXPECT_TRUE(contains(place.read("out/best.toml"), "max_output_arcmin = 9.5"));
}

TEST(ModelOption, OptimizeTellsOfAnotherGearboxAndOfDoubts) {
  const Workplace place;
  place.write("spec.toml", "name = \"new gear\"\n" + one_set());
  place.write("model.toml", doubtful());
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--model", "model.toml"});
  for (const char* part : {"measured on \"bilateral drive gear\", applied to \"new gear\"",
                           "could as well be sensor_offset", "outside the plausible"}) {
    EXPECT_TRUE(contains(result.err, part)) << part << '\n' << result.err;
  }
}

TEST(ModelOption, OptimizeSaysAtOnceThatNoTeethKeepALimitBelowTheModelsLostMotion) {
  const Workplace place;
  place.write("spec.toml", one_set());
  place.write("model.toml", replaced(replaced(kClearance, "0.1", "0.0"), "2.5", "30.0"));
  std::filesystem::create_directory(place.file("out"));
  place.write("out/best.toml", "");
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--model", "model.toml"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(
      contains(result.err, "spec.toml: backlash.max_output_arcmin = 12: the model adds 30 arcmin"))
      << result.err;
  EXPECT_FALSE(place.has("out/refined.csv")) << "nothing is searched";
  EXPECT_FALSE(place.has("out/best.toml")) << "of an earlier run";
}

}  // namespace
}  // namespace gear3k::model_test
