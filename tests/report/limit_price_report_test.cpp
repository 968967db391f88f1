#include "report/limit_price_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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

}  // namespace
}  // namespace gear3k::report::limit_price_report_test
