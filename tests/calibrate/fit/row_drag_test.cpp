#include "calibrate/fit/row_drag.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <numbers>

#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::row_drag_test {
namespace {

class RowDrag : public Bench {
 protected:
  RowDrag() {
    data_ = measured_grid({.sun_speeds_rpm = {200.0, 600.0},
                           .output_torques_Nm = {1.0, 4.0},
                           .directions = {design::Direction::kForward}});
  }
  [[nodiscard]] std::vector<ParameterResult> told(const char* id, const char* shaft,
                                                  double coefficient) const {
    FinalFit fit;
    fit.degrees = 10;
    fit.hypothesis = hypothesis({candidate(id, {.name = shaft, .body = shaft})}, {coefficient});
    fit.covariance = Eigen::MatrixXd::Constant(1, 1, 1e-4);
    std::vector<ParameterResult> result;
    add_implausible_drag(problem(), fit, 0, result);
    return result;
  }
  static constexpr double kSun_rad_s = 600.0 * std::numbers::pi / 30.0;
};

TEST_F(RowDrag, IsToldWhereItIsMoreThanSealsAndOilHave) {
  EXPECT_TRUE(told("drag_viscous", "sun", 4.9 / kSun_rad_s).empty());
  const auto viscous = told("drag_viscous", "sun", 6.0 / kSun_rad_s);
  ASSERT_EQ(viscous.size(), 1U);
  EXPECT_EQ(viscous[0].name, "greatest_drag");
  EXPECT_FALSE(viscous[0].plausible);
  EXPECT_NEAR(viscous[0].value, 6.0, 1e-12);
  // Tables of Student's t: 2.22814 for 10 degrees of freedom.
  EXPECT_NEAR(viscous[0].high - viscous[0].value, 2.22814 * 0.01 * kSun_rad_s, 1e-5 * kSun_rad_s);
  const auto quadratic = told("drag_quadratic", "sun", 7.0 / (kSun_rad_s * kSun_rad_s));
  ASSERT_EQ(quadratic.size(), 1U);
  EXPECT_NEAR(quadratic[0].value, 7.0, 1e-12);
}

TEST_F(RowDrag, OfTheOutputIsAtItsOwnSpeed) {
  const double output_rad_s = kSun_rad_s / std::abs(simulation_.ratio());
  // The same coefficient is a hundred times the torque at the sun.
  EXPECT_TRUE(told("drag_viscous", "output", 4.9 / output_rad_s).empty());
  EXPECT_FALSE(told("drag_viscous", "sun", 4.9 / output_rad_s).empty());
  EXPECT_NEAR(told("drag_viscous", "output", 6.0 / output_rad_s).at(0).value, 6.0, 1e-12);
}

TEST_F(RowDrag, OfAShaftThatCarriesMoreMayBeMore) {
  // What the load takes at the sun, and the drag on top of it.
  const auto measured_with = [&](double load_Nm, double drag_Nm) {
    for (Observation& row : data_.rows) {
      row.response = load_Nm + drag_Nm * row.condition.sun_speed_rad_s / kSun_rad_s;
    }
  };
  measured_with(6.5, 6.0);
  EXPECT_TRUE(told("drag_viscous", "sun", 6.0 / kSun_rad_s).empty());
  measured_with(6.5, 7.0);
  EXPECT_NEAR(told("drag_viscous", "sun", 7.0 / kSun_rad_s).at(0).plausible_high, 6.5, 1e-12);
  // A load that turned the sun backward against the drag was the greater.
  for (Observation& row : data_.rows) {
    row.condition.direction = design::Direction::kBackward;
    row.response = 0.5;
  }
  EXPECT_TRUE(told("drag_viscous", "sun", 7.0 / kSun_rad_s).empty());
}

TEST_F(RowDrag, OfASealIsHeldAgainstTheSame) {
  for (Observation& row : data_.rows) row.condition.output_torque_Nm = 8.0;
  const auto plausible = [&](const Form& form, std::vector<double> torques_Nm) {
    FinalFit fit;
    fit.hypothesis = hypothesis({candidate("drag_constant", form)}, torques_Nm);
    std::vector<ParameterResult> result(torques_Nm.size());
    for (std::size_t k = 0; k < result.size(); ++k) {
      result[k].name = k == 0 ? "torque" : "other_torque";
      result[k].value = torques_Nm[k];
    }
    add_implausible_drag(problem(), fit, 0, result);
    std::vector<bool> each;
    for (const ParameterResult& r : result) each.push_back(r.plausible);
    return each;
  };
  using Each = std::vector<bool>;
  EXPECT_EQ(plausible({.name = "sun", .body = "sun"}, {4.9}), Each{true});
  EXPECT_EQ(plausible({.name = "sun", .body = "sun"}, {5.1}), Each{false});
  EXPECT_EQ(plausible({.name = "output", .body = "output"}, {7.9}), Each{true});
  EXPECT_EQ(plausible({.name = "output", .body = "output"}, {8.1}), Each{false});
  EXPECT_EQ(plausible({.name = "sun_and_output", .body = "sun"}, {4.9, 7.9}), (Each{true, true}));
  EXPECT_EQ(plausible({.name = "output_and_sun", .body = "output"}, {7.9, 5.1}),
            (Each{true, false}));
}

TEST_F(RowDrag, OfOtherCausesIsNone) { EXPECT_TRUE(told("friction_level", "", 50.0).empty()); }

}  // namespace
}  // namespace gear3k::calibrate::row_drag_test
