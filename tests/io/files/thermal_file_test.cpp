// [thermal] of DESIGN and SPEC.

#include <gtest/gtest.h>

#include <string>

#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::thermal_file_test {
namespace {

using design::CheckId;

const std::string kGears =
    "[stage1]\nmodule_mm = 0.8\n[stage2]\nmodule_mm = 0.8467\n[gears]\n"
    "S = { teeth = 12, profile_shift = 0.476 }\nP1 = { teeth = 39, profile_shift = 0.762 }\n"
    "R1 = { teeth = 90, profile_shift = 2.0 }\nP2 = { teeth = 32, profile_shift = 0.536 }\n"
    "R2 = { teeth = 81, profile_shift = 1.21 }\n";
const std::string kThermal =
    "[thermal]\ntemperature_c = [-20.0, 60.0]\nreference_c = 25.0\nS.expansion_1_k = 1.1e-5\n"
    "P1 = { expansion_1_k = 1.1e-4, swelling = [-0.001, 0.002] }\nR1.expansion_1_k = 1.2e-4\n"
    "P2.expansion_1_k = 1.3e-4\nR2.expansion_1_k = 1.4e-4\ncarrier.expansion_1_k = 2.3e-5\n";
const std::string kSpec =
    "[ratio]\ntarget = 96.2\n"
    "[teeth]\nS = [12, 13]\nP1 = [50, 60]\nR1_max = 120\nP2 = [40, 60]\nR2_max = 121\n"
    "[module]\nstage1_mm = 1.0\nstage2_mm = 0.9\n";

std::string errors_of(const std::string& text) {
  try {
    static_cast<void>(parse_design(text, "gear.toml"));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_stated(const std::optional<train::ThermalRange>& range) {
  ASSERT_TRUE(range);
  EXPECT_DOUBLE_EQ(range->least_K, 253.15);
  EXPECT_DOUBLE_EQ(range->greatest_K, 333.15);
  EXPECT_DOUBLE_EQ(range->reference_K, 298.15);
  EXPECT_EQ(range->gear[train::kS].expansion_1_K, 1.1e-5);
  EXPECT_EQ(range->gear[train::kP1].expansion_1_K, 1.1e-4);
  EXPECT_EQ(range->gear[train::kP1].swelling.dry, -0.001);
  EXPECT_EQ(range->gear[train::kP1].swelling.wet, 0.002);
  EXPECT_EQ(range->gear[train::kR2].expansion_1_K, 1.4e-4);
  EXPECT_EQ(range->gear[train::kR2].swelling.wet, 0.0);
  EXPECT_EQ(range->carrier.expansion_1_K, 2.3e-5);
}

TEST(ThermalFile, StatesTheRangeOfADesignAndOfASpecification) {
  expect_stated(parse_design(kGears + kThermal, "gear.toml").thermal);
  expect_stated(parse_specification(kSpec + kThermal, "spec.toml").thermal);
  EXPECT_FALSE(parse_design(kGears, "gear.toml").thermal);
}

TEST(ThermalFile, BringsItsLimitsWhereTheFileSaysNothingOfThem) {
  const auto limits = [](const std::string& rest) {
    return parse_design(kGears + rest, "gear.toml").limits;
  };
  const auto none = limits("");
  const auto usual = limits(kThermal);
  for (const CheckId id : {CheckId::kThermalBacklash, CheckId::kThermalRootClearance}) {
    EXPECT_FALSE(none[id]);
    EXPECT_EQ(usual[id], 0.0);
  }
  const auto stated =
      limits(kThermal + "[limits]\nthermal_backlash = 5.0\nthermal_root_clearance = false\n");
  EXPECT_DOUBLE_EQ(stated[CheckId::kThermalBacklash].value(), 5e-6);
  EXPECT_FALSE(stated[CheckId::kThermalRootClearance]);
  EXPECT_FALSE(usual[CheckId::kThermalLostMotion]);
}

TEST(ThermalFile, BringsItsLimitsToAFileThatWasWrittenWithoutIt) {
  for (const char* preset : {"", "preset = \"bare\"\n", "preset = \"machined\"\n"}) {
    const std::string text = design_text(parse_design(preset + kGears, "gear.toml"));
    const auto limits = parse_design(text + kThermal, "again.toml").limits;
    EXPECT_EQ(limits[CheckId::kThermalBacklash], 0.0) << text;
    EXPECT_EQ(limits[CheckId::kThermalRootClearance], 0.0) << text;
  }
}

TEST(ThermalFile, IsWrittenAndReadBackWithItsLimits) {
  for (const char* limits :
       {"", "[limits]\nthermal_backlash = 5.0\nthermal_root_clearance = false\n",
        "[limits]\nthermal_backlash = false\nthermal_lost_motion = 9.0\n"}) {
    const design::Design design = parse_design(kGears + kThermal + limits, "gear.toml");
    const std::string text = design_text(design);
    const design::Design again = as_written(design);
    expect_stated(again.thermal);
    for (const CheckId id :
         {CheckId::kThermalBacklash, CheckId::kThermalRootClearance, CheckId::kThermalLostMotion}) {
      EXPECT_EQ(again.limits[id].has_value(), design.limits[id].has_value()) << text;
      EXPECT_NEAR(again.limits[id].value_or(0.0), design.limits[id].value_or(0.0), 1e-20) << text;
    }
    EXPECT_EQ(design_text(again), text);
  }
  const std::string without = design_text(parse_design(kGears, "gear.toml"));
  EXPECT_EQ(without.find("thermal"), std::string::npos) << without;
}

TEST(ThermalFile, WantsTheExpansionOfEveryPart) {
  std::string text = kGears + kThermal;
  text.erase(text.find("P2.exp"), std::string("P2.expansion_1_k = 1.3e-4\n").size());
  const std::string errors = errors_of(text);
  EXPECT_NE(errors.find("thermal.P2.expansion_1_k is missing"), std::string::npos) << errors;
  EXPECT_EQ(errors.find("thermal.R2"), std::string::npos) << errors;
}

TEST(ThermalFile, RefusesKeysWithoutTheTemperaturesAndARangeUpsideDown) {
  const std::string alone = errors_of(kGears + "[thermal]\nS.expansion_1_k = 1.1e-5\n");
  EXPECT_NE(alone.find("gear.toml:12:3: thermal.S.expansion_1_k without thermal.temperature_c"),
            std::string::npos)
      << alone;
  EXPECT_NE(errors_of(kGears + "[thermal]\ntemperature_c = [60.0, -20.0]\n")
                .find("thermal.temperature_c"),
            std::string::npos);
}

TEST(ThermalFile, RefusesAnEmptyTableAndTellsWhatItNeeds) {
  const std::string errors = errors_of(kGears + "[thermal]\n");
  EXPECT_NE(errors.find("gear.toml:11:"), std::string::npos) << errors;
  EXPECT_NE(errors.find("[thermal] is empty: needs thermal.temperature_c"), std::string::npos)
      << errors;
}

TEST(ThermalFile, ThatLeavesNoWorkingAngleNamesTheTemperatureAndTheMesh) {
  std::string text = kGears + kThermal;
  text.replace(text.find("carrier.expansion_1_k = 2.3e-5"), 30, "carrier.expansion_1_k = -1e-3 ");
  text.replace(text.find("P1 = { expansion_1_k = 1.1e-4"), 29, "P1 = { expansion_1_k = 1.0e-3");
  text.replace(text.find("60.0]"), 5, "260.0]");
  const std::string errors = errors_of(text);
  EXPECT_NE(errors.find("at 260 C"), std::string::npos) << errors;
  EXPECT_NE(errors.find("has no working pressure angle"), std::string::npos) << errors;
}

}  // namespace
}  // namespace gear3k::io::thermal_file_test
