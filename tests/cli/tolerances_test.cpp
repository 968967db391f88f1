// `gear3k tolerances`, and what tolerances add to analyze, mesh and optimize: what is printed,
// files, exit codes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::tolerances_test {
namespace {

using nlohmann::json;
using test::example, test::lines_of, test::OtherPath, test::ProgramResult, test::replaced,
    test::Workplace;

const std::string kDrawn =
    "name = \"gear\"\nplanets = 3\ncenter_distance_mm = 21.268\n"
    "[stage1]\nmodule_mm = 0.8\n[stage2]\nmodule_mm = 0.8467\n"
    "[gears]\n"
    "S = { teeth = 12, profile_shift = 0.476, machining_allowance = 0.05 }\n"
    "P1 = { teeth = 39, profile_shift = 0.762, machining_allowance = 0.05 }\n"
    "R1 = { teeth = 90, profile_shift = 2.0, machining_allowance = 0.05 }\n"
    "P2 = { teeth = 32, profile_shift = 0.536, machining_allowance = 0.05 }\n"
    "R2 = { teeth = 81, profile_shift = 1.21, machining_allowance = 0.05 }\n"
    "[backlash]\nmax_output_arcmin = 17.5\n";
const std::string kTolerances =
    "[tolerances]\ncenter_distance_um = 5\npin_position_um = 10\nplanet_phase_arcmin = 6\n"
    "samples = 1000\nseed = 7\n"
    "[tolerances.S]\nrunout_um = 10\n"
    "[tolerances.R2]\ntooth_thickness_um = [-20, 0]\nrunout_um = 15\ncumulative_pitch_um = 25\n"
    "single_pitch_um = 5\n";
const std::string kToleranced = kDrawn + kTolerances;

const std::vector<std::string> kTexts{"tolerances.json", "lost_motion.csv", "tolerances.csv",
                                      "turn.csv", "turn_orders.csv"};
const std::vector<std::string> kFigures{"lost_motion.svg", "tolerances.svg", "turn.svg"};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What is on stderr beside lines of progress, which a slow machine has.
std::string without_progress(const std::string& err) {
  static const std::regex progress(R"(\d+/\d+ gearboxes built at random[^\n]*\n)");
  return std::regex_replace(err, progress, "");
}

TEST(TolerancesCommand, PrintsSpreadSharesAndOneTurn) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  const ProgramResult result = place.run({"tolerances", "gear.toml"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(without_progress(result.err), "");
  for (const char* part :
       {"Limits of the built gearbox",
        "Built gearboxes at one position of the turn: 1000 drawn at random, seed 7",
        "at every position      of a turn, 400 gearboxes: ", "and keep 17.5 arcmin",
        "99 % of all keep", "worst case", "at first contact", "Which tolerance to tighten first",
        "R2 tooth_thickness", "sun against the carrier"}) {
    EXPECT_TRUE(contains(result.out, part)) << part << '\n' << result.out;
  }
  EXPECT_FALSE(contains(result.out, "Files:"));
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"gear.toml"}));
}

