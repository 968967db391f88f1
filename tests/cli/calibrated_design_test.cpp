// From a campaign to a better gearbox: calibrated on one half of it, designed with the model, built
// and measured in the rig.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/files/design_file.hpp"
#include "tests/calibrate/built_design.hpp"
#include "tests/calibrate/redesign_spec.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::calibrated_design_test {
namespace {

using nlohmann::json;
using test::ProgramResult, test::Workplace;

/// Designed without a model, measured, calibrated on half of the rows and designed again.
struct Redesign {
  json found;                                  ///< diagnosis of the first half
  double error_as_given, error_with_model;     ///< on the other half
  double noise;                                ///< of the rig, Nm
  double efficiency_before, efficiency_after;  ///< backward, of the designs as built
};

ProgramResult run(const Workplace& place, const std::vector<std::string>& arguments) {
  ProgramResult result = place.run(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result;
}

rig::Gearbox built(const Workplace& place, const std::string& design) {
  return rig::built(io::read_design(place.file(design).string()));
}

Redesign redesign(const std::vector<rig::HiddenCause>& causes) {
  const Workplace place;
  place.write("spec.toml", rig::kRedesignSpec);
  run(place, {"optimize", "spec.toml", "--out", "first", "--quiet"});
  const rig::Gearbox first = built(place, "first/best.toml");
  constexpr std::uint64_t kSeed = 3;
  const rig::Dataset campaign = rig::measure(first, rig::transmission_plan(), causes, kSeed);
  const auto halves = rig::halves_by_session(campaign.csv);
  place.write("half1.csv", halves[0]);
  place.write("half2.csv", halves[1]);
  run(place, {"diagnose", "first/best.toml", "half1.csv", "--out", "found", "--quiet"});
  const auto error_on_other_half = [&](std::vector<std::string> options) -> double {
    std::vector<std::string> words{"diagnose", "first/best.toml", "half2.csv", "--format",
                                   "json",     "--quiet"};
    words.insert(words.end(), options.begin(), options.end());
    return json::parse(run(place, words).out)["rmse"]["baseline_train"].get<double>();
  };
  run(place,
      {"optimize", "spec.toml", "--model", "found/model.toml", "--out", "second", "--quiet"});
  const rig::Condition point{
      .forward = false, .sun_speed_rpm = 600.0, .output_torque_Nm = 20.0, .temperature_c = 35.0};
  return {.found = json::parse(place.read("found/diagnosis.json")),
          .error_as_given = error_on_other_half({}),
          .error_with_model = error_on_other_half({"--model", "found/model.toml"}),
          .noise = campaign.noise_sd,
          .efficiency_before = rig::measured_efficiency(first, point, campaign.causes),
          .efficiency_after =
              rig::measured_efficiency(built(place, "second/best.toml"), point, campaign.causes)};
}

/// Friction on the pins favours planets that turn slower and press less; teeth alone do not show
/// it.
TEST(CalibratedDesign, PlainBushingsAskForAnotherGearbox) {
  const Redesign r = redesign({{.id = "bearing_load", .variant = "pins", .amplitude = 0.1}});
  ASSERT_EQ(r.found["effects"].size(), 1U) << r.found["effects"];
  EXPECT_EQ(r.found["effects"][0]["id"], "bearing_load");
  EXPECT_LT(r.error_with_model, 1.25 * r.noise);
  EXPECT_GT(r.error_as_given, 15.0 * r.noise);
  RecordProperty("efficiency_without_model", std::to_string(r.efficiency_before));
  RecordProperty("efficiency_with_model", std::to_string(r.efficiency_after));
  EXPECT_GT(r.efficiency_after, r.efficiency_before + 0.005);
}

/// All designs lose in proportion to it: the best one stays the best.
TEST(CalibratedDesign, AnotherCoefficientOfFrictionAsksForNone) {
  const Redesign r = redesign({{.id = "friction_level", .amplitude = 0.5}});
  EXPECT_EQ(r.found["effects"][0]["id"], "friction_level");
  EXPECT_LT(r.error_with_model, 1.25 * r.noise);
  EXPECT_NEAR(r.efficiency_after, r.efficiency_before, 5e-4);
}

}  // namespace
}  // namespace gear3k::calibrated_design_test
