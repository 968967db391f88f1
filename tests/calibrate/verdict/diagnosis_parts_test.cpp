// Parts of a diagnosis by themselves: noise floor, outliers, extrapolation, p-values, few rows.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "calibrate/fit/holdout.hpp"
#include "calibrate/fit/parameter_results.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "numerics/linear_algebra.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/friction_jump.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::diagnosis_parts_test {
namespace {

constexpr double kSigma = 0.004;

class Part : public Bench {
 protected:
  [[nodiscard]] Diagnosis diagnosed() const { return *diagnose(simulation_, data_, {}); }
  static Hypothesis sensor(double gain, double offset) {
    return hypothesis({candidate("sensor_gain", {.name = "gain"}),
                       candidate("sensor_offset", {.name = "offset"})},
                      {gain, offset});
  }
};

// Noise

TEST_F(Part, NoiseFloorOfRepeatsIsTheHiddenDeviation) {
  data_ = measured_grid({.repeats = 6});
  std::set<std::tuple<double, double, int, int>> conditions;
  for (const Observation& row : data_.rows) {
    const Condition& c = row.condition;
    conditions.insert(
        {c.sun_speed_rad_s, c.output_torque_Nm, static_cast<int>(c.direction), c.rotation});
  }
  const auto degrees = static_cast<int>(data_.rows.size() - conditions.size());
  const boost::math::chi_squared law(degrees);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    measure(hypothesis({candidate("friction_level", {.name = "coefficient"})}, {0.3}), kSigma,
            seed);
    const Diagnosis d = diagnosed();
    EXPECT_EQ(d.noise_source, NoiseSource::kRepeats);
    EXPECT_EQ(d.repeat_degrees, degrees);
    // (n − cells) s²/σ² is χ² distributed; one case in 10⁴ lies outside on either side.
    const double reduced = degrees * std::pow(d.errors.noise_floor / kSigma, 2);
    EXPECT_GT(reduced, quantile(law, 1e-4));
    EXPECT_LT(reduced, quantile(complement(law, 1e-4)));
  }
}

TEST_F(Part, NoiseFloorIsTheStatedOneWhereItIsStated) {
  data_ = measured_grid({.repeats = 6});
  measure({}, kSigma, 1);
  for (Observation& row : data_.rows) row.sigma = kSigma;
  const Diagnosis d = diagnosed();
  EXPECT_EQ(d.noise_source, NoiseSource::kStated);
  EXPECT_NEAR(d.errors.noise_floor, kSigma, 1e-12);
}

TEST_F(Part, NoiseFloorIsThatOfTheRowsWhereTheyScatterFarOtherwise) {
  data_ = measured_grid({.repeats = 6});
  const Hypothesis drag =
      hypothesis({candidate("drag_constant", {.name = "sun", .body = "sun"})}, {0.02});
  for (const double factor : {1e4, 3.0, 0.4}) {
    for (const Hypothesis& truth : {Hypothesis{}, drag}) {
      measure(truth, kSigma, 1);
      for (Observation& row : data_.rows) row.sigma = factor * kSigma;
      const Diagnosis d = diagnosed();
      EXPECT_EQ(d.noise_source, NoiseSource::kRepeats) << factor;
      EXPECT_NEAR(d.errors.noise_floor, kSigma, 0.15 * kSigma) << factor;
      EXPECT_NEAR(d.stated_noise, factor * kSigma, 1e-9) << factor;
      EXPECT_TRUE(std::ranges::any_of(
          d.notes, [](const std::string& n) { return n.find("stated sigma") != n.npos; }));
      // Neither reads as structure, nor hides what there is.
      EXPECT_EQ(d.verdict, truth.effects.empty() ? Verdict::kNoDiscrepancy : Verdict::kExplained)
          << factor;
      EXPECT_FALSE(d.correction.has_value());
      EXPECT_EQ(d.model.causes.size(), truth.effects.size());
    }
  }
}

