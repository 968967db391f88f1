// The DESIGN files of a front: one for each row of pareto.csv, and none of an earlier run.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/optimize/least_lost_motion.hpp"

namespace gear3k::front_files_test {
namespace {

using nlohmann::json;
using test::Workplace;

using Names = std::set<std::string>;

/// Two tooth sets with a design.
std::string task(int points, const std::string& objective) {
  std::string text = optimize::test::kLeastLostMotion;
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"[\"lost_motion\", \"backward_efficiency\"]", objective},
           {"points = 4", "points = " + std::to_string(points)},
           {"S = [18, 19]", "S = [18, 18]"},
           {"P1 = [40, 48]", "P1 = [47, 48]"},
           {"P2 = [42, 44]", "P2 = [42, 43]"},
           {"stage1_mm = { series = [0.5, 0.6, 0.7, 0.8] }", "stage1_mm = { series = [0.5, 0.6] }"},
           {"stage2_mm = { series = [0.5, 0.6, 0.7, 0.8] }",
            "stage2_mm = { series = [0.5, 0.6] }"}}) {
    text = test::replaced(text, from, to);
  }
  return text +
         "[stage1]\nface_width_mm = 10\n[stage2]\nface_width_mm = 10\n[inertia]\n"
         "density_kg_m3 = 7800\n";
}
const std::string kTwo = "[\"lost_motion\", \"backward_efficiency\"]";

Names fronts_in(const Workplace& place, const std::string& folder) {
  Names names;
  for (const auto& entry : std::filesystem::directory_iterator(place.file(folder))) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("front_")) names.insert(name);
  }
  return names;
}

test::ProgramResult optimize(const Workplace& place, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"optimize", "spec.toml", "--out", "out", "--threads", "1"};
  words.insert(words.end(), more.begin(), more.end());
  return place.run(words);
}

TEST(FrontFiles, AreTheDesignsOfTheRows) {
  const Workplace place;
  place.write("spec.toml", task(3, kTwo));
  const auto run = optimize(place);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("front_01.toml to front_03.toml"), std::string::npos) << run.out;
  EXPECT_EQ(fronts_in(place, "out"), (Names{"front_01.toml", "front_02.toml", "front_03.toml"}));
  const io::CsvTable rows = io::parse_csv(place.read("out/pareto.csv"), "pareto.csv");
  ASSERT_EQ(rows.rows.size(), 3U);
  EXPECT_EQ(rows.header.back(), "design_file");
  std::vector<std::string> named;
  for (const auto& row : rows.rows) {
    const std::string file = rows.text(row, "design_file").value_or("");
    named.push_back(file);
    const auto analysis = place.run({"analyze", "out/" + file, "--format", "json"});
    ASSERT_EQ(analysis.exit_code, 0) << file << ": " << analysis.err;
    const json read = json::parse(analysis.out);
    const auto expect = [&](const char* column, const json& value) {
      const double stated = std::stod(rows.text(row, column).value());
      EXPECT_NEAR(value.get<double>(), stated, 1e-9 * std::abs(stated)) << file << ", " << column;
    };
    expect("objective_backward_efficiency", read.at("efficiency").at("backward"));
    expect("objective_lost_motion_arcmin", read.at("backlash").at("kinematic_arcmin"));
    expect("eta_f", read.at("efficiency").at("forward"));
    expect("ratio", read.at("ratio"));
    expect("inertia_kgm2", read.at("inertia").at("lossless_kgm2"));
    expect("center_distance_mm", read.at("center_distance_mm"));
  }
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("pareto_front").at("design_files"), json(named));
}

TEST(FrontFiles, OfAnEarlierRunGoWhereThisOneHasFewer) {
  const Workplace place;
  place.write("spec.toml", task(4, kTwo));
  ASSERT_EQ(optimize(place).exit_code, 0);
  ASSERT_EQ(fronts_in(place, "out").size(), 4U);
  place.write("out/front_mine.toml", "name = \"mine\"\n");
  place.write("spec.toml", task(2, kTwo));
  EXPECT_EQ(optimize(place).exit_code, 2) << "refused without --force";
  EXPECT_EQ(fronts_in(place, "out").size(), 5U);
  const auto fewer = optimize(place, {"--force"});
  EXPECT_EQ(fewer.exit_code, 0) << fewer.err;
  EXPECT_NE(fewer.err.find("front_04.toml: was of an earlier run, removed"), std::string::npos)
      << fewer.err;
  EXPECT_EQ(fronts_in(place, "out"), (Names{"front_01.toml", "front_02.toml", "front_mine.toml"}));
  // With one objective there is no front.
  place.write("spec.toml", task(2, "\"lost_motion\""));
  EXPECT_EQ(optimize(place, {"--force"}).exit_code, 0);
  EXPECT_EQ(fronts_in(place, "out"), Names{"front_mine.toml"});
  EXPECT_EQ(place.read("out/pareto.csv").find("design_file"), std::string::npos);
}

TEST(FrontFiles, OfOthersAreKept) {
  const Workplace place;
  std::filesystem::create_directory(place.file("out"));
  place.write("out/front_02.toml", "drawn by hand");
  place.write("spec.toml", task(2, kTwo));
  const auto run = optimize(place);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(place.read("out/front_02.toml.previous"), "drawn by hand");
  EXPECT_NE(place.read("out/front_02.toml"), "drawn by hand");
  // A table that names files elsewhere is none of a run.
  place.write("elsewhere.toml", "mine");
  place.write("out/pareto.csv", "design_file\n../elsewhere.toml\nbest.toml\n");
  EXPECT_EQ(optimize(place, {"--force"}).exit_code, 0);
  EXPECT_EQ(place.read("elsewhere.toml"), "mine");
  EXPECT_TRUE(place.has("out/best.toml"));
}

TEST(FrontFiles, ReplaceNoInput) {
  const Workplace place;
  std::filesystem::create_directory(place.file("out"));
  place.write("out/front_02.toml", task(2, kTwo));
  const auto run = place.run({"optimize", "out/front_02.toml", "--out", "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("front_02.toml"), std::string::npos) << run.err;
  EXPECT_EQ(place.read("out/front_02.toml"), task(2, kTwo));
  EXPECT_FALSE(place.has("out/summary.json"));
}

}  // namespace
}  // namespace gear3k::front_files_test
