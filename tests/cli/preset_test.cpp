// What a workshop can make: presets and limits of the whole gearbox, from the command line.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::preset_cli_test {
namespace {

using nlohmann::json;
using test::ProgramResult, test::Workplace, test::replaced;

/// A SPEC of what has to be stated and nothing else.
const std::string kLeast =
    "[ratio]\ntarget = 50.0\n"
    "[teeth]\nS = [12, 14]\nP1 = [30, 45]\nP2 = [30, 45]\nR1_max = 120\nR2_max = 120\n"
    "[module]\nstage1_mm = { min = 0.5, max = 1.0 }\nstage2_mm = { min = 0.5, max = 1.0 }\n";

/// An optimisation of a SPEC and what is known of its best design.
struct Optimized {
  explicit Optimized(const std::string& spec) {
    place.write("spec.toml", spec);
    run = place.run({"optimize", "spec.toml", "--out", "out"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    summary = json::parse(place.read("out/summary.json"));
    best = json::parse(place.run({"analyze", "out/best.toml", "--strict", "--format", "json"}).out);
  }
  Workplace place;
  ProgramResult run;
  json summary, best;
};

double number(const json& check, const char* key) { return check.at(key).get<double>(); }

TEST(Preset, LeavesNoMeshOfALeastSpecWithoutBacklashAndNoLimitUnsaid) {
  // Without a limit every mesh is closed to nothing.
  const std::string spec = "objective = \"lost_motion\"\n" + kLeast;
  const Optimized bare(spec);
  const Optimized made("preset = \"machined\"\n" + spec);
  int closed = 0;
  for (const json& mesh : bare.best.at("meshes")) {
    if (number(mesh, "normal_backlash_um") < 1.0) ++closed;
  }
  EXPECT_GT(closed, 0) << "or this case shows nothing";
  for (const json& mesh : made.best.at("meshes")) {
    EXPECT_GE(number(mesh, "normal_backlash_um"), 20.0 - 1e-3);
    EXPECT_GE(number(mesh, "contact_ratio"), 1.2 - 1e-6);
  }
  for (const json& check : made.best.at("checks")) EXPECT_TRUE(check.at("ok")) << check;
  const json& limits = made.summary.at("limits");
  EXPECT_EQ(limits.at("preset"), "machined");
  EXPECT_TRUE(limits.at("bare").empty());
  EXPECT_EQ(limits.at("in_force").at("normal_backlash"), 20.0);
  EXPECT_EQ(limits.at("in_force").at("specific_sliding"), 3.0);
  EXPECT_NE(made.run.out.find("\nLimits: preset machined: "), std::string::npos);
  EXPECT_NE(made.place.read("out/best.toml").find("\npreset = \"machined\"\n"), std::string::npos);
  // What has no reserve is said to have none.
  for (const json& check : made.best.at("checks")) {
    const auto name = check.at("name").get<std::string>();
    const json& zero = limits.at("at_zero");
    const bool said = std::find(zero.begin(), zero.end(), name) != zero.end();
    const bool of_planets = name == "equal_spacing" || name == "identical_planets";
    EXPECT_EQ(said, number(check, "limit") == 0.0 && !of_planets) << name;
  }
  EXPECT_EQ(bare.summary.at("limits").at("preset"), nullptr);
  EXPECT_GT(bare.summary.at("limits").at("bare").size(), 5U);
  EXPECT_NE(bare.run.out.find("\nLimits: no preset; bare are "), std::string::npos);
  EXPECT_NE(bare.run.out.find("(backlash.max_output_arcmin)"), std::string::npos) << bare.run.out;
}

TEST(Preset, BareNamesWhatIsLeftBareAsNoPresetDoes) {
  const Optimized bare("preset = \"bare\"\n" + kLeast);
  const Optimized none(kLeast);
  EXPECT_EQ(bare.summary.at("limits").at("bare"), none.summary.at("limits").at("bare"));
  EXPECT_GT(bare.summary.at("limits").at("bare").size(), 5U);
  EXPECT_NE(bare.run.out.find("\nLimits: preset bare; bare are "), std::string::npos)
      << bare.run.out;
  // Stated as 0 it is bare no more, and without reserve.
  const Optimized stated("preset = \"bare\"\n" + kLeast + "[limits]\nform_circle = 0.0\n");
  EXPECT_EQ(stated.summary.at("limits").at("bare").dump().find("form_circle"), std::string::npos);
  EXPECT_NE(stated.summary.at("limits").at("at_zero").dump().find("form_circle"),
            std::string::npos);
}

TEST(Preset, ItsLineNamesTheChecksThatApplyAndAreOff) {
  const std::string thermal =
      "[thermal]\ntemperature_c = [10.0, 30.0]\nS.expansion_1_k = 1e-5\nP1.expansion_1_k = 1e-5\n"
      "R1.expansion_1_k = 1e-5\nP2.expansion_1_k = 1e-5\nR2.expansion_1_k = 1e-5\n"
      "carrier.expansion_1_k = 1e-5\n";
  const std::string off = "[limits]\nthermal_backlash = false\nundercut = false\n";
  const Optimized made("preset = \"machined\"\n" + kLeast + off);
  EXPECT_EQ(made.summary.at("limits").at("off"), json::array({"undercut"}));
  const std::string best = made.place.read("out/best.toml");
  EXPECT_EQ(best.find("thermal_backlash"), std::string::npos) << "it does not apply";
  const auto told_of = [&](const std::string& design) {
    made.place.write("warm.toml", design);
    std::string out = made.place.run({"analyze", "warm.toml"}).out;
    for (std::size_t at = 0; (at = out.find("\n    ", at)) != std::string::npos;) {
      out.replace(at, 5, " ");
    }
    return out;
  };
  EXPECT_NE(
      told_of(best + thermal).find("thermal_root_clearance; off: undercut, thermal_lost_motion;"),
      std::string::npos);
  EXPECT_NE(told_of(best + "thermal_backlash = false\n" + thermal)
                .find("; off: undercut, thermal_backlash, thermal_lost_motion;"),
            std::string::npos);
}

TEST(Preset, ItsLimitsAreOverriddenOneByOne) {
  const Optimized own("preset = \"machined\"\n" + kLeast +
                      "[backlash]\nmin_normal_um = 35.0\n[backlash.P2-R2]\nmin_normal_um = 50.0\n"
                      "[limits]\nspecific_sliding = 2.0\n");
  const json& limits = own.summary.at("limits").at("in_force");
  EXPECT_EQ(limits.at("normal_backlash"), 35.0);
  EXPECT_EQ(limits.at("specific_sliding"), 2.0);
  EXPECT_EQ(limits.at("contact_ratio_min"), 1.2);
  EXPECT_NE(own.run.out.find("; stated instead: "), std::string::npos);
  EXPECT_GE(number(own.best.at("meshes").at(2), "normal_backlash_um"), 50.0 - 1e-3);
}

TEST(Preset, IsNamedWhereItsLimitsBlockEveryDesignWithTheKeyThatStatesAnother) {
  const Workplace place;
  place.write("spec.toml", "preset = \"printed\"\n" + kLeast.substr(0, kLeast.find("[module]")) +
                               "[module]\nstage1_mm = 0.5\nstage2_mm = { min = 0.5, max = 0.6 }\n");
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--certify"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("of preset printed, unless stated otherwise: "), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("limits.tip_thickness_mm = 0.4 mm"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("(a proven bound, its distance may be far more)"), std::string::npos)
      << result.err;
}

TEST(Preset, ThatBlocksEveryDesignIsToldWithAValueThatHasOne) {
  const Workplace place;
  const std::string spec =
      "preset = \"printed\"\n" + kLeast + "[contact_ratio]\nrange = [1.2, 3.0]\n[limits]\n";
  place.write("spec.toml", spec + "tip_thickness_mm = 0.8\n");
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out", "--certify"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("there is a design, all other limits kept, with one limit relaxed\n"),
            std::string::npos)
      << result.err;
  const json told = json::parse(place.read("out/summary.json")).at("relaxed_limits");
  ASSERT_FALSE(told.at("freed").empty());
  for (const json& freed : told.at("freed")) {
    ASSERT_EQ(freed.at("limits").size(), 1U);
    const json& limit = freed.at("limits").at(0);
    if (limit.at("key") != "limits.tip_thickness_mm") continue;
    EXPECT_EQ(limit.at("stated"), 0.8);
    EXPECT_EQ(limit.at("of_preset"), false);
    place.write("again.toml", spec + "tip_thickness_mm = " + limit.at("relaxed").dump() + "\n");
    const ProgramResult again =
        place.run({"optimize", "again.toml", "--out", "again", "--certify"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    const json best = json::parse(place.read("again/summary.json"));
    EXPECT_EQ(best.at("relaxed_limits"), nullptr);
    EXPECT_GE(number(best.at("best"), "eta_b"), number(freed, "objective") - 1e-6);
    return;
  }
  ADD_FAILURE() << told;
}

TEST(Preset, WithACertificateHasTheBestDesignOfAllSets) {
  const std::string spec = "preset = \"machined\"\n" + kLeast +
                           "[size]\nring_rim_mm = 2.0\nmax_outer_diameter_mm = 80.0\n";
  const Optimized all(spec);
  const ProgramResult certified =
      all.place.run({"optimize", "spec.toml", "--out", "certified", "--certify", "--quiet"});
  ASSERT_EQ(certified.exit_code, 0) << certified.err;
  const json proof = json::parse(all.place.read("certified/summary.json"));
  EXPECT_EQ(proof.at("best").at("teeth"), all.summary.at("best").at("teeth"));
  EXPECT_EQ(proof.at("best").at("eta_b"), all.summary.at("best").at("eta_b"));
  EXPECT_GE(number(proof.at("certificate"), "global_bound"), number(proof.at("best"), "eta_b"));
  EXPECT_LT(proof.at("refined").get<int>(), all.summary.at("refined").get<int>());
}

struct Impossible {
  const char* name;
  const char* limits;
  const char* message;
};
class ImpossibleSize : public testing::TestWithParam<Impossible> {};

TEST_P(ImpossibleSize, IsToldWithTheLimitThatBlocksAndByHowMuch) {
  const Workplace place;
  place.write("spec.toml", kLeast + GetParam().limits);
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find(std::string("no feasible design: blocked by ") + GetParam().message),
            std::string::npos)
      << result.err;
}

INSTANTIATE_TEST_SUITE_P(
    Limits, ImpossibleSize,
    testing::Values(
        Impossible{"Diameter", "[size]\nring_rim_mm = 2.0\nmax_outer_diameter_mm = 20.0\n",
                   "gearbox_diameter: the nearest set"},
        Impossible{"Length",
                   "[size]\nmax_length_mm = 10.0\n[stage1]\nface_width_mm = 8.0\n[stage2]\n"
                   "face_width_mm = 8.5\n",
                   "gearbox_length: the nearest set, 12/30/69/35/93, misses gearbox_length by at "
                   "least 6.5 mm"},
        // The largest sun, 14 teeth of module 1, shift 1: 14 + 2 - 2.5 mm.
        Impossible{"SunRoot", "[size]\nmin_sun_root_diameter_mm = 15.0\n",
                   "sun_root_diameter: the nearest set"},
        Impossible{"SunBore", "[size]\nsun_bore_mm = 14.0\nmin_wall_mm = 1.0\n",
                   "wall: the nearest set"},
        Impossible{"RingRim", "[size]\nring_rim_mm = 1.0\nmin_wall_mm = 1.5\n",
                   "wall: the nearest set"},
        Impossible{"Tip", "[limits]\ntip_thickness_mm = 2.0\n", "tip_thickness_mm: the nearest"},
        Impossible{"Hunting",
                   "[limits]\nhunting_tooth = true\n[allowed_teeth]\nS = 12\nP1 = [36, 42]\n",
                   "allowed_teeth: it rejects "}),
    [](const auto& impossible) { return std::string(impossible.param.name); });

TEST(BadLimits, OfAWorkshopAreToldAllAtOnceWithWhatIsMeant) {
  const Workplace place;
  place.write(
      "spec.toml",
      "preset = \"machnied\"\n" +
          replaced(replaced(kLeast, "stage1_mm = { min = 0.5, max = 1.0 }",
                            "stage1_mm = { series = [0.5, 0.6] }"),
                   "stage2_mm = { min = 0.5, max = 1.0 }", "stage2_mm = { min = 0.7, max = 1.0 }") +
          "[allowed_teeth]\nS = [2, 13]\nP3 = 12\nR1 = \"all\"\n"
          "[size]\nmax_outer_diameter_mm = -3.0\nmax_lenght_mm = 3.0\nmax_length_mm = \"long\"\n"
          "min_sun_root_diameter_mm = true\nmin_wall_mm = -1.0\nsun_bore_mm = -2.0\n"
          "planet_bore_mm = 2000.0\n"
          "[backlash.S-P1]\nmin_normal_um = \"x\"\n[backlash.S-P2]\nmin_normal_um = 3.0\n"
          "[limits]\ntip_thickness_mm = \"a\"\nroot_clearance_mm = true\n"
          "specific_sliding = -1.0\nwall = true\ngearbox_diameter = true\n"
          "gearbox_length = 3\nsun_root_diameter = true\nallowed_teeth = true\n"
          "same_module = true\nhunting_tooth = 0.5\nhunting_meshes = [\"S-P1\", \"S-R1\"]\n");
  const ProgramResult result = place.run({"optimize", "spec.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  for (const char* message :
       {"preset = \"machnied\": allowed: \"bare\" or \"machined\" or \"printed\"; did you mean "
        "\"machined\"?",
        "allowed_teeth.S = [2, 13]: allowed: an integer or a list of integers, 3 to 2000",
        "unknown key allowed_teeth.P3; did you mean allowed_teeth.P1?",
        "allowed_teeth.R1 = \"all\": allowed:",
        "size.max_outer_diameter_mm = -3.0: allowed:",
        "unknown key size.max_lenght_mm; did you mean size.max_length_mm?",
        "size.max_length_mm = \"long\": allowed:",
        "size.min_sun_root_diameter_mm = true: allowed:",
        "size.min_wall_mm = -1.0: allowed:",
        "size.sun_bore_mm = -2.0: allowed:",
        "size.planet_bore_mm = 2000.0: allowed: a number in mm, 0 to 1000",
        "backlash.S-P1.min_normal_um = \"x\": allowed: a number in um",
        "unknown table [backlash.S-P2]; did you mean [backlash.S-P1]?",
        "limits.tip_thickness_mm = \"a\": allowed: true, false, or a number in mm",
        "limits.root_clearance_mm = true: the check has no default; allowed: a number in mm or "
        "false",
        "limits.specific_sliding = -1.0: allowed: true, false, or a number, 0 to",
        "limits.wall = true: the check has no default; allowed with size.min_wall_mm stated",
        "limits.gearbox_diameter = true: the check has no default",
        "limits.gearbox_length = 3: allowed: true or false",
        "limits.sun_root_diameter = true: the check has no default",
        "limits.allowed_teeth = true: the check has no default; allowed with allowed_teeth stated",
        "limits.same_module = true: module.stage1_mm and module.stage2_mm have no module in common",
        "limits.hunting_tooth = 0.5: allowed: true, false, or a number, 1 to",
        "limits.hunting_meshes = [\"S-P1\", \"S-R1\"]: allowed: \"S-P1\" or \"P1-R1\" or \"P2-R2\"",
        "limits.hunting_meshes without limits.hunting_tooth: allowed: both"}) {
    EXPECT_NE(result.err.find(message), std::string::npos) << message << "\n" << result.err;
  }
}

/// The line of limits of what a command prints, unbroken.
std::string limits_told(const std::string& out) {
  const std::size_t from = out.find("\nLimits: ");
  if (from == std::string::npos) return "";
  std::string line = out.substr(from + 1);
  for (std::size_t at = 0; (at = line.find("\n    ", at)) != std::string::npos;) {
    line.replace(at, 5, " ");
  }
  return line.substr(0, line.find('\n'));
}

// The checks that the results list are the witness.
TEST(Preset, APairIsToldTheLimitsOfItsOwnChecksAlone) {
  for (const char* kind : {"external", "internal"}) {
    const bool ring = std::string(kind) == "internal";
    Workplace place;
    place.write("pair.toml", std::string("preset = \"printed\"\nkind = \"") + kind +
                                 "\"\nmodule_mm = 1.0\n[gear1]\nteeth = 20\n[gear2]\nteeth = " +
                                 (ring ? "61" : "30") + "\n");
    const ProgramResult told = place.run({"mesh", "pair.toml"});
    ASSERT_EQ(told.exit_code, 0) << told.err;
    const std::string line = limits_told(told.out);
    ASSERT_NE(line.find("preset printed: "), std::string::npos) << told.out;
    const json result = json::parse(place.run({"mesh", "pair.toml", "--format", "json"}).out);
    std::size_t found = 0;
    for (const char* name :
         {"tip_thickness", "ring_tip_thickness", "form_circle", "root_clearance",
          "trochoid_interference", "planet_gap", "contact_ratio_min", "normal_backlash",
          "tip_thickness_length", "root_clearance_length", "specific_sliding", "wall", "body_gap",
          "ring_cutter", "ring_tip_outside_base", "tip_fouling", "undercut"}) {
      const auto& checks = result.at("checks");
      const bool checked = std::any_of(checks.begin(), checks.end(),
                                       [&](const json& check) { return check.at("name") == name; });
      const std::string words = std::string(" ") + name;
      const bool is_told = line.find(words + " ") != std::string::npos ||
                           line.find(words + ",") != std::string::npos ||
                           line.find(words + ";") != std::string::npos || line.ends_with(words);
      EXPECT_TRUE(checked || !is_told) << kind << ' ' << name << ": " << line;
      found += is_told ? 1 : 0;
    }
    EXPECT_GT(found, 5U) << line;
    EXPECT_EQ(line.find("planet_gap"), std::string::npos) << line;
    EXPECT_EQ(line.find("trochoid_interference") != std::string::npos, ring) << line;
  }
}

TEST(Preset, AllOfWhoseLimitsAreStatedHasNoneOfItsOwn) {
  Workplace place;
  place.write(
      "pair.toml",
      "preset = \"machined\"\nkind = \"external\"\nmodule_mm = 1.0\n[gear1]\nteeth = "
      "20\n[gear2]\nteeth = 30\n[backlash]\nmin_normal_um = 1.0\n"
      "[contact_ratio]\nrange = [1.05, 3.0]\n[limits]\ntip_thickness = 0.1\nform_circle = 0.01\n"
      "root_clearance = 0.02\ntip_thickness_mm = 0.03\nroot_clearance_mm = 0.04\n"
      "specific_sliding = 4.0\n");
  const ProgramResult told = place.run({"mesh", "pair.toml"});
  const std::string line = limits_told(told.out);
  EXPECT_NE(line.find("Limits: preset machined: none of its own; stated instead: "),
            std::string::npos)
      << line << told.err;
}

}  // namespace
}  // namespace gear3k::preset_cli_test
