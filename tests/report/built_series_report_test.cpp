#include "report/built_series_report.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "io/text/gnuplot.hpp"
#include "report/robust_report.hpp"
#include "tests/backlash/toleranced_train.hpp"

namespace gear3k::report::built_series_report_test {
namespace {

using design::BuiltSeries;
using nlohmann::json;

constexpr double kArcmin = std::numbers::pi / 10800.0;

design::Design usual_design() {
  design::Design design;
  design.name = "it's one";
  design.train = backlash::thinned_bilateral_drive_gear();
  design.center_distance_given = true;
  design.tolerances = backlash::all_tolerances();
  design.sampling = {.samples = 5000, .seed = 8};
  return design;
}

BuiltSeries series_of(const design::Design& design) {
  return design::build_series(design, design::clearance_model_of(design).value(), 3000, {});
}

/// Some jam, some exceed the limit, some are as they should be.
const BuiltSeries& usual() {
  static const BuiltSeries series = [] {
    design::Design design = usual_design();
    // Phases of the planets decide; the middle of what assembles is the limit.
    design.tolerances->planet_phase_rad = {.lower = -15e-3, .upper = 15e-3};
    const BuiltSeries free = series_of(design);
    design.limits[design::CheckId::kOutputBacklashMax] = free.result.lost_motion.quantiles[4].value;
    return series_of(design);
  }();
  return series;
}

/// None assembles.
const BuiltSeries& jammed() {
  static const BuiltSeries series = [] {
    design::Design design = usual_design();
    design.tolerances->gears[train::kR2].tooth_thickness_m = {.lower = 400e-6, .upper = 410e-6};
    return series_of(design);
  }();
  return series;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(YieldJson, SharesOfAllGearboxesAddUpAndLieInTheirIntervals) {
  for (const BuiltSeries* series : {&usual(), &jammed()}) {
    const json built = json::parse(built_series_fields(*series).json().text());
    EXPECT_EQ(built.at("samples"), 5000);
    EXPECT_EQ(built.at("seed"), 8);
    double sum = 0.0;
    for (const char* part : {"yield", "jammed", "beyond_limit"}) {
      sum += built.at(part).at("value").get<double>();
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_NEAR(built.at("assembled").at("value").get<double>() +
                    built.at("jammed").at("value").get<double>(),
                1.0, 1e-12);
    for (const char* part : {"assembled", "yield", "jammed", "beyond_limit"}) {
      const json& share = built.at(part);
      ASSERT_EQ(share.at("ci95").size(), 2U) << part;
      EXPECT_GE(share.at("ci95").at(0), 0.0) << part;
      EXPECT_LE(share.at("ci95").at(0), share.at("value")) << part;
      EXPECT_LE(share.at("value"), share.at("ci95").at(1)) << part;
      EXPECT_LE(share.at("ci95").at(1), 1.0) << part;
      EXPECT_LT(share.at("ci95").at(0), share.at("ci95").at(1)) << part;
    }
  }
  const json built = json::parse(built_series_fields(usual()).json().text());
  for (const char* part : {"yield", "jammed", "beyond_limit"}) {
    EXPECT_GT(built.at(part).at("value"), 0.01) << part << ": the series is to show all of them";
  }
}

TEST(YieldJson, LostMotionLiesBetweenTheWorstCases) {
  const json built = json::parse(built_series_fields(usual()).json().text());
  const json& motion = built.at("lost_motion_arcmin");
  const json& worst = built.at("worst_case");
  EXPECT_LE(worst.at("least_arcmin"), motion.at("least"));
  EXPECT_LE(motion.at("least"), motion.at("mean"));
  EXPECT_LE(motion.at("mean"), motion.at("greatest"));
  EXPECT_LE(motion.at("greatest"), worst.at("greatest_arcmin"));
  EXPECT_GT(motion.at("standard_deviation"), 0.0);
  double before = 0.0;
  double probability = 0.0;
  for (const json& q : motion.at("quantiles")) {
    EXPECT_GT(q.at("probability").get<double>(), probability);
    EXPECT_GE(q.at("lost_motion_arcmin").get<double>(), before);
    probability = q.at("probability").get<double>();
    before = q.at("lost_motion_arcmin").get<double>();
  }
  EXPECT_EQ(motion.at("quantiles").size(), backlash::kLostMotionProbabilities.size());
  EXPECT_EQ(built.at("margin_um").size(), backlash::kMarginProbabilities.size());
  EXPECT_LE(worst.at("least_margin_um"), built.at("margin_um").at(0).at("margin_um"));
  EXPECT_LT(worst.at("least_margin_um"), 0.0) << "some of them jam";
  EXPECT_GT(worst.at("root_sum_square_arcmin"), 0.0);
  EXPECT_NEAR(built.at("limit_arcmin").get<double>(), *usual().limit_rad / kArcmin, 1e-9);
  EXPECT_TRUE(built.at("limit_of_99_percent_arcmin").is_null()) << "more than 1 % jam";
  EXPECT_EQ(built.at("scatter"), "normal");
}

TEST(YieldJson, TolerancesComeByWhatHalvingThemGainsOrElseByTheirShare) {
  const json built = json::parse(built_series_fields(usual()).json().text());
  const json& shares = built.at("shares");
  EXPECT_EQ(shares.at("samples"), 3000);
  const json& sources = shares.at("tolerances");
  ASSERT_EQ(sources.size(), usual().model.sources.size());
  const bool any_gain = std::ranges::any_of(sources, [](const json& s) {
    const json& gain = s.at("halved").at("yield_gain");
    return gain.at("value").get<double>() > 3.0 * gain.at("standard_error").get<double>();
  });
  double before = 1e9;
  std::vector<std::string> names;
  for (const json& s : sources) {
    const json& halved = s.at("halved");
    const auto gain = halved.at("yield_gain").at("value").get<double>();
    const double order = any_gain ? gain : s.at("variance_total").at("value").get<double>();
    EXPECT_LE(order, before);
    before = order;
    EXPECT_NEAR(halved.at("yield").get<double>() - shares.at("yield").get<double>(), gain, 1e-12);
    EXPECT_NEAR(
        halved.at("jam_probability").get<double>() - shares.at("jam_probability").get<double>(),
        halved.at("jam_change").at("value").get<double>(), 1e-12);
    EXPECT_GE(halved.at("yield_gain").at("standard_error"), 0.0);
    EXPECT_GT(s.at("half_width_um"), 0.0);
    EXPECT_GE(s.at("variance_total").at("value"), 0.0);
    EXPECT_GE(s.at("planets_alike_arcmin"), 0.0);
    const json& gear = s.at("gear");
    names.push_back((gear.is_null() ? "" : gear.get<std::string>() + " ") +
                    s.at("tolerance").get<std::string>());
  }
  const json& most = *std::ranges::max_element(
      sources, {}, [](const json& s) { return s.at("variance_total").at("value").get<double>(); });
  EXPECT_EQ(most.at("tolerance"), "planet_phase") << "the widest by far";
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end()) << "each source once";
  for (const auto& source : usual().model.sources) {
    EXPECT_TRUE(std::ranges::binary_search(names, source.name())) << source.name();
  }
}

TEST(YieldJson, RoomsAreByRank) {
  const json first = json::parse(built_series_fields(usual()).json().text()).at("first_contact");
  EXPECT_GT(first.at("greatest_share"), 1.0 / 3.0);
  EXPECT_EQ(first.at("samples"), usual().result.assembled.count);
  ASSERT_EQ(first.at("rooms").size(), 3U);
  for (std::size_t k = 0; k + 1 < 3; ++k) {
    EXPECT_LE(first["rooms"][k]["median_um"], first["rooms"][k + 1]["median_um"]);
  }
}

TEST(YieldJson, WithoutAnAssembledGearboxThereIsNoLostMotion) {
  const json built = json::parse(built_series_fields(jammed()).json().text());
  EXPECT_EQ(built.at("jammed").at("value"), 1.0);
  EXPECT_TRUE(built.at("lost_motion_arcmin").is_null());
  EXPECT_TRUE(built.at("limit_of_99_percent_arcmin").is_null());
  EXPECT_TRUE(contains(built_series_table(jammed()), "more than 1 % do not assemble"));
}

TEST(YieldTable, NamesEveryTolerance) {
  const std::string text = built_series_table(usual());
  for (const auto& source : usual().model.sources) {
    EXPECT_TRUE(contains(text, source.name())) << source.name();
  }
  for (const char* part : {"5000 drawn at random, seed 8", "Which tolerance to tighten first",
                           "in the worst case it does not assemble", "at first contact",
                           "room left at the planets that follow"}) {
    EXPECT_TRUE(contains(text, part)) << part << '\n' << text;
  }
}

TEST(YieldTable, WhereEveryToleranceCostsYieldTheMeanHasToBeMoved) {
  BuiltSeries series = usual();
  const auto told = [&] {
    return built_series_table(series) + tolerance_shares_plot("gear", series).script;
  };
  const auto all_gain = [&](double gain) {
    for (auto& source : series.shares.sources) source.halved.yield_gain.value = gain;
  };
  constexpr const char* kTable = "tighten first: none helps, the mean has to be moved (";
  constexpr const char* kFigure = "gear: to tighten a tolerance does not help, the mean has to be";
  all_gain(-0.02);
  EXPECT_TRUE(contains(told(), kTable)) << told();
  EXPECT_TRUE(contains(told(), kFigure)) << told();
  // Nor does one that changes nothing help.
  series.shares.sources[1].halved.yield_gain.value = 0.0;
  EXPECT_TRUE(contains(told(), kTable));
  // One that helps is the one to begin with; where nothing changes nothing has to be moved.
  series.shares.sources[1].halved.yield_gain.value = 0.001;
  EXPECT_FALSE(contains(told(), "has to be moved")) << told();
  all_gain(0.0);
  EXPECT_FALSE(contains(told(), "has to be moved")) << told();
  EXPECT_TRUE(contains(told(), "which tolerance to tighten first"));
}

TEST(HistogramCsv, CountsEveryGearboxThatAssemblesOnce) {
  const io::CsvTable table = io::parse_csv(lost_motion_histogram_csv(usual()), "lost_motion.csv");
  EXPECT_EQ(table.header, (std::vector<std::string>{"from_arcmin", "to_arcmin", "gearboxes"}));
  ASSERT_GT(table.rows.size(), 10U);
  double count = 0.0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    const double to = table.number(row, "to_arcmin").value();
    EXPECT_LT(table.number(row, "from_arcmin").value(), to);
    if (i + 1 < table.rows.size()) {
      EXPECT_NEAR(table.number(table.rows[i + 1], "from_arcmin").value(), to, 1e-9);
    }
    count += table.number(row, "gearboxes").value();
  }
  EXPECT_EQ(count, static_cast<double>(usual().result.assembled.count));
  // No bin outside what was found but for the width of one.
  const auto& motion = usual().result.lost_motion;
  const double width = table.number(table.rows[0], "to_arcmin").value() -
                       table.number(table.rows[0], "from_arcmin").value();
  EXPECT_NEAR(table.number(table.rows.front(), "from_arcmin").value(), motion.least_rad / kArcmin,
              width);
  EXPECT_NEAR(table.number(table.rows.back(), "to_arcmin").value(), motion.greatest_rad / kArcmin,
              width);
  EXPECT_EQ(lost_motion_histogram_csv(jammed()), "from_arcmin,to_arcmin,gearboxes\n");
}

TEST(ToleranceSharesCsv, TellsWhatTheJsonTells) {
  const io::CsvTable table = io::parse_csv(tolerance_shares_csv(usual()), "tolerances.csv");
  EXPECT_EQ(table.header,
            (std::vector<std::string>{
                "tolerance", "half_width_um", "variance_first_order", "variance_first_order_error",
                "variance_total", "variance_total_error", "planets_alike_arcmin", "halved_yield",
                "halved_yield_gain", "halved_yield_gain_error", "halved_jam_probability",
                "halved_quantile_99_arcmin"}));
  const json built = json::parse(built_series_fields(usual()).json().text());
  const json& sources = built.at("shares").at("tolerances");
  ASSERT_EQ(table.rows.size(), sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto& row = table.rows[i];
    const json& s = sources[i];
    EXPECT_TRUE(
        table.text(row, "tolerance").value().ends_with(s.at("tolerance").get<std::string>()));
    EXPECT_EQ(table.number(row, "half_width_um"), s.at("half_width_um").get<double>());
    EXPECT_EQ(table.number(row, "variance_total"),
              s.at("variance_total").at("value").get<double>());
    EXPECT_EQ(table.number(row, "variance_first_order_error"),
              s.at("variance_first_order").at("standard_error").get<double>());
    EXPECT_EQ(table.number(row, "halved_yield_gain"),
              s.at("halved").at("yield_gain").at("value").get<double>());
    EXPECT_EQ(table.number(row, "halved_quantile_99_arcmin"),
              s.at("halved").at("quantile_99_arcmin").get<double>());
  }
}

TEST(YieldCsv, EveryRowHasTheColumnsOfTheAnalysis) {
  const std::string text = built_series_fields(usual()).csv_rows();
  std::istringstream lines(text);
  int rows = 0;
  for (std::string line; std::getline(lines, line); ++rows) {
    EXPECT_EQ(std::ranges::count(line, ','), 5) << line;
    EXPECT_TRUE(line.starts_with("built,")) << line;
  }
  EXPECT_EQ(rows, 6);
  EXPECT_TRUE(contains(text, "built,yield,"));
  EXPECT_FALSE(contains(text, "limit_of_99_percent")) << "more than 1 % jam";
}

TEST(YieldPlots, AreSvgsAlsoWhereNothingAssembles) {
  for (const BuiltSeries* series : {&usual(), &jammed()}) {
    for (const Plot& plot :
         {lost_motion_plot("it's one", *series), tolerance_shares_plot("it's one", *series)}) {
      std::string svg;
      ASSERT_NO_THROW(svg = io::run_gnuplot(plot.script)) << plot.name;
      std::istringstream in(svg);
      boost::property_tree::ptree tree;
      EXPECT_NO_THROW(boost::property_tree::read_xml(in, tree)) << plot.name;
      EXPECT_EQ(tree.count("svg"), 1U) << plot.name;
      EXPECT_TRUE(contains(svg, "it&apos;s one") || contains(svg, "it's one")) << plot.name;
    }
  }
  const std::string motion = io::run_gnuplot(lost_motion_plot("one", usual()).script);
  EXPECT_TRUE(contains(motion, ">limit<"));
  const std::string shares = io::run_gnuplot(tolerance_shares_plot("one", usual()).script);
  for (const auto& source : usual().model.sources) {
    EXPECT_TRUE(contains(shares, fmt::format(">{}<", source.name()))) << source.name();
  }
}

TEST(YieldPlots, OfADesignWithoutDeviationsAreSvgs) {
  design::Design design = usual_design();
  design.tolerances.emplace();
  const BuiltSeries series = series_of(design);
  EXPECT_TRUE(series.shares.sources.empty());
  EXPECT_NO_THROW(io::run_gnuplot(lost_motion_plot("one", series).script));
  EXPECT_NO_THROW(io::run_gnuplot(tolerance_shares_plot("one", series).script));
  EXPECT_TRUE(contains(built_series_table(series), "Built gearboxes"));
}

// ---- robust -----------------------------------------------------------------------------------

optimize::RobustPass pass_of(double share, double yield) {
  optimize::RobustPass pass;
  pass.share = share;
  pass.limits[design::CheckId::kOutputBacklashMax] = (8.0 - share) * kArcmin;
  pass.best.emplace();
  pass.best->candidate.teeth = {.S = 12, .P1 = 64, .R1 = 141, .P2 = 52, .R2 = 132};
  pass.best->eta_b = 0.95 - 0.01 * share;
  pass.outcome = optimize::BuiltOutcome{.yield = yield,
                                        .jammed = 0.25 * (1.0 - yield),
                                        .beyond_limit = 0.75 * (1.0 - yield),
                                        .limit_of_99_percent_rad = {},
                                        .greatest_rad = 17.5 * kArcmin,
                                        .least_margin_m = -37.9e-6,
                                        .checks_hold = true};
  return pass;
}

RobustRun robust_run() {
  RobustRun run;
  run.search.passes = {pass_of(0.0, 0.1), pass_of(0.3, 0.995), {}};
  run.search.passes.back().share = 1.0;
  run.search.chosen = 1;
  run.samples = 1000;
  run.fresh_seed = 2;
  run.nominal = *run.search.passes[0].outcome;
  run.chosen = *run.search.passes[1].outcome;
  return run;
}

optimize::Specification robust_specification(optimize::Hold hold) {
  optimize::Specification spec;
  spec.robust.hold = hold;
  return spec;
}

TEST(RobustJson, HasEveryPassAndNullsWhereNothingIsFeasible) {
  const json robust =
      json::parse(robust_json(robust_specification(optimize::Hold::kYield), robust_run()).text());
  EXPECT_EQ(robust.at("hold"), "yield");
  EXPECT_EQ(robust.at("yield"), 0.99);
  EXPECT_EQ(robust.at("chosen"), 1);
  EXPECT_EQ(robust.at("fresh_seed"), 2);
  ASSERT_EQ(robust.at("passes").size(), 3U);
  const json& first = robust.at("passes").at(0);
  EXPECT_NEAR(first.at("max_output_arcmin").get<double>(), 8.0, 1e-12);
  EXPECT_TRUE(first.at("min_normal_um").is_null());
  EXPECT_EQ(first.at("teeth"), json({12, 64, 141, 52, 132}));
  EXPECT_NEAR(first.at("built").at("worst_case_arcmin").get<double>(), 17.5, 1e-12);
  EXPECT_NEAR(first.at("built").at("least_margin_um").get<double>(), -37.9, 1e-12);
  const json& last = robust.at("passes").at(2);
  for (const char* key : {"teeth", "eta_b", "built"}) EXPECT_TRUE(last.at(key).is_null()) << key;
  EXPECT_EQ(robust.at("robust").at("yield"), 0.995);
  EXPECT_TRUE(robust.at("cheapest").is_null());
}

TEST(RobustTable, ShowsBothDesignsAndTheCheapestTolerances) {
  RobustRun run = robust_run();
  const auto spec = robust_specification(optimize::Hold::kYield);
  const std::string text = robust_table(spec, run);
  for (const char* part : {"3 searches", "from seed 2", "as stated", "hold for the yield", "99.500",
                           "10.000", "12/64/141/52/132"}) {
    EXPECT_TRUE(contains(text, part)) << part << '\n' << text;
  }
  EXPECT_FALSE(contains(text, "Cheapest"));
  const std::size_t sources = usual().model.sources.size();
  run.cheapest = RobustRun::Cheapest{.model = usual().model, .tolerances = {}, .built = {}};
  run.cheapest->tolerances = {.factor = std::vector<double>(sources, 0.5),
                              .stated_cost = 23.0,
                              .cost = 46.0,
                              .stated_yield = 0.8,
                              .yield = 0.98,
                              .reached = false};
  const std::string cheap = robust_table(spec, run);
  EXPECT_TRUE(contains(cheap, "cost 46.00 instead of 23.00")) << cheap;
  EXPECT_TRUE(contains(cheap, "the yield is not reached")) << cheap;
  const json robust = json::parse(robust_json(spec, run).text());
  ASSERT_EQ(robust.at("cheapest").at("tolerances").size(), sources);
  EXPECT_EQ(robust.at("cheapest").at("tolerances").at(0).at("factor"), 0.5);
  EXPECT_EQ(robust.at("cheapest").at("reached"), false);
}

TEST(RobustBlocking, NamesWhatWasReached) {
  optimize::RobustResult search = robust_run().search;
  search.chosen.reset();
  const std::string yield =
      robust_blocking_text(robust_specification(optimize::Hold::kYield), search);
  for (const char* part : {"for a yield of 99 %", "yields 99.50 %", "worst case 17.50 arcmin",
                           "37.9 um short of assembling", "nothing is feasible"}) {
    EXPECT_TRUE(contains(yield, part)) << part << '\n' << yield;
  }
  EXPECT_TRUE(
      contains(robust_blocking_text(robust_specification(optimize::Hold::kWorstCase), search),
               "in the worst case of its tolerances"));
  search.passes = {pass_of(0.0, 0.1)};
  search.passes.front().outcome.reset();
  EXPECT_TRUE(contains(
      robust_blocking_text(robust_specification(optimize::Hold::kYield), search),
      "at an end of tolerances.center_distance_um a mesh of the best that was found has no working "
      "pressure angle; wider limits or tighter [tolerances] would help"));
  search.passes = {{}};
  EXPECT_EQ(robust_blocking_text(robust_specification(optimize::Hold::kYield), search),
            "no feasible design was found with the limits as stated");
}

}  // namespace
}  // namespace gear3k::report::built_series_report_test
