// Motion with changing power flow, against closed forms and an independent simulator.
#include "motion/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "tests/motion/moving_actuators.hpp"

namespace gear3k::simulate_test {
namespace {

using namespace motion_test;

std::vector<double> times_of(const Motion& m, const std::string& what) {
  std::vector<double> times;
  for (const auto& event : m.events) {
    if (event.what == what) times.push_back(event.time_s);
  }
  return times;
}

/// The row of a time.
const MotionRow& row_at(const Motion& m, double time_s) {
  for (const MotionRow& row : m.rows) {
    if (std::abs(row.time_s - time_s) < 1e-9) return row;
  }
  throw std::out_of_range("no such row");
}

TEST(Simulate, FollowsModelicasLossyGear) {
  // Modelica.Mechanics.Rotational.Examples.LossyGearDemo1; its tolerance is 1e-6.
  Actuator a = plain_actuator({.fast_kgm2 = 1.0, .output_kgm2 = 1.5, .ratio = 2.0}, 0.5, 0.5);
  Scenario s;
  s.duration_s = 0.5;
  s.command = {.amplitude = 10.0, .frequency_Hz = 1.0};
  s.load.torque_Nm = {.time_s = {0.0, 0.5}, .value = {-10.0, -8.75}};
  s.sample_s = 0.02;
  const Motion m = simulate(a, s);
  const std::vector<double> stops = times_of(m, "stops");
  const std::vector<double> starts = times_of(m, "starts");
  ASSERT_EQ(stops.size(), 2U);
  ASSERT_EQ(starts.size(), 3U);
  EXPECT_EQ(starts[0], 0.0);
  EXPECT_NEAR(stops[0], 0.0804771289, 1e-7);
  EXPECT_NEAR(starts[1], 0.199519901, 1e-7);
  EXPECT_NEAR(stops[1], 0.371342745, 1e-7);
  EXPECT_NEAR(starts[2], 0.464539462, 1e-7);
  std::ifstream file(std::string(GEAR3K_SOURCE_DIR) + "/data/lossy_gear_demo1_modelica.csv");
  int seen = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line[0] == 't') continue;
    std::istringstream fields(line);
    double time = 0.0;
    double angle = 0.0;
    double speed = 0.0;
    char comma = 0;
    fields >> time >> comma >> angle >> comma >> speed;
    EXPECT_NEAR(row_at(m, time).sides.output_rad_s, speed, 1e-7) << time;
    EXPECT_NEAR(row_at(m, time).sides.output_rad, angle, 1e-7) << time;
    ++seen;
  }
  EXPECT_EQ(seen, 26);
  EXPECT_LT(m.ledger.balance_error, 1e-9);
}

TEST(Simulate, HasTheReferencesReversal) {
  Actuator a = plain_actuator({.fast_kgm2 = 0.2, .output_kgm2 = 0.1}, 0.9, 0.7);
  a.motor.coulomb_Nm = a.motor.static_Nm = 0.2;
  a.gearbox.coulomb_Nm = 0.2;
  a.gearbox.static_Nm = 0.3;
  Scenario s;
  s.duration_s = 1.2;
  s.command = {.time_s = {0.0, 0.3, 0.3, 0.8, 0.8}, .value = {2.0, 2.0, -1.5, -1.5, 0.0}};
  s.load.torque_Nm.constant = -0.5;
  const Motion m = simulate(a, s);
  EXPECT_NEAR(times_of(m, "reverses").at(0), 0.4215264, 5e-8);
  EXPECT_NEAR(m.end.sides.output_rad, -0.9660161, 5e-8);
  EXPECT_NEAR(m.end.sides.output_rad_s, -2.0018011, 5e-8);
  EXPECT_NEAR(loss_of(m, "mesh"), 0.0992065, 5e-8);
}

