// Options and values that would have no effect, or another one than they say, are told.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::refused_use_test {
namespace {

using nlohmann::json;
using test::example, test::lines_of, test::ProgramResult, test::replaced, test::Workplace;

struct Refused {
  std::vector<std::string> words;
  int exit_code;
  std::vector<std::string> said;
};

TEST(RefusedUse, OptionsThatHaveNoEffectAreUsageErrors) {
  const Workplace place;
  for (const Refused& r : std::vector<Refused>{
           {{"atlas", "0"}, 1, {"atlas 0: allowed: a ratio from 20 to 300"}},
           {{"atlas", "0", "--planets", "99", "--backlash", "nan"},
            1,
            {"atlas 0: ", "--planets 99: allowed: 3 to 6", "--backlash nan: allowed: at least 5"}},
           {{"search", "s.toml", "--top", "0", "--threads", "0", "--format", "x"},
            1,
            {"--top = 0: allowed:", "--threads = 0: allowed:", "unknown format x"}},
           {{"analyze", "d.toml", "--threads", "0", "--columns", "3"},
            1,
            {"--threads = 0: allowed:", "--columns = 3: allowed:"}},
           {{"sweep", "figure", "db", "--x", "a", "--y", "b", "--format", "json"},
            1,
            {"sweep figure: --format: allowed: table (the document is SVG)"}},
           {{"sweep", "--workers", "4", "--yes", "status", "db"},
            1,
            {"--workers", "--yes", "no effect before status"}},
           {{"actuator", "--select", "s.toml", "--out", "o", "--strict"},
            1,
            {"--strict: allowed: without --select"}},
           {{"diagnose", "d.toml", "t.csv", "--threads", "0", "--false-discovery-rate", "2",
             "--min-sun-speed-rpm", "-5", "--max-output-torque-nm", "few"},
            1,
            {"--threads = 0: allowed:",
             "--false-discovery-rate = 2: allowed: a number above 0, up to 0.5",
             "--min-sun-speed-rpm = -5: allowed: a finite number, 0 or more",
             "--max-output-torque-nm = few: allowed: a "}},
           {{"map", "d.toml", "more.toml", "-q"},
            1,
            {"gear3k map: not expected: more.toml -q; allowed: DESIGN\n"}},
           {{"simulate", "a.toml", "s.toml", "x", "--threads", "0"},
            1,
            {"gear3k simulate: not expected: x; allowed: ACTUATOR SCENARIO\n",
             "--threads = 0: allowed:"}},
           {{"completion", "x"},
            1,
            {"gear3k completion: not expected: x; allowed: options alone\n"}},
           {{"mesh", "p.toml", "--show", "masses"}, 1, {"unknown part masses"}}}) {
    const ProgramResult run = place.run(r.words);
    EXPECT_EQ(run.exit_code, r.exit_code) << run.err;
    for (const std::string& said : r.said) {
      EXPECT_NE(run.err.find(said), std::string::npos) << said << '\n' << run.err;
    }
  }
}

TEST(RefusedUse, OptionsBeforeTheCommandAreToldWhereTheyGo) {
  const Workplace place;
  const std::string end = "\nRun with --help for more information.\n";
  for (const Refused& r : std::vector<Refused>{
           {{"--quiet", "optimize", "s.toml", "--out", "o"},
            1,
            {"--quiet: no effect before the command: allowed: after it, gear3k optimize --quiet "
             "..."}},
           {{"--format", "json", "analyze", "d.toml"},
            1,
            {"--format: no effect before the command: allowed: after it, gear3k analyze --format "
             "..."}},
           {{"--threads=2", "search", "s.toml"},
            1,
            {"--threads: no effect before the command: allowed: after it, gear3k search --threads "
             "..."}},
           {{"--quiet"}, 1, {"--quiet: allowed: after a command, gear3k COMMAND --quiet ..."}},
           {{"--quite", "mesh", "p.toml"}, 1, {"unknown option --quite; did you mean --quiet?"}},
           {{"--model", "m.toml", "mesh", "p.toml"}, 1, {"unknown option --model; "}},
           {{"-q", "mesh", "p.toml"}, 1, {"unknown option -q; "}}}) {
    const ProgramResult run = place.run(r.words);
    EXPECT_EQ(run.exit_code, r.exit_code) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(run.err.starts_with(r.said.front())) << run.err;
    EXPECT_TRUE(run.err.ends_with(end)) << run.err;
  }
  EXPECT_TRUE(place.listing().empty());
  for (const char* own : {"--help", "-h", "--version"}) {
    EXPECT_EQ(place.run({own}).exit_code, 0) << own;
    EXPECT_EQ(place.run({own, "mesh"}).exit_code, 0) << own;
  }
}

// With the place of the key that names them.
TEST(RefusedUse, FoldersInThePlaceOfFilesThatAKeyNames) {
  const Workplace place;
  std::filesystem::create_directory(place.file("folder"));
  place.write("a.toml",
              "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\n"
              "[gearbox]\ndesign = \"folder\"\n");
  place.write("s.toml", "duration_s = \"x\"\n");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"actuator", "a.toml"}, {"simulate", "a.toml", "s.toml"}}) {
    const ProgramResult run = place.run(words);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("a.toml:5:1: gearbox.design: folder: is a directory, allowed: a file"),
              std::string::npos)
        << run.err;
  }
}

