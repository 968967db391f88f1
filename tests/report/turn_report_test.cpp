#include "report/turn_report.hpp"

#include <gtest/gtest.h>

#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "io/text/gnuplot.hpp"
#include "report/turn_plot.hpp"

namespace gear3k::report::turn_report_test {
namespace {

using backlash::DeviationValue;

constexpr train::ToothSet kTeeth{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};

/// A gearbox whose sun runs out.
/// @param runout_m  of the sun
TurnResult result_of(double runout_m) {
  train::TrainParameters<double> p{};
  p.teeth = kTeeth;
  p.pressure_angle_rad = std::numbers::pi / 9.0;
  p.module_m = {0.8e-3, 0.8e-3 * 51.0 / 49.0};
  p.center_distance_m = 20.5e-3;
  for (double& q : p.machining_allowance) q = 0.1;
  backlash::Tolerances tolerances;
  tolerances.gears[train::kS].runout_m = runout_m;
  const auto model = backlash::clearance_model(p, tolerances);
  const std::vector<DeviationValue> values(model->deviations.size(), {.x_m = 0.5 * runout_m});
  const auto window = backlash::turn_window(kTeeth);
  TurnResult result{
      .name = "it's one",
      .turn = backlash::turn(model->levers, backlash::TurningPlays(*model, kTeeth, values), window),
      .fits = {}};
  result.fits = backlash::turn_orders(
      result.turn, backlash::turn_order_list(kTeeth, p.planets, window.revolutions));
  return result;
}
TurnResult usual() { return result_of(20e-6); }
/// Jams where the sun stands closest to a planet.
TurnResult jamming() {
  TurnResult result = usual();
  result.turn.jammed = 0;
  for (std::size_t i = 0; i < result.turn.points.size(); ++i) {
    if (i % 1000 > 300) continue;
    result.turn.points[i].range.margin_m = -1e-6;
    ++result.turn.jammed;
  }
  return result;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(TurnCsv, HasARowForEveryAngleInReportUnits) {
  const TurnResult result = usual();
  const io::CsvTable table = io::parse_csv(turn_csv(result), "turn.csv");
  EXPECT_EQ(table.header,
            (std::vector<std::string>{"output_angle_deg", "lost_motion_arcmin",
                                      "transmission_error_forward_arcmin",
                                      "transmission_error_backward_arcmin", "margin_um"}));
  ASSERT_EQ(table.rows.size(), result.turn.points.size());
  double forward = 0.0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& point = result.turn.points[i];
    const auto field = [&](std::size_t k) {
      return std::strtod(table.rows[i].fields[k].c_str(), nullptr);
    };
    const double to_arcmin = 180.0 * 60.0 / std::numbers::pi;
    EXPECT_NEAR(field(0), point.angle_rad * 180.0 / std::numbers::pi, 1e-9);
    EXPECT_NEAR(field(1), point.range.width_rad() * to_arcmin, 1e-9);
    // Backward less forward is the lost motion but for what is constant.
    EXPECT_NEAR(
        field(3) - field(2) -
            (field(1) - (result.turn.mean_upper_rad - result.turn.mean_lower_rad) * to_arcmin),
        0.0, 1e-9);
    EXPECT_NEAR(field(4), point.range.margin_m * 1e6, 1e-9);
    forward += field(2);
  }
  EXPECT_NEAR(forward / static_cast<double>(table.rows.size()), 0.0, 1e-9);
}

TEST(TurnCsv, LeavesFieldsEmptyWhereItJams) {
  const TurnResult result = jamming();
  const io::CsvTable table = io::parse_csv(turn_csv(result), "turn.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const bool jams = i % 1000 <= 300;
    for (const std::size_t k : {1U, 2U, 3U}) {
      EXPECT_EQ(table.rows[i].fields[k].empty(), jams) << i;
    }
    EXPECT_FALSE(table.rows[i].fields[0].empty());
    EXPECT_FALSE(table.rows[i].fields[4].empty());
  }
}

TEST(TurnOrdersCsv, SharesAndRestOfEachQuantityAddToOne) {
  const io::CsvTable table = io::parse_csv(turn_orders_csv(usual()), "turn_orders.csv");
  for (const auto quantity : backlash::kTurnQuantityNames) {
    double sum = 0.0;
    for (const auto& row : table.rows) {
      if (row.fields[0] == quantity) sum += std::strtod(row.fields[5].c_str(), nullptr);
    }
    EXPECT_NEAR(sum, 1.0, 1e-9) << quantity;
  }
}

TEST(TurnTable, NamesTheOrderOfTheBodyThatRunsOut) {
  const std::string text = turn_table(usual());
  EXPECT_TRUE(contains(text, "3 x sun against the carrier")) << text;
  EXPECT_TRUE(contains(text, "Assembles at every angle")) << text;
  EXPECT_FALSE(contains(text, "Jams")) << text;
}

TEST(TurnTable, SaysWhereItJamsAndThatOrdersAreMissing) {
  TurnResult result = jamming();
  EXPECT_TRUE(contains(turn_table(result), "Jams at ")) << turn_table(result);
  result.fits.clear();
  EXPECT_TRUE(contains(turn_table(result), "No orders"));
}

TEST(OrderName, TellsAbsoluteFromRollingAndMultiplesFromOrders) {
  EXPECT_EQ(order_name({.of = {.body = "sun", .order = 2.0}}), "sun");
  EXPECT_EQ(order_name({.of = {.body = "sun", .order = 2.0, .rolling = true}, .multiple = 3}),
            "3 x sun against the carrier");
  EXPECT_EQ(order_name({.of = {.body = "stage 1", .order = 2.0}}), "teeth of stage 1");
}

TEST(TurnPlot, IsAnSvgAlsoWhereItJams) {
  for (const TurnResult& result : {usual(), jamming()}) {
    const Plot plot = turn_plot(result, train::speed_ratios(kTeeth).carrier);
    EXPECT_EQ(plot.name, "turn");
    const std::string svg = io::run_gnuplot(plot.script);
    std::istringstream in(svg);
    boost::property_tree::ptree tree;
    EXPECT_NO_THROW(boost::property_tree::read_xml(in, tree));
    EXPECT_TRUE(contains(svg, "transmission error forward"));
    EXPECT_LT(svg.size(), 1'000'000U);
  }
}

TEST(TurnPlot, OfAGearboxThatJamsEverywhereHasNoData) {
  TurnResult result = usual();
  for (auto& point : result.turn.points) point.range.margin_m = -1e-6;
  result.turn.jammed = result.turn.points.size();
  EXPECT_NO_THROW(io::run_gnuplot(turn_plot(result, 7.0).script));
}

}  // namespace
}  // namespace gear3k::report::turn_report_test