TEST_F(Part, WithoutADiscrepancyTheModelAddsNothing) {
  // A gain of a third of the noise: most often not found, and often what predicts better.
  int refits = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    data_ = measured_grid({.sun_speeds_rpm = {200.0, 1000.0}});
    measure(hypothesis({candidate("sensor_gain", {.name = "gain"})}, {0.006}), 2.0 * kSigma, seed);
    const Diagnosis d = diagnosed();
    if (d.verdict != Verdict::kNoDiscrepancy) continue;
    EXPECT_TRUE(d.model.causes.empty()) << seed;
    EXPECT_FALSE(d.correction.has_value()) << seed;
    if (d.refit && d.refit->refit_error < 0.95 * d.refit->found_error) ++refits;
  }
  EXPECT_GE(refits, 1);
}

TEST_F(Part, NoiseFloorIsOfWhatIsLeftWhereNothingWasRepeated) {
  data_ = measured_grid({.sun_speeds_rpm = {200.0, 400.0, 600.0, 800.0, 1000.0},
                         .output_torques_Nm = {5.0, 15.0, 25.0, 35.0, 45.0}});
  measure({}, kSigma, 2);
  const Diagnosis d = diagnosed();
  EXPECT_EQ(d.noise_source, NoiseSource::kResiduals);
  EXPECT_EQ(d.repeat_degrees, 0);
  EXPECT_NEAR(d.errors.noise_floor, kSigma, 0.3 * kSigma);
}

TEST_F(Part, OutliersAreRowsThatNoiseDoesNotReach) {
  data_ = measured_grid({.repeats = 4});
  measure({}, kSigma, 3);
  constexpr std::size_t kFar = 20;
  constexpr std::size_t kNear = 50;
  data_.rows[kFar].response = clean_[kFar] + 6.0 * kSigma;
  data_.rows[kNear].response = clean_[kNear] - 3.0 * kSigma;
  const Diagnosis d = diagnosed();
  ASSERT_TRUE(d.effects.empty());
  ASSERT_EQ(d.rows.size(), data_.rows.size());
  for (std::size_t i = 0; i < d.rows.size(); ++i) EXPECT_EQ(d.rows[i].outlier, i == kFar) << i;
}

TEST_F(Part, SessionsThatScatterAreStepsOfAllSessionsAndNoOutliers) {
  data_ = measured_grid({.repeats = 6});
  data_.runs = {"1", "2", "3", "4", "5", "6"};
  const std::size_t rows = data_.rows.size() / 6;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.run = static_cast<int>(i / rows);
    data_.rows[i].sigma = kSigma;
  }
  for (const double deviations : {1.3, 5.0}) {
    measure({}, kSigma, 6);
    // The deviation of the six values about their mean of 0, of which every row has one.
    double squares = 0.0;
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      const double off =
          deviations * kSigma * std::array{1.1, -0.9, 0.8, -1.2, 1.1, -0.9}.at(i / rows);
      data_.rows[i].response += off;
      squares += off * off;
    }
    const Diagnosis d = diagnosed();
    ASSERT_EQ(d.effects.size(), 1U) << deviations;
    EXPECT_EQ(d.effects[0].id, "run_step");
    const double hidden = std::sqrt(6.0 / 5.0 * squares / static_cast<double>(data_.rows.size()));
    const auto& parameters = d.effects[0].parameters;
    const auto found = std::ranges::find(parameters, "session_deviation", &ParameterResult::name);
    ASSERT_NE(found, parameters.end());
    EXPECT_NEAR(found->value, hidden, 0.3 * hidden);
    EXPECT_LE(found->low, hidden);
    EXPECT_GE(found->high, hidden);
    EXPECT_TRUE(std::ranges::none_of(d.rows, &RowResult::outlier)) << deviations;
  }
}

