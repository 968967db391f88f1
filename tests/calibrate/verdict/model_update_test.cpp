#include "calibrate/verdict/model_update.hpp"

#include <gtest/gtest.h>

#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate::model_update_test {
namespace {

ExtendedModel model_of(Kind kind, std::vector<AppliedCause> causes, std::vector<double> covariance,
                       std::uint64_t fingerprint) {
  ExtendedModel model;
  model.kind = kind;
  model.causes = std::move(causes);
  model.covariance = std::move(covariance);
  model.fingerprint = fingerprint;
  return model;
}

AppliedCause drag(double torque_Nm) {
  return {.id = "drag_constant", .form = {.name = "sun", .body = "sun"}, .value = {torque_Nm}};
}
AppliedCause level(double factor) {
  return {.id = "friction_level", .form = {.name = "all"}, .value = {factor}};
}
AppliedCause step() {
  return {.id = "run_step",
          .form = {.name = "from", .constants = {{.name = "first_run", .value = 1.0}}},
          .value = {0.5}};
}

TEST(ModelUpdate, NewCausesFollowEarlierOnesAndCovariancesStayApart) {
  const auto earlier = model_of(Kind::kTransmission, {drag(0.02)}, {4.0}, 1);
  const auto found = model_of(Kind::kTransmission, {level(0.3)}, {9.0}, 2);
  const auto result = updated_models({earlier}, {found});
  ASSERT_EQ(result.size(), 1U);
  ASSERT_EQ(result[0].causes.size(), 2U);
  EXPECT_EQ(result[0].causes[0].id, "drag_constant");
  EXPECT_EQ(result[0].causes[1].id, "friction_level");
  EXPECT_EQ(result[0].covariance, (std::vector<double>{4.0, 0.0, 0.0, 9.0}));
  EXPECT_EQ(result[0].fingerprint, 2U);
}

TEST(ModelUpdate, StepsOfEarlierDataStayBesideNewOnes) {
  const auto earlier = model_of(Kind::kTransmission, {step(), drag(0.02)}, {1.0, 0.5, 0.5, 4.0}, 1);
  const auto found = model_of(Kind::kTransmission, {step(), level(0.3)}, {7.0, 0.1, 0.1, 9.0}, 2);
  const auto result = updated_models({earlier}, {found});
  ASSERT_EQ(result[0].causes.size(), 4U);
  EXPECT_EQ(result[0].causes[0].id, "run_step");
  EXPECT_EQ(result[0].causes[2].id, "run_step");
  EXPECT_EQ(result[0].covariance, (std::vector<double>{1.0, 0.5, 0.0, 0.0, 0.5, 4.0, 0.0, 0.0, 0.0,
                                                       0.0, 7.0, 0.1, 0.0, 0.0, 0.1, 9.0}));
}

TEST(ModelUpdate, WhatWasAmbiguousStaysSo) {
  const auto joint = [](Verdict before, Verdict after, bool found_a_cause) {
    auto earlier = model_of(Kind::kTransmission, {drag(0.02)}, {4.0}, 1);
    earlier.causes[0].alternatives = {"sensor_offset"};
    earlier.verdict = before;
    auto found = found_a_cause ? model_of(Kind::kTransmission, {level(0.3)}, {9.0}, 2)
                               : model_of(Kind::kTransmission, {}, {}, 2);
    found.verdict = after;
    const ExtendedModel result = updated_models({earlier}, {found}).at(0);
    EXPECT_EQ(result.causes.at(0).alternatives, (std::vector<std::string>{"sensor_offset"}));
    return result.verdict.value();
  };
  using enum Verdict;
  EXPECT_EQ(joint(kAmbiguous, kExplained, true), kAmbiguous);
  EXPECT_EQ(joint(kAmbiguous, kNoDiscrepancy, false), kAmbiguous);
  EXPECT_EQ(joint(kAmbiguous, kUnexplained, true), kUnexplained);
  EXPECT_EQ(joint(kExplained, kUnexplained, false), kUnexplained);
  EXPECT_EQ(joint(kUnexplained, kExplained, true), kExplained);
}

TEST(ModelUpdate, WithNothingNewAModelStaysAsItIs) {
  const auto earlier = model_of(Kind::kTransmission, {drag(0.02)}, {4.0}, 1);
  const auto result = updated_models({earlier}, {model_of(Kind::kTransmission, {}, {}, 2),
                                                 model_of(Kind::kLostMotion, {}, {}, 3)});
  ASSERT_EQ(result.size(), 2U);
  EXPECT_EQ(result[0].fingerprint, 1U);
  EXPECT_EQ(result[0].causes.size(), 1U);
  EXPECT_EQ(result[1].kind, Kind::kLostMotion);
  EXPECT_TRUE(result[1].causes.empty());
}

TEST(ModelUpdate, KindsComeInTheirOrder) {
  const auto pairs = model_of(Kind::kPairLoss, {level(0.1)}, {1.0}, 1);
  const auto train = model_of(Kind::kTransmission, {level(0.1)}, {1.0}, 2);
  const auto result = updated_models({pairs}, {train});
  ASSERT_EQ(result.size(), 2U);
  EXPECT_EQ(result[0].kind, Kind::kTransmission);
}

}  // namespace
}  // namespace gear3k::calibrate::model_update_test
