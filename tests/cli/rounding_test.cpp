// `optimize --round`: the best design of what is made.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <string>

#include "tests/cli/run_program.hpp"

namespace gear3k::rounding_cli_test {
namespace {

using nlohmann::json;
using test::ProgramResult, test::Workplace, test::replaced;

const std::string kTask =
    "name = \"one set\"\n[ratio]\ntarget = 96.2\n"
    "[teeth]\nS = [12, 12]\nP1 = [64, 64]\nP2 = [52, 52]\nR1_max = 141\nR2_max = 132\n"
    "[module]\nstage1_mm = { min = 0.5, max = 1.0 }\nstage2_mm = { min = 0.5, max = 1.0 }\n"
    "[size]\nmax_ring_root_diameter_mm = 76.0\n"
    "[backlash]\nmax_output_arcmin = 8.0\nmin_normal_um = 10.0\nmachining_allowance = 0.02\n"
    "[friction]\ncoefficient = 0.1\n[round]\nprofile_shift = 0.02\n";

/// Whether a number is a multiple of a step, to rounding.
bool on_step(double value, double step) {
  return std::abs(value / step - std::round(value / step)) < 1e-9;
}

TEST(OptimizeRound, WritesADesignOfWholeStepsThatPassesEveryCheck) {
  const Workplace place;
  place.write("spec.toml", kTask);
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out", "--round"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("\nRounded to what is made: shifts to 0.02, "), std::string::npos);
  EXPECT_NE(run.out.find("best_rounded.toml, refined.csv"), std::string::npos);
  const ProgramResult analysis =
      place.run({"analyze", "out/best_rounded.toml", "--strict", "--format", "json"});
  ASSERT_EQ(analysis.exit_code, 0) << analysis.err;
  const json rounded = json::parse(place.read("out/summary.json")).at("rounded");
  const json best = json::parse(place.read("out/summary.json")).at("best");
  EXPECT_EQ(rounded.at("feasible"), true);
  EXPECT_EQ(rounded.at("complete"), true);
  for (const json& shift : rounded.at("profile_shift"))
    EXPECT_TRUE(on_step(shift.get<double>(), 0.02));
  for (const json& module : rounded.at("module_mm"))
    EXPECT_TRUE(on_step(module.get<double>(), 0.01));
  for (const json& length : rounded.at("machining_allowance_um"))
    EXPECT_TRUE(on_step(length.get<double>(), 1.0));
  EXPECT_TRUE(on_step(rounded.at("center_distance_mm").get<double>(), 0.005));
  EXPECT_EQ(rounded.at("face_width_mm"), json({nullptr, nullptr})) << "none is stated";
  const auto objective = rounded.at("objective").get<double>();
  EXPECT_LT(objective, best.at("eta_b").get<double>());
  EXPECT_NEAR(rounded.at("loss").get<double>(), best.at("eta_b").get<double>() - objective, 1e-15);
  // The analysis of the file says the same.
  const json efficiency = json::parse(analysis.out).at("efficiency");
  EXPECT_NEAR(efficiency.at("backward").get<double>(), objective, 1e-12);
  // Without --round it would pass for a result of this run.
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "out", "--force", "--quiet"}).exit_code,
            0);
  EXPECT_FALSE(std::filesystem::exists(place.file("out/best_rounded.toml")));
  EXPECT_TRUE(std::filesystem::exists(place.file("out/best_rounded.toml.previous")));
  EXPECT_TRUE(json::parse(place.read("out/summary.json")).at("rounded").is_null());
}

json rounded_with(const Workplace& place, const std::string& steps, ProgramResult& run) {
  place.write("spec.toml", replaced(kTask, "[round]\nprofile_shift = 0.02\n", "[round]\n" + steps));
  run = place.run({"optimize", "spec.toml", "--out", "out", "--force", "--round", "--quiet"});
  return json::parse(place.read("out/summary.json")).at("rounded");
}

