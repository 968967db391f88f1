#include "calibrate/measurement/noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>

#include "calibrate/measurement/commanded_torque.hpp"

namespace gear3k::calibrate::noise_test {
namespace {

Observation row_at(double speed_rad_s, double torque_Nm, int run = 0) {
  Observation row;
  row.condition.sun_speed_rad_s = speed_rad_s;
  row.condition.output_torque_Nm = torque_Nm;
  row.condition.temperature_K = 300.0;
  row.condition.run = run;
  return row;
}

MeasurementSet set_of(std::vector<Observation> rows, std::size_t runs = 1) {
  MeasurementSet data;
  data.rows = std::move(rows);
  for (std::size_t k = 0; k < runs; ++k) data.runs.push_back(std::to_string(k));
  return data;
}

// Repeats

TEST(Repeats, AreRowsOfOneConditionWhateverAngleAndTime) {
  MeasurementSet data = set_of({row_at(20.0, 5.0), row_at(20.0, 50.0), row_at(100.0, 5.0),
                                row_at(20.0, 5.0), row_at(100.0, 5.0), row_at(20.0, 5.0)});
  for (std::size_t k = 0; k < data.rows.size(); ++k) {
    data.rows[k].condition.output_angle_rad = 10.0 * static_cast<double>(k);
    data.rows[k].condition.time_s = 60.0 * static_cast<double>(k);
  }
  const Repeats repeats = find_repeats(data);
  EXPECT_EQ(repeats.cell, (std::vector<int>{0, 1, 2, 0, 2, 0}));
  EXPECT_EQ(repeats.cells, 3);
  EXPECT_EQ(repeats.degrees, 3);
}

TEST(Repeats, DifferInEachPartOfTheirCondition) {
  const Observation same = row_at(20.0, 5.0);
  std::vector<Observation> rows{same, row_at(100.0, 50.0)};
  const auto add = [&](auto change) {
    rows.push_back(same);
    change(rows.back().condition);
  };
  add([](Condition& c) { c.direction = design::Direction::kBackward; });
  add([](Condition& c) { c.rotation = -1; });
  add([](Condition& c) { c.reference_sensor = true; });
  add([](Condition& c) { c.driving_teeth = 20; });
  add([](Condition& c) { c.driven_teeth = 20; });
  add([](Condition& c) { c.module_m = 2e-3; });
  add([](Condition& c) { c.test_torque_Nm = 1.0; });
  add([](Condition& c) { c.temperature_K = 310.0; });
  add([](Condition& c) { c.sun_speed_rad_s = 60.0; });
  add([](Condition& c) { c.output_torque_Nm = 20.0; });
  const Repeats repeats = find_repeats(set_of(rows, 2));
  EXPECT_EQ(repeats.cells, static_cast<int>(rows.size()));
  EXPECT_EQ(repeats.degrees, 0);
}

TEST(Repeats, WithoutAModuleAreThoseOfOneMillimetre) {
  MeasurementSet data = set_of({row_at(0.0, 5.0), row_at(0.0, 5.0), row_at(0.0, 5.0)});
  data.rows[1].condition.module_m = 1e-3;
  data.rows[2].condition.module_m = 1.01e-3;
  EXPECT_EQ(find_repeats(data).cell, (std::vector<int>{0, 0, 1}));
}

TEST(Repeats, AgreeToTwoPercentOfTheRange) {
  // Range 100 rad/s.  Within half a bin of its start a row repeats it, 2 % away never.
  const Repeats repeats = find_repeats(
      set_of({row_at(0.0, 5.0), row_at(100.0, 5.0), row_at(0.9, 5.0), row_at(2.5, 5.0)}));
  EXPECT_EQ(repeats.cell[2], repeats.cell[0]);
  EXPECT_NE(repeats.cell[3], repeats.cell[0]);
  // Twice the range: half as far.
  const Repeats wider = find_repeats(
      set_of({row_at(0.0, 5.0), row_at(200.0, 5.0), row_at(0.9, 5.0), row_at(2.5, 5.0)}));
  EXPECT_EQ(wider.cell[2], wider.cell[0]);
  EXPECT_EQ(wider.degrees, 1);
}

TEST(Repeats, AreThoseOfWhatWasSetNotOfWhatDrifted) {
  // Two set points, measured in turn over two sessions while the gearbox warms up.
  std::vector<Observation> rows;
  constexpr int kRows = 60;
  for (int k = 0; k < kRows; ++k) {
    rows.push_back(row_at(k % 2 == 0 ? 20.0 : 100.0, 5.0, k < kRows / 2 ? 0 : 1));
    rows.back().condition.temperature_K = 295.0 + 0.3 * k;
  }
  MeasurementSet data = set_of(rows, 2);
  const Repeats drifting = find_repeats(data);
  EXPECT_EQ(drifting.cells, 2);
  EXPECT_EQ(drifting.degrees, kRows - 2);
  // Three temperatures that were held: each with both speeds.
  for (int k = 0; k < kRows; ++k) {
    data.rows[static_cast<std::size_t>(k)].condition.temperature_K = 295.0 + 10.0 * (k / 20);
  }
  EXPECT_EQ(find_repeats(data).cells, 6);
}

TEST(NoiseModel, OfReadingsInStepsTheDeviationIsThatOfTheirSquares) {
  // Quantiles of a normal of deviation 1, read in steps of 0.6 to 2 deviations; the simulation, 10,
  // lies anywhere in its step.
  constexpr int kRows = 400;
  const boost::math::normal normal;
  for (const double step : {0.6, 1.0, 1.5, 2.0}) {
    for (const double origin : {0.0, 0.2, 0.5}) {
      std::vector<Observation> rows(kRows);
      Eigen::VectorXd missed(kRows);
      for (int k = 0; k < kRows; ++k) {
        const double analog = 10.0 + quantile(normal, (k + 0.5) / kRows);
        const double read = step * (std::round(analog / step - origin) + origin);
        rows[static_cast<std::size_t>(k)].response = read;
        missed[k] = read - 10.0;
      }
      MeasurementSet data = set_of(std::move(rows));
      data.kind = Kind::kLostMotion;
      const NoiseModel noise = make_noise_model(data);
      EXPECT_NEAR(noise.step, step, 1e-9);
      // The median of the rows themselves is 0 or a step.
      const double squares = root_mean_square(missed);
      EXPECT_NEAR(noise.deviation_of(missed), squares, 0.25 * squares) << step << " " << origin;
      EXPECT_NEAR(noise.least_scale(), step / std::sqrt(12.0), 1e-9);
    }
  }
}

TEST(LackOfFit, ComparesWhatCellsMissWithHowRepeatsScatter) {
  // Two cells of three: means 2 and −1 against a simulation of 0.
  Repeats repeats;
  repeats.cell = {0, 0, 0, 1, 1, 1};
  repeats.cells = 2;
  repeats.degrees = 4;
  Eigen::VectorXd y(6);
  y << 1.0, 2.0, 3.0, -1.5, -1.0, -0.5;
  const LackOfFit lack = lack_of_fit(repeats, y);
  // Between: 3·4 + 3·1 = 15 over 2 degrees; within: 2 + 0.5 over 4.
  EXPECT_DOUBLE_EQ(lack.f, 7.5 / 0.625);
  EXPECT_EQ(lack.degrees, 2);
  EXPECT_EQ(lack.pure_degrees, 4);
  // For 2 degrees above, P(F >= f) = (1 + 2 f/4)^(−2).
  EXPECT_NEAR(lack.p_value, std::pow(1.0 + 0.5 * lack.f, -2.0), 1e-14);
  // A mean taken off both: 1.5²·6 less between, over one degree.
  const LackOfFit beside_mean = lack_of_fit(repeats, y - Eigen::VectorXd::Constant(6, 0.5), 1);
  EXPECT_DOUBLE_EQ(beside_mean.f, 13.5 / 0.625);
  EXPECT_EQ(beside_mean.degrees, 1);
  EXPECT_EQ(lack_of_fit(repeats, y, 2).pure_degrees, 0);
  repeats.degrees = 0;
  EXPECT_EQ(lack_of_fit(repeats, y).pure_degrees, 0);
  EXPECT_EQ(lack_of_fit(repeats, y).p_value, 1.0);
}

TEST(Repeats, NeedNoTemperature) {
  MeasurementSet data = set_of({row_at(20.0, 5.0), row_at(20.0, 5.0), row_at(20.0, 50.0)});
  for (Observation& row : data.rows) row.condition.temperature_K = kUnknown;
  const Repeats repeats = find_repeats(data);
  EXPECT_EQ(repeats.cell, (std::vector<int>{0, 0, 1}));
}

TEST(Repeats, ARowWithoutTemperatureLeavesTheOthersApart) {
  MeasurementSet data =
      set_of({row_at(20.0, 5.0), row_at(20.0, 5.0), row_at(20.0, 5.0), row_at(20.0, 5.0)});
  data.rows[0].condition.temperature_K = 290.0;
  data.rows[1].condition.temperature_K = 320.0;
  data.rows[2].condition.temperature_K = kUnknown;
  data.rows[3].condition.temperature_K = 310.0;
  const Repeats repeats = find_repeats(data);
  EXPECT_NE(repeats.cell[0], repeats.cell[1]);
  EXPECT_NE(repeats.cell[1], repeats.cell[3]);
  EXPECT_NE(repeats.cell[0], repeats.cell[2]);
}

TEST(PureError, IsTheScatterAboutTheMeansOfCells) {
  Repeats repeats;
  repeats.cell = {0, 1, 0, 1, 1, 2};
  repeats.cells = 3;
  repeats.degrees = 3;
  Eigen::VectorXd y(6);
  y << 1.0, 2.0, 3.0, 2.0, 5.0, 100.0;
  // Means 2, 3, 100: 1 + 1 + 1 + 1 + 4 + 0.
  const PureError error = pure_error(repeats, y);
  EXPECT_DOUBLE_EQ(error.sum_of_squares, 8.0);
  EXPECT_EQ(error.degrees, 3);
}

TEST(Resolution, IsTheUnitOfTheLastDigit) {
  MeasurementSet data = set_of({row_at(20.0, 5.0), row_at(20.0, 5.0), row_at(20.0, 5.0)});
  const auto measured = [&](double a, double b, double c) {
    data.rows[0].response = a;
    data.rows[1].response = b;
    data.rows[2].response = c;
    return resolution_of(data);
  };
  EXPECT_DOUBLE_EQ(measured(0.31, 0.5, 12.07), 0.01);
  EXPECT_DOUBLE_EQ(measured(0.3, 0.7, 12.1), 0.1);
  EXPECT_NEAR(measured(0.314767, 0.2, 0.9), 1e-6, 1e-18);
  EXPECT_EQ(measured(std::sqrt(2.0), 1.0 / 3.0, 0.9), 0.0);
  // Of an angle in its own unit.
  data.kind = Kind::kLostMotion;
  constexpr double kArcmin = 3.14159265358979323846 / 10800.0;
  EXPECT_NEAR(measured(6.01 * kArcmin, 5.09 * kArcmin, 7.5 * kArcmin), 0.01 * kArcmin, 1e-15);
  // Its deviation is that of an even spread over the unit; residuals within it are no discrepancy.
  data.kind = Kind::kTransmission;
  measured(0.31, 0.5, 12.07);
  const NoiseModel noise = make_noise_model(data);
  EXPECT_NEAR(noise.rounding, 0.01 / std::sqrt(12.0), 1e-15);
  EXPECT_TRUE(noise.within_rounding(Eigen::Vector3d(0.003, -0.002, 0.003)));
  EXPECT_FALSE(noise.within_rounding(Eigen::Vector3d(0.01, -0.002, 0.003)));
}

// Weights and sessions

TEST(NoiseModel, OfChangedResponsesHasTheDigitsOfTheReadings) {
  MeasurementSet data = set_of({row_at(20.0, 5.0), row_at(20.0, 5.0), row_at(20.0, 5.0)});
  data.rows[0].response = 0.31;
  data.rows[1].response = 0.5;
  data.rows[2].response = 12.07;
  data.readings = Readings{.resolution = resolution_of(data), .commanded = is_commanded(data)};
  for (Observation& row : data.rows) row.response += 0.1 * std::sqrt(2.0);
  EXPECT_DOUBLE_EQ(make_noise_model(data).rounding, 0.01 / std::sqrt(12.0));
  data.readings->commanded = true;
  EXPECT_EQ(make_noise_model(data).rounding, 0.0);
}

TEST(NoiseModel, TakesStatedDeviationsWhereEveryRowHasOne) {
  MeasurementSet data = set_of({row_at(20.0, 5.0), row_at(20.0, 5.0, 1), row_at(20.0, 5.0, 1)}, 2);
  data.rows[0].sigma = 0.5;
  data.rows[1].sigma = 2.0;
  const NoiseModel without = make_noise_model(data);
  EXPECT_NE(without.source, NoiseSource::kStated);
  EXPECT_EQ(without.weight, Eigen::VectorXd::Ones(3));
  EXPECT_EQ(without.rows_per_run, (std::vector<double>{1.0, 2.0}));
  data.rows[2].sigma = 4.0;
  const NoiseModel with = make_noise_model(data);
  EXPECT_EQ(with.source, NoiseSource::kStated);
  EXPECT_EQ(with.weight, Eigen::Vector3d(2.0, 0.5, 0.25));
}

TEST(NoiseModel, WeightsRowsInProportionWhereEveryOneTellsIt) {
  MeasurementSet data = set_of({row_at(20.0, 5.0), row_at(20.0, 50.0), row_at(60.0, 5.0)});
  data.rows[0].scatter = data.rows[1].scatter = 2.0;
  EXPECT_TRUE(make_noise_model(data).counts_rows_alike()) << "the third says nothing";
  data.rows[2].scatter = 1.0;
  const NoiseModel noise = make_noise_model(data);
  EXPECT_NE(noise.source, NoiseSource::kStated) << "a unit of theirs is not stated";
  EXPECT_NEAR(noise.weight[2] / noise.weight[0], 2.0, 1e-12);
  EXPECT_EQ(noise.weight[0], noise.weight[1]);
  EXPECT_NEAR(noise.weight.squaredNorm(), 3.0, 1e-12);
  for (Observation& row : data.rows) row.sigma = 0.1;
  EXPECT_TRUE(make_noise_model(data).counts_rows_alike()) << "what is stated comes first";
}

TEST(Whiten, MakesRowsOfScatteringSessionsIndependent) {
  // Unequal sessions, one row without any, unequal rows.
  std::vector<Observation> rows;
  const std::vector<int> run{0, 1, 0, 2, 2, 2, 2, -1, 1, 2};
  rows.reserve(run.size());
  for (std::size_t k = 0; k < run.size(); ++k) {
    rows.push_back(row_at(20.0, 5.0, run[k]));
    rows.back().sigma = 0.5 + 0.25 * static_cast<double>(k % 4);
  }
  NoiseModel noise = make_noise_model(set_of(rows, 3));
  const auto n = static_cast<Eigen::Index>(run.size());
  for (const double q : {0.0, 0.3, 5.0}) {
    noise.session_variance = q;
    // Covariance of the rows over scale²: their own, and that of the session, in units of rows of
    // weight 1.
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(n, n);
    for (std::size_t i = 0; i < run.size(); ++i) {
      for (std::size_t k = 0; k < run.size(); ++k) {
        const bool same = run[i] == run[k] && run[i] >= 0;
        if (same) covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) += q;
      }
    }
    for (std::size_t i = 0; i < run.size(); ++i) {
      covariance.row(static_cast<Eigen::Index>(i)) *= rows[i].sigma;
      covariance.col(static_cast<Eigen::Index>(i)) *= rows[i].sigma;
    }
    Eigen::MatrixXd w = Eigen::MatrixXd::Identity(n, n);
    noise.whiten(w);
    EXPECT_LT((w * covariance * w.transpose() - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-13)
        << q;
    EXPECT_LT((covariance * w.transpose() * w - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-13)
        << q;
  }
}

TEST(RobustDeviation, IsThatOfANormalSample) {
  constexpr int kCount = 2001;
  Eigen::VectorXd x(kCount);
  for (int k = 0; k < kCount; ++k) {
    x[k] = 3.0 * boost::math::quantile(boost::math::normal(), (k + 0.5) / kCount);
  }
  // A rank of the sample moves the median by 1/(n φ(0.674)) = 0.0016 σ.
  EXPECT_NEAR(robust_deviation(x), 3.0, 0.01);
  // A tenth of the rows far away: the quantile of 1/2 becomes that of 1/1.8.
  for (int k = 0; k < kCount; k += 10) x[k] = k % 20 == 0 ? 1e9 : -1e9;
  const double quantile = boost::math::quantile(boost::math::normal(), 0.5 + 0.25 / 0.9);
  const double third = boost::math::quantile(boost::math::normal(), 0.75);
  EXPECT_NEAR(robust_deviation(x), 3.0 * quantile / third, 0.02);
}

TEST(RobustDeviation, OfThreeNumbersIsTheMiddleOne) {
  // Upper quartile of the normal distribution in tables: 0.6745.
  EXPECT_NEAR(robust_deviation(Eigen::Vector3d(-2.0, 0.1, 30.0)), 2.0 / 0.6745, 2e-4);
  EXPECT_EQ(robust_deviation(Eigen::VectorXd(0)), 0.0);
}

}  // namespace
}  // namespace gear3k::calibrate::noise_test
