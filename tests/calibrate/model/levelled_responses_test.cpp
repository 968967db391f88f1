#include "calibrate/model/levelled_responses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrate/fit/linearisation.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::levelled_responses_test {
namespace {

class Levelled : public Bench {
 protected:
  Levelled() { data_ = measured_grid({.rotations = {1}}); }

  /// The simulation itself at a level.
  [[nodiscard]] double direct(std::size_t row, double level) const {
    Modification m;
    m.gearbox.friction.level = Scalar(level);
    return simulation_.response(data_.rows[row].condition, m)->a;
  }
};

TEST_F(Levelled, MeetTheSimulationWithinAnyRangeToAFactorOfFour) {
  const RowStates states(data_.rows);
  for (const double half : {0.02, 0.24, 0.26, 0.48, 0.52, std::log(2.0)}) {
    LevelRange range;
    range.include(std::exp(-half));
    range.include(std::exp(half));
    const LevelledResponses responses(states, simulation_, {}, range);
    for (std::size_t row = 0; row < data_.rows.size(); ++row) {
      const double change = std::abs(direct(row, 2.0) - direct(row, 0.5));
      for (const double share : {-1.0, -0.69, -0.1, 0.0, 0.39, 0.82, 1.0}) {
        const double level = std::exp(share * half);
        const Scalar y = *responses.of_row(row, Scalar(level, 3));
        EXPECT_NEAR(y.a, direct(row, level), 1e-5 * change) << level;
        const double step = 1e-3 * level;
        const double slope = (direct(row, level + step) - direct(row, level - step)) / (2.0 * step);
        EXPECT_NEAR(y.v[3], slope, 1e-3 * std::abs(slope)) << level;
        EXPECT_EQ(responses.by_level(row, Scalar(level, 3))->v[3], y.v[3]);
      }
    }
  }
}

TEST_F(Levelled, AtOneAreThoseOfTheSimulationBitForBit) {
  const RowStates states(data_.rows);
  LevelRange range;
  range.include(1.0);
  EXPECT_TRUE(range.varies());  // room for the derivative
  const LevelledResponses responses(states, simulation_, {}, range);
  for (std::size_t row = 0; row < data_.rows.size(); ++row) {
    EXPECT_EQ(responses.of_row(row, Scalar(1.0))->a, direct(row, 1.0));
  }
}

TEST_F(Levelled, HaveTheDerivativesOfTheGearboxBesideThoseOfTheLevel) {
  const RowStates states(data_.rows);
  Modification m;
  m.gearbox.drag[design::kSunShaft].constant_Nm = Scalar(0.01, 1);
  LevelRange range;
  range.include(1.5);
  const LevelledResponses responses(states, simulation_, m, range);
  for (std::size_t row = 0; row < data_.rows.size(); ++row) {
    // A drag at the sun adds forward and takes off backward, whatever the friction.
    const bool forward = data_.rows[row].condition.direction == design::Direction::kForward;
    EXPECT_NEAR(responses.of_row(row, Scalar(1.5, 2))->v[1], forward ? 1.0 : -1.0, 1e-9);
    EXPECT_EQ(responses.by_level(row, Scalar(1.5, 2))->v[1], 0.0);
  }
}

TEST_F(Levelled, OfAModelsFrictionWaveAreInItsSimulation) {
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.output_angle_rad = 0.3 * static_cast<double>(i);
  }
  const Form form{
      .name = "friction_with_second", .body = "output", .order = 1.0, .law = kOnFriction};
  const Hypothesis wave = hypothesis({candidate("runout", form)}, {0.3, -0.1, 0.05, 0.02});
  const Eigen::VectorXd hidden = simulated(simulation_, data_, wave).value();
  const Eigen::VectorXd plain = simulated(simulation_, data_, {}).value();
  ASSERT_GT((hidden - plain).cwiseAbs().maxCoeff(), 0.01 * plain.maxCoeff());
  ExtendedModel model;
  model.kind = Kind::kTransmission;
  model.causes.push_back({.id = "runout", .form = form, .value = wave.value});
  const Simulation with_model(design_of(rig::bilateral_drive_gear()), Kind::kTransmission, {model});
  const Eigen::VectorXd again = simulated(with_model, data_, {}).value();
  EXPECT_LT((again - hidden).cwiseAbs().maxCoeff(), 1e-9 * plain.maxCoeff());
}

}  // namespace
}  // namespace gear3k::calibrate::levelled_responses_test