TEST_F(Part, FewRowsTakeTheirStatedScatterForIntervalsToo) {
  data_ = measured_grid({.sun_speeds_rpm = {600.0}, .output_torques_Nm = {20.0}, .repeats = 2});
  const Hypothesis offset = hypothesis({candidate("sensor_offset", {.name = "offset"})}, {0.03});
  // Rows that happen to lie within a hundredth of what they state.
  measure(offset, 0.01 * kSigma, 2);
  for (Observation& row : data_.rows) row.sigma = kSigma;
  const FinalFit few = final_fit(problem(), offset, 1.0);
  const auto mean_of_8 = kSigma / std::sqrt(8.0);
  EXPECT_NEAR(std::sqrt(few.covariance(0, 0)), mean_of_8, 1e-9);
  const ParameterResult result = parameter_results(simulation_, few, 0).at(0);
  EXPECT_NEAR(result.high - result.low, 2.0 * 1.959964 * mean_of_8, 1e-7);
  // As many as say for themselves how they scatter do so.
  data_ = measured_grid({.repeats = 2});
  measure(offset, 0.01 * kSigma, 2);
  for (Observation& row : data_.rows) row.sigma = kSigma;
  const FinalFit many = final_fit(problem(), offset, 1.0);
  EXPECT_LT(std::sqrt(many.covariance(0, 0)), 0.1 * kSigma / std::sqrt(72.0));
}

// Held out and beyond

TEST_F(Part, RowsOfUnequalNoiseCountByTheirOwnInTheGain) {
  // A drag far above the noise of one half of the rows and far below that of the other.
  data_ = measured_grid({.repeats = 4});
  const auto half = data_.rows.size() / 2;
  measure(hypothesis({candidate("drag_constant", {.name = "sun", .body = "sun"})}, {0.004}), 1.0,
          9);
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    Observation& row = data_.rows[i];
    const double clean = clean_[static_cast<Eigen::Index>(i)];
    row.sigma = i < half ? 0.0005 : 0.05;
    row.response = clean + (row.response - clean) * row.sigma;
  }
  const Diagnosis d = diagnosed();
  ASSERT_EQ(d.effects.size(), 1U);
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const Observation& row = data_.rows[i];
    before += std::pow((row.response - d.rows[i].baseline) / row.sigma, 2);
    after += std::pow((row.response - d.rows[i].holdout) / row.sigma, 2);
  }
  EXPECT_NEAR(d.errors.weighted_gain, 1.0 - std::sqrt(after / before), 1e-9);
  // 0.004 of 0.0005 in half of the rows: χ² of 1 + 32 a row before, 1 after.
  EXPECT_NEAR(d.errors.weighted_gain, 1.0 - 1.0 / std::sqrt(33.0), 0.03);
  for (Observation& row : data_.rows) row.sigma = kSigma;
  EXPECT_TRUE(std::isnan(diagnosed().errors.weighted_gain));
}

TEST_F(Part, ARowFarOffPullsPredictionsNoMoreThanOneLessFarOff) {
  data_ = measured_grid({.repeats = 2});
  const Hypothesis h = sensor(0.02, 0.01);
  measure(h, kSigma, 4);
  const Blocks blocks = holdout_blocks(data_, covariate_levels(data_));
  ASSERT_GE(blocks.count, 3);
  constexpr std::size_t kRow = 7;
  const auto predicted = [&](double off) {
    data_.rows[kRow].response = clean_[kRow] + off * kSigma;
    return predict_held_out(problem(), h, blocks);
  };
  const Eigen::VectorXd far = predicted(1e2);
  const Eigen::VectorXd farther = predicted(1e6);
  EXPECT_LT((farther - far).cwiseAbs().maxCoeff(), 1e-9);
  // And hardly more than if it were within the noise.
  EXPECT_LT((farther - predicted(0.0)).cwiseAbs().maxCoeff(), kSigma);
}

