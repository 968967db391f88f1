// `gear3k analyze --figures`: the torque-angle curve, its files, and what it is refused for; and
// what `diagnose` says of the springs of [strength].

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::torque_angle_cli_test {
namespace {

using nlohmann::json;
using test::example, test::OtherPath, test::ProgramResult, test::Workplace;

std::string loaded() { return example("designs/loaded.toml"); }

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(AnalyzeFigures, AreTheCurveThatTheJsonTells) {
  const Workplace place;
  place.write("gear.toml", loaded());
  const ProgramResult result =
      place.run({"analyze", "gear.toml", "--figures", "out", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json curve = json::parse(result.out).at("torque_angle");
  ASSERT_TRUE(place.has("out/torque_angle.csv"));
  const std::string csv = place.read("out/torque_angle.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "branch,torque_nm,angle_arcmin");
  for (const char* branch :
       {"loading,20,", "unloading,0,", "reverse_loading,-20,", "reverse_unloading,0,"}) {
    EXPECT_TRUE(contains(csv, std::string("\n") + branch)) << branch;
  }
  // The end of the loading branch is half the lost motion and the wind-up.
  const std::size_t at = csv.find("\nloading,20,") + std::string("\nloading,20,").size();
  EXPECT_NEAR(
      std::stod(csv.substr(at)),
      0.5 * curve.at("lost_motion_arcmin").get<double>() + curve.at("windup_arcmin").get<double>(),
      1e-9);
  EXPECT_NEAR(curve.at("loop_mj").get<double>() / curve.at("friction_mj").get<double>(), 1.0, 1e-3);
}

TEST(AnalyzeFigures, WithoutGnuplotAreMissingAndTheDataAreThere) {
  const Workplace place;
  place.write("gear.toml", loaded());
  const OtherPath no_programs("nowhere");
  const ProgramResult result =
      place.run({"analyze", "gear.toml", "--figures", "out", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(place.has("out/torque_angle.csv"));
  EXPECT_FALSE(place.has("out/torque_angle.svg"));
  EXPECT_EQ(json::parse(result.out).at("missing_figures").at(0).at("file"), "torque_angle.svg");
}

TEST(AnalyzeFigures, WantStrengthAndAnotherFileThanThatOfOut) {
  const Workplace place;
  place.write("plain.toml", example("designs/bilateral_drive_gear.toml"));
  const ProgramResult plain = place.run({"analyze", "plain.toml", "--figures", "out"});
  EXPECT_EQ(plain.exit_code, 2);
  EXPECT_TRUE(contains(plain.err, "--figures: the torque-angle curve needs [strength]"))
      << plain.err;
  EXPECT_FALSE(place.has("out"));
  EXPECT_TRUE(json::parse(place.run({"analyze", "plain.toml", "--format", "json"}).out)
                  .at("torque_angle")
                  .is_null());
  place.write("gear.toml", loaded());
  const ProgramResult same =
      place.run({"analyze", "gear.toml", "--figures", "out", "--out", "out/torque_angle.csv"});
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_TRUE(contains(same.err, "is a file of --figures")) << same.err;
}

/// Lost motion that grows with the torque beyond what the teeth wind up.
std::string measured() {
  std::string csv = "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin\n";
  for (int k = 0; k < 40; ++k) {
    const double torque_Nm = 2.0 * (1 + k % 10);
    const double scatter_arcmin = 0.02 * ((k * 7) % 11 - 5) / 5.0;
    csv += fmt::format("{},{},{}\n", 9 * k, torque_Nm, 8.0 + 0.1 * torque_Nm + scatter_arcmin);
  }
  return csv;
}

TEST(DiagnoseWindUpCommand, TheModelSaysWhatItsComplianceCountsFrom) {
  const Workplace place;
  place.write("gear.toml", loaded());
  place.write("lost.csv", measured());
  const ProgramResult result =
      place.run({"diagnose", "gear.toml", "lost.csv", "--out", "out", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  const double springs = data.at("springs_nm_per_rad").get<double>();
  ASSERT_FALSE(data.at("effects").empty());
  const json& compliance = data.at("effects").at(0).at("parameters").at(0);
  EXPECT_EQ(data.at("effects").at(0).at("id"), "compliance");
  // 0.1 arcmin/Nm are twice the whole compliance.
  constexpr double kArcmin = std::numbers::pi / 10800.0;
  EXPECT_NEAR(compliance.at("value").get<double>(), 0.05 - 1.0 / springs / kArcmin, 0.001);
  EXPECT_TRUE(contains(place.read("out/model.toml"), "beyond_strength_springs = true\n"));
  // Applied, it is in series with the springs.
  const json with = json::parse(
      place.run({"analyze", "gear.toml", "--model", "out/model.toml", "--format", "json"}).out);
  EXPECT_NEAR(with.at("torque_angle").at("elastic_windup_arcmin").get<double>(), 20.0 * 0.05, 0.02);
}

}  // namespace
}  // namespace gear3k::torque_angle_cli_test
