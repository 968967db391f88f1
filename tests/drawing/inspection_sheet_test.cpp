// Inspection sheets: limits against a printed report, and the timing marks of planets.

#include "drawing/inspection_sheet.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "backlash/pitch_grade.hpp"
#include "drawing/planet_marks.hpp"
#include "geometry/tooth_measures.hpp"
#include "io/files/design_file.hpp"
#include "io/text/csv_table.hpp"

namespace gear3k::inspection_sheet_test {
namespace {

using drawing::Characteristic, drawing::InspectionSheet;

const std::string kExamples = std::string(GEAR3K_SOURCE_DIR) + "/examples/";

const Characteristic& row_of(const InspectionSheet& sheet, const std::string& symbol) {
  for (const Characteristic& row : sheet.rows) {
    if (row.symbol == symbol) return row;
  }
  throw std::out_of_range(symbol);
}

std::vector<InspectionSheet> pair_sheets(const std::string& file, std::array<double, 2> pins_m) {
  design::PairDesign pair = io::read_pair(kExamples + "pairs/" + file);
  pair.pin_diameter_m = {pins_m[0], pins_m[1]};
  return drawing::inspection_sheets(pair, std::get<design::PairEvaluation>(design::evaluate(pair)));
}
std::vector<InspectionSheet> train_sheets(const std::string& file) {
  const design::Design design = io::read_design(kExamples + "designs/" + file);
  return drawing::inspection_sheets(design, std::get<design::Evaluation>(design::evaluate(design)));
}

/// What KISSsoft printed: tests/golden/kisssoft_stage_01.toml names the report.
struct Printed {
  const char* symbol;
  double nominal, lower, upper;
};
void expect_printed(const InspectionSheet& sheet, const std::vector<Printed>& printed) {
  constexpr double kHalfDigit = 0.0005 + 1e-9;
  for (const Printed& p : printed) {
    const Characteristic& row = row_of(sheet, p.symbol);
    EXPECT_NEAR(row.nominal.value(), p.nominal, kHalfDigit) << sheet.name << ' ' << p.symbol;
    EXPECT_NEAR(row.lower.value(), p.lower, kHalfDigit) << sheet.name << ' ' << p.symbol;
    EXPECT_NEAR(row.upper.value(), p.upper, kHalfDigit) << sheet.name << ' ' << p.symbol;
  }
}

TEST(InspectionSheet, HasTheLimitsThatKissSoftPrints) {
  const auto sun_planet = pair_sheets("wind_turbine_sun_planet.toml", {0.095, 0.110});
  expect_printed(sun_planet.at(0), {{"W_3", 363.082, 362.842, 362.917},
                                    {"M_dR", 1050.690, 1050.253, 1050.390},
                                    {"s_n", 90.897, 90.642, 90.722},
                                    {"A_sn", 0.0, -255.0, -175.0},
                                    {"d_a", 978.808, 978.798, 978.808}});
  expect_printed(sun_planet.at(1), {{"W_3", 367.520, 367.281, 367.356},
                                    {"M_dR", 1008.755, 1008.360, 1008.484},
                                    {"s_n", 96.962, 96.707, 96.787}});
  const auto planet_ring = pair_sheets("wind_turbine_planet_ring.toml", {0.110, 0.080});
  expect_printed(planet_ring.at(1), {{"W_8", 1047.070, 1047.474, 1047.624},
                                     {"M_dR", 2445.378, 2446.539, 2446.970},
                                     {"s_n", 54.264, 53.674, 53.834}});
}

// KISSsoft prints where the ring's tip reaches on the planet at its deepest, d_Nf,i, and the
// planet's form circles by the allowances of its teeth.
TEST(InspectionSheet, HoldsTheFormCircleToWhatTheMateReachesAtWorst) {
  const Characteristic form =
      row_of(pair_sheets("wind_turbine_planet_ring.toml", {0.110, 0.080}).at(0), "d_Ff");
  EXPECT_NEAR(form.upper.value(), 749.084, 0.0005 + 1e-9);
  EXPECT_NE(form.note.find("within the tolerances; built 748.2"), std::string::npos) << form.note;
}

// The pins that KISSsoft measures with fit; the ends that are told do so too, and none beyond.
TEST(InspectionSheet, SaysWhyAPinDoesNotFitAndWhichDo) {
  const auto notes = [](double pin1_m, double pin2_m) {
    std::string text;
    for (const InspectionSheet& sheet :
         pair_sheets("wind_turbine_planet_ring.toml", {pin1_m, pin2_m})) {
      text += fmt::format("{}\n", fmt::join(sheet.notes, "\n"));
    }
    return text;
  };
  EXPECT_EQ(notes(0.110, 0.080).find("pins"), std::string::npos);
  const std::string large = notes(0.400, 0.300);
  const std::string small = notes(0.040, 0.020);
  for (const char* part : {"a pin of 400 mm is too large, it would touch beyond the tips; pins of ",
                           "a pin of 300 mm is too large"}) {
    EXPECT_NE(large.find(part), std::string::npos) << large;
  }
  EXPECT_NE(small.find("a pin of 40 mm is too small, it would touch the root or its fillets; "),
            std::string::npos)
      << small;
  const auto told = [&](const std::string& pin) {
    const auto at = large.find("pins of ", large.find(pin)) + 8;
    return std::pair{std::stod(large.substr(at)),
                     std::stod(large.substr(large.find("to ", at) + 3))};
  };
  const auto [least1, greatest1] = told("of 400 mm");
  const auto [least2, greatest2] = told("of 300 mm");
  EXPECT_EQ(notes(1e-3 * least1, 1e-3 * greatest2).find("a pin of"), std::string::npos);
  EXPECT_EQ(notes(1e-3 * greatest1, 1e-3 * least2).find("a pin of"), std::string::npos);
  EXPECT_NE(notes(1e-3 * least1 - 2e-7, 0.080).find("too small"), std::string::npos);
  EXPECT_NE(notes(0.110, 1e-3 * greatest2 + 2e-7).find("too large"), std::string::npos);
}

// What a workshop types into its machine is the tool, in full.
TEST(InspectionSheet, PrintsTheModuleInFull) {
  const design::Design design = io::read_design(kExamples + "designs/ratio_96_tolerances.toml");
  const std::string page = drawing::sheet_html(train_sheets("ratio_96_tolerances.toml").at(1));
  EXPECT_NE(page.find(fmt::format("<td>{:.10g}</td>", 1e3 * design.train.module_m[0])),
            std::string::npos);
}

// Of a tool of the rack, d_f = m (z + 2 x_E − 2 hf*) with x_E = x + A_sn/(2 m tan α); of a tool
// whose teeth are thicker d_f = m (z + 2 x − 2 hf*): a gear that is cut with either is good.
TEST(InspectionSheet, AcceptsTheRootsOfBothTools) {
  const auto sheets = train_sheets("ratio_96_tolerances.toml");
  for (const std::size_t k : {0U, 1U, 3U}) {
    const InspectionSheet& sheet = sheets[k];
    const auto value = [&](const char* symbol) { return row_of(sheet, symbol).nominal.value(); };
    const Characteristic& a_sn = row_of(sheet, "A_sn");
    const Characteristic& root = row_of(sheet, "d_f");
    const double tan_alpha = std::tan(value("alpha") * std::numbers::pi / 180.0);
    const double thick = value("m") * (value("z") + 2.0 * value("x")) - 2.0 * value("h_fP");
    EXPECT_NEAR(value("d_f"), thick, 1e-9);
    const double fed_in = thick + 1e-3 * a_sn.lower.value() / tan_alpha;
    EXPECT_NEAR(root.lower.value(), fed_in, 1e-9);
    EXPECT_GE(root.upper.value(), thick - 1e-9);
    EXPECT_NEAR(root.upper.value(),
                thick + 1e-3 * (a_sn.upper.value() - a_sn.nominal.value()) / tan_alpha, 1e-9);
  }
}

// The allowance of a drawn gear holds its machining allowance: m q is normal to the flanks, A_sn is
// the arc, and W_k is longer by A_sn cos α.
TEST(InspectionSheet, CountsTheMachiningAllowanceInA_sn) {
  const auto sheets = train_sheets("ratio_96_tolerances.toml");
  ASSERT_EQ(sheets.size(), 6U);
  for (std::size_t k = 0; k < 5; ++k) {
    const InspectionSheet& sheet = sheets[k];
    const Characteristic& a_sn = row_of(sheet, "A_sn");
    const double cos_alpha =
        std::cos(row_of(sheet, "alpha").nominal.value() * std::numbers::pi / 180.0);
    const auto span = std::ranges::find_if(
        sheet.rows, [](const Characteristic& row) { return row.symbol.starts_with("W_"); });
    ASSERT_NE(span, sheet.rows.end());
    const double width_um = a_sn.upper.value() - a_sn.lower.value();
    EXPECT_GE(width_um, 0.0);
    EXPECT_NEAR(1e3 * (span->upper.value() - span->lower.value()), width_um * cos_alpha, 1e-6);
    EXPECT_LE(a_sn.upper.value(), 0.0);
  }
}

TEST(InspectionSheet, PrintsTheThicknessAllowancesThatAFileStates) {
  const design::PairDesign pair = io::parse_pair(
      "kind = \"external\"\nmodule_mm = 45.0\ncenter_distance_mm = 863.0\n"
      "[gear1]\nteeth = 19\nprofile_shift = 0.617\nA_sn_um = [-255.0, -175.0]\n"
      "[gear2]\nteeth = 17\nprofile_shift = 0.8021342559\n",
      "pair.toml");
  const auto sheets =
      drawing::inspection_sheets(pair, std::get<design::PairEvaluation>(design::evaluate(pair)));
  const Characteristic& a_sn = row_of(sheets.at(0), "A_sn");
  EXPECT_NEAR(a_sn.lower.value(), -255.0, 1e-12);
  EXPECT_NEAR(a_sn.nominal.value(), -215.0, 1e-12);
  EXPECT_NEAR(a_sn.upper.value(), -175.0, 1e-12);
  // Of the same report: the limits of s_n and W_3 are those of HasTheLimitsThatKissSoftPrints.
  EXPECT_NEAR(row_of(sheets.at(0), "s_n").lower.value(), 90.642, 0.0005 + 1e-9);
  EXPECT_NEAR(row_of(sheets.at(0), "s_n").upper.value(), 90.722, 0.0005 + 1e-9);
  EXPECT_NEAR(row_of(sheets.at(0), "W_3").lower.value(), 362.842, 0.0005 + 1e-9);
  EXPECT_NEAR(row_of(sheets.at(0), "W_3").upper.value(), 362.917, 0.0005 + 1e-9);
  EXPECT_EQ(row_of(sheets.at(1), "A_sn").nominal.value(), 0.0);
}

// Both gears of a mesh say the same play, and it is that of the evaluation.
TEST(InspectionSheet, HasThePlayOfEveryMesh) {
  const auto sheets = train_sheets("ratio_96_tolerances.toml");
  const design::Design design = io::read_design(kExamples + "designs/ratio_96_tolerances.toml");
  const auto e = std::get<design::Evaluation>(design::evaluate(design));
  for (std::size_t m = 0; m < e.meshes.size(); ++m) {
    for (std::size_t side = 0; side < 2; ++side) {
      const auto own = train::kMeshGears[m][side], mate = train::kMeshGears[m][1 - side];
      const auto& rows = sheets.at(static_cast<std::size_t>(own)).rows;
      const auto row =
          std::ranges::find(rows, "normal backlash with " + std::string(train::kGearNames[mate]),
                            &Characteristic::name);
      ASSERT_NE(row, rows.end()) << m;
      EXPECT_NEAR(*row->nominal, 1e6 * e.meshes[m].normal_backlash_m, 1e-9);
      EXPECT_GT(*row->nominal, 0.0);
    }
  }
}

TEST(InspectionSheet, HasNoPlayThatIsTheRoundingOfPositions) {
  const design::Design design = io::read_design(kExamples + "designs/bilateral_drive_gear.toml");
  auto e = std::get<design::Evaluation>(design::evaluate(design));
  for (auto& mesh : e.meshes) mesh.normal_backlash_m = -4.33680868994e-19;
  int meshes = 0;
  for (const InspectionSheet& sheet : drawing::inspection_sheets(design, e)) {
    for (const Characteristic& row : sheet.rows) {
      if (row.symbol != "j_bn") continue;
      EXPECT_EQ(*row.nominal, 0.0);
      ++meshes;
    }
  }
  EXPECT_GE(meshes, 3);
}

TEST(InspectionSheet, WithoutTolerancesHasNominalValuesAndSaysSo) {
  for (const InspectionSheet& sheet : train_sheets("bilateral_drive_gear.toml")) {
    for (const Characteristic& row : sheet.rows) {
      if (row.symbol == "d_Ff") continue;  // what the mate reaches
      EXPECT_FALSE(row.lower || row.upper) << sheet.name << ' ' << row.name;
      EXPECT_EQ(row.note.find("limits"), std::string::npos) << sheet.name << ' ' << row.note;
    }
    EXPECT_FALSE(sheet.notes.empty()) << sheet.name;
  }
}

TEST(InspectionSheet, HasNoLimitsOfWhatHasNoTolerance) {
  design::Design design = io::read_design(std::string(GEAR3K_SOURCE_DIR) +
                                          "/examples/designs/bilateral_drive_gear.toml");
  design.tolerances.emplace();
  design.tolerances->gears[train::kP1].tooth_thickness_m = {.lower = -20e-6, .upper = -10e-6};
  design.masses.ring1_outer_radius_m = 0.05;
  const auto evaluation = std::get<design::Evaluation>(design::evaluate(design));
  for (const InspectionSheet& sheet : drawing::inspection_sheets(design, evaluation)) {
    if (sheet.name == "P1") continue;
    bool outer = false;
    for (const Characteristic& row : sheet.rows) {
      outer = outer || row.name == "outer diameter";
      if (row.symbol == "d_Ff") continue;
      const bool of_p1 = row.name.ends_with("with P1") && row.group == "mesh";
      EXPECT_EQ(row.lower || row.upper, of_p1) << sheet.name << ' ' << row.name;
    }
    EXPECT_EQ(outer, sheet.name == "R1") << sheet.name;
  }
}

TEST(InspectionSheet, NamesTheGradeOfItsDeviations) {
  geometry::GearGeometry<double> gear;
  gear.gear.module_m = 0.002;
  gear.reference_radius_m = 0.03;
  EXPECT_FALSE(drawing::grade_of(gear, {}));
  for (int grade = 3; grade <= 12; ++grade) {
    const auto t =
        backlash::pitch_grade({.module_m = 0.002, .reference_diameter_m = 0.06}, grade).value();
    backlash::GearTolerances tolerances;
    tolerances.single_pitch_m = t.single_pitch_m;
    tolerances.cumulative_pitch_m = t.cumulative_pitch_m;
    tolerances.runout_m = t.runout_m;
    EXPECT_EQ(drawing::grade_of(gear, tolerances), grade);
    tolerances.runout_m *= 1.01;
    EXPECT_FALSE(drawing::grade_of(gear, tolerances));
  }
}

TEST(InspectionSheet, FilesReadBack) {
  for (const InspectionSheet& sheet : train_sheets("ratio_96_tolerances.toml")) {
    const io::CsvTable table = io::parse_csv(drawing::sheet_csv(sheet), sheet.name);
    EXPECT_EQ(table.rows.size(), sheet.rows.size() + sheet.notes.size());
    std::istringstream page(drawing::sheet_html(sheet));
    boost::property_tree::ptree tree;
    EXPECT_NO_THROW(boost::property_tree::read_xml(page, tree)) << sheet.name;
  }
}

// What the page accepts the file accepts.
TEST(InspectionSheet, ThePagesLimitsLieWithinThoseOfTheFile) {
  int limits = 0;
  for (const InspectionSheet& sheet : train_sheets("ratio_96_tolerances.toml")) {
    std::istringstream page(drawing::sheet_html(sheet));
    boost::property_tree::ptree tree;
    boost::property_tree::read_xml(page, tree);
    std::vector<std::vector<std::string>> rows;
    for (const auto& [name, row] : tree.get_child("html.body.table")) {
      std::vector<std::string> cells;
      for (const auto& [tag, cell] : row) {
        if (tag == "td") cells.push_back(cell.data());
      }
      if (!cells.empty()) rows.push_back(std::move(cells));
    }
    ASSERT_EQ(rows.size(), sheet.rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const drawing::Characteristic& exact = sheet.rows[k];
      if (exact.group == "gear" || exact.unit.empty()) continue;
      const double step = exact.unit == "um" ? 0.1 : exact.unit == "mm" ? 1e-3 : 1e-4;
      const double computing = 1e-5 * step;
      for (const auto& [limit, cell, sense] :
           {std::tuple{exact.lower, 4, 1.0}, std::tuple{exact.upper, 5, -1.0}}) {
        if (!limit) continue;
        ++limits;
        const double within = sense * (std::stod(rows[k].at(cell)) - *limit);
        EXPECT_GE(within, -computing) << exact.name;
        EXPECT_LT(within, step) << exact.name;
        const std::string& shown = rows[k].at(static_cast<std::size_t>(cell));
        EXPECT_FALSE(shown.starts_with('-') && std::stod(shown) == 0.0) << exact.name;
      }
      if (exact.lower && exact.upper && *exact.lower < *exact.upper) {
        EXPECT_LT(std::stod(rows[k][4]), std::stod(rows[k][5])) << exact.name;
      }
    }
  }
  EXPECT_GT(limits, 40);
}

TEST(InspectionSheet, ThePageHasMoreDigitsWhereALimitOfFewLeavesNothing) {
  InspectionSheet sheet;
  sheet.rows.push_back({.group = "tooth thickness",
                        .name = "narrow",
                        .symbol = "W_5",
                        .unit = "mm",
                        .nominal = 5.5725,
                        .lower = 5.57221,
                        .upper = 5.57279,
                        .note = {}});
  sheet.rows.push_back({.group = "tooth thickness",
                        .name = "one step",
                        .symbol = "M",
                        .unit = "mm",
                        .nominal = 9.811,
                        .lower = 9.8106,
                        .upper = 9.8113,
                        .note = {}});
  sheet.rows.push_back({.group = "planet",
                        .name = "small",
                        .symbol = "phi",
                        .unit = "deg",
                        .nominal = 0.0,
                        .lower = -0.0000667,
                        .upper = 0.0000667,
                        .note = {}});
  sheet.rows.push_back({.group = "tip",
                        .name = "tip",
                        .symbol = "d_a",
                        .unit = "mm",
                        .nominal = 11.0395626,
                        .lower = {},
                        .upper = 11.0395626,
                        .note = {}});
  const std::string page = drawing::sheet_html(sheet);
  for (const char* cells :
       {"<td>11.039</td><td></td><td>11.039</td>", "<td>5.5725</td><td>5.5723</td><td>5.5727</td>",
        "<td>9.8110</td><td>9.8106</td><td>9.8113</td>",
        "<td>0.00000</td><td>-0.00006</td><td>0.00006</td>"}) {
    EXPECT_NE(page.find(cells), std::string::npos) << cells << page;
  }
}

double whole_distance(double value) { return std::abs(value - std::round(value)); }

// A marked tooth is one of the teeth where the train is drawn, and planets that are one part have
// their marks in line.
TEST(PlanetMarks, AreTeethOfThePlacedPlanets) {
  std::mt19937 random(5);
  const auto between = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  int alike = 0;
  int different = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const train::ToothSet z{.S = between(9, 40),
                            .P1 = between(12, 60),
                            .R1 = between(60, 160),
                            .P2 = between(12, 60),
                            .R2 = between(60, 160)};
    const int planets = between(2, 6);
    const train::Assembly assembly = train::assembly(z, planets);
    const auto placed = drawing::place_train(z, planets).planets;
    const auto marks = drawing::planet_marks(z, planets);
    ASSERT_EQ(marks.size(), placed.size());
    const double turn = 2.0 * std::numbers::pi;
    const double finest = turn / std::lcm(z.P1, z.P2);
    for (std::size_t i = 0; i < marks.size(); ++i) {
      EXPECT_LT(whole_distance((marks[i].p1_rad - placed[i].p1_rad) * z.P1 / turn), 1e-9);
      EXPECT_LT(
          whole_distance((marks[i].p1_rad + marks[i].phase_rad - placed[i].p2_rad) * z.P2 / turn),
          1e-9);
      EXPECT_GE(marks[i].phase_rad, 0.0);
      EXPECT_LT(marks[i].phase_rad, finest * (1.0 + 1e-12));
      if (assembly.equal_spacing && assembly.identical_planets) {
        EXPECT_EQ(marks[i].phase_rad, 0.0);
      }
    }
    if (assembly.equal_spacing) ++(assembly.identical_planets ? alike : different);
  }
  EXPECT_GT(alike, 50);
  EXPECT_GT(different, 50);
}

}  // namespace
}  // namespace gear3k::inspection_sheet_test
