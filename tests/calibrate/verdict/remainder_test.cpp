#include "calibrate/verdict/remainder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "numerics/linear_algebra.hpp"
#include "tests/calibrate/measured_grid.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/sample.hpp"

namespace gear3k::calibrate::remainder_test {
namespace {

constexpr double kRate = 0.01;

class Structure : public testing::Test {
 protected:
  Structure()
      : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission),
        data_(campaign(Kind::kTransmission)) {}

  [[nodiscard]] Eigen::VectorXd rows(const std::function<double(const Condition&)>& value) const {
    Eigen::VectorXd y(static_cast<Eigen::Index>(data_.rows.size()));
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      y[i] = value(data_.rows[static_cast<std::size_t>(i)].condition);
    }
    return y;
  }
  [[nodiscard]] static Eigen::VectorXd noise(Eigen::Index n, std::uint64_t seed) {
    RandomBits random(seed);
    Eigen::VectorXd y(n);
    for (double& value : y) value = random.normal();
    return y;
  }
  /// What is found in a residual of unit noise.
  [[nodiscard]] RemainderSearch search(const Eigen::VectorXd& structure, std::uint64_t seed) const {
    const Problem p{.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
    Columns at;
    at.residual = structure + noise(structure.size(), seed);
    at.own = Eigen::MatrixXd(structure.size(), 0);
    return search_remainder(p, at, covariate_levels(data_), kRate, seed);
  }
  [[nodiscard]] int level(const char* name, const Condition& c, double Condition::*member) const {
    for (const Levels& l : covariate_levels(data_)) {
      if (l.name != name) continue;
      for (std::size_t i = 0; i < data_.rows.size(); ++i) {
        if (data_.rows[i].condition.*member == c.*member) return l.of[i];
      }
    }
    return -1;
  }
  static double losing(const Condition& c) {
    return c.direction == design::Direction::kForward ? 1.0 : -1.0;
  }
  /// Share of a structure's squares outside the space of columns.
  static double outside(const Eigen::MatrixXd& columns, const Eigen::VectorXd& structure) {
    const Eigen::VectorXd left = structure - columns * numerics::least_squares(columns, structure);
    return left.squaredNorm() / structure.squaredNorm();
  }

  Simulation simulation_;
  MeasurementSet data_;
};

TEST_F(Structure, OfALossBySpeedTakesAValueForEachSpeed) {
  // What is lost adds to the sun's torque forward and takes from it backward: five numbers, one a
  // speed, say it all.
  const std::array<double, 5> lost{1.2, -1.0, 1.1, -1.3, 0.9};
  const Eigen::VectorXd structure = rows([&](const Condition& c) {
    const int k = level("speed", c, &Condition::sun_speed_rad_s);
    return losing(c) * lost.at(static_cast<std::size_t>(k));
  });
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RemainderSearch found = search(structure, seed);
    EXPECT_LE(found.p_value, kRate);
    EXPECT_EQ(found.best.along, "speed");
    EXPECT_EQ(found.best.columns.cols(), 5);
    EXPECT_LT(outside(found.best.columns, structure), 1e-12);
  }
}

TEST_F(Structure, AlongMoreTorquesThanRepeatsIsFoundByNeighboursTogether) {
  // Two loops of seven torques: a level of two rows each would explain anything.
  data_ = {};
  data_.kind = Kind::kTorqueAngle;
  for (int k = 0; k < 14; ++k) {
    Observation row;
    row.condition.test_torque_Nm = 2.0 * (k % 7);
    row.line = k < 7 ? 1 : 500;
    data_.rows.push_back(row);
  }
  const Eigen::VectorXd structure = rows([](const Condition& c) {
    return c.test_torque_Nm < 4.0 ? -30.0 : c.test_torque_Nm > 8.0 ? -20.0 : 25.0;
  });
  const RemainderSearch found = search(structure, 1);
  EXPECT_EQ(found.best.along, "test torque");
  ASSERT_FALSE(found.tests.empty());
  EXPECT_EQ(found.tests.front().name, "test torque");
  EXPECT_EQ(found.tests.front().degrees, 3);  // four groups, less what all share
  EXPECT_LT(found.tests.front().p_value, kRate);
}

