// Files that a run reads, or that another option names, are not replaced by its results.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::kept_files_test {
namespace {

using test::example, test::lines_of, test::ProgramResult, test::replaced, test::Workplace;

const std::string kMotor =
    "[motor]\nresistance_ohm = 0.5\ntorque_constant_nm_per_a = 0.05\nrotor_inertia_kgm2 = 2e-5\n"
    "coulomb_torque_nm = 0.002\n";
const std::string kCycle = "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n";
/// One tooth set.
const std::string kGears =
    "[ratio]\ntarget = 45.0\ntolerance = 0.3\n"
    "[teeth]\nS = [15, 15]\nP1 = [30, 30]\nP2 = [32, 32]\nR1_max = 90\nR2_max = 90\n"
    "[module]\nstage1_mm = { min = 0.5, max = 0.8 }\nstage2_mm = { min = 0.5, max = 0.8 }\n"
    "[backlash]\nmax_output_arcmin = 10.0\nmin_normal_um = 5.0\nmachining_allowance = 0.02\n"
    "[friction]\ncoefficient = 0.08\n";
const std::string kSelection =
    "motors = \"motors.csv\"\ngearboxes = [\"a.toml\", \"b.toml\"]\ncycles = \"c.csv\"\n"
    "objective = [\"energy\", \"inertia\"]\n";
const std::string kMotors =
    "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,rotor_inertia_kgm2\n"
    "A,one,0.6,0.04,2e-5\n";

/// A run that is refused and leaves a file as it was.
void expect_kept(const Workplace& place, const std::vector<std::string>& words,
                 const std::string& file, const std::string& said) {
  const std::string before = place.read(file);
  const ProgramResult run = place.run(words);
  EXPECT_EQ(run.exit_code, 2) << words.front() << run.err;
  EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
  EXPECT_EQ(place.read(file), before);
}

TEST(KeptFiles, TheDesignOfAnActuatorIsAnInput) {
  const Workplace place;
  place.write("events.csv", example("designs/loaded.toml"));
  place.write("a.toml", kMotor + "[gearbox]\ndesign = \"events.csv\"\n");
  expect_kept(place, {"actuator", "a.toml", "--out", "events.csv"}, "events.csv",
              "events.csv is an input file");
  place.write("s.toml", place.run({"new", "scenario"}).out);
  expect_kept(place, {"simulate", "a.toml", "s.toml", "--out", "."}, "events.csv",
              "events.csv is an input file");
}

TEST(KeptFiles, SearchKeepsWhatItsTaskNames) {
  const Workplace place;
  place.write("c.csv", kCycle);
  place.write("d.toml", example("designs/loaded.toml"));
  place.write("a.toml", kMotor + "[gearbox]\ndesign = \"d.toml\"\n");
  place.write("spec.toml", "objective = \"cycle_energy\"\n" + kGears +
                               "[actuator]\nmotor = \"a.toml\"\n[cycle]\nfiles = \"c.csv\"\n");
  for (const char* file : {"c.csv", "a.toml", "d.toml"}) {
    expect_kept(place, {"search", "spec.toml", "--out", file}, file, "is an input file");
  }
  place.write("felt.toml", "objective = \"outer_diameter\"\n" + kGears +
                               "[actuator]\nmotor = \"a.toml\"\n"
                               "limits.max_felt_inertia_kgm2 = 10.0\n");
  expect_kept(place, {"search", "felt.toml", "--out", "d.toml"}, "d.toml", "is an input file");
}

TEST(KeptFiles, OutIsNoFileOfFigures) {
  const Workplace place;
  place.write("a.toml", kMotor +
                            "[gearbox]\nratio = 50.0\nefficiency_forward = 0.8\n"
                            "efficiency_backward = 0.6\n");
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"actuator", "a.toml", "--figures", "f", "--out", "f/drive_backdrive.csv"},
           {"atlas", "50", "--figures", "f", "--out", "f/atlas.csv"},
           {"analyze", "d.toml", "--figures", "f", "--out", "f/torque_angle.csv"}}) {
    place.write("d.toml", example("designs/loaded.toml"));
    const ProgramResult run = place.run(words);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_NE(run.err.find("is a file of --figures, allowed: another file"), std::string::npos)
        << run.err;
    EXPECT_FALSE(place.has("f"));
  }
}

TEST(KeptFiles, AtlasWritesItsTaskLast) {
  const Workplace place;
  EXPECT_EQ(place.run({"atlas", "50", "--task", "t.toml", "--out", "none/x"}).exit_code, 2);
  EXPECT_FALSE(place.has("t.toml"));
  EXPECT_EQ(place.run({"atlas", "50", "--task", "t.toml", "--out", "x"}).exit_code, 0);
  EXPECT_TRUE(place.has("t.toml"));
}

/// Names of the DESIGN files of a folder.
std::set<std::string> designs_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("design_")) names.insert(name);
  }
  return names;
}

