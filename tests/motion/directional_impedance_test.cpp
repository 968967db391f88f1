// What A. D. Wang's thesis (Directional Impedance of Geared Transmissions, MIT 2012) says of
// dynamics, against simulated motion.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "io/files/actuator_file.hpp"
#include "io/files/scenario_file.hpp"
#include "tests/motion/moving_actuators.hpp"
#include "tests/random_numbers.hpp"

namespace gear3k::directional_impedance_test {
namespace {

using namespace motion_test;

std::string example(const std::string& name) {
  return std::string(GEAR3K_SOURCE_DIR) + "/examples/actuators/" + name;
}

/// Least squares y = slope x + const.
struct Line {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  void add(double a, double b) {
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  [[nodiscard]] double slope() const { return (n * xy - x * y) / (n * xx - x * x); }
};

// Section 3.2 and eqs. 3.3, 3.4: slopes at constant speed give back the losses of Table 3.1.
TEST(DirectionalImpedance, SlopesOfTheBenchAtConstantSpeedAreItsLosses) {
  const auto actuator = io::read_actuator(example("directional_bench.toml")).actuator;
  const auto scenario = io::read_scenario(example("directional_bench_load.toml")).scenario;
  const Motion m = simulate(actuator, scenario);
  Line forward, backward;
  for (const MotionRow& row : m.rows) {
    // Half a second after the load has jumped the control has settled.
    if (row.time_s > 0.5 && row.time_s < 2.0) {
      EXPECT_EQ(row.mode.flow, 1) << row.time_s;
      forward.add(row.outside.reflected_Nm, -row.outside.load_Nm);
    }
    if (row.time_s > 2.5 && row.time_s < 4.0) {
      EXPECT_EQ(row.mode.flow, -1) << row.time_s;
      backward.add(row.outside.load_Nm, -row.outside.reflected_Nm);
    }
    if (row.time_s > 0.5 && std::abs(row.time_s - 2.25) > 0.25) {
      EXPECT_NEAR(row.sides.output_rad_s, 31.4159, 0.02);
    }
  }
  EXPECT_NEAR(1.0 - forward.slope(), 0.001, 1e-6);
  EXPECT_NEAR(1.0 - backward.slope(), 0.167, 1e-6);
}

// Eqs. 2.6 and 2.7 as printed, at the motor's shaft: τ1 of the motor, τ2 of the load against the
// motion.  The thesis leaves open what tells the power transfer state; the mesh does.
TEST(DirectionalImpedance, EquationsAsPrintedGiveTheAccelerationOfTheMeshsFlow) {
  RandomNumbers random(5);
  int forward = 0, backward = 0;
  for (int k = 0; k < 60; ++k) {
    const double n = random.between(2.0, 10.0);
    const double loss1 = random.between(0.0, 0.2), loss2 = random.between(0.0, 0.2);
    const double j1 = random.between(1e-5, 1e-4), j2 = n * n * random.between(1e-5, 1e-4);
    const double d2 = random.between(0.0, 0.05);
    Actuator a =
        plain_actuator({.fast_kgm2 = j1, .output_kgm2 = j2, .ratio = n}, 1.0 - loss1, 1.0 - loss2);
    a.motor.viscous_Nms = random.between(0.0, 1e-3);
    a.gearbox.viscous_Nms = d2;
    Scenario s;
    s.duration_s = 1e-3;
    s.start_speed_rad_s = 3.0;
    s.command.constant = random.between(-0.3, 0.3);
    const double against = n * random.between(-0.3, 0.3);
    s.load.torque_Nm.constant = -against;
    const MotionRow row = simulate(a, s).rows[1];
    const double w = n * row.sides.output_rad_s, tau = s.command.constant;
    const double d1 = a.motor.viscous_Nms;
    double printed = 0.0;
    if (row.mode.flow > 0) {
      ++forward;
      printed = ((1.0 - loss1) * tau - against / n - ((1.0 - loss1) * d1 + d2 / (n * n)) * w) /
                ((1.0 - loss1) * j1 + j2 / (n * n));
    } else {
      ++backward;
      printed = (tau - (1.0 - loss2) * against / n - (d1 + (1.0 - loss2) * d2 / (n * n)) * w) /
                (j1 + (1.0 - loss2) * j2 / (n * n));
    }
    EXPECT_NEAR(row.acceleration_rad_s2 * n, printed, 1e-9 * (1.0 + std::abs(printed))) << k;
  }
  EXPECT_GT(forward, 10);
  EXPECT_GT(backward, 10);
}

}  // namespace
}  // namespace gear3k::directional_impedance_test