TEST_F(Structure, OfALossInOneCornerTakesOneValue) {
  const Eigen::VectorXd structure = rows([&](const Condition& c) {
    const bool here = level("speed", c, &Condition::sun_speed_rad_s) == 3 &&
                      level("load", c, &Condition::output_torque_Nm) == 1;
    return here ? 4.0 * losing(c) : 0.0;
  });
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RemainderSearch found = search(structure, seed);
    EXPECT_LE(found.p_value, kRate);
    EXPECT_EQ(found.best.columns.cols(), 1);
    EXPECT_LT(outside(found.best.columns, structure), 1e-12);
  }
}

TEST_F(Structure, OfAWaveInTimeIsFoundByItsNumberOfPeriods) {
  const std::vector<double> time = column_of(data_, &Condition::time_s);
  const double first = std::ranges::min(time);
  const double last = std::ranges::max(time);
  constexpr double kPeriods = 17.0;  // too many for levels of time
  const Eigen::VectorXd structure = rows([&](const Condition& c) {
    return 1.2 * std::cos(2.0 * std::numbers::pi * kPeriods * (c.time_s - first) / (last - first));
  });
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RemainderSearch found = search(structure, seed);
    EXPECT_LE(found.p_value, kRate);
    EXPECT_EQ(found.best.along, "time");
    EXPECT_NEAR(found.best.order, kPeriods, 0.5);
  }
}

TEST_F(Structure, OfAWaveInTheAngleIsFoundByItsOrder) {
  constexpr double kOrder = 7.3;
  const Eigen::VectorXd structure =
      rows([&](const Condition& c) { return 1.2 * std::cos(kOrder * c.output_angle_rad + 0.4); });
  const std::vector<double> angle = column_of(data_, &Condition::output_angle_rad);
  const auto [low, high] = std::ranges::minmax(angle);
  const RemainderSearch found = search(structure, 1);
  EXPECT_LE(found.p_value, kRate);
  EXPECT_EQ(found.best.along, "angle");
  // Within the resolution of the angles that were passed.
  EXPECT_NEAR(found.best.order, kOrder, 2.0 * std::numbers::pi / (high - low));
}

TEST_F(Structure, HasPValuesOfTheChiSquaresAndDegreesThatAreTold) {
  // A covariate with blanks: its levels and the rows without one are no longer the mean.
  Covariate oil{.name = "oil", .value = {}};
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    oil.value.push_back(i % 4 == 0 ? kUnknown : static_cast<double>(i % 4));
  }
  data_.covariates.push_back(oil);
  const RemainderSearch found =
      search(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data_.rows.size())), 3);
  const auto named = [&](const char* name) {
    return *std::ranges::find(found.tests, name, &CovariateTest::name);
  };
  EXPECT_EQ(named("oil").degrees, 3);
  EXPECT_EQ(named("rotation").degrees, 1);
  for (const CovariateTest& test : found.tests) {
    const double p = cdf(complement(boost::math::chi_squared(test.degrees), test.statistic));
    // Of two tests the clearer, or of all orders the best.
    double choices = test.name == "direction" ? 1.0 : 2.0;
    if (test.name == "angle") choices = static_cast<double>(found.periodogram.order.size());
    if (test.name == "time" && test.degrees == 2) continue;  // levels and a wave
    EXPECT_NEAR(test.p_value, std::min(1.0, choices * p), 1e-9) << test.name;
  }
}

TEST_F(Structure, OfNoiseIsThereAsOftenAsItsPValueSays) {
  // Along levels and products, along the angle and along time: three searches, one statement.
  data_ = thinned(data_, 3);
  const int cases = sample(120, 250);
  constexpr double kChance = 0.2;
  int passed = 0;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data_.rows.size()));
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(cases); ++seed) {
    if (search(none, seed).p_value <= kChance) ++passed;
  }
  // At most the stated share; 3.5 deviations of the count are allowed for: 33 % of 120 cases.
  const double deviation = std::sqrt(kChance * (1.0 - kChance) / cases);
  EXPECT_LT(static_cast<double>(passed) / cases, kChance + 3.5 * deviation);
  EXPECT_GT(passed, 0);
}

}  // namespace
}  // namespace gear3k::calibrate::remainder_test
