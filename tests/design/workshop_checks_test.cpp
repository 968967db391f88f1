// Checks of what a workshop states: tips, clearances and walls as lengths, sliding, whole size,
// tooth numbers; and the presets that set them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "design/evaluation.hpp"
#include "design/preset.hpp"
#include "geometry/sliding.hpp"
#include "io/files/design_file.hpp"

namespace gear3k::design::workshop_checks_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The low-backlash gearbox of the paper with bores and rings of stated sizes.
std::string text_with(const std::string& limits, const std::string& top = "") {
  return top +
         "planets = 3\ncenter_distance_mm = 16.19\n"
         "[stage1]\nmodule_mm = 0.59\nface_width_mm = 8.0\n"
         "[stage2]\nmodule_mm = 0.58\nface_width_mm = 11.0\n"
         "[gears.S]\nteeth = 14\nprofile_shift = 0.5\nmachining_allowance = 0.02\nbore_mm = 4.0\n"
         "[gears.P1]\nteeth = 40\nmachining_allowance = 0.02\nbore_mm = 6.0\n"
         "[gears.R1]\nteeth = 94\nprofile_shift = 0.45\nmachining_allowance = 0.02\n"
         "outer_diameter_mm = 62.0\n"
         "[gears.P2]\nteeth = 36\nprofile_shift = 0.4\nmachining_allowance = 0.02\nbore_mm = 6.0\n"
         "[gears.R2]\nteeth = 92\nprofile_shift = 0.29\nmachining_allowance = 0.02\n" +
         limits;
}

Evaluation evaluated(const std::string& text) {
  return std::get<Evaluation>(evaluate(io::parse_design(text, "design.toml")));
}

/// Values of a check, in the order of its members [SI].
std::vector<double> values_of(const Evaluation& e, CheckId id) {
  std::vector<double> values;
  for (const CheckResult& check : e.checks) {
    if (check.record->id == id) values.push_back(check.value);
  }
  return values;
}

/// Root diameter of a gear cut by the standard rack, dedendum 1.25.
double root_diameter_mm(double module_mm, int teeth, double shift, bool ring) {
  return module_mm * (teeth + 2.0 * shift + (ring ? 2.5 : -2.5));
}

TEST(WorkshopChecks, WallIsBetweenRootAndBoreOrOuterSurfaceWhereTheseAreKnown) {
  const auto walls = values_of(evaluated(text_with("[size]\nmin_wall_mm = 1.0\n")), CheckId::kWall);
  ASSERT_EQ(walls.size(), 4U) << "S, P1, R1, P2; R2 states no outer diameter";
  const std::array expected{0.5 * (root_diameter_mm(0.59, 14, 0.5, false) - 4.0),
                            0.5 * (root_diameter_mm(0.59, 40, 0.0, false) - 6.0),
                            0.5 * (62.0 - root_diameter_mm(0.59, 94, 0.45, true)),
                            0.5 * (root_diameter_mm(0.58, 36, 0.4, false) - 6.0)};
  for (std::size_t i = 0; i < walls.size(); ++i) {
    EXPECT_NEAR(walls[i] * 1e3, expected[i], 1e-12) << i;
  }
}

