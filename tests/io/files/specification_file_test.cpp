#include "io/files/specification_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/text/diagnostics.hpp"

namespace gear3k::io::specification_file_test {
namespace {

using design::CheckId, optimize::Specification;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kArcmin = kDegree / 60.0;

const std::string kMinimal =
    "[ratio]\ntarget = 96.2\n"
    "[teeth]\nS = [12, 13]\nP1 = [50, 60]\nR1_max = 120\nP2 = [40, 60]\nR2_max = 121\n"
    "[module]\nstage1_mm = 1.0\nstage2_mm = 0.9\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::invalid_argument("no \"" + from + "\" in the text");
  return text.replace(at, from.size(), to);
}

Specification parse(const std::string& text) { return parse_specification(text, "spec.toml"); }

std::string errors_of(const std::string& text) {
  try {
    static_cast<void>(parse(text));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

Specification example(const std::string& name) {
  return read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/" + name);
}

// What hangs on a width is not said to lack it where the width's own value is refused.
TEST(ReadSpecification, AWidthThatIsRefusedIsNotMissing) {
  const std::string errors =
      errors_of("objective = \"mass\"\n" + kMinimal +
                "[size]\nmax_length_mm = 20.0\n[inertia]\ndensity_kg_m3 = 7850.0\n"
                "[stage1]\nface_width_mm = [4.0, 8.0]\n[stage2]\nface_width_mm = 8.0\n");
  EXPECT_EQ(errors.find("spec.toml:18:1: stage1.face_width_mm = [4.0, 8.0]: allowed: "), 0U)
      << errors;
  EXPECT_EQ(errors.find('\n'), std::string::npos) << errors;
}

TEST(ReadSpecification, AListOfTeethThatHoldsNoneOfTheRangeIsAnError) {
  const auto errors = [](const std::string& lists) {
    return errors_of(kMinimal + "[allowed_teeth]\n" + lists);
  };
  EXPECT_EQ(errors("S = [11, 14]\nP1 = [40, 50]\nR1 = [57, 121]\nP2 = 39\nR2 = [47, 122]\n"),
            "spec.toml:13:1: allowed_teeth.S = [11, 14]: allowed: at least one of 12 to 13 "
            "(teeth.S)\n"
            "spec.toml:15:1: allowed_teeth.R1 = [57, 121]: allowed: at least one of 58 to 120 "
            "(teeth.P1 and min_internal_difference to teeth.R1_max)\n"
            "spec.toml:16:1: allowed_teeth.P2 = [39]: allowed: at least one of 40 to 60 "
            "(teeth.P2)\n"
            "spec.toml:17:1: allowed_teeth.R2 = [47, 122]: allowed: at least one of 48 to 121 "
            "(teeth.P2 and min_internal_difference to teeth.R2_max)");
  EXPECT_EQ(errors("S = [11, 13]\nR1 = 58\nR2 = [47, 121]\n"), "");
  EXPECT_EQ(errors("S = 11\n[limits]\nallowed_teeth = false\n"), "") << "switched off";
}

TEST(ReadSpecification, RingsInOnePlaceAreAnError) {
  EXPECT_EQ(errors_of(kMinimal + "[axial]\nR1_mm = [0, 9]\nR2_mm = [8.5, 16]\n"),
            "spec.toml:14:1: axial.R1_mm = [0, 9] and axial.R2_mm = [8.5, 16]: two rings in one "
            "place: allowed: apart along the axis");
  EXPECT_EQ(errors_of(kMinimal + "[axial]\nR1_mm = [0, 8.5]\nR2_mm = [8.5, 16]\n"), "");
}

TEST(ReadSpecification, DefaultsAreThoseOfTheContract) {
  const Specification spec = parse(kMinimal);
  EXPECT_EQ(spec.planets, std::vector<int>{3});
  EXPECT_TRUE(spec.limits[design::CheckId::kIdenticalPlanets].has_value());
  EXPECT_DOUBLE_EQ(spec.pressure_angle_rad, 20.0 * kDegree);
  EXPECT_EQ(optimize::first_objective(spec), optimize::Objective::kBackwardEfficiency);
  EXPECT_EQ(spec.ratio.tolerance, 0.005);
  EXPECT_EQ(spec.teeth.max_coaxial_offset, 4);
  EXPECT_EQ(spec.teeth.min_internal_difference, 8);
  EXPECT_EQ(spec.profile_shift.min, 0.0);
  EXPECT_EQ(spec.profile_shift.max, 1.0);
  EXPECT_EQ(spec.limits.model, backlash::LostMotionModel::kKinematic);
  EXPECT_EQ(spec.limits[CheckId::kOutputBacklashMax], std::nullopt);
  EXPECT_EQ(spec.limits[CheckId::kNormalBacklash], 0.0);
  EXPECT_EQ(spec.solver.refine, optimize::Refine::kSlsqp);
  EXPECT_EQ(spec.solver.starts, 4);
  EXPECT_EQ(spec.solver.seed, 1U);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    EXPECT_EQ(spec.machining_allowance[i], 0.0);
    EXPECT_EQ(spec.tip_shortening[i], 0.0);
  }
}

TEST(ReadSpecification, WhatNothingReadsIsNoted) {
  const auto notes = [](const std::string& more) { return parse(more + kMinimal).notes; };
  EXPECT_TRUE(notes("pressure_angle_deg = 25.0\n").empty());
  EXPECT_TRUE(notes("free.pressure_angle_deg = [18.0, 24.0]\n").empty());
  EXPECT_TRUE(notes("objective = [\"lost_motion\", \"ratio_error\"]\npareto.points = 5\n").empty());
  const auto angle = notes("pressure_angle_deg = 30.0\nfree.pressure_angle_deg = [18.0, 24.0]\n");
  ASSERT_EQ(angle.size(), 1U);
  EXPECT_TRUE(angle[0].starts_with("pressure_angle_deg is not read")) << angle[0];
  const auto points = notes("pareto.points = 5\n");
  ASSERT_EQ(points.size(), 1U);
  EXPECT_TRUE(points[0].starts_with("pareto.points is not read")) << points[0];
}

TEST(ReadSpecification, ToothRangesHoldBothEnds) {
  const Specification spec =
      parse(replaced(kMinimal, "R2_max = 121\n",
                     "R2_max = 121\nmax_coaxial_offset = 2\nmin_internal_difference = 9\n"));
  EXPECT_EQ(spec.teeth.S.min, 12);
  EXPECT_EQ(spec.teeth.S.max, 13);
  EXPECT_EQ(spec.teeth.P1.min, 50);
  EXPECT_EQ(spec.teeth.P1.max, 60);
  EXPECT_EQ(spec.teeth.P2.min, 40);
  EXPECT_EQ(spec.teeth.P2.max, 60);
  EXPECT_EQ(spec.teeth.R1_max, 120);
  EXPECT_EQ(spec.teeth.R2_max, 121);
  EXPECT_EQ(spec.teeth.max_coaxial_offset, 2);
  EXPECT_EQ(spec.teeth.min_internal_difference, 9);
}

TEST(ReadSpecification, RatioKeepsItsSign) {
  EXPECT_EQ(parse(replaced(kMinimal, "96.2", "-50")).ratio.target, -50.0);
}

TEST(ReadSpecification, ModuleIsAValueARangeOrASeries) {
  const Specification value = parse(kMinimal);
  ASSERT_TRUE(value.module[1].range_m);
  EXPECT_DOUBLE_EQ(value.module[1].range_m->min, 0.0009);
  EXPECT_DOUBLE_EQ(value.module[1].range_m->max, 0.0009);
  EXPECT_TRUE(value.module[1].series_m.empty());
  const Specification range =
      parse(replaced(kMinimal, "stage2_mm = 0.9", "stage2_mm = { max = 1.0, min = 0.5 }"));
  ASSERT_TRUE(range.module[1].range_m);
  EXPECT_DOUBLE_EQ(range.module[1].range_m->min, 0.0005);
  EXPECT_DOUBLE_EQ(range.module[1].range_m->max, 0.001);
  const Specification series =
      parse(replaced(kMinimal, "stage2_mm = 0.9", "stage2_mm = { series = [0.8, 0.5, 0.8] }"));
  EXPECT_FALSE(series.module[1].range_m);
  ASSERT_EQ(series.module[1].series_m.size(), 2U) << "sorted, each once";
  EXPECT_DOUBLE_EQ(series.module[1].series_m[0], 0.0005);
  EXPECT_DOUBLE_EQ(series.module[1].series_m[1], 0.0008);
}

TEST(ReadSpecification, ModuleMayBeATableOfItsOwn) {
  const Specification spec = parse(replaced(kMinimal, "stage2_mm = 0.9\n", "") +
                                   "[module.stage2_mm]\nmin = 0.5\nmax = 1.0\n");
  ASSERT_TRUE(spec.module[1].range_m);
  EXPECT_DOUBLE_EQ(spec.module[1].range_m->max, 0.001);
}

TEST(ReadSpecification, NumbersOfPlanetsAreSortedAndEachTriedOnce) {
  EXPECT_EQ(parse("planets = [6, 3, 4, 3]\n" + kMinimal).planets, (std::vector<int>{3, 4, 6}));
  EXPECT_EQ(parse("planets = 4\n" + kMinimal).planets, std::vector<int>{4});
}

TEST(ReadSpecification, AllowanceIsOneForAllGearsOrOneForEach) {
  const Specification one = parse(kMinimal + "[backlash]\nmachining_allowance = 0.02\n");
  for (const double q : one.machining_allowance) EXPECT_EQ(q, 0.02);
  const Specification each =
      parse(kMinimal + "[backlash]\nmachining_allowance = { R2 = 0.03, S = 0.01 }\n");
  EXPECT_EQ(each.machining_allowance, (std::array<double, 5>{0.01, 0.0, 0.0, 0.0, 0.03}));
}

TEST(ReadSpecification, LimitsAreConvertedToSi) {
  const Specification spec =
      parse(kMinimal +
            "[size]\nmax_ring_root_diameter_mm = 76.0\n"
            "[backlash]\nmodel = \"paper\"\nmin_output_arcmin = 0.5\nmax_output_arcmin = 8.0\n"
            "min_normal_um = 10.0\n[contact_ratio]\nrange = [1.2, 2.0]\n"
            "[limits]\ntip_thickness = 0.3\nring_tip_thickness = false\nundercut = true\n");
  EXPECT_DOUBLE_EQ(*spec.limits[CheckId::kRingRootDiameter], 0.076);
  EXPECT_DOUBLE_EQ(*spec.limits[CheckId::kOutputBacklashMin], 0.5 * kArcmin);
  EXPECT_DOUBLE_EQ(*spec.limits[CheckId::kOutputBacklashMax], 8.0 * kArcmin);
  EXPECT_DOUBLE_EQ(*spec.limits[CheckId::kNormalBacklash], 10e-6);
  EXPECT_EQ(spec.limits[CheckId::kContactRatioMin], 1.2);
  EXPECT_EQ(spec.limits[CheckId::kContactRatioMax], 2.0);
  EXPECT_EQ(spec.limits[CheckId::kTipThickness], 0.3);
  EXPECT_EQ(spec.limits[CheckId::kRingTipThickness], std::nullopt);
  EXPECT_EQ(spec.limits[CheckId::kUndercut], 0.0);
  EXPECT_EQ(spec.limits.model, backlash::LostMotionModel::kPaper);
}

TEST(ReadSpecification, FalseWinsOverAThresholdAndTrueWithoutOneIsAnError) {
  const std::string backlash = "[backlash]\nmax_output_arcmin = 8.0\n";
  EXPECT_EQ(parse(kMinimal + backlash + "[limits]\noutput_backlash_max = false\n")
                .limits[CheckId::kOutputBacklashMax],
            std::nullopt);
  const std::string errors = errors_of(kMinimal + "[limits]\noutput_backlash_max = true\n");
  EXPECT_NE(errors.find("backlash.max_output_arcmin"), std::string::npos) << errors;
}

TEST(ReadSpecification, IdenticalPlanetsAreASwitchOfSearchAndChecks) {
  const Specification free = parse("identical_planets = false\n" + kMinimal);
  EXPECT_FALSE(free.limits[design::CheckId::kIdenticalPlanets].has_value());
  EXPECT_EQ(free.limits[CheckId::kIdenticalPlanets], std::nullopt);
  const Specification same = parse("identical_planets = true\n" + kMinimal);
  EXPECT_TRUE(same.limits[design::CheckId::kIdenticalPlanets].has_value());
  EXPECT_NE(same.limits[CheckId::kIdenticalPlanets], std::nullopt);
}

TEST(ReadSpecification, SolverKeysReachTheSolver) {
  const Specification spec =
      parse("objective = \"forward_efficiency\"\n" + kMinimal +
            "[solver]\nrefine = \"both\"\nstarts = 7\nseed = 9007199254740992\n");
  EXPECT_EQ(optimize::first_objective(spec), optimize::Objective::kForwardEfficiency);
  EXPECT_EQ(spec.solver.refine, optimize::Refine::kBoth);
  EXPECT_EQ(spec.solver.starts, 7);
  EXPECT_EQ(spec.solver.seed, 9007199254740992ULL);
}

TEST(ReadSpecification, RelationsAreCheckedBetweenKeys) {
  const std::string ring = errors_of(replaced(kMinimal, "R2_max = 121", "R2_max = 47"));
  EXPECT_NE(ring.find("spec.toml:8:1: teeth.R2_max = 47: allowed: at least"), std::string::npos)
      << ring;
  EXPECT_EQ(errors_of(replaced(kMinimal, "R2_max = 121", "R2_max = 48")), "");
  const std::string backlash =
      errors_of(kMinimal + "[backlash]\nmax_output_arcmin = 3.0\nmin_output_arcmin = 3.5\n");
  EXPECT_NE(backlash.find("spec.toml:14:1: backlash.min_output_arcmin = 3.5"), std::string::npos)
      << backlash;
}

TEST(ReadSpecification, TheRackHasTeethOverTheWholeRangeOfAFreeAngle) {
  const auto of = [](const std::string& range, const std::string& dedendum) {
    return errors_of(kMinimal + "[free]\npressure_angle_deg = " + range +
                     "\n[rack]\ndedendum = " + dedendum + "\n");
  };
  // tan a = pi/(4 hfP*) = 0.628319: a = 32.1419 deg
  EXPECT_EQ(of("[28.0, 32.14]", "1.25"), "");
  EXPECT_NE(of("[28.0, 32.15]", "1.25")
                .find("spec.toml:13:1: free.pressure_angle_deg = [28, 32.15]: allowed: below "
                      "32.1419, where the tooth of a rack with dedendum = 1.25 comes to a point"),
            std::string::npos);
  EXPECT_NE(of("[33.5, 35.0]", "1.25").find("allowed: below 32.1419"), std::string::npos);
  EXPECT_EQ(of("[28.0, 35.0]", "1.1"), "");
  // What is refused itself says nothing of the angle.
  EXPECT_EQ(of("[28.0, 35.0]", "9.0").find("free.pressure_angle_deg"), std::string::npos);
}

TEST(ReadSpecification, AStepOfTheShiftsIsThatOfRoundingToo) {
  const Specification spec = parse(kMinimal + "[profile_shift]\nstep = 0.05\n");
  EXPECT_EQ(spec.shift_step, 0.05);
  EXPECT_EQ(spec.round.profile_shift, 0.05);
  EXPECT_FALSE(parse(kMinimal).shift_step);
  const std::string both = errors_of(
      kMinimal +
      "[profile_shift]\nstep = 0.25\nrange = [0.03, 0.07]\n[round]\nprofile_shift = 0.1\n");
  EXPECT_NE(both.find("spec.toml:14:1: profile_shift.range = [0.03, 0.07] with"), std::string::npos)
      << both;
  EXPECT_NE(both.find("spec.toml:16:1: round.profile_shift and profile_shift.step"),
            std::string::npos)
      << both;
}

TEST(ReadSpecification, CuttersAreOneOrAListToChooseFrom) {
  const std::string one = "[cutter.R1]\nteeth = 20\ntip_radius = 0.2\n";
  const Specification single = parse(kMinimal + one);
  EXPECT_EQ(single.cutter[2].teeth, 20);
  EXPECT_EQ(single.cutter[2].tip_radius, 0.2);
  const Specification listed = parse(kMinimal + replaced(one, "20", "[34, 20, 25, 20]"));
  EXPECT_EQ(listed.cutter[2].teeth, 20);
  EXPECT_EQ(listed.cutter_teeth[2], (std::vector<int>{20, 25, 34}));
  EXPECT_TRUE(listed.cutter_teeth[4].empty());
  const std::string large = errors_of(kMinimal + replaced(one, "20", "[20, 120]"));
  EXPECT_NE(large.find("spec.toml:13:1: cutter.R1.teeth = 120: allowed: below the 120"),
            std::string::npos)
      << large;
}

TEST(ReadSpecification, TellsHowManySetsTooWideRangesHold) {
  // The widest that every key by itself allows.
  std::string text = replaced(kMinimal, "S = [12, 13]", "S = [4, 500]");
  text = replaced(text, "P1 = [50, 60]", "P1 = [4, 500]");
  text = replaced(text, "P2 = [40, 60]", "P2 = [4, 4]");
  text = replaced(text, "R1_max = 120", "R1_max = 2000\nmax_coaxial_offset = 100");
  text = replaced(text, "R2_max = 121", "R2_max = 2000");
  text = replaced(text, "target = 96.2", "target = 10\ntolerance = 0.5");
  text = "planets = [1, 2, 3]\nidentical_planets = false\n" + text;
  const std::string errors = errors_of(text);
  for (const char* part : {"spec.toml:7:1: teeth.S = [4, 500]: with the other ranges, "
                           "ratio.tolerance = 0.5 and 3 numbers of planets these are about ",
                           "spec.toml:8:1: teeth.P1 = [4, 500]: ",
                           "e+10 tooth sets: allowed: at "
                           "most 4e+07"}) {
    EXPECT_NE(errors.find(part), std::string::npos) << part << '\n' << errors;
  }
  EXPECT_EQ(errors.find("teeth.P2"), std::string::npos) << errors;
  EXPECT_THROW(static_cast<void>(parse_specification(kMinimal, "spec.toml", 1.0)), InvalidInput);
}

TEST(ReadSpecification, Rp96IsTheReferenceProblem) {
  // docs/rp96.md, inequality by inequality.
  const Specification spec = example("rp96.toml");
  EXPECT_EQ(spec.planets, std::vector<int>{3});
  EXPECT_TRUE(spec.limits[design::CheckId::kIdenticalPlanets].has_value());
  EXPECT_DOUBLE_EQ(spec.pressure_angle_rad, 20.0 * kDegree);
  EXPECT_EQ(spec.ratio.target, 96.2);
  EXPECT_EQ(spec.ratio.tolerance, 0.005);
  EXPECT_EQ(spec.teeth.S.min, 10);
  EXPECT_EQ(spec.teeth.S.max, 20);
  for (const auto& range : {spec.teeth.P1, spec.teeth.P2}) {
    EXPECT_EQ(range.min, 20);
    EXPECT_EQ(range.max, 60);
  }
  EXPECT_EQ(spec.teeth.R1_max, 120);
  EXPECT_EQ(spec.teeth.R2_max, 120);
  EXPECT_EQ(spec.teeth.max_coaxial_offset, 4);
  EXPECT_EQ(spec.teeth.min_internal_difference, 8);
  ASSERT_TRUE(spec.module[0].range_m);
  EXPECT_EQ(spec.module[0].range_m->min, spec.module[0].range_m->max);
  EXPECT_EQ(spec.profile_shift.min, 0.0);
  EXPECT_EQ(spec.profile_shift.max, 1.0);
  EXPECT_EQ(spec.friction.coefficient, 0.1);
  EXPECT_EQ(spec.friction.model, efficiency::LossModel::kOhlendorf);
  EXPECT_EQ(spec.limits.model, backlash::LostMotionModel::kPaper);
  EXPECT_DOUBLE_EQ(*spec.limits[CheckId::kOutputBacklashMax], 8.0 * kArcmin);
  EXPECT_EQ(spec.limits[CheckId::kOutputBacklashMin].value_or(0.0), 0.0);
  EXPECT_EQ(spec.limits[CheckId::kNormalBacklash], 0.0);
  EXPECT_EQ(spec.limits[CheckId::kContactRatioMin], 1.2);
  EXPECT_EQ(spec.limits[CheckId::kContactRatioMax], 2.0);
  EXPECT_EQ(spec.limits[CheckId::kTipThickness], 0.25);
  EXPECT_EQ(spec.limits[CheckId::kRingTipThickness], std::nullopt);
  EXPECT_EQ(spec.limits[CheckId::kPlanetGap], 0.5);
  EXPECT_EQ(spec.limits[CheckId::kRingRootDiameter], std::nullopt);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    EXPECT_EQ(spec.machining_allowance[i], 0.0);
    EXPECT_EQ(spec.tip_shortening[i], 0.0);
  }
  // x >= 1 - z sin^2(alpha)/2: the form depth of the rack is one module.
  const double form_depth =
      spec.rack.dedendum - spec.rack.root_radius * (1.0 - std::sin(spec.pressure_angle_rad));
  EXPECT_NEAR(form_depth, 1.0, 1e-15);
}

