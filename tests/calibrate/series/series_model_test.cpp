#include "calibrate/series/series_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "calibrate/series/joint_fit.hpp"
#include "calibrate/series/unit_differences.hpp"
#include "tests/calibrate/measured_grid.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::series_model_test {
namespace {

/// Two parameters of the design in four gearboxes of unlike errors, with correlated errors.
struct Series {
  std::vector<SeriesCause> causes;
  std::vector<Eigen::MatrixXd> covariance;
};
Series two_causes() {
  Series s;
  std::vector<FinalFit> fits;
  rig::DeterministicRandom random(4);
  for (int u = 0; u < 4; ++u) {
    FinalFit fit;
    fit.hypothesis.value = {1.0 + 0.2 * random.normal(), -3.0 + 0.1 * random.normal()};
    const double a = random.between(0.05, 0.2);
    const double b = random.between(0.05, 0.2);
    fit.covariance = Eigen::Matrix2d{{a * a, 0.4 * a * b}, {0.4 * a * b, b * b}};
    fit.at_bound = {false, false};
    fit.determined = {true, true};
    fit.degrees = 7;
    fits.push_back(fit);
    s.covariance.push_back(fit.covariance);
  }
  for (const std::size_t k : {0U, 1U}) {
    SeriesCause cause{.id = k == 0 ? "clearance" : "drag_constant", .title = "", .form = {}};
    cause.parameters.push_back(
        *series_parameter(fits, ParameterRecord{"x", "1", -9.0, 9.0, -9.0, 9.0}, k));
    s.causes.push_back(cause);
  }
  return s;
}

TEST(SeriesModel, HasTheDeviationsOfTheMeans) {
  const Series s = two_causes();
  const ExtendedModel model = series_model(s.causes, s.covariance, {});
  ASSERT_EQ(model.covariance.size(), 4U);
  for (const std::size_t k : {0U, 1U}) {
    const RandomEffects& r = s.causes[k].parameters.front().effects;
    EXPECT_EQ(model.causes[k].value.front(), r.mean);
    EXPECT_NEAR(std::sqrt(model.covariance[3 * k]), r.mean_sd, 1e-12);
  }
  EXPECT_EQ(model.covariance[1], model.covariance[2]);
  EXPECT_GT(model.covariance[1], 0.0);
}

TEST(SeriesModel, KeepsLawsWithACovarianceOfItsSize) {
  const Series s = two_causes();
  ExtendedModel found;
  found.causes.push_back({.id = "clearance", .form = {}, .value = {1.1}});
  found.laws.push_back({.law = {}, .value = {2.0, 3.0}});
  found.covariance = {1e-8, 1e-9, 0.0, 1e-9, 4.0, 0.0, 0.0, 0.0, 9.0};
  const ExtendedModel model = series_model(s.causes, s.covariance, found);
  const std::size_t size = parameter_count(model);
  ASSERT_EQ(size, 3U);
  ASSERT_EQ(model.covariance.size(), size * size);
  EXPECT_EQ(model.laws.size(), 1U);
  EXPECT_EQ(model.causes.front().value.front(), 1.1);
  // Fitted to all rows: of gearboxes that differ the mean is known less well.
  EXPECT_NEAR(std::sqrt(model.covariance[0]), s.causes[0].parameters[0].effects.mean_sd, 1e-12);
  EXPECT_EQ(model.covariance[4], 4.0);
  EXPECT_EQ(model.covariance[8], 9.0);
  EXPECT_NEAR(model.covariance[1] / std::sqrt(model.covariance[0]), 1e-9 / 1e-4, 1e-12);
}

TEST(SeriesParameter, OfFewDegreesHasNoKnownError) {
  std::vector<FinalFit> fits(3);
  for (FinalFit& fit : fits) {
    fit.hypothesis.value = {1.0};
    fit.covariance = Eigen::MatrixXd::Constant(1, 1, 0.01);
    fit.at_bound = {false};
    fit.determined = {true};
    fit.degrees = 6;
  }
  fits[1].degrees = 2;
  const ParameterRecord record{"x", "1", -9.0, 9.0, -9.0, 9.0};
  const auto p = series_parameter(fits, record, 0);
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->units[0].sd, 0.1 * std::sqrt(6.0 / 4.0), 1e-12);
  EXPECT_TRUE(std::isnan(p->units[1].sd));
  fits[1].scale_is_known = true;
  EXPECT_NEAR(series_parameter(fits, record, 0)->units[1].sd, 0.1, 1e-12);
  fits[1].determined = fits[2].determined = {false};
  EXPECT_FALSE(series_parameter(fits, record, 0));
}

/// Gearboxes measured by the library's own simulation with the same causes in each.
class SeriesOfOneTruth : public testing::Test {
 protected:
  SeriesOfOneTruth()
      : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission),
        truth_(hypothesis({candidate("friction_level", {.name = "coefficient"}),
                           candidate("drag_constant", {.name = "sun", .body = "sun"})},
                          {0.5, 0.02})) {}

  void add(const SetPoints& set, double deviation, std::uint64_t seed) {
    MeasurementSet more = measured_grid(set);
    const Eigen::VectorXd y = simulated(simulation_, more, truth_).value();
    rig::DeterministicRandom random(seed);
    const int file = static_cast<int>(data_.files.size());
    data_.kind = Kind::kTransmission;
    data_.files.push_back("f" + std::to_string(file));
    data_.units.push_back("G" + std::to_string(file));
    for (std::size_t i = 0; i < more.rows.size(); ++i) {
      Observation row = more.rows[i];
      row.response = y[static_cast<Eigen::Index>(i)] + deviation * random.normal();
      row.file = file;
      data_.rows.push_back(row);
    }
  }

  Simulation simulation_;
  Hypothesis truth_;
  MeasurementSet data_;
};

