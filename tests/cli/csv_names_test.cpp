// Names of the CSV of `analyze` and `mesh`: those of the JSON without their unit, or named in
// docs/interface.md.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::csv_names_test {
namespace {

using nlohmann::json;
using test::Workplace;

using Names = std::set<std::string>;

/// Names that the rule does not give.
const Names kExceptions{
    "cutter_center_distance",
    "cutter_teeth",
    "cutter_tip_diameter",
    "inertia_backward",
    "inertia_forward",
    "inertia_lossless",
    "inertia_paper",
    "infeed_profile_shift",
    "infeed_root_diameter",
    "input_stiffness",
    "load_cycles",
    "lost_motion_input_kinematic",
    "lost_motion_kinematic",
    "lost_motion_mean",
    "lost_motion_paper",
    "lost_motion_standard_deviation",
    "lost_motion_worst_case",
    "margin_worst_case",
    "mesh_stiffness",
    "output_stiffness",
    "phase",
    "pin_bending_moment",
    "pin_bending_position",
    "pin_contact_diameter",
    "pitch_line_speed",
    "rated_output_torque",
    "rated_torque",
    "root_fillet_radius",
    "span_contact_diameter",
    "span_count",
    "torque_capacity",
    "torque_capacity_backward",
    "torque_capacity_forward",
    "centrifugal_force",
};

/// First words of quantities that name a part, a check or a key besides.
const Names kWithSubject{"bearing_load", "built",     "check",        "compliance",
                         "d_margin",     "drag_loss", "efficiency",   "force",
                         "friction",     "heat",      "normal_force", "sliding_speed"};

/// What names of the JSON end in for their units.
const std::vector<std::string> kUnits{
    "mm",        "um",         "deg",   "arcmin", "nm",  "n",       "mpa",   "kg",      "kgm2",
    "rpm",       "c",          "w",     "m_s",    "mj",  "rad",     "pitch", "n_mm_um", "n_mm",
    "nm_per_kg", "nm_per_rad", "teeth", "k",      "mm3", "percent", "h",     "1_k"};

void keys_of(const json& value, Names& keys) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      keys.insert(key);
      keys_of(member, keys);
    }
  } else if (value.is_array()) {
    for (const json& item : value) keys_of(item, keys);
  }
}

/// Whether a key, with its unit or without, is the quantity; of lists by gear with their end.
bool follows_the_rule(std::string quantity, const Names& keys) {
  for (const char* end : {"_gear1", "_gear2"}) {
    if (quantity.ends_with(end)) quantity.resize(quantity.size() - std::string(end).size());
  }
  return keys.contains(quantity) || std::ranges::any_of(kUnits, [&](const std::string& unit) {
           return keys.contains(quantity + "_" + unit);
         });
}

TEST(CsvNames, AreThoseOfTheJsonOrNamedInTheContract) {
  const Workplace place;
  const std::filesystem::path source(GEAR3K_SOURCE_DIR);
  const std::string contract = test::read_text(source / "docs/interface.md");
  Names seen;
  for (const auto& [command, file] :
       std::vector<std::array<std::string, 2>>{{"analyze", "designs/loaded.toml"},
                                               {"analyze", "designs/ratio_96_tolerances.toml"},
                                               {"analyze", "designs/ratio_96_with_losses.toml"},
                                               {"mesh", "pair_internal.toml"},
                                               {"mesh", "pairs/wind_turbine_planet_ring.toml"}}) {
    const std::string path = (source / "examples" / file).string();
    Names keys;
    keys_of(json::parse(place.run({command, path, "--format", "json"}).out), keys);
    const io::CsvTable csv =
        io::parse_csv(place.run({command, path, "--format", "csv"}).out, "result.csv");
    ASSERT_FALSE(csv.rows.empty()) << file;
    for (const auto& row : csv.rows) {
      const std::string quantity = csv.text(row, "quantity").value();
      if (follows_the_rule(quantity, keys)) continue;
      if (const std::size_t blank = quantity.find(' '); blank != std::string::npos) {
        EXPECT_TRUE(kWithSubject.contains(quantity.substr(0, blank))) << file << ": " << quantity;
        continue;
      }
      if (quantity.starts_with("phase_planet")) continue;
      EXPECT_TRUE(kExceptions.contains(quantity))
          << file << ": " << csv.text(row, "item").value() << ", " << quantity;
      seen.insert(quantity);
    }
  }
  for (const std::string& name : kExceptions) {
    EXPECT_TRUE(seen.contains(name)) << name << " is in no CSV, or is no exception";
    EXPECT_NE(contract.find("`" + name + "`"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace gear3k::csv_names_test