TEST(TolerancesCommand, WritesResultsAndWellFormedFigures) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  const ProgramResult result = place.run({"tolerances", "gear.toml", "--out", "a/b"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::vector<std::string> expected{"a", "a/b", "gear.toml"};
  for (const auto& names : {kTexts, kFigures}) {
    for (const std::string& name : names) {
      expected.push_back("a/b/" + name);
      EXPECT_TRUE(contains(result.out, "a/b/" + name)) << name;
    }
  }
  std::ranges::sort(expected);
  EXPECT_EQ(place.listing(), expected);
  EXPECT_EQ(place.read("gear.toml"), kToleranced);
  EXPECT_EQ(place.read("a/b/tolerances.json"),
            place.run({"tolerances", "gear.toml", "--format", "json"}).out);
  EXPECT_EQ(place.read("a/b/tolerances.csv"),
            place.run({"tolerances", "gear.toml", "--format", "csv"}).out);
  for (const std::string& name : kFigures) {
    std::istringstream stream(place.read("a/b/" + name));
    boost::property_tree::ptree tree;
    ASSERT_NO_THROW(boost::property_tree::read_xml(stream, tree)) << name;
    EXPECT_EQ(tree.count("svg"), 1U) << name;
  }
}

TEST(TolerancesCommand, DrawsFiguresAlsoOfGearboxesThatAllJam) {
  const Workplace place;
  place.write("gear.toml", replaced(kToleranced, "tooth_thickness_um = [-20, 0]",
                                    "tooth_thickness_um = [400, 410]"));
  const ProgramResult result = place.run({"tolerances", "gear.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(place.read("out/tolerances.json")).at("built").at("jammed").at("value"),
            1.0);
  for (const std::string& name : kFigures) EXPECT_TRUE(place.has("out/" + name)) << name;
}

TEST(TolerancesCommand, FilesAgreeWithEachOther) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  ASSERT_EQ(place.run({"tolerances", "gear.toml", "--out", "out"}).exit_code, 0);
  const json data = json::parse(place.read("out/tolerances.json"));
  EXPECT_EQ(data.at("name"), "gear");
  EXPECT_TRUE(data.contains("tolerances"));
  const json& built = data.at("built");
  EXPECT_EQ(built.at("samples"), 1000);
  EXPECT_EQ(built.at("seed"), 7);
  EXPECT_NEAR(built.at("limit_arcmin").get<double>(), 17.5, 1e-12);
  const io::CsvTable bins = io::parse_csv(place.read("out/lost_motion.csv"), "lost_motion.csv");
  double count = 0.0;
  for (const auto& row : bins.rows) count += bins.number(row, "gearboxes").value();
  EXPECT_NEAR(count, 1000.0 * built.at("assembled").at("value").get<double>(), 1e-6);
  const io::CsvTable shares = io::parse_csv(place.read("out/tolerances.csv"), "tolerances.csv");
  EXPECT_EQ(shares.rows.size(), 8U);
  EXPECT_EQ(shares.rows.size(), built.at("shares").at("tolerances").size());
}

TEST(TolerancesCommand, SameBytesAtAnyNumberOfThreadsAndOthersFromAnotherSeed) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  // Five chunks of gearboxes, so that threads have something to share.
  const std::vector<std::string> run{"tolerances", "gear.toml", "--samples", "20000"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), run.begin(), run.end());
    ASSERT_EQ(place.run(more).exit_code, 0);
  };
  with({"--out", "1", "--threads", "1"});
  with({"--out", "4", "--threads", "4"});
  with({"--out", "seed", "--seed", "8"});
  for (const auto& names : {kTexts, kFigures}) {
    for (const std::string& name : names) {
      EXPECT_EQ(place.read("1/" + name), place.read("4/" + name)) << name;
      EXPECT_NE(place.read("1/" + name), place.read("seed/" + name)) << name;
    }
  }
  const auto yield = [&](const std::string& folder) {
    return json::parse(place.read(folder + "/tolerances.json"))
        .at("built")
        .at("yield")
        .at("value")
        .get<double>();
  };
  // Five standard errors of the difference.
  EXPECT_NEAR(yield("1"), yield("seed"), 5.0 * std::sqrt(2.0 * 0.25 / 20000.0));
}

TEST(TolerancesCommand, OptionsStandForTheKeysOfTheFile) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  place.write("other.toml", replaced(replaced(kToleranced, "samples = 1000", "samples = 1500"),
                                     "seed = 7", "seed = 9"));
  const ProgramResult by_option = place.run(
      {"tolerances", "gear.toml", "--samples", "1500", "--seed", "9", "--format", "json"});
  const ProgramResult by_key = place.run({"tolerances", "other.toml", "--format", "json"});
  EXPECT_EQ(by_option.exit_code, 0) << by_option.err;
  EXPECT_EQ(by_option.out, by_key.out);
}

TEST(TolerancesCommand, ADesignWithoutTolerancesIsInvalid) {
  const Workplace place;
  place.write("gear.toml", kDrawn);
  const ProgramResult result = place.run({"tolerances", "gear.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(contains(result.err, "gear.toml: has no [tolerances]; allowed:")) << result.err;
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"gear.toml"}));
}