TEST_F(SeriesOfOneTruth, WhatAGearboxDoesNotDetermineIsNoPartsOwn) {
  for (std::uint64_t u = 1; u <= 3; ++u) add({}, 0.002, u);
  SetPoints one_load;
  one_load.sun_speeds_rpm = {600.0};
  one_load.output_torques_Nm = {20.0};
  one_load.directions = {design::Direction::kForward};
  one_load.repeats = 12;
  add(one_load, 0.002, 4);
  const UnitSeries series = find_series(simulation_, data_, {});
  ASSERT_EQ(series.causes.size(), 2U);
  for (const SeriesCause& cause : series.causes) {
    EXPECT_EQ(cause.of, Origin::kDesign) << cause.id;
    for (const SeriesParameter& p : cause.parameters) {
      EXPECT_TRUE(std::isfinite(p.units[0].sd));
      EXPECT_TRUE(std::isnan(p.units[3].sd)) << cause.id;
      EXPECT_GT(p.effects.p_between, 1e-3) << cause.id;
    }
  }
}

/// What the score of a fit is but for what the causes weigh: with S = (n − p) σ².
double expected_score(const JointFit& fit) {
  double expected = 0.0;
  double rows = 0.0;
  std::vector<Eigen::VectorXd> value;
  std::vector<Eigen::MatrixXd> information;
  for (const UnitFit& f : fit.units) {
    const auto n = static_cast<double>(f.fit.residual.size());
    rows += n;
    expected += n * std::log(f.scale * f.scale) + n - 2.0;
    value.emplace_back(Eigen::Vector2d(f.fit.hypothesis.value[0], f.fit.hypothesis.value[1]));
    information.push_back(f.information);
  }
  const auto units = static_cast<double>(fit.units.size());
  return expected + random_effects_deviance(value, information) +
         2.0 * (std::log(rows) + std::log(units));
}

TEST_F(SeriesOfOneTruth, ScoreIsOfTheVarianceThatTheInformationHas) {
  std::vector<double> weight;
  for (std::uint64_t u = 1; u <= 3; ++u) {
    add({}, 0.002, u);
    const auto units = series_units(simulation_, data_);
    JointStart start = unfitted(units);
    for (Hypothesis& h : start.hypothesis) h = truth_;
    const JointFit fit = joint_fit(units, start_at(joint_fit(units, start)));
    weight.push_back(fit.score - expected_score(fit));
  }
  // What causes weigh does not depend on the data.
  EXPECT_NEAR(weight[1], weight[0], 1e-6);
  EXPECT_NEAR(weight[2], weight[0], 1e-6);
}

TEST_F(SeriesOfOneTruth, GearboxesOfFewRowsThatRunAreRefused) {
  for (std::uint64_t u = 1; u <= 3; ++u) add({}, 0.002, u);
  // Of the last gearbox all but five rows state what no simulation runs at.
  std::size_t left = 5;
  for (Observation& row : data_.rows) {
    if (row.file == 2 && left > 0 && left-- > 0) continue;
    if (row.file == 2) row.condition.output_torque_Nm = -1e9;
  }
  EXPECT_THROW(find_series(simulation_, data_, {}), std::invalid_argument);
  EXPECT_THROW(diagnose_series(simulation_, data_, {}), std::invalid_argument);
}

TEST_F(SeriesOfOneTruth, EffectsAndModelNameTheSameCauses) {
  // A drag and an offset of the sensor are hard to tell apart in one direction.
  SetPoints set;
  set.directions = {design::Direction::kForward};
  set.rotations = {1};
  set.repeats = 2;
  truth_ = hypothesis({candidate("drag_constant", {.name = "sun", .body = "sun"})}, {0.01});
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    data_ = {};
    for (std::uint64_t u = 1; u <= 5; ++u) add(set, 0.003, 10 * seed + u);
    const auto d = diagnose_series(simulation_, data_, {});
    ASSERT_TRUE(d);
    std::vector<std::string> effects;
    for (const Effect& effect : d->effects) effects.push_back(effect.id);
    std::vector<std::string> causes;
    for (const AppliedCause& cause : d->model.causes) causes.push_back(cause.id);
    EXPECT_EQ(causes, effects) << "seed " << seed;
  }
}

TEST_F(SeriesOfOneTruth, ADifferenceIsFoundAmongManyRows) {
  SetPoints set;
  set.repeats = 60;  // 2160 rows each
  for (std::uint64_t u = 1; u <= 6; ++u) add(set, 0.002, u);
  for (Observation& row : data_.rows) {
    if (row.file == 3 && row.condition.output_torque_Nm > 40.0) row.response += 0.002;
  }
  const auto units = series_units(simulation_, data_);
  JointStart start = unfitted(units);
  for (Hypothesis& h : start.hypothesis) h = truth_;
  const JointFit fit = joint_fit(units, start);
  const auto found = unit_differences(units, fit, 0.01, 1);
  EXPECT_TRUE(found[3].along);
  EXPECT_FALSE(found[0].along);
  EXPECT_EQ(found[3].p_value, unit_differences(units, fit, 0.01, 1)[3].p_value);
}

}  // namespace
}  // namespace gear3k::calibrate::series_model_test
