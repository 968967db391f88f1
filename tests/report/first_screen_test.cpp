// The first screen of a design: lines, columns, and the change of a tip that it names.

#include "report/first_screen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "design/output_terms.hpp"
#include "design/sensitivity.hpp"
#include "design/tightest.hpp"
#include "io/files/design_file.hpp"
#include "io/files/subject_file.hpp"
#include "report/analysis_report.hpp"

namespace gear3k::first_screen_test {
namespace {

const std::string kExamples = std::string(GEAR3K_SOURCE_DIR) + "/examples/";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void expect_fits(const std::string& text, std::size_t lines, std::size_t columns) {
  EXPECT_LE(lines_of(text).size(), lines) << text;
  for (const std::string& line : lines_of(text)) EXPECT_LE(line.size(), columns) << line;
}

class FirstScreen : public testing::TestWithParam<const char*> {};

TEST_P(FirstScreen, FitsAScreen) {
  const design::Design design = io::read_design(kExamples + "designs/" + GetParam() + ".toml");
  const auto e = std::get<design::Evaluation>(design::evaluate(design));
  const auto tightest = design::tightest_checks(design, e, 6);
  const auto series = design::table_series(design);
  const design::BuiltSeries* built = series ? &*series : nullptr;
  expect_fits(report::first_screen(e, tightest, built, 100), 25, 100);
  expect_fits(report::first_screen(e, tightest, built, 120), 25, 120);
  expect_fits(report::first_screen(e, tightest, built, 80), 32, 80);
}

INSTANTIATE_TEST_SUITE_P(Designs, FirstScreen,
                         testing::Values("loaded", "ratio_96_with_losses", "ratio_96_tolerances",
                                         "bilateral_drive_gear", "low_backlash_prototype"));

std::string screen_of(const design::Design& design) {
  const auto e = std::get<design::Evaluation>(design::evaluate(design));
  return report::first_screen(e, design::tightest_checks(design, e, 6), nullptr, 100);
}

// Of the larger ring, and only where the outer surfaces of both are stated.
TEST(FirstScreenOfRims, HasTheOuterDiameter) {
  design::Design design = io::read_design(kExamples + "designs/loaded.toml");
  const auto e = std::get<design::Evaluation>(design::evaluate(design));
  const auto screen = [&] {
    return report::first_screen(e, {}, nullptr, 100, design::stated_outer_diameter_m(design));
  };
  EXPECT_EQ(screen().find("outer diameter"), std::string::npos);
  design.masses.ring1_outer_radius_m = 0.041;
  EXPECT_EQ(screen().find("outer diameter"), std::string::npos);
  design.masses.ring2_outer_radius_m = 0.0425;
  EXPECT_NE(screen().find("\n  size         outer diameter 85.00 mm, ring roots "),
            std::string::npos)
      << screen();
}

TEST(FirstScreenOfShapedRings, NamesTheirCutters) {
  design::Design design = io::read_design(kExamples + "designs/ratio_96_tolerances.toml");
  EXPECT_EQ(screen_of(design).find("cutter"), std::string::npos) << screen_of(design);
  design.train.cutter[train::kR2].teeth = 40;
  EXPECT_NE(screen_of(design).find("pinion cutters: R2 by 40 teeth\n"), std::string::npos)
      << screen_of(design);
}

TEST(FirstScreenOfAllTables, HasNoTwoEmptyLines) {
  std::ifstream file(kExamples + "designs/loaded.toml");
  const std::string loaded{std::istreambuf_iterator<char>(file), {}};
  const std::string screen = screen_of(
      io::parse_design(loaded + "\n[tolerances]\ncenter_distance_um = 10\n", "loaded.toml"));
  EXPECT_EQ(screen.find("Not checked"), std::string::npos) << screen;
  EXPECT_EQ(screen.find("\n\n\n"), std::string::npos) << screen;
}

TEST(FirstScreenOfAPair, FitsAScreen) {
  const design::PairDesign pair = io::read_pair(kExamples + "pair_internal.toml");
  const auto e = std::get<design::PairEvaluation>(design::evaluate(pair));
  const auto tightest = design::tightest_checks(pair, e, 6);
  for (const int columns : {80, 100, 120}) {
    expect_fits(report::first_screen(e, tightest, columns), 25, static_cast<std::size_t>(columns));
  }
}

/// Evaluates the pair with the tip that is named changed, and looks at the check.
TEST(TipRemedy, MeetsTheLimitWhenItIsMade) {
  const design::PairDesign pair = io::read_pair(kExamples + "pair_internal.toml");
  const auto e = std::get<design::PairEvaluation>(design::evaluate(pair));
  int solved = 0;
  for (const design::TightestCheck& t : design::tightest_checks(pair, e, 6)) {
    if (!t.tip) continue;
    ++solved;
    design::PairDesign changed = pair;
    changed.center_distance_m = e.center_distance_m;
    geometry::Gear<double>& gear = t.tip->gear == e.gears[0].name ? changed.gear1 : changed.gear2;
    const auto margin_with = [&](double shorter_m) {
      const double before = gear.tip_shortening;
      gear.tip_shortening += shorter_m / gear.module_m;
      const auto result = std::get<design::PairEvaluation>(design::evaluate(changed));
      gear.tip_shortening = before;
      const auto same = std::ranges::find_if(result.checks, [&](const design::CheckResult& c) {
        return c.record == t.check->record && c.gear == t.check->gear;
      });
      return same->margin;
    };
    const double step_m = 1e-6 + 2e-4 * gear.module_m;
    EXPECT_GE(margin_with(t.tip->shorter_m), 0.0) << t.check->record->name;
    EXPECT_LT(margin_with(t.tip->shorter_m - step_m), 0.0) << t.check->record->name;
  }
  EXPECT_GE(solved, 2);
}

TEST(TipRemedy, CuresAFailedCheckByTheAmountThatIsPrinted) {
  design::Design design = io::parse_design(
      "[stage1]\nmodule_mm = 0.6\n[stage2]\nmodule_mm = 0.6\n[gears]\n"
      "S = { teeth = 15, profile_shift = 0.3, machining_allowance = 0.07 }\n"
      "P1 = { teeth = 51, profile_shift = 0.2, machining_allowance = 0.08 }\n"
      "R1 = { teeth = 117, profile_shift = 0.9, machining_allowance = 0.1 }\n"
      "P2 = { teeth = 41, profile_shift = 0.1, machining_allowance = 0.05 }\n"
      "R2 = { teeth = 107, profile_shift = 0.8, machining_allowance = 0.05 }\n",
      "gear.toml");
  design.train.center_distance_m = 20.25e-3;
  design.center_distance_given = true;
  int cured = 0;
  for (int limit = 20; limit < 80; limit += 3) {
    design.limits[design::CheckId::kFormCircle] = 1e-3 * limit;
    const auto e = std::get<design::Evaluation>(design::evaluate(design));
    for (const design::TightestCheck& t : design::tightest_checks(design, e, 3)) {
      if (t.check->ok || t.check->record->id != design::CheckId::kFormCircle || !t.tip) continue;
      const std::string text = report::first_screen(e, std::vector{t}, nullptr, 300);
      const std::string words = "shorten the tip of " + t.tip->gear + " by ";
      const auto place = text.find(words);
      ASSERT_NE(place, std::string::npos) << text;
      const double told_mm = std::stod(text.substr(place + words.size()));
      const auto gear = static_cast<std::size_t>(std::ranges::find(train::kGearNames, t.tip->gear) -
                                                 train::kGearNames.begin());
      design::Design changed = design;
      changed.train.tip_shortening[gear] += told_mm / 0.6;
      const auto again = std::get<design::Evaluation>(design::evaluate(changed));
      const auto same = std::ranges::find_if(again.checks, [&](const design::CheckResult& c) {
        return c.record == t.check->record && c.mesh == t.check->mesh && c.gear == t.check->gear;
      });
      EXPECT_TRUE(same->ok) << text << same->margin;
      ++cured;
    }
  }
  EXPECT_GT(cured, 20);
}

TEST(Broken, KeepsEveryWordAndTheColumns) {
  const std::string text = "  one two  three " + std::string(90, 'x') + " four";
  const std::string broken = report::broken(text, 60, 4);
  EXPECT_EQ(broken, "  one two  three\n    " + std::string(90, 'x') + "\n    four\n");
}

/// Counted from the evaluation itself.
TEST(FirstScreenWithTolerances, CountsChecksAsDrawnAndAsBuilt) {
  design::Design design = io::read_design(kExamples + "designs/ratio_96_tolerances.toml");
  const auto built = [&] {
    const auto e = std::get<design::Evaluation>(design::evaluate(design));
    return std::pair(
        std::ranges::count(e.tolerance_limits->checks, false, &design::CheckLimits::holds),
        e.tolerance_limits->checks.size());
  };
  ASSERT_GT(built().first, 0);
  const std::string counts = "passed as drawn, within [tolerances] " +
                             std::to_string(built().first) + " of " +
                             std::to_string(built().second) + " fail (--show tolerances)";
  EXPECT_NE(screen_of(design).find(counts), std::string::npos) << screen_of(design);
  const auto e = std::get<design::Evaluation>(design::evaluate(design));
  for (const design::CheckLimits& check : e.tolerance_limits->checks) {
    if (!check.holds) design.limits[check.record->id].reset();
  }
  ASSERT_EQ(built().first, 0);
  EXPECT_NE(screen_of(design).find(" passed, as drawn and within [tolerances]; the nearest to"),
            std::string::npos)
      << screen_of(design);
  design.tolerances.reset();
  EXPECT_NE(screen_of(design).find(" passed; the nearest to their limits\n"), std::string::npos);
}

TEST(FirstScreenWithTolerances, TellsFailuresAsDrawnApartFromThoseAsBuilt) {
  design::Design design = io::read_design(kExamples + "designs/ratio_96_tolerances.toml");
  auto e = std::get<design::Evaluation>(design::evaluate(design));
  for (design::CheckLimits& check : e.tolerance_limits->checks) check.holds = true;
  e.checks.front().ok = false;
  const std::string screen =
      report::first_screen(e, design::tightest_checks(design, e, 6), nullptr, 100);
  const std::string counts = "Checks: 1 of " + std::to_string(e.checks.size()) +
                             " failed as drawn, within [tolerances] all " +
                             std::to_string(e.tolerance_limits->checks.size()) + " hold";
  EXPECT_NE(screen.find(counts), std::string::npos) << screen;
}

TEST(FirstScreenOfAFailedCheck, KeepsTheTightestOfThosePassed) {
  design::Design design = io::read_design(kExamples + "designs/loaded.toml");
  design.limits[design::CheckId::kContactRatioMax] = 1.0;
  const std::string screen = screen_of(design);
  const std::size_t failed = screen.find("  FAILED ");
  const std::size_t passed = screen.find("\nPassed; the nearest to their limits\n  ");
  ASSERT_NE(failed, std::string::npos) << screen;
  ASSERT_NE(passed, std::string::npos) << screen;
  EXPECT_LT(failed, passed);
  expect_fits(screen, 25, 100);
}

TEST(AnalysisText, SaysWhatAPartThatIsAskedForLacks) {
  design::Design design = io::read_design(kExamples + "designs/low_backlash_prototype.toml");
  design.tolerances.reset();
  design.rating.reset();
  design.operating_point.reset();
  design.masses.face_width_m = {};
  const auto e = std::get<design::Evaluation>(design::evaluate(design));
  ASSERT_FALSE(e.total_mass_kg);
  using report::Section;
  const std::string text =
      report::analysis_text(e, {},
                            {.full = false,
                             .sections = {Section::kLosses, Section::kStrength, Section::kMasses,
                                          Section::kTolerances, Section::kThermal, Section::kBuilt},
                             .columns = 100},
                            design::sensitivities(design), nullptr, nullptr, nullptr, {});
  for (const char* lack :
       {"\nLosses: nothing without [operating_point]\n", "\nStrength: nothing without [strength]\n",
        "\nLimits of the built gearing: nothing without [tolerances]\n",
        "\nTemperature: nothing without [thermal]\n",
        "\nBuilt gearboxes: nothing without [tolerances]\n"}) {
    EXPECT_NE(text.find(lack), std::string::npos) << lack << text;
  }
  EXPECT_NE(text.find("lacks " + e.total_mass_missing), std::string::npos) << text;
}

}  // namespace
}  // namespace gear3k::first_screen_test