TEST(Simulate, ConstantTorquesAccelerateAsBothFlowsSay) {
  // The reference: a = 5 with the motor's side ahead (10, -4), -0.3703704 behind (-4, 10).
  for (const bool ahead : {true, false}) {
    const Actuator a = plain_actuator({.fast_kgm2 = 0.2, .output_kgm2 = 0.1}, 0.9, 0.7);
    Scenario s;
    s.duration_s = 2.0;
    s.start_speed_rad_s = 5.0;
    s.command.constant = 0.2 * (ahead ? 10.0 : -4.0);
    s.load.torque_Nm.constant = 0.1 * (ahead ? -4.0 : 10.0);
    const double acceleration =
        ahead ? (0.9 * 2.0 - 0.4) / (0.9 * 0.2 + 0.1) : (-0.8 + 0.7 * 1.0) / (0.2 + 0.7 * 0.1);
    const Motion m = simulate(a, s);
    EXPECT_NEAR(m.end.acceleration_rad_s2, acceleration, 1e-12);
    EXPECT_NEAR(m.end.sides.output_rad_s, 5.0 + 2.0 * acceleration, 1e-9 * 15.0);
    EXPECT_NEAR(m.end.sides.output_rad, 10.0 + 2.0 * acceleration, 1e-9 * 20.0);
    EXPECT_EQ(m.end.mode.flow, ahead ? 1 : -1);
    EXPECT_TRUE(m.events.size() <= 1U);
  }
}

TEST(Simulate, CoastsDownOnOneFlow) {
  // Fast side with all the friction: it is driven by the output, J = J1 + eta_b J2.
  Actuator a = plain_actuator({.fast_kgm2 = 0.2, .output_kgm2 = 0.1}, 0.9, 0.7);
  a.motor.viscous_Nms = 0.03;
  a.motor.coulomb_Nm = a.motor.static_Nm = 0.05;
  Scenario s;
  s.duration_s = 30.0;
  s.start_speed_rad_s = 8.0;
  const double inertia = 0.2 + 0.7 * 0.1;
  const double rate = 0.03 / inertia;
  const double stop = std::log1p(8.0 * 0.03 / 0.05) / rate;
  const double way = (8.0 + 0.05 / 0.03) * -std::expm1(-rate * stop) / rate - 0.05 / 0.03 * stop;
  const Motion m = simulate(a, s);
  EXPECT_NEAR(times_of(m, "stops").at(0), stop, 1e-9 * stop);
  EXPECT_NEAR(m.end.sides.output_rad, way, 1e-9 * way);
  EXPECT_EQ(m.end.sides.output_rad_s, 0.0);
  EXPECT_NEAR(m.ledger.kinetic_J, -0.5 * (0.2 + 0.1) * 64.0, 1e-12);
}

TEST(Simulate, CoastsDownOnTwoFlows) {
  // c on the fast side, D on the output.  The sides slow down alike at w* where
  // c/J1 = D w*/J2; above it the output is braked more, so that the motor's side drives.
  Actuator a = plain_actuator({.fast_kgm2 = 0.2, .output_kgm2 = 0.1}, 0.8, 0.6);
  a.motor.coulomb_Nm = a.motor.static_Nm = 0.3;
  a.gearbox.viscous_Nms = 0.05;
  Scenario s;
  s.duration_s = 20.0;
  s.start_speed_rad_s = 9.0;
  const double turn = 0.3 / 0.2 * 0.1 / 0.05;
  // Forward: (eta_f J1 + J2) w' = -eta_f c - D w; backward: (J1 + eta_b J2) w' = -c - eta_b D w.
  const auto time_to = [](double from, double to, double inertia, double c, double d) {
    return inertia / d * std::log((from + c / d) / (to + c / d));
  };
  const double first = time_to(9.0, turn, 0.8 * 0.2 + 0.1, 0.8 * 0.3, 0.05);
  const double second = time_to(turn, 0.0, 0.2 + 0.6 * 0.1, 0.3, 0.6 * 0.05);
  const Motion m = simulate(a, s);
  EXPECT_NEAR(times_of(m, "flow_backward").at(0), first, 1e-9 * first);
  EXPECT_NEAR(times_of(m, "stops").at(0), first + second, 1e-9 * (first + second));
  EXPECT_LT(m.ledger.balance_error, 1e-9);
}

