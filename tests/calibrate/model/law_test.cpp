#include "calibrate/model/law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "calibrate/model/extended_model.hpp"

namespace gear3k::calibrate::law_test {
namespace {

std::size_t condition(std::string_view name) {
  const auto& list = law_conditions();
  return static_cast<std::size_t>(std::ranges::find(list, name, &LawCondition::name) -
                                  list.begin());
}

/// A factor of the sun speed with values of its parameters in the middle of what they are for.
struct Example {
  LawFactor factor;
  std::vector<double> p;
};
std::vector<Example> every_shape() {
  std::vector<Example> result;
  for (int k = 0; k < kLawShapes; ++k) {
    LawFactor factor{.shape = static_cast<LawShape>(k),
                     .condition = condition("sun_speed"),
                     .reference = 3000.0,
                     .constant = 0.4};
    if (factor.shape == LawShape::kStep) factor.constant = 1200.0;
    std::vector<double> p;
    const LawShapeRecord& record = record_of(factor.shape);
    for (int i = 0; i < parameter_count(factor.shape); ++i) {
      const std::string_view name = record.parameters[static_cast<std::size_t>(i)];
      const bool of_condition = name == "half_value" || name == "width" || name == "centre" ||
                                name == "threshold" || name == "zero";
      p.push_back(of_condition ? 700.0 : name == "order" ? 2.3 : name == "phase" ? 0.1 : 1.7);
    }
    result.push_back({factor, p});
  }
  return result;
}

TEST(Law, DerivativesOfEveryShapeAreThoseOfItsValue) {
  for (const Example& e : every_shape()) {
    for (const double x : {300.0, 1000.0, 2900.0}) {
      std::vector<Scalar> p;
      for (std::size_t k = 0; k < e.p.size(); ++k) p.emplace_back(e.p[k], static_cast<int>(k));
      const Scalar value = factor_value(e.factor, x, p.data());
      EXPECT_NEAR(value.a, factor_value(e.factor, x, e.p.data()), 1e-14);
      for (std::size_t k = 0; k < e.p.size(); ++k) {
        const double h = 1e-6 * std::abs(e.p[k]);
        std::vector<double> high = e.p;
        std::vector<double> low = e.p;
        high[k] += h;
        low[k] -= h;
        const double slope =
            (factor_value(e.factor, x, high.data()) - factor_value(e.factor, x, low.data())) /
            (2.0 * h);
        // Truncation of the central difference.
        EXPECT_NEAR(value.v[static_cast<Eigen::Index>(k)], slope, 1e-7 * (1.0 + std::abs(slope)))
            << record_of(e.factor.shape).name << " at " << x;
      }
    }
  }
}

TEST(Law, GrowthIsALineWhereItsRateIsNothing) {
  const LawFactor growth{
      .shape = LawShape::kGrowth, .condition = condition("sun_speed"), .reference = 3000.0};
  // Truncation: first order in the rate.
  for (const double rate : {0.0, 1e-8, 1e-5, -1e-5}) {
    EXPECT_NEAR(factor_value(growth, 750.0, &rate), 0.25, 1e-5);
  }
  const double levels = -5.0;
  EXPECT_NEAR(factor_value(growth, 1500.0, &levels), std::expm1(-2.5) / std::expm1(-5.0), 1e-14);
}

TEST(Law, TheFormOfALawIsTheLaw) {
  for (const Example& e : every_shape()) {
    for (const bool offset : {false, true}) {
      const Law law{.action = LawAction::kShareLost,
                    .rows = LawRows::kNegative,
                    .factors = {e.factor,
                                {.shape = LawShape::kCentred,
                                 .condition = condition("temperature"),
                                 .origin = 31.0,
                                 .reference = 11.0}},
                    .offset = offset};
      const Law back = law_of(form_of(law));
      EXPECT_EQ(form_of(back).name, form_of(law).name);
      EXPECT_EQ(back.offset, offset);
      ASSERT_EQ(back.factors.size(), 2U);
      EXPECT_EQ(back.factors[0].shape, e.factor.shape);
      EXPECT_EQ(back.factors[0].constant, e.factor.constant);
      EXPECT_EQ(back.factors[1].origin, 31.0);
    }
  }
  EXPECT_THROW(law_of(Form{.name = "loss all power"}), std::invalid_argument);
}

TEST(Law, ActsWhereItsRowsAreAndWhatItNeedsIsStated) {
  Condition c;
  c.direction = design::Direction::kBackward;
  c.rotation = -1;
  Law law{.factors = {{.shape = LawShape::kCentred, .condition = condition("temperature")}}};
  EXPECT_FALSE(acts_in(law, c)) << "the temperature is not stated";
  c.temperature_K = 300.0;
  EXPECT_TRUE(acts_in(law, c));
  law.rows = LawRows::kForward;
  EXPECT_FALSE(acts_in(law, c));
  law.rows = LawRows::kNegative;
  EXPECT_TRUE(acts_in(law, c));
  EXPECT_EQ(law_weight(LawAction::kLoss, c, 5.0), -1.0);
  EXPECT_EQ(law_weight(LawAction::kShareLost, c, 5.0), -5.0);
  EXPECT_EQ(law_weight(LawAction::kShare, c, 5.0), 5.0);
}

TEST(Law, TheFormulaHasUnitsAndReferences) {
  const Law law{
      .action = LawAction::kLoss,
      .factors = {
          {.shape = LawShape::kPower, .condition = condition("sun_speed"), .reference = 3000.0},
          {.shape = LawShape::kCentred,
           .condition = condition("temperature"),
           .origin = 30.0,
           .reference = 10.0}}};
  EXPECT_EQ(law_formula(law, {0.012, 1.5, 27.0}, Kind::kTransmission),
            "loss = 0.012 Nm * (sun_speed/3000 rpm)^1.5 * (temperature - 27 C)/10 C");
  EXPECT_EQ(law_title(law), "power of sun_speed times line through a temperature");
}

TEST(Law, ChangesTheReadingByItsAction) {
  Condition c;
  c.direction = design::Direction::kBackward;
  c.sun_speed_rad_s = 50.0 * std::numbers::pi;  // 1500 rpm
  AppliedLaw applied{.law = {.action = LawAction::kLoss,
                             .factors = {{.shape = LawShape::kPower,
                                          .condition = condition("sun_speed"),
                                          .reference = 3000.0}}},
                     .value = {0.4, 1.0}};
  Modification m;
  apply_law(applied, c, Kind::kTransmission, m);
  EXPECT_NEAR(m.added.a, -0.2, 1e-15);
  applied.law.action = LawAction::kShare;
  apply_law(applied, c, Kind::kTransmission, m);
  EXPECT_NEAR(m.response_factor.a, 1.2, 1e-15);
  applied.value = {0.4};
  EXPECT_THROW(apply_law(applied, c, Kind::kTransmission, m), std::invalid_argument);
}

TEST(Law, KeepsItsValueBeyondItsEnds) {
  // 1 + u from 0.2 to 0.5 of 3000 rpm.
  Law law{.factors = {{.shape = LawShape::kCentred,
                       .condition = condition("sun_speed"),
                       .reference = 3000.0,
                       .least = 600.0,
                       .greatest = 1500.0}}};
  const std::vector<double> p{1.0, -3000.0};
  for (const auto& [rpm, expected] :
       {std::pair{100.0, 1.2}, std::pair{600.0, 1.2}, std::pair{900.0, 1.3}, std::pair{1500.0, 1.5},
        std::pair{9000.0, 1.5}}) {
    Condition c;
    c.sun_speed_rad_s = rpm * std::numbers::pi / 30.0;
    EXPECT_NEAR(law_value(law, c, p.data()), expected, 1e-12) << rpm;
    EXPECT_NEAR(law_value(law_of(form_of(law)), c, p.data()), expected, 1e-12) << rpm;
  }
  EXPECT_TRUE(has_limits(law.factors[0]));
  law.factors[0].shape = LawShape::kWave;
  EXPECT_FALSE(has_limits(law.factors[0]));
}

/// What a model of one law adds to a reading of any time and session of a speed.
double left_by(const AppliedLaw& law, double sun_speed_rpm) {
  ExtendedModel model;
  model.laws = {law};
  std::vector<double> added;
  for (const double t : {kUnknown, 0.0, 7.0, 1e6}) {
    Condition c;
    c.time_s = c.cycles = t;
    c.sun_speed_rad_s = sun_speed_rpm * std::numbers::pi / 30.0;
    Modification m;
    apply_model(model, c, Kind::kTransmission, m);
    added.push_back(m.added.a);
  }
  EXPECT_EQ(std::ranges::count(added, added.front()), std::ssize(added));
  return added.front();
}

TEST(Law, OverTimeLeavesBehindItsValueAtTheLastRow) {
  for (const char* name : {"time", "cycles"}) {
    const LawFactor until_20{.shape = LawShape::kPower,
                             .condition = condition(name),
                             .reference = 10.0,
                             .greatest = 25.0};
    const LawFactor by_speed{
        .shape = LawShape::kPower, .condition = condition("sun_speed"), .reference = 3000.0};
    // 0.1 + 0.3 (20/10)^1.5 (rpm/3000)^2
    for (const bool time_first : {true, false}) {
      AppliedLaw law{
          .law = {.action = LawAction::kAdded, .factors = {until_20, by_speed}, .offset = true},
          .value = {0.3, 0.1, 1.5, 2.0}};
      if (!time_first) {
        std::swap(law.law.factors[0], law.law.factors[1]);
        std::swap(law.value[2], law.value[3]);
      }
      // A file without what was left behind says where the law was asked for, not where rows ended.
      EXPECT_EQ(left_by(law, 600.0), 0.0);
      std::vector<Observation> rows(3);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].condition.time_s = rows[i].condition.cycles = 20.0 - 5.0 * static_cast<double>(i);
      }
      law = applied_law(law.law, law.value, rows);
      for (const double rpm : {600.0, 3000.0}) {
        EXPECT_NEAR(left_by(law, rpm), 0.1 + 0.3 * std::pow(2.0, 1.5) * std::pow(rpm / 3000.0, 2.0),
                    1e-12);
      }
    }
  }
}