TEST(WorkshopChecks, WholeSizeIsThatOfRingsWithRimsAndOfTheFaceWidths) {
  const std::string limits =
      "[size]\nmax_outer_diameter_mm = 61.0\nmax_length_mm = 18.5\nmin_sun_root_diameter_mm = "
      "7.4\n";
  const Evaluation e = evaluated(text_with(limits));
  const auto diameters = values_of(e, CheckId::kGearboxDiameter);
  ASSERT_EQ(diameters.size(), 2U);
  EXPECT_NEAR(diameters[0] * 1e3, 62.0, 1e-12);
  EXPECT_NEAR(diameters[1] * 1e3, root_diameter_mm(0.58, 92, 0.29, true), 1e-12);
  EXPECT_NEAR(values_of(e, CheckId::kGearboxLength)[0] * 1e3, 19.0, 1e-12);
  EXPECT_NEAR(values_of(e, CheckId::kSunRootDiameter)[0] * 1e3,
              root_diameter_mm(0.59, 14, 0.5, false), 1e-12);
  for (const CheckResult& check : e.checks) {
    if (check.record->id == CheckId::kGearboxLength) {
      EXPECT_NEAR(check.margin, -0.5e-3, 1e-15);
    }
    if (check.record->id == CheckId::kGearboxDiameter && check.gear == "R1") {
      EXPECT_NEAR(check.margin, -1e-3, 1e-15);
      EXPECT_FALSE(check.ok);
    }
  }
  const Evaluation placed = evaluated(
      text_with(limits + "[axial]\nS_mm = [0.0, 8.0]\nP2_mm = [8.5, 20.0]\nR1_mm = [-3.0, 9.0]\n"));
  EXPECT_NEAR(values_of(placed, CheckId::kGearboxLength)[0] * 1e3, 23.0, 1e-12);
  // A gear that has no place is as wide as the faces, about the middle of its stage: 8 and 11 mm.
  const Evaluation steps =
      evaluated(text_with(limits + "[axial]\nP1_mm = [0.0, 6.0]\nP2_mm = [7.0, 16.0]\n"));
  EXPECT_NEAR(values_of(steps, CheckId::kGearboxLength)[0] * 1e3, 16.0 + 2.0, 1e-12);
}

TEST(WorkshopChecks, LengthsOfTipsAndClearancesAreThoseInModulesTimesTheModule) {
  const Evaluation e =
      evaluated(text_with("[limits]\ntip_thickness_mm = 0.1\nroot_clearance_mm = 0.05\n"));
  auto tips = values_of(e, CheckId::kTipThickness);  // S, P1, P2
  const auto rings = values_of(e, CheckId::kRingTipThickness);
  tips = {0.59 * tips[0], 0.59 * tips[1], 0.59 * rings[0], 0.58 * tips[2], 0.58 * rings[1]};
  const auto lengths = values_of(e, CheckId::kTipThicknessLength);
  ASSERT_EQ(lengths.size(), tips.size());
  for (std::size_t i = 0; i < tips.size(); ++i) EXPECT_NEAR(lengths[i] * 1e3, tips[i], 1e-12) << i;
  const auto clearances = values_of(e, CheckId::kRootClearance);
  const auto clearances_m = values_of(e, CheckId::kRootClearanceLength);
  ASSERT_EQ(clearances_m.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(clearances_m[i] * 1e3, clearances[i] * (i < 4 ? 0.59 : 0.58), 1e-12) << i;
  }
}

TEST(WorkshopChecks, SlidingIsTheRatioOfSpeedsAtTheTipsContact) {
  const Evaluation e = evaluated(text_with("[limits]\nspecific_sliding = 3.0\n"));
  const auto sliding = values_of(e, CheckId::kSpecificSliding);
  ASSERT_EQ(sliding.size(), 6U);
  // S-P1 by hand: P1's tip touches S at the distance ρ from S's tangent point.
  const double cosine = std::cos(20.0 * kPi / 180.0);
  const double base_s = 0.5 * 0.59 * 14 * cosine, base_p = 0.5 * 0.59 * 40 * cosine;
  const double line = std::sqrt(16.19 * 16.19 - (base_s + base_p) * (base_s + base_p));
  const double tip_p = 0.5 * 0.59 * 42.0;
  const double at_p = std::sqrt(tip_p * tip_p - base_p * base_p);
  const double at_s = line - at_p;
  const double speed_s = at_s * 1.0, speed_p = at_p * 14.0 / 40.0;  // at ω_S = 1
  EXPECT_NEAR(sliding[0], -(speed_s - speed_p) / speed_s, 1e-9);
  for (const MeshResult& mesh : e.meshes) {
    for (const std::size_t own : {0U, 1U}) {
      const std::size_t k = static_cast<std::size_t>(&mesh - e.meshes.data()) * 2 + own;
      EXPECT_NEAR(sliding[k], -mesh.tip_sliding[1 - own].specific_at_root, 1e-9)
          << mesh.name << own;
    }
  }
}

