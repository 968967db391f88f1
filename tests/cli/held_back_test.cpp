// What `optimize` says holds a design back, against runs of the program with the key changed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/cli/run_program.hpp"

namespace gear3k::held_back_cli_test {
namespace {

using nlohmann::json;
using test::ProgramResult, test::Workplace, test::replaced;

/// The winner's teeth of the 96:1 example, without a load.
const std::string kOneSet =
    "name = \"one set\"\n[ratio]\ntarget = 96.2\n"
    "[teeth]\nS = [12, 12]\nP1 = [64, 64]\nP2 = [52, 52]\nR1_max = 141\nR2_max = 132\n"
    "[module]\nstage1_mm = { min = 0.5, max = 1.0 }\nstage2_mm = { min = 0.5, max = 1.0 }\n"
    "[profile_shift]\nrange = [0.0, 1.0]\n"
    "[size]\nmax_ring_root_diameter_mm = 76.0\n"
    "[backlash]\nmax_output_arcmin = 8.0\nmin_normal_um = 10.0\nmachining_allowance = 0.02\n"
    "[limits]\nundercut = 0.0\n[friction]\ncoefficient = 0.1\n";

json summary_of(const Workplace& place, const std::string& spec) {
  place.write("spec.toml", spec);
  const ProgramResult run =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--quiet"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return json::parse(place.read("out/summary.json"));
}

double backward_efficiency(const Workplace& place, const std::string& spec) {
  return summary_of(place, spec).at("best").at("eta_b").get<double>();
}

TEST(WithoutDesign, WhyNoLimitIsRelaxedIsSaidOnTheScreenAndInTheSummary) {
  const Workplace place;
  place.write("spec.toml", replaced(kOneSet, "diameter_mm = 76.0", "diameter_mm = 40.0") +
                               "[free]\npressure_angle_deg = [19.0, 21.0]\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("limits that would have to give way are not told: this needs bounds, "
                         "and there are none with a free pressure angle"),
            std::string::npos)
      << run.err;
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("relaxed_limits"), nullptr);
  EXPECT_EQ(summary.at("relaxed_limits_missing").get<std::string>().find("this needs bounds"), 0U);
  place.write("spec.toml", replaced(kOneSet, "diameter_mm = 76.0", "diameter_mm = 40.0"));
  const ProgramResult told =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--quiet"});
  EXPECT_EQ(told.exit_code, 3);
  EXPECT_EQ(told.out, "");
  const json other = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(other.at("relaxed_limits_missing"), nullptr);
  EXPECT_FALSE(other.at("relaxed_limits").at("freed").empty());
}

TEST(WithoutDesign, ScriptsGetTheFilesOnStdoutAllTheSame) {
  const Workplace place;
  place.write("spec.toml", replaced(kOneSet, "diameter_mm = 76.0", "diameter_mm = 40.0"));
  for (const auto& [format, file] :
       {std::pair{"json", "out/summary.json"}, std::pair{"csv", "out/refined.csv"}}) {
    const ProgramResult run = place.run(
        {"optimize", "spec.toml", "--out", "out", "--force", "--quiet", "--format", format});
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_FALSE(run.out.empty());
    EXPECT_EQ(run.out, place.read(file));
  }
}

// With the default of grid_relaxations this task has a design: no limit has to give way.
TEST(WithoutDesign, AGridThatIsCutShortNamesNoLimit) {
  const Workplace place;
  const std::string task =
      replaced(replaced(kOneSet, "stage1_mm = { min = 0.5, max = 1.0 }", "stage1_mm = 0.5"),
               "range = [0.0, 1.0]", "range = [0.0, 1.0]\nstep = 0.02");
  place.write("spec.toml", task + "[solver]\ngrid_relaxations = 3\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_EQ(run.err.find("no feasible design was found: the grids of shifts of 1 tooth set were "
                         "not searched to the end and may have one (raise "
                         "solver.grid_relaxations = 3)"),
            0U)
      << run.err;
  EXPECT_NE(run.err.find("\nlimits that would have to give way are not told: the grids of shifts "
                         "of 1 of the tooth sets were not searched to the end"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("blocked by"), std::string::npos) << run.err;
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("relaxed_limits"), nullptr);
  EXPECT_EQ(summary.at("status").at("no_feasible_found"), 1) << summary;
  EXPECT_TRUE(summary.at("reasons").at("no_feasible_found").empty()) << summary;
  EXPECT_GT(backward_efficiency(place, task), 0.9);
}

