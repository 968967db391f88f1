// A_sn as files state it: DESIGN, PAIR and SPEC.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::thickness_allowance_test {
namespace {

constexpr double kCos20 = 0.93969262078590838;  // cos 20 deg
constexpr double kMicrometre = 1e-6;

std::string design_with(const std::string& sun, const std::string& rest = "") {
  return "[stage1]\nmodule_mm = 0.8\n[stage2]\nmodule_mm = 0.8467\n[gears]\n"
         "S = { teeth = 12, profile_shift = 0.476" +
         sun +
         " }\n"
         "P1 = { teeth = 39, profile_shift = 0.762 }\n"
         "R1 = { teeth = 90, profile_shift = 2.0 }\n"
         "P2 = { teeth = 32, profile_shift = 0.536 }\n"
         "R2 = { teeth = 81, profile_shift = 1.21, A_sn_um = [-50.0, -20.0] }\n" +
         rest;
}

design::Design parsed(const std::string& text) { return parse_design(text, "gear.toml"); }

template <class Parse>
std::string errors_of(Parse parse) {
  try {
    static_cast<void>(parse());
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(ThicknessAllowance, IsTheThinningOfItsMiddleWithHalfItsWidthAsTolerance) {
  const design::Design d = parsed(design_with(", A_sn_um = [-60.0, -30.0]"));
  // 45 um of arc are 45 cos 20 deg um normal to the flanks, of a module of 0.8 mm.
  EXPECT_NEAR(d.train.machining_allowance[train::kS], 45e-3 * kCos20 / 0.8, 1e-15);
  EXPECT_NEAR(d.train.machining_allowance[train::kR2], 35e-3 * kCos20 / 0.8467, 1e-15);
  EXPECT_EQ(d.train.machining_allowance[train::kP1], 0.0);
  ASSERT_TRUE(d.tolerances);
  EXPECT_NEAR(d.tolerances->gears[train::kS].tooth_thickness_m.lower, -15e-6, 1e-18);
  EXPECT_NEAR(d.tolerances->gears[train::kS].tooth_thickness_m.upper, 15e-6, 1e-18);
  EXPECT_EQ(d.tolerances->gears[train::kP1].tooth_thickness_m.upper, 0.0);
}

TEST(ThicknessAllowance, IsTheThinningAndTheToleranceThatAFileCouldStateInstead) {
  const auto range = [](const std::string& text) {
    const auto e = std::get<design::Evaluation>(design::evaluate(parsed(text)));
    return e.tolerance_limits->meshes[0].normal_backlash_m;
  };
  const auto a = range(design_with(", A_sn_um = [-60.0, -30.0]"));
  const auto b = range(design_with(fmt::format(", normal_thinning_um = {}", 45.0 * kCos20),
                                   "[tolerances.S]\ntooth_thickness_um = 15.0\n"));
  EXPECT_NEAR(a.least, b.least, 1e-15);
  EXPECT_NEAR(a.nominal, b.nominal, 1e-15);
  EXPECT_NEAR(a.greatest, b.greatest, 1e-15);
}

TEST(ThicknessAllowance, ExcludesThinningAndToleranceOfItsGearAtBothLines) {
  const std::string both = errors_of(
      [] { return parsed(design_with(", A_sn_um = [-60, -30], normal_thinning_um = 4")); });
  EXPECT_NE(both.find("gears.S.A_sn_um and gears.S.normal_thinning_um state the same"),
            std::string::npos)
      << both;
  const std::string toleranced = errors_of([] {
    return parsed(
        design_with(", A_sn_um = [-60, -30]", "[tolerances.S]\ntooth_thickness_um = 15.0\n"));
  });
  for (const char* line : {"gear.toml:6:", "gear.toml:12:"}) {
    EXPECT_NE(toleranced.find(line), std::string::npos) << toleranced;
  }
  EXPECT_NE(errors_of([] {
              return parsed(design_with(", A_sn_um = [-60, -30], machining_allowance = 0.0"));
            }).find("gears.S.A_sn_um and gears.S.machining_allowance"),
            std::string::npos);
  // The tolerance of another gear, and others of this one, stay.
  EXPECT_EQ(errors_of([] {
              return parsed(design_with(", A_sn_um = [-60, -30]",
                                        "[tolerances.S]\ntip_diameter_um = 5\n[tolerances.P1]\n"
                                        "tooth_thickness_um = 15.0\n"));
            }),
            "");
}

TEST(ThicknessAllowance, IsRefusedOutsideItsRange) {
  EXPECT_NE(errors_of([] { return parsed(design_with(", A_sn_um = [-30, 10]")); }).find("A_sn_um"),
            std::string::npos);
  EXPECT_NE(errors_of([] { return parsed(design_with(", A_sn_um = [-30, -60]")); }).find("A_sn_um"),
            std::string::npos);
  EXPECT_NE(errors_of([] {
              return parsed(design_with(", A_sn_um = [-2000, -1800]"));
            }).find("allowed: at most 851.342 um (1 module)"),  // 800/cos 20 deg
            std::string::npos);
}

TEST(ThicknessAllowance, IsWrittenAsItWasStated) {
  const design::Design d =
      parsed(design_with(", A_sn_um = [-60.0, -30.0]", "[tolerances.S]\ntip_diameter_um = 5.0\n"));
  const std::string text = design_text(d);
  EXPECT_NE(text.find("A_sn_um = [-60.0, -30.0]"), std::string::npos) << text;
  EXPECT_EQ(text.find("tooth_thickness_um"), std::string::npos) << text;
  const design::Design again = as_written(d);
  for (const train::GearId gear : {train::kS, train::kR2}) {
    EXPECT_EQ(again.train.machining_allowance[gear], d.train.machining_allowance[gear]);
    EXPECT_EQ(again.tolerances->gears[gear].tooth_thickness_m.upper,
              d.tolerances->gears[gear].tooth_thickness_m.upper);
  }
  EXPECT_EQ(design_text(again), text);
}

TEST(ThicknessAllowance, IsNotWrittenWhereThinningOrToleranceAreNoLongerItsOwn) {
  design::Design d = parsed(design_with(", A_sn_um = [-60.0, -30.0]"));
  d.tolerances->gears[train::kS].tooth_thickness_m = {.lower = -5e-6, .upper = 5e-6};
  const design::Design again = as_written(d);
  EXPECT_FALSE(again.thickness_allowance_m[train::kS]);
  EXPECT_TRUE(again.thickness_allowance_m[train::kR2]);
  EXPECT_NEAR(again.tolerances->gears[train::kS].tooth_thickness_m.upper, 5e-6, 1e-20);
  EXPECT_NEAR(again.train.machining_allowance[train::kS], d.train.machining_allowance[train::kS],
              1e-15);
}

// The drawing's own numbers: tests/golden/kisssoft_stage_01.toml, circumferential_backlash.
TEST(ThicknessAllowance, OfAPairGivesTheBacklashThatKissSoftPrints) {
  const design::PairDesign pair = parse_pair(
      "kind = \"internal\"\nmodule_mm = 45.0\ncenter_distance_mm = 863.0\n"
      "[gear1]\nteeth = 17\nprofile_shift = 0.8021342559\nA_sn_um = [-255.0, -175.0]\n"
      "[gear2]\nteeth = 56\nprofile_shift = 0.5013089106\nA_sn_um = [-590.0, -430.0]\n"
      "[tolerances]\ncenter_distance_um = 45.0\n",
      "pair.toml");
  const auto e = std::get<design::PairEvaluation>(design::evaluate(pair));
  ASSERT_TRUE(e.tolerance_limits);
  const auto& j_t = e.tolerance_limits->meshes[0].circumferential_backlash_m;
  EXPECT_NEAR(j_t.least / 1e-3, 0.567, 0.0005);
  EXPECT_NEAR(j_t.greatest / 1e-3, 0.859, 0.0005);
  EXPECT_NEAR(j_t.nominal / 1e-3, 0.5 * (0.567 + 0.859), 0.001);
}

const std::string kSpec =
    "[ratio]\ntarget = 96.2\n"
    "[teeth]\nS = [12, 13]\nP1 = [50, 60]\nR1_max = 120\nP2 = [40, 60]\nR2_max = 121\n"
    "[module]\nstage1_mm = { min = 0.8, max = 1.0 }\nstage2_mm = 0.9\n"
    "[backlash]\nS.A_sn_um = [-60.0, -30.0]\n";

TEST(ThicknessAllowance, OfASpecThinsByALengthAtAnyModule) {
  const auto spec = parse_specification(kSpec, "spec.toml");
  EXPECT_TRUE(optimize::thinning_varies(spec));
  for (const double module_m : {0.8e-3, 1e-3}) {
    const double q =
        optimize::machining_allowance(spec, train::kS, spec.pressure_angle_rad, module_m);
    EXPECT_NEAR(q * module_m, 45.0 * kMicrometre * kCos20, 1e-18);
  }
  EXPECT_NEAR(spec.machining_allowance[train::kS] * 0.8e-3, 45.0 * kMicrometre * kCos20, 1e-18);
  ASSERT_TRUE(spec.tolerances);
  EXPECT_NEAR(spec.tolerances->gears[train::kS].tooth_thickness_m.upper, 15e-6, 1e-18);
}

TEST(ThicknessAllowance, OfASpecExcludesThinningAndTolerance) {
  const auto errors = [](const std::string& rest) {
    return errors_of([&] { return parse_specification(kSpec + rest, "spec.toml"); });
  };
  EXPECT_EQ(errors("machining_allowance = { P1 = 0.02 }\n"), "");
  const std::string thinned = errors("machining_allowance = 0.02\n");
  for (const char* line : {"spec.toml:13:", "spec.toml:14:"}) {
    EXPECT_NE(thinned.find(line), std::string::npos) << thinned;
  }
  EXPECT_NE(errors("[tolerances.S]\ntooth_thickness_um = 4.0\n").find("tolerances.S"),
            std::string::npos);
}

}  // namespace
}  // namespace gear3k::io::thickness_allowance_test
