// A gearbox over temperature: against evaluate() of drawings that are scaled by hand.

#include "design/thermal_result.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"

namespace gear3k::design::thermal_result_test {
namespace {

constexpr double kMicrometre = 1e-6;

/// Backlash of some 10 µm in every mesh.
Design drawn_design() {
  Design design = io::read_design(std::string(GEAR3K_SOURCE_DIR) +
                                  "/examples/designs/ratio_96_tolerances.toml");
  design.tolerances.reset();
  design.train = resolved_parameters(design);
  design.center_distance_given = true;
  return design;
}

/// Stage 1 and stage 2 of two plastics that swell, in a carrier of metal.
train::ThermalRange two_plastics() {
  const train::Growth first{.expansion_1_K = 1.1e-4, .swelling = {-1e-3, 2e-3}};
  const train::Growth second{.expansion_1_K = 4e-5, .swelling = {0.0, 5e-4}};
  return {.least_K = 253.15,
          .greatest_K = 333.15,
          .gear = {first, first, first, second, second},
          .carrier = {.expansion_1_K = 2.3e-5}};
}

Evaluation evaluated(const Design& design) {
  auto result = evaluate(design);
  if (const auto* undefined = std::get_if<NotDefined>(&result)) {
    throw std::invalid_argument(undefined->message);
  }
  return std::get<Evaluation>(std::move(result));
}

/// The drawing with its modules and its centre distance scaled by these factors.
Design scaled(Design design, std::array<double, 2> stage, double carrier) {
  design.thermal.reset();
  for (std::size_t k = 0; k < 2; ++k) design.train.module_m[k] *= stage[k];
  design.train.center_distance_m *= carrier;
  return design;
}

TEST(ThermalResult, IsThatOfADrawingScaledByHand) {
  Design design = drawn_design();
  design.thermal = two_plastics();
  const Evaluation e = evaluated(design);
  ASSERT_TRUE(e.thermal);
  ASSERT_EQ(e.thermal->states.size(), 5U);
  // 20 C; then -20 C dry and wet, 60 C dry and wet.
  const std::array<std::array<double, 3>, 5> factors{
      {{1.0, 1.0, 1.0},
       {1.0 - 1.1e-4 * 40.0 - 1e-3, 1.0 - 4e-5 * 40.0, 1.0 - 2.3e-5 * 40.0},
       {1.0 - 1.1e-4 * 40.0 + 2e-3, 1.0 - 4e-5 * 40.0 + 5e-4, 1.0 - 2.3e-5 * 40.0},
       {1.0 + 1.1e-4 * 40.0 - 1e-3, 1.0 + 4e-5 * 40.0, 1.0 + 2.3e-5 * 40.0},
       {1.0 + 1.1e-4 * 40.0 + 2e-3, 1.0 + 4e-5 * 40.0 + 5e-4, 1.0 + 2.3e-5 * 40.0}}};
  for (std::size_t s = 0; s < factors.size(); ++s) {
    const auto [first, second, carrier] = factors[s];
    const Evaluation by_hand = evaluated(scaled(design, {first, second}, carrier));
    const ThermalStateResult& at = e.thermal->states[s];
    EXPECT_NEAR(at.center_distance_m, by_hand.center_distance_m, 1e-15);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const ThermalMesh& m = at.meshes[k];
      const MeshResult& expected = by_hand.meshes[k];
      EXPECT_NEAR(m.normal_backlash_m / kMicrometre, expected.normal_backlash_m / kMicrometre, 1e-9)
          << s << ' ' << k;
      EXPECT_NEAR(m.least_backlash_m / kMicrometre, expected.normal_backlash_m / kMicrometre, 1e-9);
      EXPECT_NEAR(m.working_pressure_angle_rad, expected.working_pressure_angle_rad, 1e-13);
      EXPECT_NEAR(m.contact_ratio, expected.contact_ratio, 1e-12);
      for (const std::size_t i : {0U, 1U}) {
        EXPECT_NEAR(m.root_clearance_m[i], expected.root_clearance_m[i], 1e-15);
      }
    }
    EXPECT_NEAR(at.lost_motion_rad, by_hand.lost_motion.kinematic_rad, 1e-12);
  }
}

TEST(ThermalResult, OfOneMaterialScalesLengthsAndKeepsAngles) {
  Design design = drawn_design();
  const train::Growth all{.expansion_1_K = 1e-4};
  design.thermal = train::ThermalRange{
      .least_K = 243.15, .greatest_K = 353.15, .gear = {all, all, all, all, all}, .carrier = all};
  const Evaluation e = evaluated(design);
  ASSERT_EQ(e.thermal->states.size(), 3U);
  for (const ThermalStateResult& at : e.thermal->states) {
    const double factor = 1.0 + 1e-4 * (at.state.temperature_K - 293.15);
    EXPECT_NEAR(at.lost_motion_rad, e.lost_motion.kinematic_rad, 1e-13);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      EXPECT_NEAR(at.meshes[k].normal_backlash_m, factor * e.meshes[k].normal_backlash_m, 1e-16);
      EXPECT_NEAR(at.meshes[k].working_pressure_angle_rad, e.meshes[k].working_pressure_angle_rad,
                  1e-14);
      EXPECT_NEAR(at.meshes[k].contact_ratio, e.meshes[k].contact_ratio, 1e-12);
    }
  }
  for (const JamRange& jam : e.thermal->jams) EXPECT_FALSE(jam.below_K || jam.above_K);
}

