// What every simulated motion keeps: the ledger, the order of the method, its own inverse.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "actuator/duty_cycle.hpp"
#include "tests/motion/moving_actuators.hpp"
#include "tests/random_numbers.hpp"

namespace gear3k::simulate_properties_test {
namespace {

using namespace motion_test;

/// A motor that swings a pendulum with friction everywhere.
Actuator swinging() {
  Actuator a = plain_actuator({.fast_kgm2 = 2e-5, .output_kgm2 = 0.01, .ratio = 50.0}, 0.8, 0.7);
  a.motor.resistance_ohm = 0.6;
  a.motor.torque_constant_Nm_A = 0.04;
  a.motor.coulomb_Nm = 0.004;
  a.motor.static_Nm = 0.008;
  a.motor.viscous_Nms = 1e-6;
  a.gearbox.coulomb_Nm = 0.3;
  a.gearbox.static_Nm = 0.6;
  a.gearbox.viscous_Nms = 0.02;
  a.drive = {.bus_voltage_V = {},
             .efficiency_motoring = 0.9,
             .efficiency_regenerating = 0.8,
             .standby_W = 0.5};
  return a;
}

Scenario pendulum(double torque_Nm) {
  Scenario s;
  s.duration_s = 8.0;
  s.start_angle_rad = 0.2;
  s.command = {.amplitude = torque_Nm, .frequency_Hz = 0.6};
  s.load.pendulum = {.mass_kg = 1.5, .length_m = 0.3};
  return s;
}

int modes_entered(const Motion& m) {
  int count = 0;
  for (const auto& share : m.shares) count += share.entries;
  return count;
}

TEST(SimulateProperties, APendulumPassesThroughAllModesAndItsLedgerCloses) {
  const Motion m = simulate(swinging(), pendulum(0.12));
  EXPECT_GT(modes_entered(m), 12);
  EXPECT_GT(m.shares[0].time_s, 0.0);
  EXPECT_GT(m.shares[1].time_s, 0.0);
  EXPECT_GT(m.shares[2].time_s, 0.0);
  bool up = false;
  bool down = false;
  for (const MotionRow& row : m.rows) {
    up = up || (row.mode.sense > 0);
    down = down || (row.mode.sense < 0);
  }
  EXPECT_TRUE(up && down);
  EXPECT_LT(m.ledger.balance_error, 1e-9);
  double time = 0.0;
  for (const auto& share : m.shares) time += share.time_s;
  EXPECT_NEAR(time, 8.0, 1e-9);
  for (const auto& [cause, energy] : m.ledger.losses) EXPECT_GE(energy, 0.0) << cause;
}

TEST(SimulateProperties, LedgersOfRandomScenariosClose) {
  RandomNumbers random(7);
  for (int k = 0; k < 60; ++k) {
    Actuator a = swinging();
    a.gearbox.ratio = random.between(20.0, 80.0) * (random.count(0, 1) == 0 ? 1.0 : -1.0);
    a.gearbox.efficiency_forward = random.between(0.3, 1.0);
    a.gearbox.efficiency_backward = random.between(-0.5, 1.0);
    a.gearbox.coulomb_Nm = random.between(0.0, 0.4);
    a.gearbox.static_Nm = a.gearbox.coulomb_Nm + random.between(0.0, 0.3);
    a.gearbox.backlash_rad = random.count(0, 1) == 0 ? 0.0 : random.between(1e-4, 0.02);
    Scenario s = pendulum(random.between(0.02, 0.3));
    s.duration_s = 3.0;
    s.control = static_cast<Control>(random.count(0, 4));
    s.start_speed_rad_s = random.between(-4.0, 4.0);
    s.control_stiffness_Nm_rad = 40.0;
    s.control_damping_Nms = 2.0;
    if (s.control == Control::kVoltage) s.command.amplitude = random.between(1.0, 12.0);
    s.load.torque_Nm = {.time_s = {0.0, 1.0, 1.0, 2.5}, .value = {0.0, 2.0, -1.0, 1.0}};
    s.load.stiffness_Nm_rad = random.between(0.0, 5.0);
    const Motion m = simulate(a, s);
    EXPECT_LT(m.ledger.balance_error, 1e-9) << k;
    EXPECT_TRUE(m.complete) << k;
    EXPECT_NEAR(m.end.time_s, 3.0, 1e-12) << k;
    EXPECT_LT(m.events.size(), 2000U) << k;
    for (const MotionRow& row : m.rows) {
      ASSERT_LE(std::abs(row.sides.fast_rad - row.sides.output_rad),
                0.5 * a.gearbox.backlash_rad.value_or(0.0) * (1.0 + 1e-9) + 1e-13)
          << k;
    }
  }
}

TEST(SimulateProperties, TheMirroredScenarioMovesAsTheMirror) {
  for (const double gap : {0.0, 0.004}) {
    Actuator a = swinging();
    a.gearbox.backlash_rad = gap;
    Scenario s = pendulum(0.12);
    const Motion m = simulate(a, s);
    s.start_angle_rad = -s.start_angle_rad;
    s.command.amplitude = -s.command.amplitude;
    const Motion mirrored = simulate(a, s);
    EXPECT_EQ(m.end.sides.output_rad, -mirrored.end.sides.output_rad);
    ASSERT_EQ(m.events.size(), mirrored.events.size());
    EXPECT_EQ(m.ledger.drawn_J, mirrored.ledger.drawn_J);
  }
}

TEST(SimulateProperties, WithoutLossesNoEnergyIsLost) {
  Actuator a = plain_actuator({.fast_kgm2 = 1e-4, .output_kgm2 = 0.1, .ratio = 20.0}, 1.0, 1.0);
  Scenario s = pendulum(0.0);
  s.start_angle_rad = 1.2;
  const Motion m = simulate(a, s);
  EXPECT_NEAR(m.ledger.kinetic_J, -m.ledger.gravity_J, 1e-9);
  EXPECT_LT(m.ledger.balance_error, 1e-9);
  EXPECT_EQ(m.ledger.drawn_J, 0.0);
  EXPECT_GT(m.events.size(), 4U);
}

double end_error(double step_s, double relative, const Motion& truth) {
  Scenario s = pendulum(0.12);
  s.solver.max_step_s = step_s;
  s.solver.relative_tolerance = relative;
  s.solver.absolute_tolerance = relative;
  const Motion m = simulate(swinging(), s);
  return std::hypot(m.end.sides.output_rad - truth.end.sides.output_rad,
                    m.end.sides.output_rad_s - truth.end.sides.output_rad_s);
}

TEST(SimulateProperties, TheErrorFallsWithTheFifthPowerOfTheStep) {
  Scenario fine = pendulum(0.12);
  fine.solver.relative_tolerance = 1e-13;
  fine.solver.absolute_tolerance = 1e-14;
  const Motion truth = simulate(swinging(), fine);
  ASSERT_GT(modes_entered(truth), 12);
  const double coarse = end_error(0.08, 1.0, truth);
  const double half = end_error(0.02, 1.0, truth);
  // 4^5 = 1024; the places of the steps between events differ, so that the power shows roughly.
  const double order = std::log(coarse / half) / std::log(4.0);
  EXPECT_GT(order, 4.2) << coarse << ' ' << half;
  EXPECT_LT(order, 6.5) << coarse << ' ' << half;
}

TEST(SimulateProperties, TheErrorFallsWithTheTolerance) {
  Scenario fine = pendulum(0.12);
  fine.solver.relative_tolerance = 1e-13;
  fine.solver.absolute_tolerance = 1e-14;
  const Motion truth = simulate(swinging(), fine);
  const double loose = end_error(1.0, 1e-5, truth);
  const double tight = end_error(1.0, 1e-9, truth);
  // Of order 5 with steps ~ tolerance^(1/5): the error is proportional to the tolerance.
  const double power = std::log10(loose / tight) / 4.0;
  EXPECT_GT(power, 0.75) << loose << ' ' << tight;
  EXPECT_LT(power, 1.4) << loose << ' ' << tight;
}

/// A cycle of random rows; the torque that it asks of the motor.
struct InverseRun {
  actuator::Cycle cycle;
  motion::Signal torque;
};
InverseRun random_inverse(const Actuator& a, RandomNumbers& random) {
  InverseRun run;
  for (int k = 0; k <= 40; ++k) {
    run.cycle.time_s.push_back(0.05 * k);
    run.cycle.load_Nm.push_back(random.between(-6.0, 6.0));
    run.cycle.motion.push_back(random.between(-3.0, 3.0));
  }
  for (const auto& instant : run_cycle(a, run.cycle, true).instants) {
    run.torque.time_s.push_back(instant.time_s);
    run.torque.value.push_back(instant.motor_Nm);
  }
  return run;
}

TEST(SimulateProperties, TheTorqueOfACycleReturnsTheCycle) {
  Actuator a = swinging();
  a.motor.static_Nm = a.motor.coulomb_Nm;
  a.gearbox.static_Nm = a.gearbox.coulomb_Nm;
  RandomNumbers random(11);
  for (int k = 0; k < 20; ++k) {
    const InverseRun run = random_inverse(a, random);
    Scenario s;
    s.duration_s = run.cycle.time_s.back();
    s.start_speed_rad_s = run.cycle.motion.front();
    s.command = run.torque;
    s.load.torque_Nm = {.time_s = run.cycle.time_s, .value = run.cycle.load_Nm};
    s.sample_s = 0.05;
    const Motion m = simulate(a, s);
    std::size_t row = 0;
    double angle = 0.0;
    for (const MotionRow& r : m.rows) {
      if (row >= run.cycle.time_s.size() || std::abs(r.time_s - run.cycle.time_s[row]) > 1e-9) {
        continue;
      }
      if (row > 0) angle += 0.025 * (run.cycle.motion[row] + run.cycle.motion[row - 1]);
      EXPECT_NEAR(r.sides.output_rad_s, run.cycle.motion[row], 3e-6) << k << ' ' << row;
      EXPECT_NEAR(r.sides.output_rad, angle, 1e-6) << k << ' ' << row;
      ++row;
    }
    EXPECT_EQ(row, run.cycle.time_s.size());
  }
}

// T = 2 π √(J/(m g l)) with J of the load, the output and the motor referred to it; however coarse
// the tolerance, a step is at most a fortieth of it.
TEST(SimulateProperties, StepsAreAtMostAFortiethOfThePeriodOfAPendulum) {
  Actuator a = plain_actuator({.fast_kgm2 = 1e-9, .output_kgm2 = 0.001, .ratio = 10.0}, 1.0, 1.0);
  Scenario s = pendulum(0.0);
  s.control = Control::kOpen;
  s.solver.relative_tolerance = s.solver.absolute_tolerance = 1e-2;
  const auto& p = s.load.pendulum;
  const double inertia_kgm2 = 1e-9 * 100.0 + 0.001 + p.mass_kg * p.length_m * p.length_m;
  const double period_s =
      2.0 * std::numbers::pi * std::sqrt(inertia_kgm2 / (p.mass_kg * p.gravity_m_s2 * p.length_m));
  s.duration_s = 20.0 * period_s;
  EXPECT_GE(simulate(a, s).steps, 800U);
}

TEST(SimulateProperties, AStiffControlEndsAndSaysSo) {
  Scenario s = pendulum(0.0);
  s.control = Control::kPosition;
  s.command = {.amplitude = 0.4, .frequency_Hz = 1.0};
  s.control_stiffness_Nm_rad = 1e3;
  s.control_damping_Nms = 1e8;
  s.solver.max_steps = 2000;
  const Motion m = simulate(swinging(), s);
  EXPECT_FALSE(m.complete);
  EXPECT_EQ(m.steps, 2000U);
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes[0].find("solver.max_steps = 2000"), std::string::npos) << m.notes[0];
}

// Rows at the zeros of a sine see nothing of it.
TEST(SimulateProperties, PeaksAreThoseBetweenTheRows) {
  const Actuator a = plain_actuator({.fast_kgm2 = 1.0, .output_kgm2 = 1.0}, 0.9, 0.8);
  Scenario s;
  s.duration_s = 1.0;
  s.start_speed_rad_s = 10.0;
  s.command = {.amplitude = 3.0, .frequency_Hz = 50.0};
  s.sample_s = 0.02;
  const Motion m = simulate(a, s);
  double of_rows = 0.0;
  for (const MotionRow& row : m.rows) of_rows = std::max(of_rows, std::abs(row.outside.current_A));
  EXPECT_LT(of_rows, 0.1);
  // Kt = 1: the peak is the amplitude, which is missed by at most half of a 160th of the period.
  EXPECT_LE(m.peak_current_A, 3.0);
  EXPECT_GE(m.peak_current_A, 3.0 * std::cos(std::numbers::pi / 160.0));
}

TEST(SimulateProperties, StepsThatEventsCutCountToo) {
  Scenario s = pendulum(0.12);
  const Motion whole = simulate(swinging(), s);
  ASSERT_TRUE(whole.complete);
  ASSERT_GT(whole.cuts, 20U);
  for (const std::int64_t most : {1, 7, 40, 100}) {
    s.solver.max_steps = most;
    const Motion m = simulate(swinging(), s);
    EXPECT_FALSE(m.complete);
    EXPECT_EQ(m.steps, static_cast<std::size_t>(most));
    EXPECT_NE(m.ended_early.find("solver.max_steps"), std::string::npos) << m.ended_early;
  }
  // As many as it takes are enough.
  s.solver.max_steps = static_cast<std::int64_t>(whole.steps);
  EXPECT_TRUE(simulate(swinging(), s).complete);
}

TEST(SimulateProperties, TooManyEventsEndTheRunAndSaySo) {
  Scenario s = pendulum(0.12);
  s.solver.max_events = 5;
  const Motion m = simulate(swinging(), s);
  EXPECT_FALSE(m.complete);
  EXPECT_LT(m.end.time_s, 8.0);
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes[0].find("solver.max_events = 5"), std::string::npos);
}

}  // namespace
}  // namespace gear3k::simulate_properties_test