TEST(KeptFiles, GearboxesOfASelectionHaveNamesOfTheirOwn) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("c.csv", kCycle);
  place.write("a.toml", kGears);
  place.write("b.toml", replaced(kGears, "0.08", "0.05"));
  place.write("s.toml", kSelection);
  ASSERT_EQ(place.run({"actuator", "--select", "s.toml", "--out", "o"}).exit_code, 0);
  std::set<std::string> rows;
  const auto lines = lines_of(place.read("o/selection.csv"));
  for (const std::string& line : lines) {
    rows.insert(line.substr(0, line.find(',', line.find(',') + 1)));
  }
  EXPECT_EQ(rows.size(), lines.size());
  const auto front = nlohmann::json::parse(place.read("o/summary.json")).at("front").size();
  EXPECT_EQ(designs_in(place.file("o")).size(), front);

  // Alone they are named by their teeth, and what is of the run before goes.
  place.write("s.toml", replaced(kSelection, "\"a.toml\", ", ""));
  place.write("o/design_mine.toml", "name = \"mine\"\n");
  ASSERT_EQ(place.run({"actuator", "--select", "s.toml", "--out", "o"}).exit_code, 0);
  for (const std::string& name : designs_in(place.file("o"))) {
    EXPECT_TRUE(name.find("-b") == std::string::npos && name.find("-a") == std::string::npos)
        << name;
  }
  EXPECT_TRUE(place.has("o/design_mine.toml"));
}

/// The one figure that a summary says to be missing.
void expect_missing_front(const Workplace& place, const std::vector<std::string>& words) {
  std::filesystem::remove_all(place.file("o"));
  {
    const test::OtherPath path("");
    const ProgramResult run = place.run(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(place.read("o/summary.json"), run.out);
  }
  const auto missing = nlohmann::json::parse(place.read("o/summary.json")).at("missing_figures");
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing.at(0).at("file"), "pareto.svg");
  EXPECT_NE(missing.at(0).at("cause").get<std::string>().find("gnuplot"), std::string::npos);
  EXPECT_FALSE(place.has("o/pareto.svg"));
  std::filesystem::remove_all(place.file("o"));
  EXPECT_EQ(place.run(words).exit_code, 0);
  EXPECT_FALSE(nlohmann::json::parse(place.read("o/summary.json")).contains("missing_figures"));
  EXPECT_TRUE(place.has("o/pareto.svg"));
}

TEST(KeptFiles, FrontsWithoutAFigureSaySoInTheirSummary) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("c.csv", kCycle);
  place.write("a.toml", kGears);
  place.write("s.toml", replaced(kSelection, ", \"b.toml\"", ""));
  expect_missing_front(place, {"actuator", "--select", "s.toml", "--out", "o", "--format", "json"});
  place.write("spec.toml",
              "objective = [\"outer_diameter\", \"lost_motion\"]\npareto.points = 2\n" + kGears);
  expect_missing_front(place, {"optimize", "spec.toml", "--out", "o", "--format", "json"});
}

TEST(KeptFiles, AnInterruptedSelectionSaysThatNothingIsKept) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("c.csv", kCycle);
  place.write("a.toml", replaced(kGears, "S = [15, 15]\nP1 = [30, 30]\nP2 = [32, 32]",
                                 "S = [10, 30]\nP1 = [15, 40]\nP2 = [15, 40]"));
  place.write("s.toml", replaced(kSelection, ", \"b.toml\"", ""));
  test::RunningProgram program =
      place.start({"actuator", "--select", "s.toml", "--out", "o", "--quiet"});
  ASSERT_TRUE(program.wait_until_it_catches(SIGINT, std::chrono::seconds(10)));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.send(SIGINT);
  const auto result = program.wait(std::chrono::seconds(20));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->exit_code, 130);
  EXPECT_EQ(result->err, "interrupted: nothing is kept\n");
  EXPECT_FALSE(place.has("o"));
}

TEST(KeptFiles, ADesignOfASelectionReplacesNoInput) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("c.csv", kCycle);
  place.write("b.toml", kGears);
  place.write("s.toml", replaced(kSelection, "\"a.toml\", ", ""));
  ASSERT_EQ(place.run({"actuator", "--select", "s.toml", "--out", "o"}).exit_code, 0);
  const std::string design = "o/" + *designs_in(place.file("o")).begin();
  // Of another name, and worse than the one that is made, which is on the front.
  std::string own = replaced(place.read(design), "coefficient = 0.08", "coefficient = 0.1");
  own.replace(own.find("15/30/75/32/90"), std::string("15/30/75/32/90").size(), "mine");
  place.write(design, own);
  place.write("s.toml", replaced(kSelection, "a.toml", design));
  expect_kept(place, {"actuator", "--select", "s.toml", "--out", "o"}, design, "is an input file");
}

}  // namespace
}  // namespace gear3k::kept_files_test