TEST(RootSliding, GoesOnSmoothlyAndRisesWhereTheTipInterferes) {
  using geometry::rolling_share, geometry::sliding_at;
  double before = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 4000; ++i) {
    const double share = 1.5 - 1e-3 * i;
    const double sliding = sliding_at(share);
    EXPECT_TRUE(std::isfinite(sliding));
    EXPECT_GT(sliding, before) << share;
    EXPECT_NEAR(rolling_share(sliding), share, 1e-12 * (1.0 + std::abs(sliding)));
    before = sliding;
  }
  const double at = geometry::kLeastRollingShare, h = 1e-7;
  const double left = (sliding_at(at) - sliding_at(at - h)) / h;
  const double right = (sliding_at(at + h) - sliding_at(at)) / h;
  EXPECT_NEAR(left, right, 1e-4 * std::abs(right));
}

TEST(WorkshopChecks, CommonFactorsAreThoseOfTheMeshesThatAreAskedOf) {
  const auto factors = [](const std::string& limits) {
    return values_of(evaluated(text_with(limits)), CheckId::kHuntingTooth);
  };
  EXPECT_EQ(factors("[limits]\nhunting_tooth = true\n"), (std::vector{2.0, 2.0, 4.0}));
  EXPECT_EQ(factors("[limits]\nhunting_tooth = 3\nhunting_meshes = \"P2-R2\"\n"),
            (std::vector{4.0}));
  EXPECT_TRUE(factors("").empty());
  const Evaluation e = evaluated(text_with("[limits]\nhunting_tooth = 2\n"));
  for (const CheckResult& check : e.checks) {
    if (check.record->id == CheckId::kHuntingTooth) {
      EXPECT_EQ(check.ok, check.mesh != "P2-R2");
    }
  }
}

TEST(WorkshopChecks, ListedTeethAreAsFarAsTheNearestThatIsAllowed) {
  const Evaluation e =
      evaluated(text_with("[allowed_teeth]\nS = [12, 17]\nR2 = 92\nP1 = [30, 38, 45]\n"));
  EXPECT_EQ(values_of(e, CheckId::kAllowedTeeth), (std::vector{2.0, 2.0, 0.0}));
}

TEST(WorkshopChecks, ModulesThatDifferMissOneModuleByTheirDifference) {
  const Evaluation e = evaluated(text_with("[limits]\nsame_module = true\n"));
  EXPECT_NEAR(values_of(e, CheckId::kSameModule)[0], 0.01e-3, 1e-15);
  EXPECT_FALSE(all_ok(e.checks));
}

TEST(WorkshopChecks, AMeshMayHaveALeastBacklashOfItsOwn) {
  const Design design = io::parse_design(
      text_with("[backlash]\nmin_normal_um = 5.0\n[backlash.P2-R2]\nmin_normal_um = 12.0\n"),
      "design.toml");
  EXPECT_DOUBLE_EQ(least_backlash_m(design.limits, train::kMeshSP1).value(), 5e-6);
  EXPECT_DOUBLE_EQ(least_backlash_m(design.limits, train::kMeshP2R2).value(), 12e-6);
  const Evaluation e = std::get<Evaluation>(evaluate(design));
  for (const CheckResult& check : e.checks) {
    if (check.record->id != CheckId::kNormalBacklash) continue;
    EXPECT_NEAR(check.value - check.margin, check.mesh == "P2-R2" ? 12e-6 : 5e-6, 1e-18);
  }
}