// While a pipe that nobody writes to is read.
TEST(RefusedUse, CommandsThatAreInterruptedSayThatNothingIsKept) {
  const Workplace place;
  ASSERT_EQ(::mkfifo(place.file("pipe").c_str(), 0600), 0);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"analyze", "pipe"},
                                                {"mesh", "pipe"},
                                                {"compare", "pipe", "pipe"},
                                                {"export", "pipe", "--dxf", "out"},
                                                {"map", "pipe", "--out", "out"},
                                                {"search", "pipe"},
                                                {"actuator", "pipe"},
                                                {"actuator", "--select", "pipe", "--out", "out"},
                                                {"simulate", "pipe", "pipe", "--out", "out"},
                                                {"diagnose", "pipe", "pipe"},
                                                {"tolerances", "pipe", "--out", "out"}}) {
    for (const int signal : {SIGINT, SIGTERM}) {
      test::RunningProgram program = place.start(words);
      ASSERT_TRUE(program.wait_until_it_catches(signal, std::chrono::seconds(20))) << words[0];
      program.send(signal);
      const auto result = program.wait(std::chrono::seconds(20));
      ASSERT_TRUE(result.has_value()) << words[0];
      EXPECT_EQ(result->exit_code, 130) << words[0];
      EXPECT_EQ(result->err, "interrupted: nothing is kept\n") << words[0];
      EXPECT_EQ(result->out, "") << words[0];
      EXPECT_EQ(place.listing(), std::vector<std::string>{"pipe"}) << words[0];
    }
  }
}

TEST(RefusedUse, ErrorsOfAModelAreToldWithThoseOfItsSubject) {
  const Workplace place;
  place.write("d.toml", "planetz = 3\n");
  place.write("m.toml", "[x]\ny = 1\n");
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"analyze", "d.toml", "--model", "m.toml"},
           {"map", "d.toml", "--model", "m.toml"},
           {"optimize", "d.toml", "--model", "m.toml", "--out", "o"}}) {
    const ProgramResult run = place.run(words);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("d.toml:1:1: unknown key planetz"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("m.toml:"), std::string::npos) << run.err;
  }
}

TEST(RefusedUse, QuotedKeysWithADotNameNoKey) {
  const Workplace place;
  const std::string design = example("designs/low_backlash_prototype.toml");
  place.write("d.toml", design + "[\"gears.S\"]\nteeth = 14\n");
  const ProgramResult table = place.run({"analyze", "d.toml"});
  EXPECT_EQ(table.exit_code, 2);
  EXPECT_NE(table.err.find("unknown table [\"gears.S\"]"), std::string::npos) << table.err;
  place.write("d.toml", "\"friction.coefficient\" = 0.1\n" + design);
  const ProgramResult key = place.run({"analyze", "d.toml"});
  EXPECT_EQ(key.exit_code, 2);
  EXPECT_NE(key.err.find("unknown key \"friction.coefficient\""), std::string::npos) << key.err;
}

