// The CSV of an analysis beside its JSON: what the one knows the other has.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "app/analyze.hpp"
#include "io/files/design_file.hpp"
#include "io/text/csv_table.hpp"
#include "report/analysis_report.hpp"

namespace gear3k::app::analysis_csv_test {
namespace {

using nlohmann::json;

Analysis analysis_of(const std::string& name) {
  return analyze(
      {.design = io::read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/" + name),
       .model = std::nullopt,
       .source = name});
}

const design::TorqueAngleCurve* curve_of(const Analysis& analysis) {
  return analysis.torque_angle ? &*analysis.torque_angle : nullptr;
}

json json_of(const Analysis& a) {
  return json::parse(
      report::analysis_json(a.evaluation, a.sensitivities, nullptr, nullptr, curve_of(a)).text());
}
std::string csv_of(const Analysis& a) {
  return report::analysis_csv(a.evaluation, a.sensitivities, nullptr, curve_of(a));
}

/// Numbers of the column `value`, sorted.
std::vector<double> values_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::vector<double> values;
  io::CsvFields fields;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_TRUE(fields.split(line)) << line;
    if (const auto value = io::csv_number(fields.values()[2])) values.push_back(*value);
  }
  std::ranges::sort(values);
  return values;
}

/// Every number with its path.
void collect(const json& part, const std::string& path, const std::set<std::string>& without,
             std::vector<std::pair<double, std::string>>& numbers) {
  if (without.contains(path)) return;
  if (part.is_number()) numbers.emplace_back(part.get<double>(), path);
  if (part.is_object()) {
    for (const auto& [key, value] : part.items()) {
      collect(value, path.empty() ? key : path + "." + key, without, numbers);
    }
  }
  if (part.is_array()) {
    for (const json& value : part) collect(value, path, without, numbers);
  }
}

class AnalysisCsv : public testing::TestWithParam<const char*> {};

TEST_P(AnalysisCsv, HasARowForEveryNumberOfTheJson) {
  const Analysis analysis = analysis_of(GetParam());
  // A check's limit has a column of its own, and its margin follows; factors are rows of teeth and
  // meshes; a part of which nothing is known is not counted; inputs and corners have their own
  // tests.
  const std::set<std::string> without{
      "tool",       "masses.count",  "checks.limit",     "checks.margin",
      "tolerances", "sensitivities", "strength.factors", "tightest_checks"};
  std::vector<std::pair<double, std::string>> numbers;
  collect(json_of(analysis), "", without, numbers);
  ASSERT_GT(numbers.size(), 100U);
  std::vector<double> rows = values_of(csv_of(analysis));
  for (const auto& [value, path] : numbers) {
    const auto found = std::ranges::lower_bound(rows, value);
    ASSERT_TRUE(found != rows.end() && *found == value) << path << " = " << value;
    rows.erase(found);
  }
}

TEST_P(AnalysisCsv, HasNoMinusZero) {
  const Analysis analysis = analysis_of(GetParam());
  for (const double value : values_of(csv_of(analysis))) {
    EXPECT_FALSE(value == 0.0 && std::signbit(value));
  }
  std::vector<std::pair<double, std::string>> numbers;
  collect(json_of(analysis), "", {}, numbers);
  for (const auto& [value, path] : numbers) {
    EXPECT_FALSE(value == 0.0 && std::signbit(value)) << path;
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, AnalysisCsv,
                         testing::Values("ratio_96_with_losses.toml", "ratio_96_tolerances.toml",
                                         "loaded.toml"),
                         [](const auto& tested) {
                           const std::string name = tested.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace gear3k::app::analysis_csv_test