TEST(Simulate, AVoltageStepApproachesItsSpeed) {
  Actuator a = plain_actuator({.fast_kgm2 = 1e-4, .output_kgm2 = 0.1, .ratio = -40.0}, 0.85, 0.8);
  a.motor.resistance_ohm = 0.5;
  a.motor.torque_constant_Nm_A = 0.05;
  Scenario s;
  s.duration_s = 1.0;
  s.control = Control::kVoltage;
  s.command.constant = 12.0;
  s.load.torque_Nm.constant = 4.0;  // against the motion, which is backward
  const double inertia = 0.85 * 1600.0 * 1e-4 + 0.1;
  const double rate = 0.85 * 1600.0 * 0.05 * 0.05 / 0.5 / inertia;
  const double last = -(0.85 * 40.0 * 0.05 * 12.0 / 0.5 - 4.0) / (rate * inertia);
  const Motion m = simulate(a, s);
  for (const MotionRow& row : m.rows) {
    const double speed = -last * std::expm1(-rate * row.time_s);
    ASSERT_NEAR(row.sides.output_rad_s, speed, 1e-9 * std::abs(last)) << row.time_s;
  }
  EXPECT_LT(m.ledger.balance_error, 1e-9);
  EXPECT_NEAR(m.end.outside.voltage_V, 12.0, 1e-12);
}

TEST(Simulate, ContactAtTheGapIsPlastic) {
  // The motor's side is driven through half of the gap, then takes the output along.
  Actuator a = plain_actuator({.fast_kgm2 = 0.2, .output_kgm2 = 0.1}, 0.9, 0.7);
  a.gearbox.backlash_rad = 0.02;
  Scenario s;
  s.duration_s = 1.0;
  s.command.constant = 0.5;
  const double touch = std::sqrt(2.0 * 0.01 / (0.5 / 0.2));
  const double before = 0.5 / 0.2 * touch;
  const double after = 0.9 * 0.2 * before / (0.9 * 0.2 + 0.1);
  const double acceleration = 0.9 * 0.5 / (0.9 * 0.2 + 0.1);
  const Motion m = simulate(a, s);
  EXPECT_NEAR(times_of(m, "contact").at(0), touch, 1e-9 * touch);
  EXPECT_NEAR(m.end.sides.output_rad_s, after + acceleration * (1.0 - touch), 1e-9);
  EXPECT_NEAR(loss_of(m, "contact"),
              0.5 * 0.2 * before * before - 0.5 * (0.2 + 0.1) * after * after, 1e-12);
  EXPECT_NEAR(m.end.sides.fast_rad - m.end.sides.output_rad, 0.01, 1e-12);
  EXPECT_LT(m.ledger.balance_error, 1e-9);
}

TEST(Simulate, AnOutputThatCatchesUpDrivesTheMotorsSide) {
  // The output is pushed through the gap and drives the motor's side: backward flow.
  Actuator a = plain_actuator({.fast_kgm2 = 0.2, .output_kgm2 = 0.1}, 0.9, 0.7);
  a.gearbox.backlash_rad = 0.02;
  Scenario s;
  s.duration_s = 1.0;
  s.load.torque_Nm.constant = 0.5;
  const double touch = std::sqrt(2.0 * 0.01 / (0.5 / 0.1));
  const double after = 0.7 * 0.1 * (0.5 / 0.1 * touch) / (0.2 + 0.7 * 0.1);
  const double acceleration = 0.7 * 0.5 / (0.2 + 0.7 * 0.1);
  const Motion m = simulate(a, s);
  EXPECT_NEAR(m.end.sides.output_rad_s, after + acceleration * (1.0 - touch), 1e-9);
  EXPECT_EQ(m.end.mode.flow, -1);
  EXPECT_EQ(m.end.mode.contact, -1);
}

