#include "report/tolerance_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "io/files/design_file.hpp"
#include "report/analysis_report.hpp"

namespace gear3k::report::tolerance_report_test {
namespace {

const std::string kExamples = GEAR3K_SOURCE_DIR "/examples/";

design::PairEvaluation pair(const std::string& name) {
  return std::get<design::PairEvaluation>(
      design::evaluate(io::read_pair(kExamples + "pairs/" + name + ".toml")));
}

TEST(ToleranceReport, SaysNothingWithoutTolerances) {
  const auto e = pair("dry_steel_pair");
  EXPECT_EQ(tolerance_table(e.tolerance_limits), "");
  EXPECT_EQ(analysis_csv(e).find("built"), std::string::npos);
  EXPECT_FALSE(nlohmann::json::parse(analysis_json(e).text()).contains("tolerances"));
  EXPECT_NE(analysis_table(e).find("Not checked: strength (no [strength]), tolerances (no "
                                   "[tolerances]).\n"),
            std::string::npos);
}

TEST(ToleranceReport, NominalIsWhatTheSameReportSaysOfTheDrawnPair) {
  const auto json = nlohmann::json::parse(analysis_json(pair("wind_turbine_planet_ring")).text());
  const auto& limits = json["tolerances"];
  const auto& mesh = limits["meshes"][0];
  const auto& drawn = json["meshes"][0];
  for (const char* key : {"normal_backlash_um", "contact_ratio", "working_pressure_angle_deg"}) {
    EXPECT_EQ(mesh[key]["nominal"], drawn[key]) << key;
    EXPECT_LT(mesh[key]["min"], mesh[key]["max"]) << key;
  }
  for (const std::size_t i : {0U, 1U}) {
    for (const char* key : {"root_clearance_mm", "active_root_diameter_mm"}) {
      EXPECT_EQ(mesh[key][i]["nominal"], drawn[key][i]) << key;
    }
    const auto& gear = limits["gears"][i];
    for (const char* key : {"tip_diameter_mm", "root_diameter_mm", "tip_thickness_mm"}) {
      EXPECT_EQ(gear[key]["nominal"], json["gears"][i][key]) << key;
    }
  }
  std::size_t i = 0;
  for (const auto& check : json["checks"]) {
    ASSERT_LT(i, limits["checks"].size());
    EXPECT_EQ(limits["checks"][i]["name"], check["name"]);
    EXPECT_EQ(limits["checks"][i]["margin"]["nominal"], check["margin"]);
    ++i;
  }
  EXPECT_EQ(i, limits["checks"].size());
  EXPECT_GT(i, 10U);
  EXPECT_FALSE(limits.contains("lost_motion_arcmin"));
}

TEST(ToleranceReport, EveryCsvRowHasTheColumnsOfTheTable) {
  const std::string csv = analysis_csv(pair("wind_turbine_sun_planet"));
  std::istringstream lines(csv);
  int built = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(",built ") == std::string::npos) continue;
    ++built;
    if (line.find('"') != std::string::npos) continue;  // a subject "1-2, 1" is quoted
    EXPECT_EQ(std::ranges::count(line, ','), 5) << line;
  }
  EXPECT_GT(built, 60);
}

}  // namespace
}  // namespace gear3k::report::tolerance_report_test