TEST(TolerancesCommand, UsageErrors) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  for (const char* samples : {"999", "0", "-1", "1000000001", "many"}) {
    const ProgramResult result = place.run({"tolerances", "gear.toml", "--samples", samples});
    EXPECT_EQ(result.exit_code, 1) << samples;
    EXPECT_TRUE(contains(result.err, "--samples")) << result.err;
  }
  EXPECT_EQ(place.run({"tolerances"}).exit_code, 1);
  EXPECT_EQ(place.run({"tolerances", "gear.toml", "--seed", "-1"}).exit_code, 1);
  EXPECT_EQ(place.run({"tolerances", "gear.toml", "--out", ""}).exit_code, 1);
  const ProgramResult typo = place.run({"tolerances", "gear.toml", "--sample", "2000"});
  EXPECT_EQ(typo.exit_code, 1);
  EXPECT_TRUE(contains(typo.err, "did you mean --samples?")) << typo.err;
  const ProgramResult help = place.run({"tolerances", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_TRUE(contains(help.out, "Keys of DESIGN.toml"));
}

TEST(TolerancesCommand, AllErrorsOfTheTableAreReportedAtOnce) {
  const Workplace place;
  place.write("gear.toml", kDrawn +
                               "[tolerances]\npin_position_um = -1\nsamples = 10\n"
                               "[tolerances.P1]\ntooth_thickness_um = [3, -3]\nrun_out_um = 3\n");
  const ProgramResult result = place.run({"tolerances", "gear.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  for (const char* part : {"gear.toml:17:1: tolerances.pin_position_um = -1",
                           "gear.toml:18:1: tolerances.samples = 10",
                           "gear.toml:20:1: tolerances.P1.tooth_thickness_um = [3, -3]",
                           "gear.toml:21:1: unknown key tolerances.P1.run_out_um; did you mean "
                           "tolerances.P1.runout_um?"}) {
    EXPECT_TRUE(contains(result.err, part)) << part << '\n' << result.err;
  }
}

TEST(TolerancesCommand, ACentreDistanceWithoutAWorkingAngleIsNamed) {
  const Workplace place;
  place.write("gear.toml",
              replaced(kToleranced, "center_distance_um = 5", "center_distance_um = [-5000, 0]"));
  const ProgramResult result = place.run({"tolerances", "gear.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "gear.toml: tolerances.center_distance_um: ")) << result.err;
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"gear.toml"}));
}

TEST(TolerancesCommand, NeverReplacesItsInput) {
  for (const char* name : {"tolerances.json", "turn.csv", "lost_motion.svg"}) {
    const Workplace place;
    place.write(name, kToleranced);
    const ProgramResult result = place.run({"tolerances", name, "--out", "."});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_TRUE(contains(result.err, name)) << result.err;
    EXPECT_EQ(place.read(name), kToleranced);
    EXPECT_EQ(place.listing(), (std::vector<std::string>{name}));
  }
}

TEST(TolerancesCommand, WithoutGnuplotTheResultsAreThereAndOldFiguresAreNot) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  ASSERT_EQ(place.run({"tolerances", "gear.toml", "--out", "out"}).exit_code, 0);
  ProgramResult result;
  {
    const OtherPath path("");
    result = place.run({"tolerances", "gear.toml", "--out", "out", "--format", "csv"});
  }
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err, "gnuplot: not found in PATH; figures need it")) << result.err;
  EXPECT_TRUE(contains(result.err, "written without figures: out/tolerances.json")) << result.err;
  EXPECT_EQ(place.read("out/tolerances.csv"), result.out);
  EXPECT_EQ(json::parse(place.read("out/tolerances.json")).at("missing_figures").size(),
            kFigures.size());
  for (const std::string& name : kFigures) {
    EXPECT_FALSE(place.has("out/" + name)) << name;
    EXPECT_TRUE(place.has("out/" + name + ".previous")) << name;
  }
}

TEST(TolerancesCommand, InterruptedSaysOfHowManyGearboxesTheFiguresAre) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  test::RunningProgram program = place.start(
      {"tolerances", "gear.toml", "--samples", "1000000000", "--format", "json", "--quiet"});
  ASSERT_TRUE(program.wait_until_it_catches(SIGTERM, std::chrono::seconds(10)));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.send(SIGTERM);
  const auto result = program.wait(std::chrono::seconds(20));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->signal, 0);
  EXPECT_EQ(result->exit_code, 130);
  EXPECT_TRUE(contains(result->err, "interrupted: figures are of ")) << result->err;
  const auto samples = json::parse(result->out).at("built").at("samples").get<std::int64_t>();
  EXPECT_GT(samples, 0);
  EXPECT_LT(samples, 1'000'000'000);
  EXPECT_TRUE(contains(result->err, fmt::format("of {} gearboxes", samples)));
}

// ---- analyze, mesh ----------------------------------------------------------------------------