TEST(OptimizeRound, SaysWhichStepOfModulesFitsNothing) {
  const Workplace place;
  ProgramResult run;
  // Multiples within 0.5 to 1.0 mm: 0.7 alone, with which the stages have no distance in common.
  const json one = rounded_with(place, "module_mm = 0.7\n", run);
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("every check: with none of the modules tried in steps of 0.7 mm "
                         "(round.module_mm) was a design of these teeth found"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(one.at("module_pairs"), 1);
  EXPECT_EQ(one.at("module_pairs_with_design"), 0);
  place.write("spec.toml", replaced(replaced(kTask, "stage1_mm = { min = 0.5, max = 1.0 }",
                                             "stage1_mm = { min = 0.51, max = 0.59 }"),
                                    "profile_shift = 0.02", "module_mm = 0.1"));
  run = place.run({"optimize", "spec.toml", "--out", "out", "--force", "--round", "--quiet"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("no module in its range is a multiple of round.module_mm = 0.1"),
            std::string::npos)
      << run.err;
}

// Without its allowance of 10 um a tooth is thicker than the free optimum's.
TEST(OptimizeRound, SaysWhereWhatIsMadeIsBetterThanWhatIsDrawn) {
  const Workplace place;
  ProgramResult run;
  const json rounded = rounded_with(place, "allowance_um = 100\n", run);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(rounded.at("loss").get<double>(), 0.0);
  EXPECT_NE(run.out.find(" percent points better than the free optimum"), std::string::npos)
      << run.out;
  EXPECT_EQ(run.out.find("a loss of -"), std::string::npos);
}

TEST(OptimizeRound, WritesAllowancesOfFewDigits) {
  const Workplace place;
  std::string task =
      replaced(kTask, "stage1_mm = { min = 0.5, max", "stage1_mm = { min = 0.6, max");
  task = replaced(replaced(task, "stage2_mm = { min = 0.5, max", "stage2_mm = { min = 0.6, max"),
                  "diameter_mm = 76.0", "diameter_mm = 90.0");
  place.write("spec.toml", replaced(task, "profile_shift = 0.02", "module_mm = 0.1"));
  const ProgramResult run =
      place.run({"optimize", "spec.toml", "--out", "out", "--round", "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json rounded = json::parse(place.read("out/summary.json")).at("rounded");
  EXPECT_EQ(rounded.at("module_mm")[0], 0.6);
  // 12 um over 0.6 mm.
  EXPECT_NE(place.read("out/best_rounded.toml").find("machining_allowance = 0.02\n"),
            std::string::npos);
}

// A thickness allowance is a length: what it thins a tooth by does not depend on the module.
TEST(OptimizeRound, TellsWhatThicknessAllowancesThinTheTeethBy) {
  const Workplace place;
  place.write("spec.toml", replaced(kTask, "machining_allowance = 0.02\n",
                                    "S.A_sn_um = [-30.0, -14.0]\nP1.A_sn_um = [-30.0, -14.0]\n"
                                    "R1.A_sn_um = [-40.0, -20.0]\nP2.A_sn_um = [-30.0, -14.0]\n"
                                    "R2.A_sn_um = [-40.0, -20.0]\n"));
  const ProgramResult run =
      place.run({"optimize", "spec.toml", "--out", "out", "--round", "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json lengths =
      json::parse(place.read("out/summary.json")).at("rounded").at("machining_allowance_um");
  const double cosine = std::cos(20.0 * std::numbers::pi / 180.0);
  for (std::size_t gear = 0; gear < 5; ++gear) {
    EXPECT_NEAR(lengths[gear].get<double>(), (gear == 2 || gear == 4 ? 30.0 : 22.0) * cosine, 1e-6);
  }
  const ProgramResult search = place.run({"search", "spec.toml"});
  EXPECT_NE(search.out.find("P2-R2 closed, A_sn_um at the least module (before"), std::string::npos)
      << search.out;
  EXPECT_NE(run.out.find(", allowances 20.67 20.67 28.19 20.67 28.19 um"), std::string::npos)
      << run.out;
}

TEST(OptimizeRound, WritesNoDigitsOfRounding) {
  const Workplace place;
  // Rims make an outer diameter of root circle and twice 2.15 mm.
  place.write("spec.toml", replaced(kTask, "max_ring_root_diameter_mm = 76.0",
                                    "max_ring_root_diameter_mm = 76.0\nmax_outer_diameter_mm = "
                                    "86.0\nring_rim_mm = 2.15"));
  const ProgramResult run =
      place.run({"optimize", "spec.toml", "--out", "out", "--round", "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string design = place.read("out/best_rounded.toml");
  EXPECT_NE(design.find("outer_diameter_mm = "), std::string::npos) << design;
  // 10 um over 0.52 mm has no end; all other numbers do.
  const std::regex long_number("\n(?!machining_allowance)[a-z_]* = [0-9]+\\.[0-9]{13,}");
  std::smatch found;
  EXPECT_FALSE(std::regex_search(design, found, long_number)) << found[0];
}

TEST(OptimizeRound, StepsThatNothingReadsAreToldOnTheScreenAndInTheSummary) {
  const Workplace place;
  place.write("spec.toml", kTask);
  const ProgramResult run =
      place.run({"optimize", "spec.toml", "--out", "out", "--columns", "200", "--show", "notes"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string text = "the steps of [round] are read by optimize --round only";
  EXPECT_NE(run.out.find(text), std::string::npos) << run.out;
  const auto missing = json::parse(place.read("out/summary.json")).at("rounded_missing");
  EXPECT_EQ(missing.get<std::string>().find(text), 0U);
  // Nothing is said of steps that no file states.
  place.write("spec.toml", replaced(kTask, "[round]\nprofile_shift = 0.02\n", ""));
  const ProgramResult bare =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--format", "json"});
  ASSERT_EQ(bare.exit_code, 0) << bare.err;
  EXPECT_EQ(json::parse(bare.out).at("rounded_missing"), nullptr);
}

TEST(OptimizeRound, SaysWhichLimitBlocksWhereNoStepFits) {
  const Workplace place;
  place.write("spec.toml", replaced(kTask, "[round]\nprofile_shift = 0.02\n",
                                    "[round]\nprofile_shift = 0.5\ncenter_distance_mm = 1.0\n"));
  const ProgramResult run =
      place.run({"optimize", "spec.toml", "--out", "out", "--force", "--round", "--quiet"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("spec.toml: no rounded design meets every check: the nearest misses "),
            std::string::npos)
      << run.err;
  EXPECT_TRUE(std::filesystem::exists(place.file("out/best.toml")));
  EXPECT_FALSE(std::filesystem::exists(place.file("out/best_rounded.toml")));
  const json rounded = json::parse(place.read("out/summary.json")).at("rounded");
  EXPECT_EQ(rounded.at("feasible"), false);
  ASSERT_FALSE(rounded.at("blocked_by").empty());
  EXPECT_GT(rounded.at("blocked_by")[0].at("amount").get<double>(), 0.0);
}

}  // namespace
}  // namespace gear3k::rounding_cli_test