TEST(ThermalResult, JamsWhereTheScaledDrawingHasNoBacklash) {
  Design design = drawn_design();
  design.thermal = two_plastics();
  for (train::Growth& gear : design.thermal->gear) gear.swelling = {};
  const Evaluation e = evaluated(design);
  int found = 0;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const JamRange& jam = e.thermal->jams[k];
    for (const auto& at_K : {jam.below_K, jam.above_K}) {
      if (!at_K) continue;
      const double warmer = *at_K - 293.15;
      const Design there =
          scaled(design, {1.0 + 1.1e-4 * warmer, 1.0 + 4e-5 * warmer}, 1.0 + 2.3e-5 * warmer);
      EXPECT_NEAR(evaluated(there).meshes[k].normal_backlash_m, 0.0, 1e-13) << k;
      ++found;
    }
  }
  // The external mesh closes as its gears outgrow the carrier, the internal ones as they shrink.
  EXPECT_TRUE(e.thermal->jams[train::kMeshSP1].above_K);
  EXPECT_TRUE(e.thermal->jams[train::kMeshP1R1].below_K);
  EXPECT_TRUE(e.thermal->jams[train::kMeshP2R2].below_K);
  EXPECT_EQ(found, 3);
}

TEST(ThermalResult, OfAMeshThatHasNoPlayAsDrawnJamsThere) {
  Design design = drawn_design();
  design.train.machining_allowance.fill(0.0);
  design.train.profile_shift[train::kS] += 0.5;
  design.thermal = two_plastics();
  const Evaluation e = evaluated(design);
  ASSERT_LT(e.meshes[train::kMeshSP1].normal_backlash_m, 0.0);
  EXPECT_EQ(e.thermal->jams[train::kMeshSP1].below_K, 293.15);
  EXPECT_EQ(e.thermal->jams[train::kMeshSP1].above_K, 293.15);
}

TEST(ThermalChecks, AreTheResultsAtTheEndsAndFailWhereAMeshJams) {
  Design design = drawn_design();
  design.thermal = two_plastics();
  for (const CheckId id :
       {CheckId::kThermalBacklash, CheckId::kThermalRootClearance, CheckId::kThermalLostMotion}) {
    design.limits[id] = 0.0;
  }
  const Evaluation e = evaluated(design);
  std::vector<double> backlash, clearance, lost_motion;
  for (const CheckResult& c : e.checks) {
    if (c.record->id == CheckId::kThermalBacklash) {
      backlash.push_back(c.value);
      EXPECT_EQ(c.ok, c.value >= -kFeasibilityTolerance * e.module_m[0]) << c.mesh;
    }
    if (c.record->id == CheckId::kThermalRootClearance) clearance.push_back(c.value);
    if (c.record->id == CheckId::kThermalLostMotion) {
      lost_motion.push_back(c.value);
      EXPECT_EQ(c.ok, c.value <= 0.0 + kFeasibilityTolerance * 3e-4);
    }
  }
  ASSERT_EQ(backlash.size(), 12U);
  ASSERT_EQ(clearance.size(), 24U);
  ASSERT_EQ(lost_motion.size(), 4U);
  for (std::size_t end = 0; end < 4; ++end) {
    const ThermalStateResult& at = e.thermal->states[end + 1];
    EXPECT_NEAR(lost_motion[end], at.lost_motion_rad, 1e-15);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      EXPECT_NEAR(backlash[3 * end + k], at.meshes[k].least_backlash_m, 1e-16);
      for (const std::size_t i : {0U, 1U}) {
        const auto gear = static_cast<std::size_t>(train::kMeshGears[k][0]);
        const double stage_module_m =
            e.module_m[static_cast<std::size_t>(train::stage_of(train::kMeshGears[k][0]))];
        const double factor = train::growth_factor(design.thermal->gear[gear], 293.15, at.state);
        EXPECT_NEAR(clearance[6 * end + 2 * k + i] * stage_module_m * factor,
                    at.meshes[k].root_clearance_m[i], 1e-15);
      }
    }
  }
  EXPECT_FALSE(all_ok(e.checks));
  Design cold = design;
  cold.thermal.reset();
  for (const CheckResult& c : evaluated(cold).checks) EXPECT_NE(c.record->group, "temperature");
}