TEST(AnalyzeTolerances, AddsLimitsAndSeriesOnlyWhereTheyAreStated) {
  const Workplace place;
  place.write("drawn.toml", kDrawn);
  place.write("built.toml", kToleranced);
  const json drawn = json::parse(place.run({"analyze", "drawn.toml", "--format", "json"}).out);
  const json built = json::parse(place.run({"analyze", "built.toml", "--format", "json"}).out);
  for (const char* key : {"tolerances", "built"}) {
    EXPECT_FALSE(drawn.contains(key)) << key;
    EXPECT_TRUE(built.contains(key)) << key;
  }
  // Nothing that was there before changes.
  for (const auto& [key, value] : drawn.items()) EXPECT_EQ(built.at(key), value) << key;
  EXPECT_EQ(built.at("built").at("samples"), 1000);
  const std::string drawn_table = place.run({"analyze", "drawn.toml", "--full"}).out;
  const std::string built_table = place.run({"analyze", "built.toml", "--full"}).out;
  for (const char* part :
       {"Limits of the built gearbox", "Built gearboxes at one position of the turn: 1000",
        "Which tolerance to tighten first"}) {
    EXPECT_FALSE(contains(drawn_table, part)) << part;
    EXPECT_TRUE(contains(built_table, part)) << part;
  }
  EXPECT_TRUE(
      contains(place.run({"analyze", "built.toml", "--format", "csv"}).out, "\nbuilt,yield,"));
}

TEST(AnalyzeTolerances, ShowsTheSeriesOfTheTolerancesCommand) {
  const Workplace place;
  place.write("gear.toml", kToleranced);
  const json analyzed = json::parse(place.run({"analyze", "gear.toml", "--format", "json"}).out);
  const json built = json::parse(place.run({"tolerances", "gear.toml", "--format", "json"}).out);
  EXPECT_EQ(analyzed.at("tolerances"), built.at("tolerances"));
  // 1000 gearboxes are fewer than either command takes for shares; only one turns them.
  json series = built.at("built");
  EXPECT_EQ(series.at("turn").at("gearboxes"), 400);
  EXPECT_TRUE(analyzed.at("built").at("turn").is_null());
  series["turn"] = nullptr;
  EXPECT_EQ(analyzed.at("built"), series);
}