TEST(ReadSpecification, Ratio96IsAGearboxThatOneCouldBuild) {
  const Specification spec = example("ratio-96.toml");
  EXPECT_EQ(spec.ratio.target, 96.2);
  EXPECT_LE(spec.ratio.tolerance, 0.005);
  EXPECT_EQ(spec.planets, std::vector<int>{3});
  EXPECT_TRUE(spec.limits[design::CheckId::kIdenticalPlanets].has_value());
  ASSERT_TRUE(spec.limits[CheckId::kRingRootDiameter]);
  EXPECT_LE(*spec.limits[CheckId::kRingRootDiameter], 0.076);
  ASSERT_TRUE(spec.limits[CheckId::kOutputBacklashMax]);
  EXPECT_DOUBLE_EQ(*spec.limits[CheckId::kOutputBacklashMax], 8.0 * kArcmin);
  EXPECT_EQ(spec.limits.model, backlash::LostMotionModel::kKinematic);
  for (const double q : spec.machining_allowance) EXPECT_GT(q, 0.0);
  for (const auto& module : spec.module) {
    ASSERT_TRUE(module.range_m);
    EXPECT_DOUBLE_EQ(module.range_m->min, 0.0005);
  }
  EXPECT_EQ(spec.limits[CheckId::kContactRatioMin], 1.2);
  EXPECT_EQ(spec.friction.model, efficiency::LossModel::kSliding);
}