TEST(ThermalChecks, HoldAtTheCornersOfTheTolerances) {
  Design design = drawn_design();
  design.thermal = two_plastics();
  design.limits[CheckId::kThermalBacklash] = 0.0;
  backlash::Tolerances tolerances;
  for (auto& gear : tolerances.gears) gear.tooth_thickness_m = {-5e-6, 5e-6};
  design.tolerances = tolerances;
  const Evaluation e = evaluated(design);
  ASSERT_TRUE(e.tolerance_limits);
  int seen = 0;
  for (const CheckLimits& c : e.tolerance_limits->checks) {
    if (c.record->id != CheckId::kThermalBacklash) continue;
    ++seen;
    // Two teeth, thicker by 5 µm arc each, in a gear that has grown by less than 1 %.
    const double loss = c.margin.nominal - c.margin.least;
    const double arc = 2.0 * 5e-6 * std::cos(design.train.pressure_angle_rad);
    EXPECT_NEAR(loss, arc, 0.01 * arc) << c.mesh;
  }
  EXPECT_EQ(seen, 12);
}

TEST(ThermalRange, ThatLeavesAMeshNoWorkingAngleIsSaidSo) {
  Design design = drawn_design();
  design.thermal = two_plastics();
  design.thermal->carrier.expansion_1_K = -5e-3;
  const auto result = evaluate(design);
  const auto* undefined = std::get_if<NotDefined>(&result);
  ASSERT_NE(undefined, nullptr);
  EXPECT_NE(undefined->message.find("at 60 C dry mesh"), std::string::npos) << undefined->message;
}

/// The contact ratio is checked as drawn: where it is less over the temperatures is told.
TEST(ThermalResult, NotesAContactRatioThatFallsBelowItsLimit) {
  Design design = drawn_design();
  design.thermal = two_plastics();
  const Evaluation e = evaluated(design);
  double drawn = 1e9, least = 1e9;
  for (const ThermalStateResult& state : e.thermal->states) {
    for (const ThermalMesh& mesh : state.meshes) {
      least = std::min(least, mesh.contact_ratio);
      if (&state == e.thermal->states.data()) drawn = std::min(drawn, mesh.contact_ratio);
    }
  }
  ASSERT_LT(least, drawn - 1e-3);
  const auto noted = [&](double limit) {
    design.limits[CheckId::kContactRatioMin] = limit;
    const Evaluation with = evaluated(design);
    std::string text;
    for (const std::string& note : with.notes) {
      if (note.find("over [thermal]") != std::string::npos) text += note;
    }
    return text;
  };
  EXPECT_EQ(noted(least - 1e-3), "");
  const std::string text = noted(0.5 * (least + drawn));
  EXPECT_NE(text.find(fmt::format("as low as {:.4f} (", least)), std::string::npos) << text;
}

TEST(Evaluation, NotesALimitOfTheCutterWithoutACutter) {
  Design design = drawn_design();
  const auto noted = [&] {
    const Evaluation e = evaluated(design);
    return std::ranges::count(e.notes, "ring_cutter is not checked: no ring has a pinion cutter");
  };
  EXPECT_EQ(noted(), 0);
  design.limits[CheckId::kRingCutter] = 0.5;
  EXPECT_EQ(noted(), 1);
  design.train.cutter[train::kR2].teeth = 40;
  EXPECT_EQ(noted(), 0);
}

}  // namespace
}  // namespace gear3k::design::thermal_result_test
