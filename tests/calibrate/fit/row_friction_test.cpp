#include "calibrate/fit/row_friction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "design/evaluation.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::row_friction_test {
namespace {

class RowFriction : public Bench {
 protected:
  RowFriction() : design_(design_of(rig::bilateral_drive_gear())) {
    data_ = measured_grid({});
    data_.runs = {"first", "second"};
    double time_s = 0.0;
    for (Observation& row : data_.rows) {
      row.condition.time_s = time_s;
      time_s += 60.0;
      row.condition.run = row.condition.time_s < 1000.0 ? 0 : 1;
    }
    span_s_ = data_.rows.back().condition.time_s;
  }
  [[nodiscard]] double mu() const { return design_.friction.coefficient; }
  [[nodiscard]] Candidate level() const {
    return candidate("friction_level", {.name = "coefficient"});
  }
  [[nodiscard]] Candidate load(double reference_N) const {
    return candidate(
        "friction_load",
        {.name = "about_middle",
         .constants = {{.name = "reference_load", .unit = "N", .value = reference_N}}});
  }
  [[nodiscard]] Candidate drift() const {
    return candidate("drift",
                     {.name = "power_any_exponent_any_start_time_friction",
                      .constants = {{.name = "start", .unit = "s", .value = 0.0},
                                    {.name = "span", .unit = "s", .value = span_s_},
                                    {.name = "time_constant", .unit = "s", .value = span_s_}},
                      .law = kOnFriction});
  }
  [[nodiscard]] std::vector<ParameterResult> told(const Hypothesis& h, std::size_t effect) const {
    FinalFit fit;
    fit.degrees = 10;
    fit.hypothesis = h;
    const auto count = static_cast<Eigen::Index>(h.value.size());
    fit.covariance = 1e-4 * Eigen::MatrixXd::Identity(count, count);
    std::vector<ParameterResult> result;
    add_implausible_friction(problem(), fit, effect, result);
    return result;
  }

  design::Design design_;
  double span_s_ = 0.0;
};

TEST_F(RowFriction, OfAnotherLevelIsThatCoefficientOnEveryFlank) {
  const auto range = row_friction(problem(), hypothesis({level()}, {0.5})).value();
  EXPECT_NEAR(range.least, 1.5 * mu(), 1e-12);
  EXPECT_NEAR(range.greatest, 1.5 * mu(), 1e-12);
}

TEST_F(RowFriction, OfAPowerOfTheForceIsThatOfTheMeshesForces) {
  constexpr double kReference_N = 20.0, kExponent = -0.4;
  const auto range = row_friction(problem(), hypothesis({load(kReference_N)}, {kExponent})).value();
  // The forces of the gearbox as stated are those of the other friction within its losses.
  const auto geometry = *train::make_train_geometry(design::resolved_parameters(design_));
  const auto train = design::lossy_train(design_, geometry);
  double least = HUGE_VAL, greatest = 0.0;
  for (const Observation& row : data_.rows) {
    const auto at = design::operate<double>(train,
                                            {.sun_speed_rad_s = row.condition.sun_speed_rad_s,
                                             .output_torque_Nm = row.condition.output_torque_Nm,
                                             .temperature_K = 293.15},
                                            row.condition.direction);
    for (const auto& mesh : at.operation->mesh) {
      const double coefficient = mu() * std::pow(mesh.normal_force_N / kReference_N, kExponent);
      least = std::min(least, coefficient);
      greatest = std::max(greatest, coefficient);
    }
  }
  constexpr double kOfLosses = 0.1;
  EXPECT_NEAR(range.least, least, kOfLosses * least);
  EXPECT_NEAR(range.greatest, greatest, kOfLosses * greatest);
}

TEST_F(RowFriction, OfADriftIsThatOfTheFirstAndTheLastRow) {
  // change, ln of the exponent, value at the start
  const auto range = row_friction(problem(), hypothesis({drift()}, {2.0, 0.0, -0.25})).value();
  EXPECT_NEAR(range.least, 0.75 * mu(), 1e-12);
  EXPECT_NEAR(range.greatest, 2.75 * mu(), 1e-12);
}

TEST_F(RowFriction, ThatMaterialsShowIsNotTold) {
  // Threefold within a campaign, and a steep law between references that no row is near.
  EXPECT_TRUE(told(hypothesis({drift()}, {2.0, 0.0, 0.0}), 0).empty());
  EXPECT_TRUE(told(hypothesis({load(20.0)}, {-0.8}), 0).empty());
}

TEST_F(RowFriction, BelowNoneOrAboveThatOfCleanMetalsIsImplausible) {
  const auto negative = told(hypothesis({drift()}, {1.0, 0.0, -1.25}), 0);
  ASSERT_EQ(negative.size(), 1U);
  EXPECT_EQ(negative[0].name, "least_friction");
  EXPECT_FALSE(negative[0].plausible);
  EXPECT_NEAR(negative[0].value, -0.25 * mu(), 1e-12);
  // Of the three parameters the value at the start alone counts in the first row: deviation 0.01,
  // and 2.22814 of it by tables of Student's t for 10 degrees of freedom.
  EXPECT_NEAR(0.5 * (negative[0].high - negative[0].low), 2.22814 * 0.01 * mu(), 1e-6);

  // Three times what is stated, and four times that in the last row.
  const auto above = told(hypothesis({level(), drift()}, {2.0, 3.0, 0.0, 0.0}), 0);
  ASSERT_EQ(above.size(), 1U);
  EXPECT_EQ(above[0].name, "greatest_friction");
  EXPECT_NEAR(above[0].value, 12.0 * mu(), 1e-9);
}

TEST_F(RowFriction, IsNoMatterOfADrag) {
  const Hypothesis h =
      hypothesis({drift(), candidate("drag_constant", {.name = "sun", .body = "sun"})},
                 {1.0, 0.0, -1.25, 0.01});
  EXPECT_EQ(told(h, 0).size(), 1U);
  EXPECT_TRUE(told(h, 1).empty());
}

}  // namespace
}  // namespace gear3k::calibrate::row_friction_test