// What blocks most sets is named, not the one whose proof happens to miss least.
TEST(WithoutDesign, TheConstraintThatBlocksMostSetsIsNamed) {
  const Workplace place;
  place.write("spec.toml",
              "name = \"seven planets\"\nplanets = 7\nidentical_planets = false\n[ratio]\n"
              "target = 96.2\n[teeth]\nS = [11, 14]\nP1 = [50, 70]\nP2 = [30, 60]\n"
              "R1_max = 150\nR2_max = 150\n[module]\nstage1_mm = { min = 0.5, max = 1.0 }\n"
              "stage2_mm = { min = 0.5, max = 1.0 }\n[size]\nmax_ring_root_diameter_mm = 76.0\n"
              "[friction]\ncoefficient = 0.1\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(run.exit_code, 3);
  const json reasons = json::parse(place.read("out/summary.json")).at("reasons").at("infeasible");
  ASSERT_GT(reasons.size(), 1U) << reasons;
  std::string most;
  for (const auto& [reason, sets] : reasons.items()) {
    if (most.empty() || sets > reasons.at(most)) most = reason;
  }
  EXPECT_EQ(run.err.find("no feasible design: blocked by " + most + ": the nearest set"), 0U)
      << reasons << run.err;
}

// A mesh without backlash has no lost motion, to rounding.
TEST(WithoutDesign, ALimitThatHasToVanishIsToldAsNothing) {
  const Workplace place;
  place.write("spec.toml",
              "name = \"no play\"\npreset = \"machined\"\n[ratio]\ntarget = 50.0\n"
              "tolerance = 0.01\n"
              "[teeth]\nS = [13, 13]\nP1 = [43, 43]\nP2 = [36, 36]\nR1_max = 110\nR2_max = 110\n"
              "min_internal_difference = 9\n"
              "[module]\nstage1_mm = { min = 0.5, max = 1.0 }\n"
              "stage2_mm = { min = 0.5, max = 1.0 }\n[profile_shift]\nrange = [-0.5, 1.0]\n"
              "[size]\nring_rim_mm = 3.0\nmax_outer_diameter_mm = 86.0\n"
              "[backlash]\nmachining_allowance = 0.02\nmax_output_arcmin = 0\n"
              "[friction]\ncoefficient = 0.1\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("\n  backlash.min_normal_um = 0 um instead of 20 (preset): "),
            std::string::npos)
      << run.err;
}

TEST(WithoutDesign, ADiameterOfNothingIsRefusedWithItsLine) {
  for (const char* key : {"max_ring_root_diameter_mm", "max_outer_diameter_mm"}) {
    const Workplace place;
    place.write("spec.toml",
                replaced(kOneSet, "max_ring_root_diameter_mm = 76.0", std::string(key) + " = 0"));
    const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find(std::string("spec.toml:16:1: size.") + key +
                           " = 0: allowed: a number in mm, above 0 to 1000000"),
              std::string::npos)
        << run.err;
    EXPECT_EQ(place.listing(), std::vector<std::string>{"spec.toml"});
  }
}

