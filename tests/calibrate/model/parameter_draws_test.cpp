#include "calibrate/model/parameter_draws.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace gear3k::calibrate::parameter_draws_test {
namespace {

/// A drag and a coefficient of friction that the data tell together better than alone.
ExtendedModel drag_and_level() {
  ExtendedModel model;
  model.causes = {{.id = "drag_constant", .form = {.name = "sun", .body = "sun"}, .value = {0.02}},
                  {.id = "friction_level", .form = {.name = "coefficient"}, .value = {0.3}}};
  model.covariance = {4e-6, -3e-5, -3e-5, 9e-4};
  return model;
}

TEST(ParameterDraws, HaveTheMeansAndTheCovarianceOfTheModel) {
  const std::vector<ExtendedModel> models{drag_and_level()};
  const ParameterDraws draws(models, 1);
  constexpr int kDraws = 20000;
  double mean[2]{};
  double product[3]{};
  for (int n = 0; n < kDraws; ++n) {
    const auto drawn = draws.draw(static_cast<std::uint64_t>(n));
    const double drag = drawn[0].causes[0].value[0] - 0.02;
    const double level = drawn[0].causes[1].value[0] - 0.3;
    mean[0] += drag / kDraws;
    mean[1] += level / kDraws;
    product[0] += drag * drag / kDraws;
    product[1] += drag * level / kDraws;
    product[2] += level * level / kDraws;
  }
  // Five standard errors: of a mean σ/√n, of a product at most √2 σσ/√n.
  const double error = 5.0 / std::sqrt(kDraws);
  EXPECT_NEAR(mean[0], 0.0, error * 2e-3);
  EXPECT_NEAR(mean[1], 0.0, error * 3e-2);
  EXPECT_NEAR(product[0], 4e-6, 1.42 * error * 4e-6);
  EXPECT_NEAR(product[1], -3e-5, 1.42 * error * 6e-5);
  EXPECT_NEAR(product[2], 9e-4, 1.42 * error * 9e-4);
}

TEST(ParameterDraws, DependOnSeedAndNumberOnly) {
  const std::vector<ExtendedModel> models{drag_and_level()};
  const ParameterDraws draws(models, 7);
  const auto later = draws.draw(5);
  (void)draws.draw(4);
  EXPECT_EQ(later[0].causes[0].value, draws.draw(5)[0].causes[0].value);
  EXPECT_NE(later[0].causes[0].value, draws.draw(6)[0].causes[0].value);
  EXPECT_NE(later[0].causes[0].value, ParameterDraws(models, 8).draw(5)[0].causes[0].value);
}

/// Of a parameter that follows from another one both deviate together.
TEST(ParameterDraws, OfASingularCovarianceStayOnItsLine) {
  std::vector<ExtendedModel> models{drag_and_level()};
  models[0].covariance = {4e-6, -6e-5, -6e-5, 9e-4};
  const ParameterDraws draws(models, 1);
  for (std::uint64_t n = 0; n < 100; ++n) {
    const auto drawn = draws.draw(n);
    EXPECT_NEAR((drawn[0].causes[1].value[0] - 0.3) / 0.03,
                -(drawn[0].causes[0].value[0] - 0.02) / 0.002, 1e-9);
  }
}

TEST(ParameterDraws, StayWithinTheBoundsOfTheFit) {
  std::vector<ExtendedModel> models{drag_and_level()};
  models[0].covariance = {1.0, 0.0, 0.0, 4.0};  // as good as unknown
  const ParameterDraws draws(models, 1);
  int at_bound = 0;
  for (std::uint64_t n = 0; n < 200; ++n) {
    const auto drawn = draws.draw(n);
    const double level = drawn[0].causes[1].value[0];
    EXPECT_GE(level, -0.99);
    at_bound += level == -0.99 ? 1 : 0;
  }
  EXPECT_GT(at_bound, 20);
}

TEST(ParameterDraws, OfAModelWithoutCovarianceAreTheModel) {
  std::vector<ExtendedModel> models{drag_and_level()};
  models[0].covariance.clear();
  EXPECT_EQ(ParameterDraws(models, 1).draw(3)[0].causes[0].value, models[0].causes[0].value);
  EXPECT_EQ(parameters_without_scatter(models),
            (std::vector<std::string>{"drag_constant.torque", "friction_level.relative_change"}));
  models[0] = drag_and_level();
  EXPECT_TRUE(parameters_without_scatter(models).empty());
  // What belongs to the sensor does not change the gearbox.
  models[0].causes[0] = {.id = "sensor_gain", .form = {.name = "gain"}, .value = {0.01}};
  models[0].covariance = {0.0, 0.0, 0.0, 9e-4};
  EXPECT_TRUE(parameters_without_scatter(models).empty());
}

TEST(ParameterDraws, OfACovarianceOfAnotherSizeAreRefused) {
  std::vector<ExtendedModel> models{drag_and_level()};
  models[0].covariance.pop_back();
  EXPECT_THROW(ParameterDraws(models, 1), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::calibrate::parameter_draws_test