TEST(RefusedUse, WhatActsOnPlasticAloneIsNotedWhereThereIsNone) {
  const Workplace place;
  const std::string loaded = example("designs/loaded.toml");
  const std::string before = "s_h_min = 1.2\n";
  place.write("d.toml",
              replaced(loaded, before, before + "duty = 0.5\nwear_coefficient_mm3_nm = 1e-6\n"));
  const ProgramResult run = place.run({"analyze", "d.toml", "--full"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("duty, wear_coefficient_mm3_nm of [strength]: no effect"),
            std::string::npos)
      << run.out;
  place.write("d.toml", loaded);
  EXPECT_EQ(place.run({"analyze", "d.toml", "--full"}).out.find("of [strength]: no effect"),
            std::string::npos);
}

TEST(RefusedUse, ARingHasNoBore) {
  const Workplace place;
  const std::string loaded = example("designs/loaded.toml");
  std::string design = loaded;
  const std::string ring = "[gears.R1]\n";
  const std::size_t at = design.find(ring);
  ASSERT_NE(at, std::string::npos);
  design.insert(at + ring.size(), "bore_mm = 3.0\n");
  place.write("d.toml", design);
  const ProgramResult run = place.run({"analyze", "d.toml"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("gears.R1.bore_mm: allowed for S, P1 and P2 only"), std::string::npos)
      << run.err;
}

/// No tooth set fits it.
const std::string kNothing =
    "[ratio]\ntarget = 45.0\ntolerance = 1e-9\n"
    "[teeth]\nS = [15, 15]\nP1 = [30, 30]\nP2 = [31, 31]\nR1_max = 90\nR2_max = 90\n"
    "[module]\nstage1_mm = 0.5\nstage2_mm = { min = 0.5, max = 0.8 }\n"
    "[backlash]\nmax_output_arcmin = 10.0\n[friction]\ncoefficient = 0.08\n";

TEST(RefusedUse, ASearchWithoutASetLeavesNoTableOfAnEarlierOne) {
  const Workplace place;
  place.write("spec.toml", kNothing);
  place.write("t.txt", "of an earlier run\n");
  EXPECT_EQ(place.run({"search", "spec.toml", "--out", "t.txt"}).exit_code, 3);
  const std::string counts = place.read("t.txt");
  EXPECT_EQ(counts.find("of an earlier run"), std::string::npos);
  EXPECT_NE(counts.find("0 tooth sets"), std::string::npos) << counts;
}

TEST(RefusedUse, ASelectionNamesItsTasksWithoutADesign) {
  const Workplace place;
  place.write("knee.toml", kNothing);
  place.write("m.csv",
              "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a\nA,one,0.6,0.04\n");
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"m.csv\"\ngearboxes = \"knee.toml\"\ncycles = \"c.csv\"\n"
              "objective = \"energy\"\n");
  const ProgramResult run = place.run({"actuator", "--select", "s.toml", "--out", "o", "--quiet"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("knee.toml: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("no pair: there is no gearbox"), std::string::npos) << run.err;
}

TEST(RefusedUse, ADesignOfASelectionCarriesItsCapacity) {
  const Workplace place;
  place.write("weak.toml", example("designs/loaded.toml"));
  const ProgramResult analysis = place.run({"analyze", "weak.toml", "--format", "json"});
  const json strength = json::parse(analysis.out).at("strength");
  ASSERT_FALSE(strength.is_null());
  const double capacity = strength.at("capacity_nm").get<double>();
  place.write("m.csv",
              "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a\nA,one,0.6,0.04\n");
  const std::string torque = std::to_string(1.5 * capacity);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-" + torque + ",1\n0.5," + torque +
                           ",-1\n1,-" + torque + ",1\n");
  place.write("s.toml",
              "motors = \"m.csv\"\ngearboxes = \"weak.toml\"\ncycles = \"c.csv\"\n"
              "objective = \"energy\"\n");
  const ProgramResult run = place.run({"actuator", "--select", "s.toml", "--out", "o", "--quiet"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_NE(place.read("o/selection.csv").find("intermittent_torque"), std::string::npos)
      << place.read("o/selection.csv");
}

}  // namespace
}  // namespace gear3k::refused_use_test
