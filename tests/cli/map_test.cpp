// `gear3k map`: what is printed, files, figures with and without gnuplot, exit codes.

#include <gtest/gtest.h>

#include <boost/property_tree/xml_parser.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::map_test {
namespace {

using nlohmann::json;
using test::example, test::OtherPath, test::ProgramResult, test::replaced, test::Workplace;

std::string bilateral() { return example("designs/bilateral_drive_gear.toml"); }

/// With drag on the sun and a small grid.
std::string dragged() {
  return bilateral() +
         "\n[drag.S]\nconstant_nm = 0.01\n[map]\nsun_speed_rpm = [100.0, 700.0]\nspeed_points = 4\n"
         "output_torque_nm = [2.0, 20.0]\ntorque_points = 3\n";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

const std::vector<std::string> kFigures{"efficiency_forward.svg", "efficiency_backward.svg",
                                        "torques.svg"};

TEST(Map, PrintsTheGridOfTheDesign) {
  const Workplace place;
  place.write("gear.toml", dragged());
  const ProgramResult result = place.run({"map", "gear.toml"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* part : {"Efficiency forward", "Efficiency backward", "  100 ", "  700",
                           "no-load torque at the sun (N m)", "Breakaway torque",
                           "Back-driving margin", "mesh P2-R2"}) {
    EXPECT_TRUE(contains(result.out, part)) << part << '\n' << result.out;
  }
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"gear.toml"}));
}

TEST(Map, ConstantSunDragIsTheNoLoadAndTheBreakawayTorque) {
  const Workplace place;
  place.write("gear.toml", dragged());
  const ProgramResult result = place.run({"map", "gear.toml", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_NEAR(data.at("breakaway").at("sun").at("torque_nm").get<double>(), 0.01, 1e-15);
  for (const json& at : data.at("running")) {
    EXPECT_NEAR(at.at("sun").at("torque_nm").get<double>(), 0.01, 1e-15);
  }
  EXPECT_EQ(data.at("sun_speed_rpm"), json({100.0, 300.0, 500.0, 700.0}));
  EXPECT_EQ(data.at("output_torque_nm"), json({2.0, 11.0, 20.0}));
}

TEST(Map, CsvAndJsonTellTheSame) {
  const Workplace place;
  place.write("gear.toml", dragged());
  const io::CsvTable table =
      io::parse_csv(place.run({"map", "gear.toml", "--format", "csv"}).out, "stdout");
  const json data = json::parse(place.run({"map", "gear.toml", "--format", "json"}).out);
  ASSERT_EQ(table.rows.size(), 24U);
  ASSERT_EQ(data.at("points").size(), 24U);
  for (std::size_t k = 0; k < 24; ++k) {
    const json& point = data.at("points").at(k);
    const auto& row = table.rows[k];
    EXPECT_EQ(table.text(row, "direction"), point.at("direction").get<std::string>());
    EXPECT_EQ(table.number(row, "sun_torque_nm"), point.at("sun_torque_nm").get<double>());
    EXPECT_EQ(table.number(row, "heat_p2_r2_w"),
              point.at("meshes").at(2).at("heat_w").get<double>());
  }
}

TEST(Map, WritesResultsAndFigures) {
  const Workplace place;
  place.write("gear.toml", dragged());
  const ProgramResult result = place.run({"map", "gear.toml", "--out", "a/map"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(place.listing(),
            (std::vector<std::string>{"a", "a/map", "a/map/efficiency_backward.svg",
                                      "a/map/efficiency_forward.svg", "a/map/map.csv",
                                      "a/map/map.json", "a/map/torques.svg", "gear.toml"}));
  EXPECT_TRUE(contains(result.out, "a/map/torques.svg")) << result.out;
  EXPECT_EQ(place.read("a/map/map.csv"), place.run({"map", "gear.toml", "--format", "csv"}).out);
  EXPECT_EQ(place.read("a/map/map.json"), place.run({"map", "gear.toml", "--format", "json"}).out);
}

TEST(Map, FiguresAreWellFormedAndShowTheDesign) {
  const Workplace place;
  place.write("gear.toml", dragged());
  ASSERT_EQ(place.run({"map", "gear.toml", "--out", "map"}).exit_code, 0);
  for (const std::string& name : kFigures) {
    const std::string svg = place.read("map/" + name);
    std::istringstream stream(svg);
    boost::property_tree::ptree tree;
    ASSERT_NO_THROW(boost::property_tree::read_xml(stream, tree)) << name;
    EXPECT_EQ(tree.count("svg"), 1U) << name;
    EXPECT_TRUE(contains(svg, "bilateral drive gear: ")) << name;
    EXPECT_TRUE(contains(svg, "(rpm)")) << name;
  }
}

TEST(Map, SameInputGivesTheSameBytesWhateverTheThreads) {
  const Workplace place;
  place.write("gear.toml", dragged());
  ASSERT_EQ(place.run({"map", "gear.toml", "--out", "1", "--threads", "1"}).exit_code, 0);
  ASSERT_EQ(place.run({"map", "gear.toml", "--out", "2", "--threads", "4"}).exit_code, 0);
  for (std::string name : {"map.csv", "map.json", "efficiency_forward.svg",
                           "efficiency_backward.svg", "torques.svg"}) {
    EXPECT_EQ(place.read("1/" + name), place.read("2/" + name)) << name;
  }
}

TEST(Map, WithoutGnuplotTheResultsAreThereAndOldFiguresAreNot) {
  const Workplace place;
  place.write("gear.toml", dragged());
  ASSERT_EQ(place.run({"map", "gear.toml", "--out", "map"}).exit_code, 0);
  place.write("map/map.csv", "old");
  ProgramResult result;
  {
    const OtherPath path("");
    result = place.run({"map", "gear.toml", "--out", "map", "--format", "csv"});
  }
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err, "gnuplot: not found in PATH; figures need it")) << result.err;
  EXPECT_TRUE(contains(result.err, "written without figures: map/map.csv, map/map.json"))
      << result.err;
  EXPECT_EQ(place.read("map/map.csv"), result.out);
  const json missing = json::parse(place.read("map/map.json")).at("missing_figures");
  ASSERT_EQ(missing.size(), kFigures.size());
  EXPECT_EQ(missing.at(0).at("file"), "efficiency_forward.svg");
  EXPECT_TRUE(contains(missing.at(0).at("cause").get<std::string>(), "gnuplot: not found in PATH"));
  for (const std::string& name : kFigures) {
    EXPECT_FALSE(place.has("map/" + name)) << name;
    EXPECT_TRUE(place.has("map/" + name + ".previous")) << name;
  }
}

TEST(Map, PrintingNeedsNoGnuplot) {
  const Workplace place;
  place.write("gear.toml", dragged());
  const OtherPath path("");
  const ProgramResult result = place.run({"map", "gear.toml"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
}

TEST(Map, AFolderThatCannotBeMadeLeavesNothingBehind) {
  const Workplace place;
  place.write("gear.toml", dragged());
  place.write("file", "");
  const ProgramResult result = place.run({"map", "gear.toml", "--out", "file"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "file: cannot be made a folder")) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"file", "gear.toml"}));
}

TEST(Map, AFolderOfAResultsNameKeepsEverythingAsItWas) {
  const Workplace place;
  place.write("gear.toml", dragged());
  std::filesystem::create_directories(place.file("map/torques.svg"));
  const ProgramResult result = place.run({"map", "gear.toml", "--out", "map"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "map/torques.svg")) << result.err;
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"gear.toml", "map", "map/torques.svg"}));
}

