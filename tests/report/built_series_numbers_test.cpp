#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "io/text/csv_table.hpp"
#include "report/built_series_report.hpp"
#include "tests/report/all_numbers.hpp"

namespace gear3k::report::built_series_numbers_test {
namespace {

using nlohmann::json;

constexpr double kArcmins = 10800.0 / std::numbers::pi;

void fill(backlash::Proportion& p, EachAnother& value) {
  p.count = 1;
  p.value = value();
  p.lower = value();
  p.upper = value();
}
Numbers numbers_of_proportion(const backlash::Proportion& p) {
  return {{"/value", p.value}, {"/ci95/0", p.lower}, {"/ci95/1", p.upper}};
}

void fill(backlash::LostMotionDistribution& d, EachAnother& value) {
  for (double* member : {&d.mean_rad, &d.deviation_rad, &d.least_rad, &d.greatest_rad}) {
    *member = value();
  }
  d.quantiles.resize(2);
  for (auto& q : d.quantiles) {
    q.probability = value();
    q.value = value();
  }
}
Numbers numbers_of_distribution(const backlash::LostMotionDistribution& d) {
  return {{"/mean", d.mean_rad * kArcmins},
          {"/standard_deviation", d.deviation_rad * kArcmins},
          {"/least", d.least_rad * kArcmins},
          {"/greatest", d.greatest_rad * kArcmins},
          {"/quantiles/0/probability", d.quantiles[0].probability},
          {"/quantiles/0/lost_motion_arcmin", d.quantiles[0].value * kArcmins},
          {"/quantiles/1/probability", d.quantiles[1].probability},
          {"/quantiles/1/lost_motion_arcmin", d.quantiles[1].value * kArcmins}};
}

void fill(backlash::WorstCase& w, EachAnother& value) {
  for (double* member :
       {&w.middle_rad, &w.greatest_rad, &w.least_rad, &w.least_margin_m, &w.root_sum_square_rad}) {
    *member = value();
  }
}
Numbers numbers_of_worst_case(const backlash::WorstCase& w) {
  return {{"/planets_alike_arcmin", w.middle_rad * kArcmins},
          {"/root_sum_square_arcmin", w.root_sum_square_rad * kArcmins},
          {"/greatest_arcmin", w.greatest_rad * kArcmins},
          {"/least_arcmin", w.least_rad * kArcmins},
          {"/least_margin_um", w.least_margin_m * 1e6}};
}

void fill(backlash::ToleranceShare& share, EachAnother& value) {
  for (backlash::Estimate* e :
       {&share.first_order, &share.total, &share.halved.yield_gain, &share.halved.jam_change}) {
    e->value = value();
    e->standard_error = value();
  }
  for (double* member :
       {&share.halved.yield, &share.halved.jam_probability, &share.halved.quantile_99_rad}) {
    *member = value();
  }
}
Numbers numbers_of_share(const backlash::ToleranceSource& source,
                         const backlash::ToleranceShare& share, double planets_alike_rad) {
  return {{"/half_width_um", source.half_width_m * 1e6},
          {"/variance_first_order/value", share.first_order.value},
          {"/variance_first_order/standard_error", share.first_order.standard_error},
          {"/variance_total/value", share.total.value},
          {"/variance_total/standard_error", share.total.standard_error},
          {"/planets_alike_arcmin", planets_alike_rad * kArcmins},
          {"/halved/yield", share.halved.yield},
          {"/halved/yield_gain/value", share.halved.yield_gain.value},
          {"/halved/yield_gain/standard_error", share.halved.yield_gain.standard_error},
          {"/halved/jam_probability", share.halved.jam_probability},
          {"/halved/jam_change/value", share.halved.jam_change.value},
          {"/halved/jam_change/standard_error", share.halved.jam_change.standard_error},
          {"/halved/quantile_99_arcmin", share.halved.quantile_99_rad * kArcmins}};
}

void fill(backlash::MonteCarloResult& r, EachAnother& value) {
  for (backlash::Proportion* p : {&r.assembled, &r.jammed, &r.beyond_limit, &r.yield}) {
    fill(*p, value);
  }
  fill(r.lost_motion, value);
  fill(r.worst, value);
  r.limit_of_99_percent_rad = value();
  r.margin.resize(1);
  r.margin[0].probability = value();
  r.margin[0].value = value();
}

/// Two tolerances, the second of which gains more by being halved.
design::BuiltSeries any_series(EachAnother& value) {
  design::BuiltSeries series;
  series.seed = 4321;
  series.scatter.sigma_level = value();
  series.limit_rad = value();
  fill(series.result, value);
  series.result.samples = 5003;
  series.rooms.greatest_share = value();
  series.rooms.samples = 2003;
  series.rooms.median_m = {value(), value()};
  series.rooms.percent95_m = {value(), value()};
  series.turn.emplace();
  series.turn->gearboxes = 1009;
  fill(series.turn->assembled, value);
  fill(series.turn->yield, value);
  series.shares.samples = 3001;
  series.shares.yield = value();
  series.shares.jam_probability = value();
  series.shares.quantile_99_rad = value();
  series.model.sources.resize(2);
  series.shares.sources.resize(2);
  for (std::size_t k = 0; k < 2; ++k) {
    series.model.sources[k].half_width_m = value();
    series.model.sources[k].gear = static_cast<int>(k);
    fill(series.shares.sources[k], value);
    series.result.worst.share_rad.push_back(value());
  }
  return series;
}

json json_of(const design::BuiltSeries& series) {
  return json::parse(built_series_fields(series).json().text());
}

TEST(BuiltSeriesNumbers, SeriesHasEveryNumberByItsName) {
  EachAnother value;
  const design::BuiltSeries s = any_series(value);
  const backlash::MonteCarloResult& r = s.result;
  Numbers stated{{"/samples", 5003.0},
                 {"/seed", 4321.0},
                 {"/sigma_level", s.scatter.sigma_level},
                 {"/limit_arcmin", *s.limit_rad * kArcmins},
                 {"/limit_of_99_percent_arcmin", *r.limit_of_99_percent_rad * kArcmins},
                 {"/margin_um/0/probability", r.margin[0].probability},
                 {"/margin_um/0/margin_um", r.margin[0].value * 1e6},
                 {"/turn/gearboxes", 1009.0},
                 {"/first_contact/samples", 2003.0},
                 {"/first_contact/greatest_share", s.rooms.greatest_share},
                 {"/first_contact/rooms/0/median_um", s.rooms.median_m[0] * 1e6},
                 {"/first_contact/rooms/0/percent95_um", s.rooms.percent95_m[0] * 1e6},
                 {"/first_contact/rooms/1/median_um", s.rooms.median_m[1] * 1e6},
                 {"/first_contact/rooms/1/percent95_um", s.rooms.percent95_m[1] * 1e6},
                 {"/shares/samples", 3001.0},
                 {"/shares/yield", s.shares.yield},
                 {"/shares/jam_probability", s.shares.jam_probability},
                 {"/shares/quantile_99_arcmin", s.shares.quantile_99_rad * kArcmins}};
  stated.merge(at_path("/assembled", numbers_of_proportion(r.assembled)));
  stated.merge(at_path("/jammed", numbers_of_proportion(r.jammed)));
  stated.merge(at_path("/beyond_limit", numbers_of_proportion(r.beyond_limit)));
  stated.merge(at_path("/yield", numbers_of_proportion(r.yield)));
  stated.merge(at_path("/lost_motion_arcmin", numbers_of_distribution(r.lost_motion)));
  stated.merge(at_path("/worst_case", numbers_of_worst_case(r.worst)));
  stated.merge(at_path("/turn/assembled", numbers_of_proportion(s.turn->assembled)));
  stated.merge(at_path("/turn/yield", numbers_of_proportion(s.turn->yield)));
  for (const std::size_t k : {0U, 1U}) {
    stated.merge(
        at_path("/shares/tolerances/" + std::to_string(1 - k),
                numbers_of_share(s.model.sources[k], s.shares.sources[k], r.worst.share_rad[k])));
  }
  expect_all_numbers(numbers_of(json_of(s)), stated);
}

TEST(BuiltSeriesNumbers, EndsOfTheRangeHaveEveryNumberByItsName) {
  EachAnother value;
  design::BuiltSeries series;
  series.thermal.resize(2);
  for (design::ThermalSeries& end : series.thermal) {
    end.state.temperature_K = value();
    fill(end.jammed, value);
    fill(end.result, value);
  }
  const json ends = json_of(series).at("thermal");
  ASSERT_EQ(ends.size(), 2U);
  for (const std::size_t k : {0U, 1U}) {
    const design::ThermalSeries& end = series.thermal[k];
    const backlash::MonteCarloResult& r = end.result;
    // Jammed are those of the end, by the least play.
    Numbers stated{{"/temperature_c", end.state.temperature_K - 273.15},
                   {"/limit_of_99_percent_arcmin", *r.limit_of_99_percent_rad * kArcmins}};
    stated.merge(at_path("/jammed", numbers_of_proportion(end.jammed)));
    stated.merge(at_path("/assembled", numbers_of_proportion(r.assembled)));
    stated.merge(at_path("/yield", numbers_of_proportion(r.yield)));
    stated.merge(at_path("/lost_motion_arcmin", numbers_of_distribution(r.lost_motion)));
    expect_all_numbers(numbers_of(ends.at(k)), stated);
  }
}

TEST(BuiltSeriesNumbers, CsvOfTolerancesHasEveryNumberByItsColumn) {
  EachAnother value;
  const design::BuiltSeries s = any_series(value);
  const io::CsvTable table = io::parse_csv(tolerance_shares_csv(s), "tolerances.csv");
  ASSERT_EQ(table.rows.size(), 2U);
  for (const std::size_t k : {0U, 1U}) {
    const backlash::ToleranceShare& share = s.shares.sources[k];
    expect_all_numbers(numbers_of(table, 1 - k),
                       {{"half_width_um", s.model.sources[k].half_width_m * 1e6},
                        {"variance_first_order", share.first_order.value},
                        {"variance_first_order_error", share.first_order.standard_error},
                        {"variance_total", share.total.value},
                        {"variance_total_error", share.total.standard_error},
                        {"planets_alike_arcmin", s.result.worst.share_rad[k] * kArcmins},
                        {"halved_yield", share.halved.yield},
                        {"halved_yield_gain", share.halved.yield_gain.value},
                        {"halved_yield_gain_error", share.halved.yield_gain.standard_error},
                        {"halved_jam_probability", share.halved.jam_probability},
                        {"halved_quantile_99_arcmin", share.halved.quantile_99_rad * kArcmins}});
  }
}

TEST(BuiltSeriesNumbers, CsvOfTheSeriesHasItsNumbersByTheirQuantities) {
  EachAnother value;
  design::BuiltSeries s = any_series(value);
  s.shares = {};
  const io::CsvTable table =
      io::parse_csv(kRowsHeader + built_series_fields(s).csv_rows(), "analysis.csv");
  Numbers rows;
  for (const auto& row : table.rows) {
    EXPECT_EQ(table.text(row, "item"), "built");
    rows[*table.text(row, "quantity")] = *table.number(row, "value");
  }
  const backlash::MonteCarloResult& r = s.result;
  expect_all_numbers(rows,
                     {{"assembled", r.assembled.value},
                      {"yield", r.yield.value},
                      {"limit_of_99_percent", *r.limit_of_99_percent_rad * kArcmins},
                      {"lost_motion_mean", r.lost_motion.mean_rad * kArcmins},
                      {"lost_motion_standard_deviation", r.lost_motion.deviation_rad * kArcmins},
                      {"lost_motion_worst_case", r.worst.greatest_rad * kArcmins},
                      {"margin_worst_case", r.worst.least_margin_m * 1e6}});
}

}  // namespace
}  // namespace gear3k::report::built_series_numbers_test