TEST_F(Part, ALawThroughEveryLevelClaimsNothingOfWhatLiesBetween) {
  // Another coefficient of friction at each of four loads, at one speed: without a load the law
  // goes through all others, and rows left out of every load alike would be no test.
  constexpr double kNoise = 5e-4;
  data_ = friction_jump(kNoise, 5);
  const Diagnosis d = diagnosed();
  ASSERT_EQ(d.effects.size(), 1U);
  ASSERT_EQ(d.effects.front().id, "friction_load");
  EXPECT_LT(d.errors.extended_train, 1.3 * kNoise);
  EXPECT_EQ(d.holdout_blocks, "");
  EXPECT_TRUE(std::isnan(d.errors.extended_holdout));
  EXPECT_FALSE(d.refit.has_value());
  EXPECT_FALSE(d.correction.has_value());
  ASSERT_EQ(d.model.causes.size(), 1U);
  EXPECT_EQ(d.model.causes.front().id, "friction_load");
  for (const RowResult& row : d.rows) EXPECT_TRUE(std::isnan(row.holdout));
  EXPECT_EQ(std::ranges::count_if(d.notes,
                                  [](const std::string& note) {
                                    return note.find("between the levels was not measured") !=
                                           std::string::npos;
                                  }),
            1);
}

TEST_F(Part, AnExactLawIsExactBeyondWhatItWasFittedTo) {
  data_ = measured_grid({.output_torques_Nm = {5.0, 20.0, 35.0, 50.0}});
  const Hypothesis h = sensor(0.04, 0.003);
  measure(h, 0.0, 1);
  const Eigen::VectorXd y = measured(data_);
  const Eigen::VectorXd baseline = simulated(simulation_, data_, {}).value();
  const Extrapolation e = extrapolate(problem(), h, covariate_levels(data_), y, baseline);
  EXPECT_EQ(e.along, "load");
  EXPECT_NEAR(e.left_out, 50.0, 1e-12);
  double squares = 0.0;
  int rows = 0;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    if (data_.rows[i].condition.output_torque_Nm != 50.0) continue;
    const auto k = static_cast<Eigen::Index>(i);
    squares += (y[k] - baseline[k]) * (y[k] - baseline[k]);
    ++rows;
  }
  EXPECT_EQ(e.rows, rows);
  EXPECT_NEAR(e.baseline, std::sqrt(squares / rows), 1e-12);
  EXPECT_NEAR(e.extended, 0.0, 1e-12);
}

TEST_F(Part, BeyondWhatItWasFittedToARefitWithoutTheHighestLoadPredicts) {
  data_ = measured_grid({.output_torques_Nm = {5.0, 20.0, 35.0, 50.0}, .repeats = 2});
  const Hypothesis h = sensor(0.04, 0.003);
  measure(h, 0.0, 1);
  rig::DeterministicRandom random(8);
  for (Observation& row : data_.rows) row.response += random.between(-kSigma, kSigma);
  const Eigen::VectorXd y = measured(data_);
  const Eigen::VectorXd torque = simulated(simulation_, data_, {}).value();
  const Extrapolation e = extrapolate(problem(), h, covariate_levels(data_), y, torque);
  // y − T = g T + b s on the rows below, by a QR decomposition.
  Eigen::MatrixXd line(y.size(), 2);
  Eigen::VectorXd below = Eigen::VectorXd::Zero(y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const Condition& c = data_.rows[static_cast<std::size_t>(i)].condition;
    line.row(i) << torque[i],
        (c.direction == design::Direction::kForward ? c.rotation : -c.rotation);
    below[i] = c.output_torque_Nm < 50.0 ? 1.0 : 0.0;
  }
  const Eigen::MatrixXd x = below.asDiagonal() * line;
  const Eigen::Vector2d fitted = numerics::least_squares(x, (y - torque).cwiseProduct(below));
  const Eigen::VectorXd error =
      (y - torque - line * fitted).cwiseProduct(Eigen::VectorXd::Ones(y.size()) - below);
  EXPECT_NEAR(e.extended, std::sqrt(error.squaredNorm() / e.rows), 1e-9);
}

// Chance

