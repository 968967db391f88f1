#include "io/files/model_laws.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "io/files/model_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::io::model_laws_test {
namespace {

using calibrate::ExtendedModel, calibrate::Kind, calibrate::Law, calibrate::LawFactor,
    calibrate::LawShape;

std::string errors_of(const std::string& text) {
  try {
    parse_model(text, "m.toml");
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// Values inside the bounds of every parameter, with many digits.
std::vector<double> values_of(const Law& law, Kind kind) {
  std::vector<double> values;
  for (const auto& p : parameters_of(law, kind)) {
    values.push_back(p.lower +
                     (p.upper - p.lower) / 3.1 / (1.0 + static_cast<double>(values.size())));
  }
  return values;
}

TEST(ModelLaws, EveryShapeOfEveryConditionComesBackExactly) {
  int laws = 0;
  for (const Kind kind : {Kind::kTransmission, Kind::kLostMotion, Kind::kPairLoss}) {
    for (int shape = 0; shape < calibrate::kLawShapes; ++shape) {
      const auto& conditions = calibrate::law_conditions();
      for (std::size_t c = 0; c < conditions.size(); ++c) {
        if (std::ranges::find(conditions[c].kinds, kind) == conditions[c].kinds.end()) continue;
        LawFactor factor{.shape = static_cast<LawShape>(shape),
                         .condition = c,
                         .origin = c % 2 == 0 ? 0.0 : 1.0 / 3.0,
                         .reference = 100.0 / 7.0,
                         .constant = record_of(static_cast<LawShape>(shape)).constant.empty()
                                         ? 0.0
                                         : 0.1 + 1.0 / 7.0,
                         .least = shape % 3 == 0 ? -HUGE_VAL : 0.3 / 7.0,
                         .greatest = shape % 2 == 0 ? HUGE_VAL : 900.0 / 7.0};
        if (!has_limits(factor)) {
          factor.least = -HUGE_VAL;
          factor.greatest = HUGE_VAL;
        }
        const int fitted = 1 + parameter_count(factor.shape);
        Law law{.action = static_cast<calibrate::LawAction>(laws % 4),
                .rows = static_cast<calibrate::LawRows>(laws % 5),
                .factors = {factor},
                .offset = fitted < 3 && laws % 2 == 0};
        if (fitted < 3 && !law.offset) {
          law.factors.push_back({.shape = LawShape::kStep,
                                 .condition = c,
                                 .reference = 2.0 / 3.0,
                                 .constant = -1.0 / 9.0});
        }
        ++laws;
        ExtendedModel model;
        model.name = "box";
        model.kind = kind;
        model.laws.push_back({.law = law, .value = values_of(law, kind)});
        model.laws.push_back(model.laws.front());
        const std::size_t count = 2 * model.laws[0].value.size();
        model.covariance.assign(count * count, 0.0);
        for (std::size_t k = 0; k < count; ++k) {
          model.covariance[k * (count + 1)] = 1.0 / (3.0 + static_cast<double>(k));
        }
        const std::string text = model_text({model});
        const auto back = parse_model(text, "m.toml");
        ASSERT_EQ(back.size(), 1U);
        ASSERT_EQ(back[0].laws.size(), 2U) << text;
        EXPECT_EQ(back[0].laws[1].value, model.laws[1].value);
        EXPECT_EQ(back[0].laws[0].law.action, law.action);
        EXPECT_EQ(back[0].laws[0].law.factors[0].reference, factor.reference);
        EXPECT_EQ(back[0].laws[0].law.factors[0].constant, factor.constant);
        EXPECT_EQ(back[0].laws[0].law.factors[0].least, factor.least);
        EXPECT_EQ(back[0].laws[0].law.factors[0].greatest, factor.greatest);
        EXPECT_EQ(model_text(back), text);
      }
    }
  }
  EXPECT_GT(laws, 100);
}

constexpr const char* kGood =
    "[transmission]\n"
    "[transmission.causes]\n"
    "[transmission.laws.law]\n"
    "acts_on = \"loss\"\n"
    "rows = \"all\"\n"
    "shape = \"power\"\n"
    "condition = \"sun_speed\"\n"
    "reference_rpm = 3000.0\n"
    "amplitude_nm = 0.012\n"
    "exponent = 1.4\n";

TEST(ModelLaws, EveryErrorHasItsPlaceAndWhatIsAllowed) {
  ASSERT_EQ(errors_of(kGood), "");
  struct Case {
    std::string from, to, expected;
  };
  for (const Case& c : std::vector<Case>{
           {"\"loss\"", "\"los\"", "m.toml:4:1: transmission.laws.law.acts_on = \"los\""},
           {"\"loss\"", "\"los\"", "did you mean \"loss\"?"},
           {"acts_on = \"loss\"\n", "",
            "transmission.laws.law.acts_on is missing: allowed: \"response\" or \"loss\""},
           {"\"all\"", "7", "m.toml:5:1: transmission.laws.law.rows = 7"},
           {"\"power\"", "\"pover\"", "did you mean \"power\"?"},
           {"\"sun_speed\"", "\"test_torque\"",
            "m.toml:7:1: transmission.laws.law.condition = \"test_torque\""},
           {"3000.0", "0.0", "m.toml:8:1: transmission.laws.law.reference_rpm = 0"},
           {"3000.0", "0.0", "allowed: 1e-06 to 1e+12"},
           {"3000.0\n", "3000.0\nleast_rpm = nan\n",
            "m.toml:9:1: transmission.laws.law.least_rpm = nan"},
           {"3000.0\n", "3000.0\nleast_rpm = 900.0\ngreatest_rpm = 600.0\n",
            "m.toml:10:1: transmission.laws.law.greatest_rpm = 600"},
           {"3000.0\n", "3000.0\nleast_rpm = 900.0\ngreatest_rpm = 600.0\n",
            "allowed: a number, at least 900"},
           {"0.012", "inf", "m.toml:9:1: transmission.laws.law.amplitude_nm = inf"},
           {"1.4", "9.0", "transmission.laws.law.exponent = 9"},
           {"1.4", "9.0", "allowed: a number, -8 to 8"},
           {"exponent = 1.4\n", "", "transmission.laws.law.exponent is missing"},
           {"exponent = 1.4\n", "exponent = 1.4\nexponent_sd = -1.0\n",
            "m.toml:11:1: transmission.laws.law.exponent_sd = -1"},
           {"exponent = 1.4\n", "exponent = 1.4\nexponet_sd = 1.0\n", "did you mean exponent_sd?"},
           {"laws.law]", "laws.rule]",
            "m.toml:3:20: unknown law transmission.laws.rule: allowed: law, law_2"},
           {"\"power\"", "\"bell\"", "transmission.laws.law.centre_rpm is missing"}}) {
    std::string text = kGood;
    text.replace(text.find(c.from), c.from.size(), c.to);
    const std::string errors = errors_of(text);
    EXPECT_NE(errors.find(c.expected), std::string::npos)
        << "expected: " << c.expected << "\nin: " << errors;
  }
}

TEST(ModelLaws, WhatTurnsHasNoEnds) {
  std::string text = kGood;
  text.replace(text.find("\"sun_speed\""), 11, "\"output_angle\"");
  text.replace(text.find("reference_rpm = 3000.0"), 22, "reference_deg = 30.0\nleast_deg = 1.0");
  EXPECT_NE(errors_of(text).find("m.toml:9:1: unknown key transmission.laws.law.least_deg"),
            std::string::npos)
      << errors_of(text);
}

TEST(ModelLaws, ARefusedLeastValueLimitsNoGreatestOne) {
  std::string text = kGood;
  text.replace(text.find("3000.0\n"), 7, "3000.0\nleast_rpm = \"low\"\ngreatest_rpm = 0.5\n");
  const std::string errors = errors_of(text);
  EXPECT_NE(errors.find("least_rpm"), std::string::npos) << errors;
  EXPECT_EQ(errors.find("greatest_rpm"), std::string::npos) << errors;
}

TEST(ModelLaws, MoreThanThreeParametersAreRefused) {
  const std::string errors =
      errors_of(std::string(kGood) +
                "offset_nm = 0.1\nshape_2 = \"power\"\ncondition_2 = \"output_torque\"\n"
                "reference_2_nm = 10.0\nexponent_2 = 1.0\n");
  EXPECT_NE(errors.find("transmission.laws.law has 4 parameters: allowed: at most 3"),
            std::string::npos)
      << errors;
}

}  // namespace
}  // namespace gear3k::io::model_laws_test