TEST(HeldBack, PricesAreWhatRunsWithTheKeyChangedGain) {
  const Workplace place;
  const json summary = summary_of(place, kOneSet);
  struct Moved {
    const char* key;
    const char* text;
    const char* up;
    const char* down;
    double difference;
  };
  for (const Moved& m :
       {Moved{"backlash.max_output_arcmin", "max_output_arcmin = 8.0", "max_output_arcmin = 8.02",
              "max_output_arcmin = 7.98", 0.04},
        Moved{"limits.undercut", "undercut = 0.0", "undercut = 0.001", "undercut = -0.001", 0.002},
        Moved{"profile_shift.range[1]", "range = [0.0, 1.0]", "range = [0.0, 1.001]",
              "range = [0.0, 0.999]", 0.002}}) {
    const auto price = std::ranges::find_if(
        summary.at("prices"), [&](const json& entry) { return entry.at("key") == m.key; });
    ASSERT_NE(price, summary.at("prices").end()) << m.key;
    const double gain = backward_efficiency(place, replaced(kOneSet, m.text, m.up)) -
                        backward_efficiency(place, replaced(kOneSet, m.text, m.down));
    const auto per_unit = price->at("price_per_unit").get<double>();
    EXPECT_NEAR(gain / m.difference / per_unit, 1.0, 0.02) << m.key;
    EXPECT_NEAR(price->at("percent_points_per_step").get<double>(),
                100.0 * per_unit * price->at("step").get<double>(), 1e-12);
  }
}

TEST(HeldBack, FitsTheColumnsOfTheScreen) {
  const Workplace place;
  place.write("spec.toml", kOneSet);
  for (const std::size_t columns : {80U, 120U}) {
    const ProgramResult run =
        place.run({"optimize", "spec.toml", "--out", "out", "--force", "--round", "--quiet",
                   "--columns", std::to_string(columns)});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    std::istringstream lines(run.out);
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
      EXPECT_LE(line.size(), columns) << line;
    }
    EXPECT_GT(count, 30U);
    for (const char* part : {"Held back by", "Rounded to what is made", "Limits:", "Files in"}) {
      EXPECT_NE(run.out.find(part), std::string::npos) << part;
    }
  }
}

TEST(ShiftStep, BestDesignHasWholeStepsAndSaysWhyThereAreNoPrices) {
  const Workplace place;
  const std::string task =
      replaced(kOneSet, "range = [0.0, 1.0]", "range = [0.0, 1.0]\nstep = 0.25");
  const json summary = summary_of(place, task);
  EXPECT_TRUE(summary.at("prices").empty());
  EXPECT_EQ(summary.at("prices_missing"),
            "shifts are multiples of profile_shift.step, between which nothing is");
  const ProgramResult analysis = place.run({"analyze", "out/best.toml", "--format", "json"});
  EXPECT_EQ(place.run({"analyze", "out/best.toml", "--strict"}).exit_code, 0);
  const json result = json::parse(analysis.out);
  ASSERT_FALSE(result.at("gears").empty());
  for (const json& gear : result.at("gears")) {
    const double steps = gear.at("profile_shift").get<double>() / 0.25;
    EXPECT_EQ(steps, std::round(steps));
  }
  // Into the same folder.
  EXPECT_LT(summary.at("best").at("eta_b").get<double>(), backward_efficiency(place, kOneSet));
}

TEST(ShiftStep, AGridThatIsNotSearchedToTheEndIsToldEverywhere) {
  const Workplace place;
  const std::string task =
      replaced(kOneSet, "range = [0.0, 1.0]", "range = [0.0, 1.0]\nstep = 0.1") +
      "[solver]\ngrid_relaxations = 3\n";
  place.write("spec.toml", task);
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out", "--certify",
                                       "--columns", "100", "--show", "notes"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("Note: the grid of shifts was not searched to the end in 1 tooth set, at"),
            std::string::npos)
      << run.out;
  EXPECT_NE(run.err.find("the grids of 1 refined set were not searched to the end"),
            std::string::npos)
      << run.err;
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("grid_cut"), 1);
  EXPECT_EQ(summary.at("certificate").at("grid_cut"), 1);
  EXPECT_NE(place.read("out/refined.csv").find(",grid_cut\n"), std::string::npos);
  EXPECT_NE(place.read("out/refined.csv").find(",true\n"), std::string::npos);
  const json whole = summary_of(place, replaced(task, "relaxations = 3", "relaxations = 20000"));
  EXPECT_EQ(whole.at("grid_cut"), 0);
  EXPECT_EQ(summary.at("refinements"), 1);  // of one set with a range of modules
  EXPECT_EQ(whole.at("refinements"), 1);
  EXPECT_GE(summary.at("relaxations"), 3);
  EXPECT_GT(whole.at("relaxations"), summary.at("relaxations"));
  EXPECT_GE(whole.at("best").at("eta_b").get<double>(),
            summary.at("best").at("eta_b").get<double>());
}

