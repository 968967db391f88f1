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
  [[nodiscard]] Scalar direct(std::size_t row, double level, Modification m = {}) const {
    m.gearbox.friction.level = m.gearbox.friction.level * level;
    return *simulation_.response(data_.rows[row].condition, m);
  }
};

/// Losses that are not linear in the level, with derivatives.
Modification curved_losses() {
  Modification m;
  auto& friction = m.gearbox.friction;
  friction.load_exponent = Scalar(-0.3, 0);
  friction.reference_force_N = 50.0;
  friction.slow_excess = Scalar(0.5, 1);
  friction.slow_speed_m_s = Scalar(0.05);
  m.gearbox.drag[design::kSunShaft].constant_Nm = Scalar(0.002, 2);
  m.gearbox.drag[design::kOutputShaft].constant_Nm = Scalar(0.05, 4);
  return m;
}

TEST_F(Levelled, MeetTheSimulationWithinAnyRangeToAFactorOfFour) {
  const RowStates states(data_.rows);
  for (const Modification& losses : {Modification{}, curved_losses()}) {
    for (const double half : {0.02, 0.24, std::log(2.0)}) {
      LevelRange range;
      range.include(std::exp(-half));
      range.include(std::exp(half));
      const LevelledResponses responses(states, simulation_, losses, range);
      for (std::size_t row = 0; row < data_.rows.size(); ++row) {
        const auto value = [&](double level) { return direct(row, level, losses).a; };
        const double change = std::abs(value(2.0) - value(0.5));
        for (const double share : {-1.0, -0.69, -0.1, 0.0, 0.39, 0.82, 1.0}) {
          const double level = std::exp(share * half);
          const Scalar y = responses.of_row(row, level)->at(Scalar(level, 3), true);
          const Scalar exact = direct(row, level, losses);
          EXPECT_NEAR(y.a, exact.a, 1e-7 * change) << level;
          const double step = 1e-3 * level;
          const double slope = (value(level + step) - value(level - step)) / (2.0 * step);
          EXPECT_NEAR(y.v[3], slope, 1e-6 * std::abs(slope)) << level;
          EXPECT_EQ(responses.of_row(row, level)->at(Scalar(level, 3), false).v[3], y.v[3]);
          for (Eigen::Index k = 0; k < exact.v.size(); ++k) {
            if (k == 3) continue;
            EXPECT_NEAR(y.v[k], exact.v[k], 3e-5 * exact.v.norm()) << level << ' ' << k;
          }
        }
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
    EXPECT_EQ(responses.of_row(row, 1.0)->value, direct(row, 1.0).a);
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
    EXPECT_NEAR(responses.of_row(row, 1.5)->at(Scalar(1.5, 2), true).v[1], forward ? 1.0 : -1.0,
                1e-9);
    EXPECT_EQ(responses.of_row(row, 1.5)->at(Scalar(1.5, 2), false).v[1], 0.0);
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
