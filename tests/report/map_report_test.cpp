#include "report/map_report.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "io/text/csv_table.hpp"
#include "io/text/gnuplot.hpp"
#include "report/display.hpp"
#include "report/map_plot.hpp"

namespace gear3k::report::map_report_test {
namespace {

using design::Design, design::OperatingMap;
using nlohmann::json;

/// Zero shift at the reference centre distance of every mesh.
Design coaxial_design(const train::ToothSet& teeth) {
  Design d;
  d.name = "coaxial";
  d.train.teeth = teeth;
  d.train.pressure_angle_rad = std::numbers::pi / 9.0;
  d.train.module_m = {0.8e-3, 0.8e-3 * (teeth.R1 - teeth.P1) / (teeth.R2 - teeth.P2)};
  d.train.center_distance_m = 0.4e-3 * (teeth.R1 - teeth.P1);
  d.center_distance_given = true;
  return d;
}
Design usual() { return coaxial_design({.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 79}); }
Design self_locking() { return coaxial_design({.S = 12, .P1 = 39, .R1 = 90, .P2 = 38, .R2 = 88}); }
/// Needs help on the sun at small loads, none at great ones.
Design dragged() {
  Design d = usual();
  d.shafts.drag[design::kSunShaft] = {
      .constant_Nm = 0.05, .viscous_Nms = 1e-3, .quadratic_Nms2 = 0.0};
  return d;
}
/// Load-dependent friction without a value at rest or without load.
Design without_rest() {
  Design d = usual();
  d.friction.law = efficiency::FrictionLaw::kLoadPower;
  d.friction.load_exponent = -0.1;
  d.friction.reference_force_N = 100.0;
  d.map.output_torque_Nm.from = 0.0;
  return d;
}

OperatingMap map_of(const Design& design) {
  auto result = design::make_operating_map(design);
  if (const auto* undefined = std::get_if<design::NotDefined>(&result)) {
    throw std::logic_error(undefined->message);
  }
  return std::get<OperatingMap>(std::move(result));
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(MapUnits, StatedNumbersComeBackFromSiUnits) {
  for (const double stated : {0.1, 7.0, 19.9, 200.0, 333.3, 1000.0, 12345.678}) {
    EXPECT_EQ(rpm(stated * std::numbers::pi / 30.0), stated);
    EXPECT_EQ(celsius(stated + 273.15), stated);
    EXPECT_EQ(clean(-stated), -stated);
  }
  EXPECT_FALSE(std::signbit(clean(-0.0)));
}

TEST(MapCsv, IsATransmissionMeasurement) {
  const OperatingMap map = map_of(dragged());
  const io::CsvTable table = io::parse_csv(map_csv(map), "map.csv");
  EXPECT_EQ(table.notes, (std::vector<std::string>{" kind: transmission"}));
  const std::vector<std::string> required{"direction", "sun_speed_rpm", "output_torque_nm",
                                          "sun_torque_nm"};
  EXPECT_TRUE(std::equal(required.begin(), required.end(), table.header.begin()));
  ASSERT_EQ(table.rows.size(), 2U * 9U * 10U);
  // Friction is constant: what forward takes beyond the drag at 200 rpm grows with the load alone.
  const double drag_Nm = 0.05 + 1e-3 * 200.0 * std::numbers::pi / 30.0;
  const auto torque = [&](std::size_t row) {
    return *table.number(table.rows[row], "sun_torque_nm");
  };
  EXPECT_NEAR((torque(9) - drag_Nm) / (torque(0) - drag_Nm), 50.0 / 5.0, 1e-9);
  EXPECT_EQ(table.text(table.rows[0], "sun_speed_rpm"), "200");
  EXPECT_EQ(table.text(table.rows[0], "output_torque_nm"), "5");
  EXPECT_EQ(table.text(table.rows[90], "direction"), "backward");
}

TEST(MapCsv, HeatsOfARowAddUpToItsLossAndPowerBalance) {
  Design design = dragged();
  design.shafts.planet_bearing_coefficient = 0.005;
  design.shafts.planet_bearing_radius_m = 2e-3;
  design.shafts.drag[design::kCarrierShaft].constant_Nm = 0.03;
  const OperatingMap map = map_of(design);
  const io::CsvTable table = io::parse_csv(map_csv(map), "map.csv");
  for (const auto& row : table.rows) {
    const auto number = [&](const std::string& column) { return *table.number(row, column); };
    double heat = 0.0;
    for (const std::string& column : table.header) {
      if (column.starts_with("heat_") || column.starts_with("drag_loss_") ||
          column == "bearing_loss_w") {
        heat += number(column);
      }
    }
    const double w = number("sun_speed_rpm") * std::numbers::pi / 30.0;
    const double sun_W = number("sun_torque_nm") * w;
    const double output_W = number("output_torque_nm") * w / std::abs(map.ratio);
    const bool forward = table.text(row, "direction") == "forward";
    EXPECT_NEAR(heat, forward ? sun_W - output_W : output_W - sun_W, 1e-9);
    EXPECT_NEAR(heat, number("loss_w"), 1e-9);
  }
}

TEST(MapCsv, RowsWithoutOperationHaveNoNumbersButAStatus) {
  const OperatingMap map = map_of(without_rest());
  const io::CsvTable table = io::parse_csv(map_csv(map), "map.csv");
  for (const auto& row : table.rows) {
    const bool unloaded = *table.number(row, "output_torque_nm") == 0.0;
    EXPECT_EQ(table.text(row, "status"), unloaded ? "no_friction_value" : "runs");
    EXPECT_EQ(table.text(row, "sun_torque_nm").has_value(), !unloaded);
    EXPECT_EQ(table.text(row, "friction_p1_r1").has_value(), !unloaded);
  }
}

TEST(MapJson, HoldsEveryPointAndSaysWhyATorqueIsMissing) {
  const json data = json::parse(map_json(map_of(without_rest())).text());
  EXPECT_EQ(data.at("points").size(), 180U);
  EXPECT_EQ(data.at("sun_speed_rpm").size(), 9U);
  EXPECT_EQ(data.at("sun_speed_rpm").at(8), 1000.0);
  EXPECT_EQ(data.at("friction_law"), "load_power");
  EXPECT_TRUE(data.at("points").at(0).at("sun_torque_nm").is_null());
  EXPECT_TRUE(data.at("points").at(0).at("meshes").is_null());
  EXPECT_EQ(data.at("points").at(1).at("meshes").size(), 3U);
  const json& breakaway = data.at("breakaway").at("sun");
  EXPECT_TRUE(breakaway.at("torque_nm").is_null());
  EXPECT_EQ(breakaway.at("status"), "no_friction_value");
  EXPECT_EQ(breakaway.at("reason"), "friction law load_power has no value without tooth load");
  EXPECT_EQ(data.at("running").size(), 9U);
  EXPECT_EQ(data.at("reference").at("from"), "grid");
  EXPECT_EQ(data.at("reference").at("backward").at("sun_speed_rpm"), 1000.0);
}

TEST(MapJson, TellsSelfLocking) {
  const json locks = json::parse(map_json(map_of(self_locking())).text());
  EXPECT_TRUE(locks.at("backdriving_margin").at("self_locking").get<bool>());
  EXPECT_LT(locks.at("backdriving_margin").at("least").get<double>(), 0.0);
  EXPECT_EQ(locks.at("running").at(0).at("output").at("status"), "locks");
  const json drives = json::parse(map_json(map_of(usual())).text());
  EXPECT_FALSE(drives.at("backdriving_margin").at("self_locking").get<bool>());
}

TEST(MapTable, ShowsEveryPartAndTheReasonOfWhatIsMissing) {
  const std::string text = map_table(map_of(self_locking()));
  for (const char* part :
       {"Efficiency forward (sun drives) in percent", "Efficiency backward (R2 drives)", "helped",
        "Torques without load", "locks", "at R2, sun free:     none: the train locks",
        "self-locking", "mesh P1-R1", "all losses", "states no load-independent losses"}) {
    EXPECT_TRUE(contains(text, part)) << part << '\n' << text;
  }
}

TEST(MapTable, ThinsOutAGreatGridButKeepsItsEnds) {
  Design design = usual();
  design.map.sun_speed_rad_s.points = 41;
  design.map.output_torque_Nm.points = 2;
  const std::string text = map_table(map_of(design));
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line) && !contains(line, "torque at R2 (N m)")) continue;
  EXPECT_TRUE(contains(line, "  200 ")) << line;
  EXPECT_TRUE(line.ends_with(" 1000")) << line;
  EXPECT_LT(line.size(), 120U);
  EXPECT_TRUE(contains(text, "every point: --format csv"));
}

// --- figures

/// Every text of an SVG; throws when it is no well-formed XML.
void collect_texts(const boost::property_tree::ptree& tree, std::vector<std::string>& texts) {
  for (const auto& [name, child] : tree) {
    if (name == "text" || name == "tspan") texts.push_back(child.data());
    collect_texts(child, texts);
  }
}
std::vector<std::string> texts_of(const std::string& svg) {
  std::istringstream stream(svg);
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(stream, tree);
  std::vector<std::string> texts;
  collect_texts(tree, texts);
  return texts;
}
long count(const std::vector<std::string>& texts, const std::string& text) {
  return std::count(texts.begin(), texts.end(), text);
}

std::string script_of(const OperatingMap& map, const std::string& name) {
  for (const Plot& plot : map_plots(map)) {
    if (plot.name == name) return plot.script;
  }
  throw std::logic_error("no plot " + name);
}
std::vector<std::string> drawn_texts(const OperatingMap& map, const std::string& name) {
  return texts_of(io::run_gnuplot(script_of(map, name)));
}

TEST(MapPlot, EveryPointOfConstantFrictionShowsTheSameEfficiency) {
  const OperatingMap map = map_of(usual());
  const double forward = 100.0 * *map.points[0].forward.operation->efficiency;
  const double backward = 100.0 * *map.points[0].backward.operation->efficiency;
  EXPECT_EQ(count(drawn_texts(map, "efficiency_forward"), fmt::format("{:.2f}", forward)), 90);
  EXPECT_EQ(count(drawn_texts(map, "efficiency_backward"), fmt::format("{:.2f}", backward)), 90);
}

TEST(MapPlot, AxesNameQuantityAndUnit) {
  const OperatingMap map = map_of(dragged());
  const auto texts = drawn_texts(map, "efficiency_forward");
  for (const char* text :
       {"coaxial: efficiency forward (sun drives)", "sun speed (rpm)", "torque at R2 (N m)",
        "R2 speed (rpm)", "efficiency (%)", "200", "1000", "5", "50"}) {
    EXPECT_GE(count(texts, text), 1) << text;
  }
  const auto torques = drawn_texts(map, "torques");
  EXPECT_EQ(count(torques, "torque at the sun (N m)"), 1);
  EXPECT_EQ(count(torques, "torque at R2 (N m)"), 1);
  EXPECT_EQ(count(torques, "breakaway"), 2);
}

TEST(MapPlot, PointsWithoutEfficiencySayWhy) {
  const OperatingMap map = map_of(dragged());
  long helped = 0;
  for (const auto& pair : map.points) helped += pair.backward.status == design::MapStatus::kHelped;
  ASSERT_GT(helped, 0);
  ASSERT_LT(helped, 90);
  EXPECT_EQ(count(drawn_texts(map, "efficiency_backward"), "helped"), helped);
  EXPECT_EQ(count(drawn_texts(map_of(without_rest()), "efficiency_forward"), "no value"), 9);
}

TEST(MapPlot, AMapWithoutAnyPointIsStillDrawn) {
  const OperatingMap map = map_of(self_locking());
  EXPECT_EQ(count(drawn_texts(map, "efficiency_backward"), "helped"), 90);
  EXPECT_EQ(count(drawn_texts(map, "torques"),
                  "no running torque: the train locks: R2 cannot drive the sun"),
            1);
}

TEST(MapPlot, AFineGridHasContourLinesInsteadOfText) {
  Design design = dragged();
  design.map.sun_speed_rad_s.points = 30;
  design.map.output_torque_Nm.points = 20;
  const OperatingMap map = map_of(design);
  EXPECT_TRUE(contains(script_of(map, "efficiency_backward"), "set contour"));
  const auto texts = drawn_texts(map, "efficiency_backward");
  EXPECT_EQ(count(texts, "helped"), 0);
  EXPECT_GE(count(texts, "efficiency (%), lines at the ticks"), 1);
  // One value throughout has no contour.
  design.shafts = {};
  EXPECT_FALSE(drawn_texts(map_of(design), "efficiency_forward").empty());
}

TEST(MapPlot, OnePointOnAnAxisIsEnough) {
  Design design = dragged();
  design.map.sun_speed_rad_s = {.from = 0.0, .to = 0.0, .points = 1};
  design.map.output_torque_Nm = {.from = 10.0, .to = 10.0, .points = 1};
  const OperatingMap map = map_of(design);
  for (const Plot& plot : map_plots(map)) {
    EXPECT_FALSE(texts_of(io::run_gnuplot(plot.script)).empty()) << plot.name;
  }
}

TEST(MapPlot, TheNameOfADesignIsTextAndNothingElse) {
  Design design = usual();
  design.name = "a'b`touch x`$(y)@z_{w}<&>\"%d\nquit \xC3\xA4";
  const auto texts = drawn_texts(map_of(design), "efficiency_forward");
  EXPECT_EQ(
      count(texts, "a'b`touch x`$(y)@z_{w}<&>\"%d quit \xC3\xA4: efficiency forward (sun drives)"),
      1);
}

TEST(MapPlot, SameMapSameBytes) {
  const OperatingMap map = map_of(dragged());
  for (const Plot& plot : map_plots(map)) {
    EXPECT_EQ(io::run_gnuplot(plot.script), io::run_gnuplot(plot.script)) << plot.name;
  }
}

}  // namespace
}  // namespace gear3k::report::map_report_test