TEST_F(Part, FewRowsFarOutsideTheirStatedScatterAreUnexplained) {
  // One condition six times, 2.9 deviations up and down: nothing that varies could cause it.
  data_ = measured_grid({.sun_speeds_rpm = {600.0},
                         .output_torques_Nm = {20.0},
                         .directions = {design::Direction::kForward},
                         .rotations = {1},
                         .repeats = 6});
  const auto scatter = [&](double deviations) {
    measure({}, 0.0, 1);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response += (i % 2 == 0 ? 1.0 : -1.0) * deviations * kSigma;
      data_.rows[i].sigma = kSigma;
    }
    return diagnosed();
  };
  const Diagnosis far = scatter(2.9);
  EXPECT_EQ(far.verdict, Verdict::kUnexplained);
  EXPECT_TRUE(far.effects.empty());
  // P(χ²_6 ≥ x) = e^(−x/2) (1 + x/2 + x²/8).
  const double x = 6.0 * 2.9 * 2.9;
  const double p = std::exp(-0.5 * x) * (1.0 + 0.5 * x + 0.125 * x * x);
  EXPECT_NEAR(far.remainder.p_value, p, 1e-9 * p);
  const Diagnosis near = scatter(1.0);
  EXPECT_EQ(near.verdict, Verdict::kNoDiscrepancy);
  EXPECT_FALSE(near.remainder.significant);
}

TEST_F(Part, AScatterOfThriceTheStatedOneBesideACauseIsTheNoiseOfTheRows) {
  data_ = measured_grid({.sun_speeds_rpm = {200.0, 400.0, 600.0, 800.0, 1000.0},
                         .output_torques_Nm = {10.0, 20.0, 30.0, 40.0, 50.0}});
  measure(hypothesis({candidate("drag_constant", {.name = "sun", .body = "sun"})}, {0.015}), 0.006,
          3);
  for (Observation& row : data_.rows) row.sigma = 0.002;
  const Diagnosis d = diagnosed();
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_FALSE(d.remainder.significant);
  EXPECT_EQ(d.noise_source, NoiseSource::kResiduals);
  EXPECT_NEAR(d.errors.noise_floor, 0.006, 0.2 * 0.006);
  EXPECT_NEAR(d.stated_noise, 0.002, 1e-12);
  // As where the rows state it themselves.
  for (Observation& row : data_.rows) row.sigma = 0.006;
  const Diagnosis right = diagnosed();
  EXPECT_EQ(right.verdict, d.verdict);
  EXPECT_EQ(right.noise_source, NoiseSource::kStated);
  EXPECT_EQ(right.effects.at(0).id, d.effects[0].id);
  EXPECT_NEAR(right.effects[0].parameters[0].value, d.effects[0].parameters[0].value, 1e-9);
}

TEST_F(Part, ThePValueIsThatOfTheGreatestFindingWhateverItIs) {
  // Cells of load and speed off up and down at random: no cause does that, and all of it shows in
  // the remainder.
  data_ = measured_grid({.sun_speeds_rpm = {200.0, 400.0, 600.0, 800.0, 1000.0},
                         .output_torques_Nm = {5.0, 20.0, 35.0, 50.0},
                         .repeats = 2});
  measure({}, kSigma, 5);
  rig::DeterministicRandom random(3);
  for (const double speed : {200.0, 400.0, 600.0, 800.0, 1000.0}) {
    for (const double load : {5.0, 20.0, 35.0, 50.0}) {
      const double off = random.uniform() < 0.5 ? -kSigma : kSigma;
      for (Observation& row : data_.rows) {
        if (std::abs(row.condition.sun_speed_rad_s - speed * std::numbers::pi / 30.0) < 1e-6 &&
            row.condition.output_torque_Nm == load) {
          row.response += off;
        }
      }
    }
  }
  const Diagnosis d = diagnosed();
  ASSERT_TRUE(d.remainder.significant);
  ASSERT_TRUE(d.effects.empty());
  EXPECT_EQ(d.p_value, d.remainder.p_value);
  EXPECT_GT(d.remainder.share, 0.2);
  EXPECT_LE(d.remainder.share, 1.0);
}

}  // namespace
}  // namespace gear3k::calibrate::diagnosis_parts_test