TEST(MeshTolerances, AreLimitsOfThePair) {
  const Workplace place;
  place.write("pair.toml", example("pairs/wind_turbine_sun_planet.toml"));
  const ProgramResult table = place.run({"mesh", "pair.toml", "--show", "tolerances"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_TRUE(contains(table.out, "min / nominal / max")) << table.out;
  const json data = json::parse(place.run({"mesh", "pair.toml", "--format", "json"}).out);
  const json& backlash = data.at("tolerances").at("meshes").at(0).at("normal_backlash_um");
  EXPECT_LT(backlash.at("min"), backlash.at("max"));
  EXPECT_FALSE(data.contains("built"));
  place.write("drawn.toml", test::replaced(example("pairs/wind_turbine_sun_planet.toml"),
                                           "[tolerances]\ncenter_distance_um = 45.0", "#"));
  EXPECT_EQ(place.run({"mesh", "drawn.toml"}).exit_code, 0);
}

// ---- optimize ---------------------------------------------------------------------------------

/// One tooth set of examples/ratio-96.toml that has to hold for the built gearboxes.
std::string robust_spec(const std::string& robust, double scale = 1.0) {
  std::string spec = example("ratio-96.toml");
  spec = spec.substr(0, std::min({spec.size(), spec.find("[tolerances]"), spec.find("[robust]")}));
  spec = replaced(spec, "S = [10, 24]", "S = [12, 12]");
  spec = replaced(spec, "P1 = [18, 70]", "P1 = [64, 64]");
  spec = replaced(spec, "P2 = [18, 70]", "P2 = [52, 52]");
  spec = replaced(spec, "starts = 4", "starts = 2");
  const auto um = [&](double value) { return std::to_string(scale * value) + "\n"; };
  spec += "[tolerances]\nsamples = 20000\nseed = 5\ncenter_distance_um = " + um(5.0) +
          "pin_position_um = " + um(8.0);
  for (const char* gear : {"S", "P1", "R1", "P2", "R2"}) {
    spec += fmt::format("[tolerances.{}]\nrunout_um = {}tooth_thickness_um = {}", gear, um(12.0),
                        um(4.0));
  }
  return spec + "[robust]\n" + robust;
}

TEST(OptimizeRobust, WritesADesignThatYieldsAsAskedUnderTheStatedLimits) {
  const Workplace place;
  place.write("spec.toml", robust_spec("hold = \"yield\"\nyield = 0.97\n"));
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--full"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* part :
       {"Limits that hold for the built gearboxes", "as stated", "hold for the yield",
        "Built gearboxes at one position of the turn: 20000"}) {
    EXPECT_TRUE(contains(result.out, part)) << part;
  }
  const std::string best = place.read("out/best.toml");
  EXPECT_TRUE(contains(best, "max_output_arcmin = 8.0\n")) << best;
  EXPECT_TRUE(contains(best, "min_normal_um = 10.0\n")) << best;
  EXPECT_TRUE(contains(best, "[tolerances.R2]"));

  const json robust = json::parse(place.read("out/summary.json")).at("robust");
  EXPECT_EQ(robust.at("hold"), "yield");
  const auto chosen = robust.at("chosen").get<std::size_t>();
  ASSERT_GT(chosen, 0U);
  ASSERT_LT(chosen, robust.at("passes").size());
  const json& pass = robust.at("passes").at(chosen);
  EXPECT_GE(pass.at("built").at("yield").get<double>(), 0.97);
  EXPECT_LT(pass.at("max_output_arcmin"), 8.0);
  EXPECT_GT(pass.at("min_normal_um"), 10.0);
  EXPECT_LT(robust.at("passes").at(0).at("built").at("yield"), 0.97);
  EXPECT_NEAR(robust.at("passes").at(0).at("max_output_arcmin").get<double>(), 8.0, 1e-12);
  EXPECT_LT(robust.at("nominal").at("yield"), robust.at("robust").at("yield"));

  // Again from the file, with a seed that nothing has used yet.
  const ProgramResult again = place.run(
      {"tolerances", "out/best.toml", "--seed", "1234", "--samples", "50000", "--format", "json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json built = json::parse(again.out).at("built");
  EXPECT_NEAR(built.at("limit_arcmin").get<double>(), 8.0, 1e-12);
  EXPECT_NEAR(built.at("yield").at("value").get<double>(),
              pass.at("built").at("yield").get<double>(),
              5.0 * std::sqrt(0.97 * 0.03 * (1.0 / 50000.0 + 1.0 / 20000.0)));
  const ProgramResult analysis = place.run({"analyze", "out/best.toml", "--format", "json"});
  EXPECT_EQ(json::parse(analysis.out).at("built").at("yield").at("value"),
            pass.at("built").at("yield"))
      << "the same seed and samples";
}

TEST(OptimizeRobust, ThatCannotHoldSaysWhatWasReached) {
  const Workplace place;
  place.write("spec.toml", robust_spec("hold = \"yield\"\n", 10.0));
  std::filesystem::create_directories(place.file("out"));
  place.write("out/best.toml", "old");
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.out, "");
  for (const char* part : {"spec.toml: no design was found that holds for a yield of 99 %: the "
                           "best that was found yields ",
                           "beyond the limit", "worst case "}) {
    EXPECT_TRUE(contains(result.err, part)) << part << '\n' << result.err;
  }
  EXPECT_FALSE(place.has("out/best.toml"));
  EXPECT_FALSE(place.has("out/summary.json"));
  EXPECT_EQ(place.read("out/best.toml.previous"), "old");
}

TEST(OptimizeRobust, WithTolerancesThatLeaveNoMeshSaysSo) {
  const Workplace place;
  for (const char* hold : {"hold = \"yield\"\n", "hold = \"worst_case\"\n"}) {
    place.write("spec.toml", replaced(robust_spec(hold), "center_distance_um = 5.000000",
                                      "center_distance_um = 2000"));
    const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_TRUE(contains(result.err,
                         "at an end of tolerances.center_distance_um a mesh of the "
                         "best that was found has no working pressure angle"))
        << result.err;
    EXPECT_FALSE(place.has("out/best.toml"));
  }
}

TEST(OptimizeRobust, WorstCaseOfTheFileHasNoJamAndKeepsTheLimit) {
  const Workplace place;
  place.write("spec.toml", robust_spec("hold = \"worst_case\"\n", 0.15));
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--quiet", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const ProgramResult again = place.run({"tolerances", "out/best.toml", "--format", "json"});
  const json data = json::parse(again.out);
  const json& worst = data.at("built").at("worst_case");
  // A thousandth of what is printed.
  EXPECT_LE(worst.at("greatest_arcmin"), 8.0 + 1e-3);
  EXPECT_GE(worst.at("least_margin_um"), -0.1);
  EXPECT_EQ(data.at("built").at("yield").at("value"), 1.0);
  for (const json& check : data.at("tolerances").at("checks")) {
    EXPECT_TRUE(check.at("ok").get<bool>()) << check;
  }
}

TEST(OptimizeRobust, CheapestTolerancesAreThoseOfTheFile) {
  const Workplace place;
  std::string spec = robust_spec("hold = \"yield\"\nyield = 0.9\ntolerances = \"cheapest\"\n");
  // Few sources, as every one of them costs time; thicknesses move the corners of other checks.
  const auto begin = spec.find("[tolerances.S]");
  spec = spec.substr(0, begin) +
         "[tolerances.P1]\ntooth_thickness_um = 4\n[tolerances.R2]\nrunout_um = 12\n" +
         spec.substr(spec.find("[robust]"));
  place.write("spec.toml", spec);
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "Cheapest tolerances for a yield of 90 %")) << result.out;
  const json cheapest = json::parse(place.read("out/summary.json")).at("robust").at("cheapest");
  EXPECT_EQ(cheapest.at("reached"), true);
  EXPECT_LT(cheapest.at("cost"), cheapest.at("stated_cost"));
  EXPECT_GE(cheapest.at("yield").get<double>(), 0.9);
  EXPECT_EQ(cheapest.at("fresh").at("checks_hold"), true);
  const json data = json::parse(place.run({"tolerances", "out/best.toml", "--format", "json"}).out);
  for (const json& check : data.at("tolerances").at("checks")) {
    const auto name = check.at("name").get<std::string>();
    EXPECT_TRUE(check.at("ok").get<bool>() || contains(name, "backlash")) << check;
  }
  const json& built = data.at("built");
  ASSERT_EQ(built.at("shares").at("tolerances").size(), cheapest.at("tolerances").size());
  for (const json& source : built.at("shares").at("tolerances")) {
    const std::string name =
        (source.at("gear").is_null() ? "" : source.at("gear").get<std::string>() + " ") +
        source.at("tolerance").get<std::string>();
    bool found = false;
    for (const json& chosen : cheapest.at("tolerances")) {
      if (chosen.at("tolerance") != name) continue;
      found = true;
      const double asked =
          chosen.at("factor").get<double>() * chosen.at("half_width_um").get<double>();
      EXPECT_NEAR(source.at("half_width_um").get<double>(), asked, 1e-9 * asked) << name;
    }
    EXPECT_TRUE(found) << name;
  }
  // As the files state them: before in SPEC, after in best.toml.
  const std::string best = place.read("out/best.toml");
  for (const auto& [name, key, stated] :
       {std::tuple("center_distance", "center_distance_um", 5.0),
        std::tuple("pin_position", "pin_position_um", 8.0),
        std::tuple("P1 tooth_thickness", "tooth_thickness_um", 4.0),
        std::tuple("R2 runout", "runout_um", 12.0)}) {
    const json& list = cheapest.at("tolerances");
    const auto own = std::ranges::find_if(
        list, [&, tolerance = name](const json& t) { return t.at("tolerance") == tolerance; });
    ASSERT_NE(own, list.end()) << name;
    EXPECT_EQ(own->at("unit"), "um");
    EXPECT_EQ(own->at("stated"), stated) << name;
    EXPECT_EQ(own->at("stated_um"), stated) << name;
    const std::string start = std::string("\n") + key + " = ";
    const auto at = best.find(start);
    ASSERT_NE(at, std::string::npos) << best;
    const std::string line = best.substr(at + start.size(), best.find('\n', at + 1) - at);
    const auto upper = line.find(", ");  // of two limits
    const double written = std::stod(upper == std::string::npos ? line : line.substr(upper + 2));
    EXPECT_NEAR(own->at("cheapest").get<double>(), written, 1e-9 * written) << name;
  }
  EXPECT_NEAR(built.at("yield").at("value").get<double>(), cheapest.at("yield").get<double>(),
              5.0 * std::sqrt(0.1 * 0.9 / 20000.0));
  // Over a turn, by other gearboxes: within five standard errors of both.
  const json& turned = built.at("turn").at("yield");
  const json& turn = cheapest.at("turn").at("yield");
  EXPECT_LT(turn, cheapest.at("yield"));
  EXPECT_NEAR(turned.at("value").get<double>(), turn.get<double>(), 0.1);
}

TEST(OptimizeRobust, WithoutTheTableNothingIsSaidOfBuiltGearboxes) {
  const Workplace place;
  std::string spec = robust_spec("");
  place.write("spec.toml", spec.substr(0, spec.find("[tolerances]")));
  const ProgramResult result =
      place.run({"optimize", "spec.toml", "--out", "out", "--quiet", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(json::parse(result.out).contains("robust"));
}

}  // namespace
}  // namespace gear3k::tolerances_test
