#include "calibrate/fit/parameter_results.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "tests/calibrate/rig_campaign.hpp"

namespace gear3k::calibrate::parameter_results_test {
namespace {

const ParameterResult& named(const std::vector<ParameterResult>& all, const std::string& name) {
  const auto at = std::ranges::find(all, name, &ParameterResult::name);
  if (at == all.end()) throw std::invalid_argument("no parameter " + name);
  return *at;
}

FinalFit fit_of(Hypothesis h, const Eigen::MatrixXd& covariance, int degrees) {
  FinalFit fit;
  fit.at_bound.assign(h.value.size(), false);
  fit.beyond.assign(h.value.size(), 0.0);
  fit.hypothesis = std::move(h);
  fit.covariance = covariance;
  fit.degrees = degrees;
  return fit;
}

double half_width(const ParameterResult& r) { return 0.5 * (r.high - r.low); }

class ParameterResults : public testing::Test {
 protected:
  ParameterResults() : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission) {}
  Simulation simulation_;
};

TEST_F(ParameterResults, HaveStudentsIntervals) {
  Hypothesis h = hypothesis({candidate("sensor_gain", {.name = "gain"}),
                             candidate("drag_constant", {.name = "sun", .body = "sun"})},
                            {0.2, 0.03});
  Eigen::Matrix2d covariance;
  covariance << 4e-4, 1e-6, 1e-6, 9e-6;
  FinalFit fit = fit_of(h, covariance, 5);
  fit.at_bound[1] = true;
  const auto gain = parameter_results(simulation_, fit, 0);
  const auto drag = parameter_results(simulation_, fit, 1);
  ASSERT_EQ(gain.size(), 1U);
  // Tables of Student's t: 2.5706 for 5 degrees of freedom.
  EXPECT_NEAR(half_width(gain[0]), 2.5706 * 0.02, 1e-5);
  EXPECT_NEAR(half_width(drag[0]), 2.5706 * 0.003, 1e-6);
  // 20 % is no plausible error of a sensor.
  EXPECT_FALSE(gain[0].plausible);
  EXPECT_TRUE(drag[0].plausible);
  EXPECT_FALSE(gain[0].at_bound);
  EXPECT_TRUE(drag[0].at_bound);
  EXPECT_EQ(drag[0].unit, "Nm");
}

TEST_F(ParameterResults, AtABoundArePlausibleWhereTheRowsDoNotRuleItOut) {
  const Candidate gain = candidate("sensor_gain", {.name = "gain"});
  const ParameterRecord& record = gain.parameters[0];
  const auto is_plausible = [&](double value, double beyond, double deviation) {
    const Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(1, 1, deviation * deviation);
    FinalFit fit = fit_of(hypothesis({gain}, {value}), covariance, 1000);
    fit.at_bound[0] = value == record.lower;
    fit.beyond[0] = beyond;
    return parameter_results(simulation_, fit, 0)[0].plausible;
  };
  // Inside the bounds the value decides, however little is known of it.
  EXPECT_TRUE(is_plausible(record.plausible_high, 0.0, 10.0));
  EXPECT_FALSE(is_plausible(record.plausible_high + 1e-6, 0.0, 10.0));
  EXPECT_FALSE(is_plausible(record.lower + 1e-9, 0.0, 10.0));
  // At the bound the interval does: 1.9623 deviations at 1000 degrees of freedom.
  const double away = record.plausible_low - record.lower;
  ASSERT_GT(away, 0.0);
  EXPECT_TRUE(is_plausible(record.lower, 0.0, 1.001 * away / 1.9623));
  EXPECT_FALSE(is_plausible(record.lower, 0.0, 0.999 * away / 1.9623));
  // About where the rows would have it without the bound.
  EXPECT_FALSE(is_plausible(record.lower, -away, 1.001 * away / 1.9623));
  EXPECT_TRUE(is_plausible(record.lower, -away, 2.001 * away / 1.9623));
}

TEST_F(ParameterResults, LeadWithTheAmplitudeOfAWave) {
  const Candidate sun = candidate("runout", {.name = "constant", .body = "sun", .order = 83.5});
  Eigen::Matrix2d covariance;
  covariance << 4e-6, 1e-6, 1e-6, 2e-6;
  const auto results =
      parameter_results(simulation_, fit_of(hypothesis({sun}, {0.03, -0.04}), covariance, 1000), 0);
  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(results[0].name, "amplitude");
  EXPECT_TRUE(results[0].derived);
  EXPECT_DOUBLE_EQ(results[0].value, 0.05);
  // Gradient (0.6, −0.8): 0.36·4 − 2·0.48·1 + 0.64·2 = 1.76.
  EXPECT_NEAR(half_width(results[0]), 1.9623 * std::sqrt(1.76e-6), 1e-7);
}

TEST_F(ParameterResults, PropagateThroughALaw) {
  // The slow excess against brute force: the ratio at both ends by finite differences.
  const auto form = [](const Simulation& simulation) {
    const MeasurementSet data = campaign(Kind::kTransmission);
    const auto candidates = candidates_for(simulation, data);
    return *std::ranges::find_if(
        candidates, [](const Candidate& c) { return c.form.name == "slow_excess_any_scale"; });
  }(simulation_);
  Eigen::Matrix2d covariance;
  covariance << 1e-2, 2e-3, 2e-3, 3e-2;
  const auto ratio = [&](double excess, double log_scale) {
    const auto results = parameter_results(
        simulation_, fit_of(hypothesis({form}, {excess, log_scale}), covariance, 100), 0);
    return named(results, "slow_over_fast");
  };
  constexpr double kStep = 1e-5;
  const Eigen::Vector2d slope(
      (ratio(0.8 + kStep, 0.2).value - ratio(0.8 - kStep, 0.2).value) / (2.0 * kStep),
      (ratio(0.8, 0.2 + kStep).value - ratio(0.8, 0.2 - kStep).value) / (2.0 * kStep));
  const double factor = boost::math::quantile(boost::math::students_t(100), 0.975);
  const ParameterResult at = ratio(0.8, 0.2);
  EXPECT_GT(at.value, 1.0);
  EXPECT_NEAR(half_width(at), factor * std::sqrt(slope.dot(covariance * slope)), 1e-8);
  // No excess: friction is the same at both ends.
  EXPECT_NEAR(ratio(0.0, 0.2).value, 1.0, 1e-15);
}

TEST(ParameterResultsOfPairs, TellTheFlanksOfAllCausesTogether) {
  design::Design design = design_of(rig::bilateral_drive_gear());
  const Simulation pairs(pair_of(design), Kind::kPairLoss);
  const Hypothesis both =
      hypothesis({candidate("friction_level", {.name = "coefficient"}, Kind::kPairLoss),
                  candidate("friction_direction", {.name = "approach_recess"}, Kind::kPairLoss)},
                 {0.5, 0.2});
  Eigen::Matrix2d covariance;
  covariance << 1e-4, 0.0, 0.0, 4e-4;
  const auto results = parameter_results(pairs, fit_of(both, covariance, 1000), 1);
  const double mu = pair_of(design).friction.coefficient;
  EXPECT_NEAR(named(results, "friction_in_approach").value, mu * 1.5 * 1.2, 1e-12);
  EXPECT_NEAR(named(results, "friction_in_recess").value, mu * 1.5 * 0.8, 1e-12);
  // d/dlevel = μ 1.2, d/dasymmetry = μ 1.5.
  EXPECT_NEAR(half_width(named(results, "friction_in_approach")),
              1.9623 * mu * std::hypot(1.2 * 0.01, 1.5 * 0.02), 1e-5 * mu);
  // The level by itself has no flanks to tell.
  EXPECT_EQ(parameter_results(pairs, fit_of(both, covariance, 1000), 0).size(), 1U);
}

}  // namespace
}  // namespace gear3k::calibrate::parameter_results_test
