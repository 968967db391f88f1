// What the ledgers of all papers have in common: where an entry says that something is printed is
// what the data have of it.
#include "papers/ledger.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/text/csv_table.hpp"
#include "papers/published_sources.hpp"
#include "papers/reproduce.hpp"
#include "papers/reproduce_report.hpp"

namespace gear3k::papers::ledger_test {
namespace {

const Reproduction& reproduction() {
  static const Reproduction kResult = reproduce(published_sources());
  return kResult;
}

io::CsvTable table_of(const std::string& name) {
  std::ifstream file(std::string(GEAR3K_SOURCE_DIR) + "/data/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return io::parse_csv(text.str(), name);
}

/// The places that a text names, e.g. of "Secs. IV, V.A; eqs. 37 to 39; Table I": "sec IV",
/// "sec V.A", "eq 37", "eq 38", "eq 39", "table I".
std::vector<std::string> places_of(const std::string& text) {
  static const std::string kItem = R"((?:[IVX]+(?:\.[A-Z])?(?![A-Za-z])|\d+(?:[.-]\d+)*[a-c]?))";
  static const std::regex kPlaces(
      R"((sec|section|eq|table|fig)s?\.? ()" + kItem + "(?:(?:, | and | to )" + kItem + ")*)",
      std::regex::icase);
  static const std::regex kItems("( to )?(" + kItem + ")");
  std::vector<std::string> places;
  for (std::sregex_iterator found(text.begin(), text.end(), kPlaces), end; found != end; ++found) {
    std::string kind = found->str(1).substr(0, found->str(1) == "section" ? 3 : std::string::npos);
    std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return std::tolower(c); });
    const std::string list = found->str(2);
    int last = 0;
    for (std::sregex_iterator item(list.begin(), list.end(), kItems); item != end; ++item) {
      const std::string name = item->str(2);
      if (item->length(1) > 0) {
        for (int k = last + 1; k < std::stoi(name); ++k) {
          places.push_back(fmt::format("{} {}", kind, k));
        }
      }
      places.push_back(fmt::format("{} {}", kind, name));
      last = std::isdigit(static_cast<unsigned char>(name.front())) != 0 ? std::stoi(name) : 0;
    }
  }
  return places;
}

/// Where an entry does not name a place that is no figure, or the first one.
std::string missing_places(const std::string& locator, const std::string& where) {
  const std::vector<std::string> printed = places_of(locator);
  const std::vector<std::string> named = places_of(where);
  std::string missing = printed.empty() ? "no place in \"" + locator + "\"" : "";
  for (std::size_t k = 0; k < printed.size(); ++k) {
    if (k > 0 && printed[k].starts_with("fig")) continue;
    if (std::ranges::find(named, printed[k]) == named.end()) missing += printed[k] + "; ";
  }
  return missing;
}

TEST(Ledger, NamesOfFiguresAreUniqueInEachEntry) {
  for (const auto* ledger : {&reproduction().ledger, &reproduction().thesis.ledger,
                             &reproduction().backdrivability.ledger}) {
    ASSERT_FALSE(ledger->empty());
    for (const LedgerEntry& entry : *ledger) {
      std::set<std::string> names;
      for (const Figure& f : entry.figures) {
        EXPECT_TRUE(names.insert(f.name).second) << entry.where << ": " << f.name;
      }
    }
  }
}

TEST(Reproduce, NoTwoLinesOfItsCsvHaveOneName) {
  const io::CsvTable csv = io::parse_csv(reproduce_csv(reproduction()), "reproduce.csv");
  ASSERT_GT(csv.rows.size(), 1000U);
  std::set<std::pair<std::string, std::string>> names;
  for (const io::CsvTable::Row& row : csv.rows) {
    const auto name = std::pair(row.fields.at(0), row.fields.at(1));
    EXPECT_TRUE(names.insert(name).second) << name.first << ": " << name.second;
  }
}

TEST(LedgerPlaces, AreReadFromText) {
  using Places = std::vector<std::string>;
  EXPECT_EQ(places_of("Secs. II, V.A; Table III: ratio"),
            (Places{"sec II", "sec V.A", "table III"}));
  EXPECT_EQ(places_of("abstract, sections 3.4.1 and 4.1"), (Places{"sec 3.4.1", "sec 4.1"}));
  EXPECT_EQ(places_of("eqs. 3 to 5, Fig. 2: planets"), (Places{"eq 3", "eq 4", "eq 5", "fig 2"}));
  EXPECT_EQ(places_of("Sec. 4.1: I to II"), (Places{"sec 4.1"}));
  EXPECT_EQ(missing_places("section VI: so", "Sec. V.B: that"), "sec VI; ");
  EXPECT_EQ(missing_places("section VI, Fig. 6", "Secs. V.B, VI"), "");
}

/// Numbers of the entries that print a statement; none for what an equation takes in alone, what
/// the original of another paper states, and what stands beside a figure.
using Printed = std::map<std::string, std::vector<std::size_t>>;

void expect_places(const std::vector<LedgerEntry>& ledger, const Printed& printed,
                   const std::string& name, const std::string& locator) {
  const auto at = printed.find(name);
  ASSERT_NE(at, printed.end()) << name << ": in which entry?";
  for (const std::size_t number : at->second) {
    const LedgerEntry& entry = ledger.at(number - 1);
    EXPECT_EQ(missing_places(locator, entry.where), "") << name << " in " << entry.where;
  }
}

void expect_statements(const std::string& file, const std::vector<LedgerEntry>& ledger,
                       const Printed& printed) {
  const io::CsvTable table = table_of(file);
  ASSERT_EQ(table.rows.size(), printed.size());
  for (const io::CsvTable::Row& row : table.rows) {
    expect_places(ledger, printed, table.text(row, "name").value(),
                  table.text(row, "locator").value());
  }
}

TEST(Ledger, NamesThePlacesOfTheLowBacklashPapersStatements) {
  expect_statements("low_backlash_paper_statements.csv", reproduction().ledger,
                    {{"simulated_lost_motion", {4, 11}},
                     {"simulated_backward", {10, 11}},
                     {"backlash_accuracy", {4}},
                     {"bilateral_backlash_accuracy", {4}},
                     {"measured_lost_motion_bracket", {4}},
                     {"bilateral_xP2_printed", {3}},
                     {"starting_torque_ratio", {13}},
                     {"eq10_factor_printed", {7}},
                     {"bilateral_contact_ratio_SP1", {}},
                     {"bilateral_contact_ratio_P1R1", {}},
                     {"bilateral_contact_ratio_P2R2", {}},
                     {"figure_outer_diameter", {}},
                     {"lost_motion_before", {}},
                     {"lost_motion_after", {11}},
                     {"efficiency_after", {11}}});
}

TEST(Ledger, NamesThePlacesOfTheThesisStatements) {
  expect_statements("directional_impedance_statements.csv", reproduction().thesis.ledger,
                    {{"module", {}},
                     {"pressure_angle", {}},
                     {"map_friction", {}},
                     {"corrected_friction", {5, 6}},
                     {"corrected_offset", {6, 8}},
                     {"corrected_symmetric_scale", {6, 8}},
                     {"corrected_skew_factor", {6, 7}},
                     {"largest_model_skew", {5}},
                     {"single_pair_contact_ratio", {3}},
                     {"small_skew_teeth", {10}},
                     {"small_skew", {10}},
                     {"sensor_sensitivity_error", {11}},
                     {"mesh_rate", {}},
                     {"largest_asymmetry", {14}},
                     {"smaller_asymmetry", {14}}});
}

TEST(Ledger, NamesThePlacesOfTheBackdrivabilityPapersStatements) {
  expect_statements("backdrivability_statements.csv", reproduction().backdrivability.ledger,
                    {{"ratio", {}},
                     {"acceleration_torque", {}},
                     {"efficiency", {}},
                     {"gear_inertia", {}},
                     {"gear_stiffness", {}},
                     {"max_backdriving_torque", {19}},
                     {"gear_viscous", {}},
                     {"rotor_inertia", {}},
                     {"motor_stiffness", {}},
                     {"resistance", {}},
                     {"torque_constant", {}},
                     {"no_load_speed", {}},
                     {"no_load_current", {}},
                     {"motor_viscous", {14}},
                     {"motor_nominal_torque", {}},
                     {"knee_torque", {}},
                     {"body_mass", {}},
                     {"eq37_factor", {5, 15}},
                     {"eq38_viscous", {14}},
                     {"eq39_coulomb", {19}},
                     {"eq40_load_share", {18}},
                     {"eq41_inertia", {16}},
                     {"eq42_inertia", {16}},
                     {"eq45_torque_factor", {}},
                     {"eq45_viscous", {14}},
                     {"eq45_inertia", {16}},
                     {"eq45_stiffness", {17}},
                     {"point_i", {21, 22, 23}},
                     {"enough_torque", {23}},
                     {"point_ii", {22, 23}},
                     {"passable_share", {23}},
                     {"fig9_exponent", {12}}});
}

// The table of the gearboxes has a place for each column in its head.
TEST(Ledger, NamesThePlacesOfThePublishedGearboxes) {
  const io::CsvTable table = table_of("published_3k_prototypes.csv");
  std::map<std::string, std::string> locators;
  for (const std::string& note : table.notes) {
    const auto from = note.find("place of ");
    if (from == std::string::npos) continue;
    const auto colon = note.find(": ", from);
    std::istringstream columns(note.substr(from + 9, colon - from - 9));
    for (std::string column; columns >> column;) locators[column] = note.substr(colon + 2);
  }
  for (const auto& [column, locator] : locators) {
    EXPECT_NE(std::ranges::find(table.header, column), table.header.end()) << column;
  }
  const Printed printed{{"ratio_stated", {2}},        {"xP2", {3}},
                        {"backlash_arcmin", {4}},     {"n_planets", {5}},
                        {"fwd_eff_pct", {10}},        {"bwd_eff_pct", {10}},
                        {"backdrive_start_Nm", {13}}, {"max_backdrive_Nm", {13}}};
  for (const auto& [column, entries] : printed) {
    expect_places(reproduction().ledger, printed, column, locators[column]);
  }
}

}  // namespace
}  // namespace gear3k::papers::ledger_test
