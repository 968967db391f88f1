// Published ratings of pairs: the examples through `gear3k mesh`, against
// tests/golden/kisssoft_stage_01_strength.toml and gearpie_c14_strength.toml.

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/run_program.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::published_ratings_test {
namespace {

using nlohmann::json;
using test::ProgramResult, test::Workplace;

struct PublishedRating {
  const char* golden;
  int figures;
};

std::string text_of(const toml::node_view<const toml::node>& node) { return node.value_or(""); }

/// Meshes and teeth of the golden file's pairs, by the names that it gives them.
std::map<std::string, json> rated_subjects(const toml::table& golden) {
  std::map<std::string, json> subjects;
  for (const toml::node& node : *golden["pair"].as_array()) {
    const toml::table& pair = *node.as_table();
    const Workplace place;
    const std::string file =
        std::string(GEAR3K_SOURCE_DIR "/examples/pairs/") + text_of(pair["file"]);
    const ProgramResult result = place.run({"mesh", file, "--format", "json", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << file << "\n" << result.err;
    const json strength = json::parse(result.out).at("strength");
    subjects[text_of(pair["mesh"])] = strength.at("meshes").at(0);
    for (std::size_t i = 0; i < 2; ++i) {
      subjects[text_of(pair["gears"][i])] = strength.at("teeth").at(i);
    }
  }
  return subjects;
}

class PublishedRatings : public testing::TestWithParam<PublishedRating> {};

TEST_P(PublishedRatings, AreThoseOfTheProgramToTheirPrintedDigits) {
  const toml::table golden =
      toml::parse_file(std::string(GEAR3K_SOURCE_DIR "/tests/golden/") + GetParam().golden);
  ASSERT_NE(text_of(golden["cite"]), "");
  ASSERT_NE(text_of(golden["locator"]), "");
  const std::map<std::string, json> subjects = rated_subjects(golden);
  LargestDeviation digits, percents;
  int in_digits = 0, in_percents = 0;
  for (const toml::node& node : *golden["expect"].as_array()) {
    const toml::table& row = *node.as_table();
    const std::string quantity = text_of(row["quantity"]);
    const auto percent = row["tolerance_percent"].value<double>();
    ASSERT_TRUE(!percent || row["reason"].value<std::string>()) << quantity;
    const double unit = row["in_modules"].value_or(false) ? golden["module"].value_or(0.0) : 1.0;
    const int decimals = row["decimals"].value_or(golden["decimals"].value_or(0));
    for (const auto& [key, value] : row) {
      const auto subject = subjects.find(std::string(key.str()));
      if (subject == subjects.end()) continue;
      const double printed = value.value<double>().value();
      const double computed = subject->second.at(quantity).get<double>() / unit;
      const double rounding = row["input_rounding_percent"].value_or(0.0) / 100.0 * printed;
      const double allowed =
          percent ? *percent / 100.0 * printed : 0.5000001 * std::pow(10.0, -decimals) + rounding;
      EXPECT_NEAR(computed, printed, allowed) << quantity << " of " << subject->first;
      (percent ? percents : digits).see(0, computed - printed, allowed);
      ++(percent ? in_percents : in_digits);
    }
  }
  EXPECT_EQ(in_digits + in_percents, GetParam().figures);
  const std::string id = text_of(golden["id"]);
  digits.expect_allowed(fmt::format("{}, {} figures, half a digit", id, in_digits));
  if (in_percents == 0) return;
  percents.expect_allowed(
      fmt::format("{}, {} figures, percents with their reason", id, in_percents));
}

INSTANTIATE_TEST_SUITE_P(
    Rows, PublishedRatings,
    testing::Values(PublishedRating{.golden = "kisssoft_stage_01_strength.toml", .figures = 124},
                    PublishedRating{.golden = "gearpie_c14_strength.toml", .figures = 7}),
    [](const auto& row) {
      const std::string name = row.param.golden;
      return name.substr(0, name.find('_')) + "_strength";
    });

// The cutter of the ring leaves a sharper root than the report's virtual rack, as the example says.
TEST(PublishedRatings, TheRingsCutterLeaves18PercentMoreStressThanTheVirtualRack) {
  const std::string name = "wind_turbine_planet_ring.toml";
  const std::string stated = test::read_text(GEAR3K_SOURCE_DIR "/examples/pairs/" + name);
  const std::string line = "virtual_root_radius = 0.380255\n";
  const Workplace place;
  place.write("rack.toml", stated);
  place.write("cutter.toml", std::string(stated).erase(stated.find(line), line.size()));
  const auto stress = [&](const char* file) {
    const json report = json::parse(place.run({"mesh", file, "--format", "json", "--quiet"}).out);
    return report.at("strength").at("teeth").at(1).at("sigma_f_mpa").get<double>();
  };
  EXPECT_NEAR(stress("cutter.toml") / stress("rack.toml"), 1.18, 0.005);
}

}  // namespace
}  // namespace gear3k::published_ratings_test