TEST(Map, UsageErrors) {
  const Workplace place;
  place.write("gear.toml", dragged());
  EXPECT_EQ(place.run({"map"}).exit_code, 1);
  EXPECT_EQ(place.run({"map", "gear.toml", "--out", ""}).exit_code, 1);
  const ProgramResult typo = place.run({"map", "gear.toml", "--fromat", "csv"});
  EXPECT_EQ(typo.exit_code, 1);
  EXPECT_TRUE(contains(typo.err, "did you mean --format?")) << typo.err;
  EXPECT_EQ(place.run({"map", "gear.toml", "--out", "x", "--help"}).exit_code, 0);
}

TEST(Map, AnUndefinedGeometryIsTheErrorOfAnalyze) {
  const Workplace place;
  place.write("gear.toml", "center_distance_mm = 15.0\n" + dragged());
  const ProgramResult map = place.run({"map", "gear.toml"});
  const ProgramResult analyze = place.run({"analyze", "gear.toml"});
  EXPECT_EQ(map.exit_code, 2);
  EXPECT_EQ(map.err, analyze.err);
  EXPECT_TRUE(contains(map.err, "leaves no working pressure angle")) << map.err;
}

TEST(Map, AMeshWithoutContactIsNamed) {
  const Workplace place;
  place.write("gear.toml", "center_distance_mm = 23.4\n" + bilateral());
  const ProgramResult result = place.run({"map", "gear.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "gear.toml: mesh S-P1 has no contact")) << result.err;
}

TEST(MapInterrupt, EndsWithItsCodeAndLeavesNothing) {
  const Workplace place;
  place.write("gear.toml", bilateral() + "\n[map]\nspeed_points = 200\ntorque_points = 200\n");
  test::RunningProgram program = place.start({"map", "gear.toml", "--out", "out"});
  ASSERT_TRUE(program.wait_until_it_catches(SIGTERM, std::chrono::seconds(10)));
  program.send(SIGTERM);
  const auto result = program.wait(std::chrono::seconds(5));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->signal, 0);
  EXPECT_EQ(result->exit_code, 130);
  EXPECT_EQ(result->err, "interrupted: nothing is kept\n");
  EXPECT_EQ(result->out, "");
  EXPECT_FALSE(std::filesystem::exists(place.file("out")));
}

}  // namespace
}  // namespace gear3k::map_test