TEST(ShiftStep, GridsThatPassesForBuiltGearboxesDidNotEndAreTold) {
  const Workplace place;
  place.write("spec.toml",
              replaced(kOneSet, "range = [0.0, 1.0]", "range = [0.0, 1.0]\nstep = 0.1") +
                  "[solver]\ngrid_relaxations = 3\n[tolerances]\ncenter_distance_um = 2.0\n"
                  "samples = 1000\n[robust]\nhold = \"worst_case\"\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out", "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("  grids of shifts were not searched to the end in "), std::string::npos)
      << run.out;
  const json passes = json::parse(place.read("out/summary.json")).at("robust").at("passes");
  ASSERT_FALSE(passes.empty());
  for (const json& pass : passes) EXPECT_EQ(pass.at("grid_cut"), 1);
}

TEST(HeldBack, TellsWhatLiesBeyondTheEndsOfRanges) {
  const Workplace place;
  std::string task = replaced(kOneSet, "P1 = [64, 64]", "P1 = [50, 66]");
  task = replaced(replaced(task, "S = [12, 12]", "S = [13, 13]"), "P2 = [52, 52]", "P2 = [40, 52]");
  task = replaced(replaced(task, "R1_max = 141", "R1_max = 145"), "R2_max = 132", "R2_max = 140");
  const json summary = summary_of(place, task);
  const double best = summary.at("best").at("eta_b").get<double>();
  int better = 0;
  for (const json& bound : summary.at("at_bounds")) {
    const auto key = bound.at("key").get<std::string>();
    if (!key.starts_with("teeth.S") && !key.starts_with("teeth.P")) continue;
    // A run with that range says the same.
    const std::string gear = key.substr(6, key.size() - 9);
    const int to = bound.at("tried").get<int>();
    const bool upper = key.ends_with("[1]");
    const std::string line = gear == "S"    ? "S = [13, 13]"
                             : gear == "P1" ? "P1 = [50, 66]"
                                            : "P2 = [40, 52]";
    const std::string wide = gear + " = [" + std::to_string(upper ? to - 1 : to) + ", " +
                             std::to_string(upper ? to : to + 1) + "]";
    place.write("wide.toml", replaced(task, line, wide));
    const ProgramResult run =
        place.run({"optimize", "wide.toml", "--out", "wide", "--force", "--quiet"});
    const bool feasible = run.exit_code == 0;
    const double there =
        feasible ? json::parse(place.read("wide/summary.json")).at("best").at("eta_b").get<double>()
                 : 0.0;
    if (bound.at("better").is_null()) {
      EXPECT_LE(there, best + 1e-7) << key;
    } else {
      ++better;
      EXPECT_NEAR(bound.at("better").at("objective").get<double>(), there, 1e-7) << key;
      EXPECT_NEAR(bound.at("better").at("change").get<double>(), there - best, 1e-7) << key;
    }
  }
  EXPECT_GT(better, 0);
}

TEST(HeldBack, PricesOfALoadAreWhatRunsWithTheKeyChangedGain) {
  // Mass of gears as narrow as they carry 20 N m.
  const std::string task =
      "objective = \"mass\"\n[ratio]\ntarget = 96.2\ntolerance = 0.01\n"
      "[teeth]\nS = [12, 12]\nP1 = [60, 60]\nP2 = [35, 35]\nR1_max = 132\nR2_max = 88\n"
      "[module]\nstage1_mm = { min = 0.5, max = 1.0 }\nstage2_mm = { min = 0.5, max = 1.0 }\n"
      "[backlash]\nmax_output_arcmin = 8.0\n[limits]\nform_circle = 0.0\n"
      "[stage1]\nface_width_mm = { min = 1.0, max = 12.0 }\n"
      "[stage2]\nface_width_mm = { min = 1.0, max = 12.0 }\n"
      "[material]\nname = \"34CrNiMo6 through hardened\"\n"
      "[strength]\noutput_torque_nm = 20.0\ns_f_min = 1.5\ns_h_min = 1.2\n"
      "[friction]\ncoefficient = 0.1\n";
  const Workplace place;
  const auto mass = [&](const std::string& spec) {
    return summary_of(place, spec).at("best_per_planets")[0].at("objective").get<double>();
  };
  struct Moved {
    const char* key;
    const char* text;
    const char* up;
    const char* down;
    double difference;
  };
  const json summary = summary_of(place, task);
  for (const Moved& m :
       {Moved{"strength.s_f_min", "s_f_min = 1.5", "s_f_min = 1.501", "s_f_min = 1.499", 0.002},
        Moved{"strength.s_h_min", "s_h_min = 1.2", "s_h_min = 1.2005", "s_h_min = 1.1995", 0.001},
        Moved{"limits.form_circle", "form_circle = 0.0", "form_circle = 1e-4",
              "form_circle = -1e-4", 2e-4}}) {
    const auto price = std::ranges::find_if(
        summary.at("prices"), [&](const json& entry) { return entry.at("key") == m.key; });
    ASSERT_NE(price, summary.at("prices").end()) << m.key;
    const double gain = mass(replaced(task, m.text, m.up)) - mass(replaced(task, m.text, m.down));
    EXPECT_NEAR(gain / m.difference / price->at("price_per_unit").get<double>(), 1.0, 0.02)
        << m.key;
    EXPECT_TRUE(price->at("percent_points_per_step").is_null());
  }
}

TEST(HeldBack, NamesTheBoundsOfTheSearchAndTheNearestBetterAnswer) {
  const Workplace place;
  const json summary = summary_of(place, kOneSet);
  std::string at;
  for (const json& bound : summary.at("at_bounds")) at += bound.at("key").get<std::string>() + " ";
  EXPECT_EQ(at,
            "teeth.S[0] teeth.S[1] teeth.P1[0] teeth.P1[1] teeth.P2[0] teeth.P2[1] teeth.R1_max "
            "teeth.R2_max ");
  const json& better = summary.at("better_estimate");
  double most = 0.0;
  for (const json& price : summary.at("prices")) {
    const json& refined = price.at("refined_change_per_step");
    if (!refined.is_null()) most = std::max(most, refined.get<double>());
  }
  EXPECT_EQ(better.at("change"), most);
  EXPECT_DOUBLE_EQ(better.at("objective").get<double>(),
                   summary.at("best").at("eta_b").get<double>() + most);
  const std::string table =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--quiet"}).out;
  for (const char* text : {"\nHeld back by ", "  backlash.max_output_arcmin ", "8 arcmin",
                           "  at a bound of the search: teeth.S[0]", "  nearest better: "}) {
    EXPECT_NE(table.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(table.find("Best by number of planets"), std::string::npos);
}

// The better answer is what a run with the limit moved has.
TEST(HeldBack, SearchesAgainWithTheLimitThatGainsMost) {
  const Workplace place;
  const json summary = summary_of(place, kOneSet);
  const json& again = summary.at("better_searched");
  ASSERT_EQ(again.at("key"), summary.at("better_estimate").at("key"));
  EXPECT_EQ(again.at("all_sets"), true);
  const auto value = again.at("value").get<double>();
  const auto key = again.at("key").get<std::string>();
  const std::string moved =
      key == "limits.undercut"
          ? replaced(kOneSet, "undercut = 0.0", "undercut = " + std::to_string(value))
      : key == "profile_shift.range[1]"
          ? replaced(kOneSet, "range = [0.0, 1.0]", "range = [0.0, " + std::to_string(value) + "]")
          : replaced(kOneSet, "max_output_arcmin = 8.0",
                     "max_output_arcmin = " + std::to_string(value));
  ASSERT_NE(moved, kOneSet) << key;
  const double best = summary.at("best").at("eta_b").get<double>();
  const auto found = again.at("better").at("objective").get<double>();
  EXPECT_NEAR(found, backward_efficiency(place, moved), 1e-8);
  EXPECT_GT(found, best);
  EXPECT_DOUBLE_EQ(again.at("better").at("change").get<double>(), found - best);
}

TEST(HeldBack, TellsTheBestOfEveryNumberOfPlanets) {
  const Workplace place;
  const std::string task =
      "planets = [2, 3]\n[ratio]\ntarget = 50.0\ntolerance = 0.002\n"
      "[teeth]\nS = [12, 14]\nP1 = [30, 40]\nP2 = [30, 40]\nR1_max = 120\nR2_max = 120\n"
      "[module]\nstage1_mm = { min = 0.5, max = 1.0 }\nstage2_mm = { min = 0.5, max = 1.0 }\n";
  const json both = summary_of(place, task);
  ASSERT_EQ(both.at("best_per_planets").size(), 2);
  const std::string table =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--quiet"}).out;
  EXPECT_NE(table.find("\nBest by number of planets\n"), std::string::npos);
  double best = 0.0;
  for (const json& entry : both.at("best_per_planets")) {
    const std::string own =
        replaced(task, "[2, 3]", std::to_string(entry.at("planets").get<int>()));
    const json alone = summary_of(place, own);
    EXPECT_EQ(entry.at("teeth"), alone.at("best").at("teeth"));
    EXPECT_EQ(entry.at("eta_b"), alone.at("best").at("eta_b"));
    EXPECT_EQ(entry.at("prices"), alone.at("prices"));
    best = std::max(best, entry.at("objective").get<double>());
  }
  EXPECT_EQ(both.at("best").at("eta_b"), best);
  EXPECT_TRUE(both.at("planets_without_best").empty());
}

TEST(HeldBack, ProvesTheBestOfEveryNumberOfPlanetsAndSaysWhichHaveNone) {
  const Workplace place;
  // Ten planets have no room; six have a design, whose bound is below the best of three.
  place.write("spec.toml",
              "planets = [3, 6, 10]\n[ratio]\ntarget = 30.0\ntolerance = 0.001\n"
              "[teeth]\nS = [14, 30]\nP1 = [16, 40]\nP2 = [16, 40]\nR1_max = 110\nR2_max = 110\n"
              "[module]\nstage1_mm = 0.5\nstage2_mm = { min = 0.4, max = 0.6 }\n"
              "[limits]\nplanet_gap = 1.0\n");
  const auto reason_of = [&](int planets, const json& summary) -> std::string {
    for (const json& entry : summary.at("planets_without_best")) {
      if (entry.at("planets") == planets) return entry.at("reason").get<std::string>();
    }
    return "";
  };
  const auto run = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"optimize", "spec.toml", "--out", "out", "--force"});
    const auto result = place.run(options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return std::pair(result.out, json::parse(place.read("out/summary.json")));
  };
  const auto [plain_table, plain] = run({"--quiet"});
  EXPECT_EQ(reason_of(6, plain), "");
  EXPECT_EQ(reason_of(10, plain), "no_design");
  EXPECT_NE(plain_table.find("\n  10: no design\n"), std::string::npos) << plain_table;
  const auto [table, certified] = run({"--quiet", "--certify"});
  EXPECT_EQ(reason_of(3, certified), "");
  EXPECT_EQ(reason_of(6, certified), "");
  EXPECT_EQ(reason_of(10, certified), "no_design");
  EXPECT_NE(table.find("\nBest by number of planets, each by a proof of its own\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\n  10: no design\n"), std::string::npos) << table;
  ASSERT_EQ(certified.at("best_per_planets").size(), plain.at("best_per_planets").size());
  for (std::size_t k = 0; k < certified.at("best_per_planets").size(); ++k) {
    const json& proven = certified.at("best_per_planets")[k];
    const json& best = plain.at("best_per_planets")[k];
    EXPECT_EQ(proven.at("teeth"), best.at("teeth"));
    EXPECT_EQ(proven.at("objective"), best.at("objective"));
    EXPECT_EQ(proven.at("certificate").at("best"), best.at("objective"));
    EXPECT_GE(proven.at("certificate").at("global_bound"), best.at("objective"));
    EXPECT_EQ(best.at("certificate"), nullptr);
  }
}

}  // namespace
}  // namespace gear3k::held_back_cli_test