TEST(Law, OfWavesInTimeLeavesBehindTheirMeanOverTheRows) {
  const Law wave{
      .action = LawAction::kAdded,
      .factors = {{.shape = LawShape::kWave, .condition = condition("time"), .reference = 10.0}}};
  std::vector<Observation> rows;
  double mean = 0.0;
  const std::vector<double> times{0.0, 0.5, 0.7, 3.0, 9.0};
  for (const double t : times) {
    rows.emplace_back();
    rows.back().condition.time_s = t;
    mean += std::cos(2.0 * std::numbers::pi * (0.6 * t / 10.0 - 0.1)) /
            static_cast<double>(times.size());
  }
  const std::vector<double> value{0.5, 0.6, 0.1};
  EXPECT_NEAR(left_by(applied_law(wave, value, rows), 600.0), 0.5 * mean, 1e-14);
  // Of which no mean is known nothing is left.
  EXPECT_EQ(left_by({.law = wave, .value = value}, 600.0), 0.0);
}

TEST(Law, OverTimeWithoutAnEndBelongsToItsCampaign) {
  for (const char* name : {"time", "cycles", "sun_speed", "temperature"}) {
    Condition c;
    c.time_s = c.cycles = 5.0;
    c.sun_speed_rad_s = 30.0;
    c.temperature_K = 300.0;
    ExtendedModel model;
    model.laws = {{.law = {.action = LawAction::kAdded,
                           .factors = {{.shape = LawShape::kCentred,
                                        .condition = condition(name),
                                        .reference = 10.0}}},
                   .value = {0.5, 0.0}}};
    const bool of_campaign = std::string_view(name) == "time" || std::string_view(name) == "cycles";
    EXPECT_EQ(is_of_campaign(model.laws[0].law), of_campaign) << name;
    Modification m;
    apply_model(model, c, Kind::kTransmission, m);
    EXPECT_EQ(m.added.a == 0.0, of_campaign) << name;
  }
}

}  // namespace
}  // namespace gear3k::calibrate::law_test