TEST(Simulate, ASelfLockingTrainRunsWhileTheRotorIsHeavyEnough) {
  // eta_b = -0.5: J1 + eta_b J2 = 0.15 > 0.  Coulomb friction of the motor, output free: a
  // = -c/(J1 + eta_b J2), until it stops.
  Actuator a = plain_actuator({.fast_kgm2 = 0.2, .output_kgm2 = 0.1}, 0.4, -0.5);
  a.motor.coulomb_Nm = a.motor.static_Nm = 0.3;
  Scenario s;
  s.duration_s = 5.0;
  s.start_speed_rad_s = 4.0;
  const Motion m = simulate(a, s);
  EXPECT_NEAR(times_of(m, "stops").at(0), 4.0 * 0.15 / 0.3, 1e-9);
  EXPECT_TRUE(times_of(m, "jams").empty());
  EXPECT_LT(m.ledger.balance_error, 1e-9);
}

TEST(Simulate, ALighterRotorJamsAtTheFirstInstantOfBackwardFlow) {
  // J1 + eta_b J2 = -0.03.  The motor drives until its torque falls below what keeps up with the
  // output: tau(t) = 2 - 4 t, a1 - a0 = tau/J1, so that the flow would change at 0.5 s.
  Actuator a = plain_actuator({.fast_kgm2 = 0.02, .output_kgm2 = 0.1}, 0.4, -0.5);
  Scenario s;
  s.duration_s = 2.0;
  s.command = {.time_s = {0.0, 1.0}, .value = {2.0, -2.0}};
  const Motion m = simulate(a, s);
  ASSERT_EQ(times_of(m, "jams").size(), 1U);
  EXPECT_NEAR(times_of(m, "jams")[0], 0.5, 1e-9);
  const double speed = 0.4 * 0.5 / (0.4 * 0.02 + 0.1);  // of the integral of tau to 0.5 s
  EXPECT_NEAR(loss_of(m, "jam"), 0.5 * 0.12 * speed * speed, 1e-9);
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes.back().find("jams at 0.5 s"), std::string::npos);
  EXPECT_LT(m.ledger.balance_error, 1e-9);
  // Driven from the output from the start on, it jams there.
  s.command = {};
  s.start_speed_rad_s = 1.0;
  s.load.torque_Nm.constant = 0.1;
  const Motion at_once = simulate(a, s);
  EXPECT_EQ(times_of(at_once, "jams").at(0), 0.0);
}

TEST(Simulate, SidesThatCoastAlikeDoNotChatter) {
  // c1/J1 = c2/J2 and D1/J1 = D2/J2: the mesh is without torque throughout.
  for (const double gap : {0.0, 0.01}) {
    Actuator a = plain_actuator({.fast_kgm2 = 0.3, .output_kgm2 = 0.1}, 0.8, 0.6);
    a.motor.coulomb_Nm = a.motor.static_Nm = 0.3 * 0.7;
    a.gearbox.coulomb_Nm = a.gearbox.static_Nm = 0.1 * 0.7;
    a.motor.viscous_Nms = 0.3 * 0.11;
    a.gearbox.viscous_Nms = 0.1 * 0.11;
    a.gearbox.backlash_rad = gap;
    Scenario s;
    s.duration_s = 10.0;
    s.start_speed_rad_s = 7.0;
    s.start_gap_position = 1.0;
    const Motion m = simulate(a, s);
    EXPECT_LE(m.events.size(), 6U);
    EXPECT_LT(m.steps, 1000U);
    const double stop = std::log1p(7.0 * 0.11 / 0.7) / 0.11;
    EXPECT_NEAR(m.events.back().time_s, stop, 1e-8);
    EXPECT_EQ(m.end.sides.output_rad_s, 0.0);
  }
}

}  // namespace
}  // namespace gear3k::simulate_test
