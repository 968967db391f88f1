#include "calibrate/fit/row_gain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::row_gain_test {
namespace {

class RowGain : public Bench {
 protected:
  RowGain() {
    data_ = measured_grid({.sun_speeds_rpm = {200.0, 600.0}});
    const auto last = static_cast<double>(data_.rows.size() - 1);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].condition.time_s = 100.0 * static_cast<double>(i) / last;
    }
  }
  /// 1 − exp(−t/τ), τ = 100 s e^p, of a change of the gain.
  [[nodiscard]] std::vector<ParameterResult> told(const char* form, double change,
                                                  double log_scale) const {
    FinalFit fit;
    fit.degrees = 10;
    fit.hypothesis =
        hypothesis({candidate("drift", {.name = form,
                                        .constants = {{.name = "start"},
                                                      {.name = "span", .value = 100.0},
                                                      {.name = "time_constant", .value = 100.0}}})},
                   {change, log_scale});
    fit.covariance = Eigen::MatrixXd::Zero(2, 2);
    fit.covariance(0, 0) = 0.04;
    std::vector<ParameterResult> result;
    add_implausible_gain(problem(), fit, 0, result);
    return result;
  }
};

TEST_F(RowGain, OfADriftIsThatOfTheRowFurthestOff) {
  // At the last row 1 − e^(−1/e) of what the drift tends to.
  const double share = 1.0 - std::exp(-std::exp(-1.0));
  EXPECT_TRUE(told("levelling_any_scale_time_gain", 0.19 / share, 1.0).empty());
  const auto more = told("levelling_any_scale_time_gain", -0.25 / share, 1.0);
  ASSERT_EQ(more.size(), 1U);
  EXPECT_EQ(more[0].name, "greatest_gain_change");
  EXPECT_FALSE(more[0].plausible);
  EXPECT_NEAR(more[0].value, -0.25, 1e-12);
  // Tables of Student's t: 2.22814 for 10 degrees of freedom.
  EXPECT_NEAR(more[0].high - more[0].value, 2.22814 * 0.2 * share, 1e-5);
}

TEST_F(RowGain, OfOtherTargetsIsNotAsked) {
  EXPECT_TRUE(told("levelling_any_scale_time_friction", 5.0, 1.0).empty());
}

TEST_F(RowGain, ZeroOfTheOutputsSensorIsATenthOfWhatItReadAtMost) {
  const auto judged = [&](double offset_Nm) {
    FinalFit fit;
    fit.hypothesis = hypothesis({candidate("sensor_offset", {.name = "output"})}, {offset_Nm});
    std::vector<ParameterResult> result(1);
    result.front().value = offset_Nm;
    judge_output_zero(problem(), fit, 0, result);
    return result.front().plausible;
  };
  // The grid's greatest torque is 50 Nm.
  EXPECT_TRUE(judged(4.9));
  EXPECT_TRUE(judged(-4.9));
  EXPECT_FALSE(judged(5.1));
  EXPECT_FALSE(judged(-5.1));
  for (Observation& row : data_.rows) row.condition.output_torque_Nm *= 0.1;
  EXPECT_TRUE(judged(0.9));
  EXPECT_FALSE(judged(1.1));
}

}  // namespace
}  // namespace gear3k::calibrate::row_gain_test