TEST(WorkshopChecks, HoldAtTheWorstCornerOfTheTolerances) {
  const Evaluation e = evaluated(text_with(
      "[size]\nmin_wall_mm = 1.0\nmin_sun_root_diameter_mm = 7.0\nmax_length_mm = 20.0\n"
      "[limits]\nspecific_sliding = 3.0\ntip_thickness_mm = 0.1\n"
      "[tolerances.S]\nroot_diameter_um = [-40, 10]\n[tolerances.P1]\ntip_diameter_um = 30\n"));
  ASSERT_TRUE(e.tolerance_limits);
  const double root = root_diameter_mm(0.59, 14, 0.5, false);
  bool sliding = false;
  for (const CheckLimits& check : e.tolerance_limits->checks) {
    const CheckId id = check.record->id;
    if (id == CheckId::kWall && check.gear == "S") {
      EXPECT_NEAR(check.margin.least * 1e3, 0.5 * (root - 0.04 - 4.0) - 1.0, 1e-9);
    }
    if (id == CheckId::kSunRootDiameter) {
      EXPECT_NEAR(check.margin.least * 1e3, root - 0.04 - 7.0, 1e-9);
      EXPECT_NEAR(check.margin.greatest * 1e3, root + 0.01 - 7.0, 1e-9);
    }
    if (id == CheckId::kGearboxLength) {
      EXPECT_EQ(check.margin.least, check.margin.greatest);
    }
    // A longer tip of P1 reaches deeper into S.
    if (id == CheckId::kSpecificSliding && check.mesh == "S-P1" && check.gear == "S") {
      sliding = true;
      EXPECT_LT(check.margin.least, check.margin.nominal - 0.01);
    }
  }
  EXPECT_TRUE(sliding);
}

// ---- Presets -------------------------------------------------------------------------------

Limits limits_of(const std::string& top, const std::string& limits = "") {
  return io::parse_design(text_with(limits, top), "design.toml").limits;
}

TEST(Preset, SetsEveryLimitOfItsTable) {
  for (const Preset preset : {Preset::kMachined, Preset::kPrinted}) {
    const std::string name(kPresetNames[static_cast<std::size_t>(preset)]);
    const Limits limits = limits_of("preset = \"" + name + "\"\n");
    for (const PresetLimit& of_preset : preset_limits()) {
      EXPECT_EQ(limits[of_preset.check], preset_limit(preset, of_preset.check))
          << check_record(of_preset.check).name;
    }
    EXPECT_EQ(limits.preset, preset);
    EXPECT_TRUE(limits.bare.empty());
  }
  EXPECT_DOUBLE_EQ(preset_limit(Preset::kMachined, CheckId::kNormalBacklash).value(), 20e-6);
  EXPECT_DOUBLE_EQ(preset_limit(Preset::kPrinted, CheckId::kTipThicknessLength).value(), 0.4e-3);
}

TEST(Preset, BareIsWhatHoldsWithoutOne) {
  Limits none = limits_of("");
  const Limits bare = limits_of("preset = \"bare\"\n");
  EXPECT_EQ(none.limit, bare.limit);
  EXPECT_EQ(none.limit, default_limits().limit);
  EXPECT_EQ(none.bare, bare.bare);
  EXPECT_FALSE(bare.bare.empty());
}

TEST(Preset, EveryLimitIsOverriddenByItsOwnKey) {
  const std::string top = "preset = \"machined\"\n";
  const std::string own =
      "[backlash]\nmin_normal_um = 3.0\n[contact_ratio]\nrange = [1.1, 3.0]\n[size]\nmin_wall_mm = "
      "0.4\n[limits]\ntip_thickness = 0.1\nring_tip_thickness = 0.2\nform_circle = 0.01\n"
      "root_clearance = 0.02\ntrochoid_interference = 0.03\nplanet_gap = 0.7\ntip_thickness_mm = "
      "0.11\nroot_clearance_mm = 0.04\nspecific_sliding = 5.0\n";
  const Limits limits = limits_of(top, own);
  for (const PresetLimit& of_preset : preset_limits()) {
    const CheckId id = of_preset.check;
    EXPECT_TRUE(limits[id]);
    EXPECT_NE(limits[id], preset_limit(Preset::kMachined, id)) << check_record(id).name;
  }
  EXPECT_EQ(limits[CheckId::kSpecificSliding], 5.0);
  EXPECT_EQ(limits[CheckId::kWall], 0.4e-3);
  for (const PresetLimit& of_preset : preset_limits()) {
    const std::string name(check_record(of_preset.check).name);
    EXPECT_FALSE(limits_of(top, "[limits]\n" + name + " = false\n")[of_preset.check]) << name;
    EXPECT_EQ(limits_of(top, "[limits]\n" + name + " = true\n")[of_preset.check],
              preset_limit(Preset::kMachined, of_preset.check))
        << name;
  }
}

