// The published 96.2:1 prototypes: one coefficient of friction cannot explain both directions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "io/text/csv_table.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::published_prototypes_test {
namespace {

using nlohmann::json;
using test::ProgramResult, test::Workplace;

struct Prototype {
  const char* design;
  const char* data;
  double ratio;              ///< (1 + zR1/zS)/(1 − zP2 zR1/(zP1 zR2))
  double forward, backward;  ///< efficiency, Table III of the low-backlash paper
};

const Prototype kLowBacklash{"low_backlash_prototype.toml", "published_low_backlash.csv",
                             (1.0 + 94.0 / 14.0) / (1.0 - 36.0 * 94.0 / (40.0 * 92.0)), 0.871,
                             0.825};
const Prototype kBilateral{"bilateral_drive_gear.toml", "published_bilateral_drive_gear.csv",
                           (1.0 + 90.0 / 12.0) / (1.0 - 32.0 * 90.0 / (39.0 * 81.0)), 0.890, 0.853};

std::string example_path(const std::string& name) {
  return std::string(GEAR3K_SOURCE_DIR) + "/examples/" + name;
}

class PublishedPrototypes : public testing::TestWithParam<Prototype> {
 protected:
  [[nodiscard]] static ProgramResult diagnose(const std::string& format) {
    const Workplace place;
    return place.run({"diagnose", example_path(std::string("designs/") + GetParam().design),
                      example_path(std::string("measurements/") + GetParam().data), "--format",
                      format, "--quiet"});
  }
};

/// The sun's torque follows from the printed efficiency; sigma is half of its last digit, 0.05 %.
TEST_P(PublishedPrototypes, DataFollowFromTheEfficiencies) {
  const std::string path = example_path(std::string("measurements/") + GetParam().data);
  const io::CsvTable table = io::parse_csv(test::read_text(path), path);
  ASSERT_EQ(table.rows.size(), 2U);
  const auto value = [&](std::size_t row, const char* column) {
    return table.number(table.rows.at(row), column).value();
  };
  constexpr double kPrinted = 0.5e-6;
  constexpr double kHalfDigit = 0.0005;
  const double through = value(0, "output_torque_nm") / GetParam().ratio;
  EXPECT_NEAR(value(0, "sun_torque_nm"), through / GetParam().forward, kPrinted);
  EXPECT_NEAR(value(1, "sun_torque_nm"), through * GetParam().backward, kPrinted);
  EXPECT_NEAR(value(0, "sigma_nm"), through / GetParam().forward * kHalfDigit / GetParam().forward,
              kPrinted);
  EXPECT_NEAR(value(1, "sigma_nm"), through * kHalfDigit, kPrinted);
  for (const char* column : {"sun_speed_rpm", "output_torque_nm"}) {
    EXPECT_EQ(value(0, column), value(1, column)) << "only the direction may differ";
  }
}

TEST_P(PublishedPrototypes, FrictionLevelAloneDoesNotExplainThem) {
  const ProgramResult result = diagnose("json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json d = json::parse(result.out);
  EXPECT_EQ(d["verdict"], "ambiguous");
  ASSERT_EQ(d["effects"].size(), 2U) << d["effects"];
  // Each of them with all that these data cannot tell from it.
  std::vector<std::set<std::string>> could;
  for (const json& effect : d["effects"]) {
    could.push_back({effect["id"].get<std::string>()});
    for (const json& id : effect["alternatives"]) could.back().insert(id.get<std::string>());
  }
  const auto level = std::ranges::find_if(
      could, [](const auto& names) { return names.contains("friction_level"); });
  ASSERT_NE(level, could.end()) << d["effects"];
  const auto& other = could[level == could.begin() ? 1 : 0];
  EXPECT_TRUE(other.contains("friction_direction")) << d["effects"];
  EXPECT_TRUE(other.contains("sensor_gain")) << d["effects"];
  EXPECT_FALSE(other.contains("friction_level")) << d["effects"];
  // A drag costs both directions torque, the more the greater it is: with any coefficient of
  // friction, forward would lose too much.
  for (const char* drag : {"drag_constant", "drag_viscous", "drag_quadratic"}) {
    EXPECT_FALSE(other.contains(drag)) << d["effects"];
  }
  EXPECT_LT(d["rmse"]["extended_train"], d["rmse"]["noise_floor"]);
  EXPECT_GT(d["rmse"]["baseline_train"], 10.0 * d["rmse"]["noise_floor"].get<double>());
}

TEST_P(PublishedPrototypes, TheMeasurementThatWouldTellIsProposed) {
  const ProgramResult result = diagnose("json");
  const json d = json::parse(result.out);
  const json& next = d["next_experiment"];
  ASSERT_TRUE(next.is_object()) << result.out;
  EXPECT_GE(next["separates"].size(), 2U);
  ASSERT_FALSE(next["conditions"].empty());
  for (const json& condition : next["conditions"]) {
    for (const char* key : {"direction", "sun_speed_rpm", "output_torque_nm", "repeats"}) {
      EXPECT_TRUE(condition.contains(key)) << condition;
    }
    EXPECT_GT(condition["repeats"].get<int>(), 0);
  }
  // It tells some of them apart, or says of which that it cannot.
  constexpr double kTold = 9.0;
  const auto advice = next["advice"].get<std::string>();
  const auto named = std::ranges::count_if(next["separates"], [&](const json& id) {
    return advice.find(id.get<std::string>()) != std::string::npos;
  });
  if (next["expected_statistic"].get<double>() < kTold) {
    EXPECT_GE(named, 2) << next["expected_statistic"] << ' ' << advice;
  }
  EXPECT_TRUE(advice.empty() || named >= 2) << advice;
}

TEST_P(PublishedPrototypes, TheTableSaysSo) {
  const ProgramResult result = diagnose("table");
  for (const char* part : {"Verdict: ambiguous", "One coefficient of friction cannot explain",
                           "[friction_level]", "cannot tell", "sensor_gain", "Next experiment"}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part << '\n' << result.out;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, PublishedPrototypes, testing::Values(kLowBacklash, kBilateral),
                         [](const auto& tested) {
                           return tested.index == 0 ? "LowBacklash" : "BilateralDriveGear";
                         });

}  // namespace
}  // namespace gear3k::published_prototypes_test
