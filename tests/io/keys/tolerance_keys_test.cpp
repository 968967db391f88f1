#include "io/keys/tolerance_keys.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::tolerance_keys_test {
namespace {

constexpr double kArcmin = std::numbers::pi / 10800.0;

const std::string kBilateral =
    "planets = 3\n"
    "[stage1]\nmodule_mm = 0.8\n"
    "[stage2]\nmodule_mm = 0.8467\n"
    "[gears]\n"
    "S = { teeth = 12, profile_shift = 0.476 }\n"
    "P1 = { teeth = 39, profile_shift = 0.762 }\n"
    "R1 = { teeth = 90, profile_shift = 2.0 }\n"
    "P2 = { teeth = 32, profile_shift = 0.536 }\n"
    "R2 = { teeth = 81, profile_shift = 1.21 }\n";

const std::string kAll =
    "[tolerances]\ncenter_distance_um = [-4, 6]\npin_position_um = 8\nplanet_phase_arcmin = 0.5\n"
    "scatter = \"uniform\"\nsigma_level = 2.5\nsamples = 5000\nseed = 9\n"
    "[tolerances.S]\ntooth_thickness_um = [-20, -5]\ntip_diameter_um = [-10, 0]\n"
    "root_diameter_um = [-30, 3]\nrunout_um = 7\ncumulative_pitch_um = 11\nsingle_pitch_um = 3\n"
    "[tolerances.R2]\ntooth_thickness_um = 6\n";

design::Design parse(const std::string& text) { return parse_design(text, "gear.toml"); }

std::string errors_of(const std::string& text) {
  try {
    static_cast<void>(parse(text));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(ToleranceKeys, WithoutTheTableADesignHasNoTolerances) {
  EXPECT_FALSE(parse(kBilateral).tolerances);
  EXPECT_EQ(design_text(parse(kBilateral)).find("tolerances"), std::string::npos);
}

TEST(ToleranceKeys, AreReadInSi) {
  const design::Design d = parse(kBilateral + kAll);
  ASSERT_TRUE(d.tolerances);
  const backlash::Tolerances& t = *d.tolerances;
  EXPECT_DOUBLE_EQ(t.center_distance_m.lower, -4e-6);
  EXPECT_DOUBLE_EQ(t.center_distance_m.upper, 6e-6);
  EXPECT_DOUBLE_EQ(t.pin_position_m, 8e-6);
  EXPECT_DOUBLE_EQ(t.planet_phase_rad.lower, -0.5 * kArcmin);
  EXPECT_DOUBLE_EQ(t.planet_phase_rad.upper, 0.5 * kArcmin);
  EXPECT_EQ(t.scatter, backlash::Scatter::kUniform);
  EXPECT_EQ(t.sigma_level, 2.5);
  EXPECT_EQ(d.sampling.samples, 5000);
  EXPECT_EQ(d.sampling.seed, 9U);
  const backlash::GearTolerances& sun = t.gears[train::kS];
  EXPECT_DOUBLE_EQ(sun.tooth_thickness_m.lower, -20e-6);
  EXPECT_DOUBLE_EQ(sun.tooth_thickness_m.upper, -5e-6);
  EXPECT_DOUBLE_EQ(sun.tip_diameter_m.lower, -10e-6);
  ASSERT_TRUE(sun.root_diameter_m);
  EXPECT_DOUBLE_EQ(sun.root_diameter_m->upper, 3e-6);
  EXPECT_DOUBLE_EQ(sun.runout_m, 7e-6);
  EXPECT_DOUBLE_EQ(sun.cumulative_pitch_m, 11e-6);
  EXPECT_DOUBLE_EQ(sun.single_pitch_m, 3e-6);
  const backlash::GearTolerances& ring = t.gears[train::kR2];
  EXPECT_DOUBLE_EQ(ring.tooth_thickness_m.lower, -6e-6);
  EXPECT_DOUBLE_EQ(ring.tooth_thickness_m.upper, 6e-6);
  EXPECT_FALSE(ring.root_diameter_m);
}

TEST(ToleranceKeys, SurviveBeingWritten) {
  const std::string written = design_text(parse(kBilateral + kAll));
  EXPECT_NE(written.find("[tolerances.R2]"), std::string::npos);
  EXPECT_EQ(design_text(parse(written)), written);
}

TEST(ToleranceKeys, AGradeSetsWhatIsNotStated) {
  const design::Design d =
      parse(kBilateral + "[tolerances.R2]\naccuracy_grade = 6\nrunout_um = 4\n");
  ASSERT_TRUE(d.tolerances);
  const auto grade =
      backlash::pitch_grade({.module_m = 0.8467e-3, .reference_diameter_m = 81 * 0.8467e-3}, 6);
  ASSERT_TRUE(grade);
  const backlash::GearTolerances& ring = d.tolerances->gears[train::kR2];
  EXPECT_DOUBLE_EQ(ring.runout_m, 4e-6);
  EXPECT_EQ(ring.cumulative_pitch_m, grade->cumulative_pitch_m);
  EXPECT_EQ(ring.single_pitch_m, grade->single_pitch_m);
}

TEST(ToleranceKeys, EveryErrorIsReportedAtItsLine) {
  const std::string errors =
      errors_of(kBilateral +
                "[tolerances]\ncenter_distance_um = [6, -4]\npin_position_um = -1\n"
                "scatter = \"gaussian\"\n"
                "[tolerances.P1]\ntooth_thickness_um = -3\nacuracy_grade = 6\n");
  EXPECT_NE(errors.find("gear.toml:13:1: tolerances.center_distance_um = [6, -4]: allowed: a "
                        "number >= 0, meaning +- it, or [lower, upper], lower <= upper"),
            std::string::npos)
      << errors;
  EXPECT_NE(errors.find("gear.toml:14:1: tolerances.pin_position_um = -1"), std::string::npos);
  EXPECT_NE(errors.find("gear.toml:15:1: tolerances.scatter = \"gaussian\": allowed: \"normal\" or "
                        "\"uniform\""),
            std::string::npos);
  EXPECT_NE(errors.find("gear.toml:17:1: tolerances.P1.tooth_thickness_um = -3"),
            std::string::npos);
  EXPECT_NE(errors.find("gear.toml:18:1: unknown key tolerances.P1.acuracy_grade; did you mean "
                        "tolerances.P1.accuracy_grade?"),
            std::string::npos)
      << errors;
}

TEST(ToleranceKeys, AGradeOutsideItsSizesIsAnErrorThatNamesThem) {
  std::string small = kBilateral;
  small.replace(small.find("0.8467"), 6, "0.2000");
  const std::string errors = errors_of(small + "[tolerances.P2]\naccuracy_grade = 6\n");
  EXPECT_NE(errors.find("tolerances.P2.accuracy_grade = 6: a gear of module 0.2 mm and reference "
                        "diameter 6.4 mm; allowed: module 0.5 to 70 mm"),
            std::string::npos)
      << errors;
}

const std::string kSpec =
    "[ratio]\ntarget = 96.2\n[teeth]\nS = [10, 20]\nP1 = [20, 60]\nR1_max = 120\nP2 = [20, 60]\n"
    "R2_max = 120\n[module]\nstage1_mm = 0.5\nstage2_mm = 0.5\n";

TEST(ToleranceKeys, ASpecStatesThemToo) {
  const auto spec = parse_specification(
      kSpec +
          "[tolerances]\npin_position_um = 8\n[tolerances.P2]\nrunout_um = 5\n"
          "[robust]\nhold = \"yield\"\nyield = 0.95\ntolerances = \"cheapest\"\n"
          "cost = { runout = 2.5 }\n",
      "spec.toml");
  ASSERT_TRUE(spec.tolerances);
  EXPECT_DOUBLE_EQ(spec.tolerances->pin_position_m, 8e-6);
  EXPECT_DOUBLE_EQ(spec.tolerances->gears[train::kP2].runout_m, 5e-6);
  EXPECT_EQ(spec.robust.hold, optimize::Hold::kYield);
  EXPECT_EQ(spec.robust.yield, 0.95);
  EXPECT_TRUE(spec.robust.cheapest);
  EXPECT_EQ(spec.robust.cost[static_cast<std::size_t>(backlash::ToleranceKind::kRunout)], 2.5);
}

}  // namespace
}  // namespace gear3k::io::tolerance_keys_test
