// The rig against the program: with no cause hidden, two independent derivations agree.

#include "tests/rig/rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"
#include "tests/cpu_time.hpp"

namespace gear3k::rig::rig_test {
namespace {

nlohmann::json analyze(const Gearbox& gearbox) {
  const test::Workplace place;
  place.write("design.toml", design_toml(gearbox));
  const auto result = place.run({"analyze", "design.toml", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

class RigOf : public testing::TestWithParam<Gearbox> {};

TEST_P(RigOf, SunTorqueAgreesWithAnalyze) {
  const Gearbox& gearbox = GetParam();
  const nlohmann::json analysis = analyze(gearbox);
  const auto ratio = analysis["ratio"].get<double>();
  // Truncation: none; both are exact for the first-order loss with an equal share of the load.
  constexpr double kTolerance = 1e-5;
  for (const double load : {5.0, 50.0}) {
    for (const int rotation : {1, -1}) {
      const Condition forward{.forward = true, .output_torque_Nm = load, .rotation = rotation};
      const Condition backward{.forward = false, .output_torque_Nm = load, .rotation = rotation};
      const double lossless = load / std::fabs(ratio);
      const double eta_f = lossless / sun_torque(gearbox, forward);
      const double eta_b = sun_torque(gearbox, backward) / lossless;
      EXPECT_NEAR(eta_f, analysis["efficiency"]["forward"].get<double>(), kTolerance * eta_f);
      EXPECT_NEAR(eta_b, analysis["efficiency"]["backward"].get<double>(), kTolerance * eta_b);
    }
  }
}

TEST_P(RigOf, LostMotionAgreesWithAnalyze) {
  const Gearbox& gearbox = GetParam();
  const auto expected = analyze(gearbox)["backlash"]["kinematic_arcmin"].get<double>();
  ASSERT_GT(expected, 0.0);
  EXPECT_NEAR(lost_motion_arcmin(gearbox, {}), expected, 1e-6 * expected);
}

INSTANTIATE_TEST_SUITE_P(Gearboxes, RigOf,
                         testing::Values(bilateral_drive_gear(), low_backlash_gear(),
                                         reversing_gear()),
                         [](const auto& gearbox) {
                           std::string name;
                           for (const char c : gearbox.param.name) {
                             if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
                           }
                           return name;
                         });

// Follows the includes of the library's sources; what scores the product's answers may stand in
// the same folder but not in this library.
TEST(Rig, SharesNoCodeWithTheProduct) {
  const std::filesystem::path root = GEAR3K_SOURCE_DIR;
  std::string sources = test::read_text(root / "tests/rig/CMakeLists.txt");
  sources.erase(0, sources.find("add_library(gear3k_rig"));
  sources.erase(sources.find(')'));
  std::vector<std::string> files;
  std::istringstream words(sources);
  for (std::string word; words >> word;) {
    if (word.ends_with(".cpp")) files.push_back("tests/rig/" + word);
  }
  EXPECT_GE(files.size(), 7U);
  const std::string mark = "#include \"";
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string name = files[i];
    for (const std::string& line : test::lines_of(test::read_text(root / name))) {
      if (!line.starts_with(mark)) continue;
      const std::string target = line.substr(mark.size(), line.rfind('"') - mark.size());
      ASSERT_TRUE(target.starts_with("tests/rig/")) << name << ": " << line;
      if (std::find(files.begin(), files.end(), target) == files.end()) files.push_back(target);
    }
  }
  EXPECT_GT(files.size(), 14U);
}

TEST(Rig, ReversingGearTurnsItsOutputBackwards) {
  EXPECT_LT(analyze(reversing_gear())["ratio"].get<double>(), 0.0);
}

TEST(Rig, PairLossAgreesWithMesh) {
  const test::Workplace place;
  place.write("pair.toml",
              "kind = \"external\"\nmodule_mm = 1.0\npressure_angle_deg = 20.0\n"
              "center_distance_mm = 50.0\n[gear1]\nteeth = 20\n[gear2]\nteeth = 80\n"
              "[friction]\ncoefficient = 0.1\nloss_model = \"sliding\"\n");
  const auto result = place.run({"mesh", "pair.toml", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto mesh = nlohmann::json::parse(result.out)["meshes"][0];
  const double loss = 1.0 - mesh["efficiency_forward"].get<double>();
  const Gearbox gearbox = bilateral_drive_gear();
  EXPECT_NEAR(pair_loss(gearbox, 1.0, {.driving_teeth = 20, .driven_teeth = 80}), loss,
              1e-8 * loss);
}

TEST(Rig, CampaignOf120RowsTakesLessThanEightMillisecondsOfAProcessor) {
  const std::vector<HiddenCause> causes{{.id = "friction_load", .rms_in_noise = 1.0},
                                        {.id = "bearing_load", .rms_in_noise = 1.0},
                                        {.id = "drag_constant", .rms_in_noise = 1.0}};
  const Gearbox gearbox = bilateral_drive_gear();
  constexpr int kCampaigns = 50;
  std::size_t bytes = 0;
  const double all_s = test::cpu_seconds_of([&] {
    for (std::uint64_t seed = 0; seed < kCampaigns; ++seed) {
      bytes += measure(gearbox, transmission_plan(), causes, seed).csv.size();
    }
  });
  const double each_ms = 1e3 * all_s / kCampaigns;
  RecordProperty("milliseconds", std::to_string(each_ms));
  EXPECT_GT(bytes, 0U);
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(each_ms, 8.0);  // four times what it is, for slower machines
#endif
}

}  // namespace
}  // namespace gear3k::rig::rig_test
