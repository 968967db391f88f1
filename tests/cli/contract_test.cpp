// Commands, formats, files and exit codes that users' scripts rely on.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "io/csv_table.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k {
namespace {

using nlohmann::json;
using test::example, test::lines_of, test::ProgramResult, test::replaced, test::RunningProgram,
    test::Workplace;

constexpr double kDegree = std::numbers::pi / 180.0;
const std::string kLowBacklash = "designs/low_backlash_prototype.toml";
const std::string kBilateral = "designs/bilateral_drive_gear.toml";

/// Half a unit of the last decimal that a source prints.
double half_unit(int decimals) { return 0.5 * std::pow(10.0, -decimals); }

/// Rounding of a handful of operations on a value of this size.
double rounding(double size) { return 1e-13 * std::abs(size); }

json json_of(const Workplace& place, const std::vector<std::string>& arguments) {
  const ProgramResult result = place.run(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

json analysis_of(const std::string& design) {
  const Workplace place;
  place.write("gear.toml", design);
  return json_of(place, {"analyze", "gear.toml", "--format", "json"});
}

/// The keys are there with the type of their letter: n number, i integer, b boolean, s text,
/// o object, a list.
void expect_keys(const json& object, const std::map<std::string, char>& keys) {
  for (const auto& [key, type] : keys) {
    ASSERT_TRUE(object.contains(key)) << key;
    const json& value = object.at(key);
    const bool fits = type == 'n'   ? value.is_number()
                      : type == 'i' ? value.is_number_integer()
                      : type == 'b' ? value.is_boolean()
                      : type == 's' ? value.is_string()
                      : type == 'o' ? value.is_object()
                                    : value.is_array();
    EXPECT_TRUE(fits) << key << " = " << value;
  }
}

void expect_mesh_keys(const json& mesh) {
  expect_keys(mesh, {{"name", 's'},
                     {"working_pressure_angle_deg", 'n'},
                     {"zero_backlash_center_distance_mm", 'n'},
                     {"contact_ratio", 'n'},
                     {"approach_contact_ratio", 'n'},
                     {"recess_contact_ratio", 'n'},
                     {"normal_backlash_um", 'n'},
                     {"efficiency_forward", 'n'},
                     {"efficiency_backward", 'n'}});
  EXPECT_NEAR(mesh.at("approach_contact_ratio").get<double>() +
                  mesh.at("recess_contact_ratio").get<double>(),
              mesh.at("contact_ratio").get<double>(), rounding(10.0));
}

void expect_gear_keys(const json& gear) {
  expect_keys(gear, {{"name", 's'},
                     {"teeth", 'i'},
                     {"pitch_diameter_mm", 'n'},
                     {"base_diameter_mm", 'n'},
                     {"tip_diameter_mm", 'n'},
                     {"root_diameter_mm", 'n'},
                     {"tip_thickness_mm", 'n'}});
}

void expect_check_keys(const json& check) {
  static const std::set<std::string> kUnits{"", "module", "mm", "um", "arcmin", "deg"};
  expect_keys(check, {{"name", 's'}, {"margin", 'n'}, {"unit", 's'}, {"ok", 'b'}});
  EXPECT_TRUE(kUnits.contains(check.at("unit").get<std::string>())) << check;
  for (const char* subject : {"mesh", "gear"}) {
    if (check.contains(subject)) {
      EXPECT_TRUE(check.at(subject).is_string()) << check;
    }
  }
}

// --- analyze

struct Prototype {
  std::string name, file;
  double ratio;  ///< (1 + zR1/zS)/(1 - zP2 zR1/(zP1 zR2))
  double stated_ratio;
  std::vector<double> zero_backlash_mm;
  double module1_mm, module2_mm;
  std::vector<int> teeth;
  std::vector<double> shift;
};

void PrintTo(const Prototype& prototype, std::ostream* stream) { *stream << prototype.name; }

class PublishedPrototype : public testing::TestWithParam<Prototype> {};

TEST_P(PublishedPrototype, AnalysisHasEveryKeyWithItsTypeAndUnit) {
  const Prototype& p = GetParam();
  const json result = analysis_of(example(p.file));
  expect_keys(result, {{"tool", 'o'},
                       {"name", 's'},
                       {"ratio", 'n'},
                       {"g1", 'n'},
                       {"g2", 'n'},
                       {"center_distance_mm", 'n'},
                       {"efficiency", 'o'},
                       {"meshes", 'a'},
                       {"gears", 'a'},
                       {"backlash", 'o'},
                       {"inertia", 'n' /* replaced below */},
                       {"assembly", 'o'},
                       {"checks", 'a'}}.size() == 0
                          ? std::map<std::string, char>{}
                          : std::map<std::string, char>{{"tool", 'o'},
                                                        {"name", 's'},
                                                        {"ratio", 'n'},
                                                        {"g1", 'n'},
                                                        {"g2", 'n'},
                                                        {"center_distance_mm", 'n'},
                                                        {"efficiency", 'o'},
                                                        {"meshes", 'a'},
                                                        {"gears", 'a'},
                                                        {"backlash", 'o'},
                                                        {"assembly", 'o'},
                                                        {"checks", 'a'}});
}

}  // namespace
}  // namespace gear3k