TEST(Preset, HoldsForAPairToo) {
  const PairDesign pair = io::parse_pair(
      "preset = \"machined\"\nkind = \"external\"\nmodule_mm = 1.0\ncenter_distance_mm = 30.4\n"
      "[gear1]\nteeth = 20\nprofile_shift = 0.3\n[gear2]\nteeth = 40\nprofile_shift = 0.1\n",
      "pair.toml");
  const PairEvaluation e = std::get<PairEvaluation>(evaluate(pair));
  std::vector<std::string> names;
  for (const CheckResult& check : e.checks) names.emplace_back(check.record->name);
  for (const char* name : {"tip_thickness_mm", "root_clearance_mm", "specific_sliding"}) {
    EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
  }
  for (const CheckResult& check : e.checks) {
    if (check.record->id == CheckId::kNormalBacklash) {
      EXPECT_NEAR(check.limit, 20e-6, 1e-18);
    }
  }
}

TEST(Preset, WithoutOneWhatNobodyStatesIsBare) {
  const auto is_bare = [](const Limits& limits, CheckId id) {
    return std::ranges::find(limits.bare, id) != limits.bare.end();
  };
  const Limits none = limits_of("");
  for (const CheckId id : {CheckId::kNormalBacklash, CheckId::kContactRatioMin,
                           CheckId::kSpecificSliding, CheckId::kRootClearance}) {
    EXPECT_TRUE(is_bare(none, id));
  }
  EXPECT_FALSE(is_bare(none, CheckId::kPlanetGap)) << "its default is what presets have";
  const Limits stated = limits_of("",
                                  "[backlash]\nmin_normal_um = 0.0\n[limits]\nspecific_sliding = "
                                  "false\n");
  EXPECT_FALSE(is_bare(stated, CheckId::kNormalBacklash)) << "0 was stated";
  EXPECT_FALSE(is_bare(stated, CheckId::kSpecificSliding)) << "it was switched off";
}

TEST(Preset, IsWrittenWithItsLimitsAndReadBackAlike) {
  for (const std::string top : {"preset = \"machined\"\n", "preset = \"printed\"\n", ""}) {
    for (const std::string limits :
         {"", "[limits]\nspecific_sliding = false\nhunting_tooth = true\nwall = false\n",
          "[limits]\nhunting_tooth = 2\nhunting_meshes = [\"S-P1\"]\nsame_module = true\n"
          "[allowed_teeth]\nS = [13, 14]\n[backlash.P1-R1]\nmin_normal_um = 4.0\n",
          "[limits]\nallowed_teeth = false\n[allowed_teeth]\nS = [13, 14]\n"}) {
      const Design stated = io::parse_design(text_with(limits, top), "design.toml");
      const Design read = io::parse_design(io::design_text(stated), "written.toml");
      EXPECT_EQ(read.limits.limit, stated.limits.limit) << top << limits;
      EXPECT_EQ(read.limits.preset, stated.limits.preset);
      EXPECT_EQ(read.limits.hunting_meshes, stated.limits.hunting_meshes);
      EXPECT_EQ(read.limits.allowed_teeth, stated.limits.allowed_teeth);
      EXPECT_EQ(read.limits.mesh_backlash_m, stated.limits.mesh_backlash_m);
    }
  }
}

}  // namespace
}  // namespace gear3k::design::workshop_checks_test
