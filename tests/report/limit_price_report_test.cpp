#include "report/limit_price_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

namespace gear3k::report::limit_price_report_test {
namespace {

/// A set of so much backward efficiency, held back by a limit of so many per metre.
HeldBackReport held_back(double eta_b, double per_m) {
  HeldBackReport report;
  report.best.set.eta_b = eta_b;
  optimize::LimitPrice price;
  price.key = "module.stage2_mm.min";
  price.limit.kind = optimize::LimitKind::kModule;
  price.limit.at_least = true;
  price.unit = units::Unit::kMillimetre;
  price.value_si = 0.5e-3;
  price.loosened = per_m;
  price.tightened = per_m;
  report.best.held.prices = {price};
  return report;
}

nlohmann::json better_estimate(const optimize::Specification& spec, const HeldBackReport& report) {
  return nlohmann::json::parse(held_back_json(spec, report).text()).at("better_estimate");
}

TEST(LimitPriceReport, TellsNoEfficiencyAboveOne) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kBackwardEfficiency};
  const double step_m = 1e-3 * optimize::giving_step(held_back(0.9, 0.0).best.held.prices[0]);
  const HeldBackReport within = held_back(0.9, 0.05 / step_m);
  EXPECT_NE(held_back_table(spec, within.best).find("an estimate to first order: 95.000 %"),
            std::string::npos)
      << held_back_table(spec, within.best);
  EXPECT_NEAR(better_estimate(spec, within).at("objective").get<double>(), 0.95, 1e-12);
  const HeldBackReport beyond = held_back(0.9, 0.313 / step_m);
  const std::string table = held_back_table(spec, beyond.best);
  EXPECT_EQ(table.find("121."), std::string::npos) << table;
  EXPECT_EQ(table.find("31.3"), std::string::npos) << table;
  EXPECT_NE(table.find("its price does not hold as far as that"), std::string::npos) << table;
  const nlohmann::json better = better_estimate(spec, beyond);
  EXPECT_TRUE(better.at("objective").is_null());
  EXPECT_EQ(better.at("key"), "module.stage2_mm.min");
}

TEST(LimitPriceReport, HasNoBetterEstimateWhereNothingGains) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kBackwardEfficiency};
  HeldBackReport report = held_back(0.9, 0.01);
  EXPECT_FALSE(better_estimate(spec, report).is_null());
  report.best.held.prices.front().refined_gain_si = 0.0;
  EXPECT_TRUE(better_estimate(spec, report).is_null());
  const std::string table = held_back_table(spec, report.best);
  EXPECT_EQ(table.find("nearest better"), std::string::npos) << table;
  EXPECT_NE(table.find("+0 % points"), std::string::npos) << table;  // the gain, in its row
}

TEST(LimitPriceReport, AdvisesNoBacklashBelowNone) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kLostMotion};
  HeldBackReport report = held_back(0.9, 0.01);
  optimize::LimitPrice& price = report.best.held.prices.front();
  price.key = "backlash.min_normal_um";
  price.limit.kind = optimize::LimitKind::kCheck;
  price.unit = units::Unit::kMicrometre;
  for (const double least_um : {5.0, 1.0, 0.5, 0.0}) {
    price.value_si = 1e-6 * least_um;
    EXPECT_EQ(better_estimate(spec, report).is_null(), least_um < 1.0) << least_um;
  }
}

TEST(LimitPriceReport, TellsWideTablesInLines) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kBackwardEfficiency};
  spec.planets = {3, 4};
  HeldBackReport report = held_back(0.9, 0.01);
  report.by_planets = {report.best};
  report.by_planets.front().set.candidate = {.teeth = {12, 64, 141, 52, 132}, .planets = 3};
  const auto longest = [](const std::string& text) {
    std::size_t most = 0, begin = 0;
    for (std::size_t end = 0; begin < text.size(); begin = end + 1) {
      end = std::min(text.find('\n', begin), text.size());
      const bool row =
          text.compare(begin, 2, "  ") == 0 && text.compare(begin, 9, "  nearest") != 0;
      if (row) most = std::max(most, end - begin);
    }
    return most;
  };
  const std::string wide = held_back_table(spec, report.best) + planets_table(spec, report);
  ASSERT_GT(longest(wide), 76U) << wide;
  const std::string narrow =
      held_back_table(spec, report.best, 76) + planets_table(spec, report, 76);
  EXPECT_LE(longest(narrow), 76U) << narrow;
  EXPECT_NE(narrow.find("\n  module.stage2_mm.min = 0.5 mm\n    price "), std::string::npos)
      << narrow;
}

TEST(LimitPriceReport, TellsNumbersOfPlanetsWithoutADesign) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kBackwardEfficiency};
  spec.planets = {2, 3, 4, 5};
  HeldBackReport report = held_back(0.9, 0.01);
  for (const int planets : {2, 3}) {
    report.by_planets.push_back(report.best);
    report.by_planets.back().set.candidate = {.teeth = {12, 64, 141, 52, 132}, .planets = planets};
  }
  EXPECT_NE(planets_table(spec, report).find("\n  4, 5: no design\n"), std::string::npos);
  report.all_refined = false;
  EXPECT_NE(planets_table(spec, report).find("\n  4, 5: not refined to a design, as the proof "),
            std::string::npos);
  EXPECT_NE(planets_table(spec, report, 76).find("\n    best of all; plain optimize "),
            std::string::npos)
      << planets_table(spec, report, 76);
  const auto proof = [](int planets, double best, double bound) {
    optimize::PlanetsCertificate own{.planets = planets, .proof = {}};
    own.proof.best = best;
    own.proof.global_bound = bound;
    return own;
  };
  report.proofs = {proof(2, 0.9, 0.9 + 1e-7), proof(3, 0.9, 0.912341),
                   proof(4, -optimize::kInfinity, -optimize::kInfinity)};
  const std::string proven = planets_table(spec, report);
  EXPECT_NE(proven.find("\nBest by number of planets, each by a proof of its own\n"),
            std::string::npos);
  EXPECT_NE(proven.find(" proven "), std::string::npos) << proven;
  EXPECT_NE(proven.find(" none above 91.235 % "), std::string::npos) << proven;
  EXPECT_NE(proven.find("\n  4: no design\n  5: not refined"), std::string::npos) << proven;
  report.proofs.clear();
  report.interrupted = true;
  EXPECT_NE(planets_table(spec, report).find("\n  4, 5: none was refined to a design before "),
            std::string::npos);
}

}  // namespace
}  // namespace gear3k::report::limit_price_report_test