TEST(SpecificationFile, LimitsOverTemperaturesWantTheTemperatures) {
  for (const std::string name : {"thermal_backlash", "thermal_root_clearance"}) {
    for (const std::string value : {"5.0", "true"}) {
      EXPECT_NE(errors_of(kMinimal + "[limits]\n" + name + " = " + value + "\n")
                    .find("limits." + name + " without [thermal]: allowed: with it, or false"),
                std::string::npos);
    }
    EXPECT_EQ(errors_of(kMinimal + "[limits]\n" + name + " = false\n"), "");
  }
  EXPECT_NE(errors_of(kMinimal + "[limits]\nthermal_lost_motion = 5.0\n")
                .find("limits.thermal_lost_motion without [thermal]"),
            std::string::npos);
}

TEST(SpecificationFile, WhatAnObjectiveLacksIsToldOnce) {
  const std::string errors = errors_of("objective = [\"mass\", \"mass\"]\n" + kMinimal);
  EXPECT_NE(errors.find("objective: \"mass\" twice"), std::string::npos) << errors;
  const auto first = errors.find("objective \"mass\" without");
  ASSERT_NE(first, std::string::npos) << errors;
  EXPECT_EQ(errors.find("objective \"mass\" without", first + 1), std::string::npos) << errors;
}

}  // namespace
}  // namespace gear3k::io::specification_file_test
