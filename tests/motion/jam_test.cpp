// Self-locking trains below J1 + η_b J2 = 0: when they jam, rest and start again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/motion/moving_actuators.hpp"
#include "tests/random_numbers.hpp"

namespace gear3k::jam_test {
namespace {

using namespace motion_test;

constexpr double kFast_kgm2 = 0.002, kOutput_kgm2 = 0.05, kForward = 0.5, kBackward = -0.4;

/// Both sides with an elastic mesh between them, by small steps: nothing here is rigid, so nothing
/// has two solutions or none.  The fast side rests while η_b m and m/η_f hold it.
struct ElasticTrain {
  double stiffness_Nm_rad = 2e4, damping_Nms = 0.02, step_s = 2e-6;
  double fast_rad = 0.0, output_rad = 0.0, fast_rad_s = 0.0, output_rad_s = 0.0;

  static double input(double mesh_Nm, double sense) {
    return sense * mesh_Nm > 0.0 ? mesh_Nm / kForward : kBackward * mesh_Nm;
  }
  void step(double motor_Nm, double load_Nm) {
    const double mesh = stiffness_Nm_rad * (fast_rad - output_rad);
    const double output = mesh + load_Nm - damping_Nms * (output_rad_s - fast_rad_s);
    double fast = 0.0;
    if (fast_rad_s != 0.0) {
      fast = motor_Nm - input(mesh, fast_rad_s > 0.0 ? 1.0 : -1.0);
    } else if (motor_Nm > input(mesh, 1.0)) {
      fast = motor_Nm - input(mesh, 1.0);
    } else if (motor_Nm < input(mesh, -1.0)) {
      fast = motor_Nm - input(mesh, -1.0);
    }
    const double next = fast_rad_s + step_s * fast / kFast_kgm2;
    fast_rad_s = next * fast_rad_s < 0.0 ? 0.0 : next;
    output_rad_s += step_s * output / kOutput_kgm2;
    fast_rad += step_s * fast_rad_s;
    output_rad += step_s * output_rad_s;
  }
};

Actuator locking() {
  return plain_actuator({.fast_kgm2 = kFast_kgm2, .output_kgm2 = kOutput_kgm2}, kForward,
                        kBackward);
}

TEST(Jam, ATrainUnderItsLoadStartsWhereAnElasticOneDoes) {
  // T_L = 1 N m presses, the motor's torque rises by 0.5 N m/s.  At J1/J2 of the load, 0.04 N m and
  // 0.08 s, the motor's side would run ahead; the pressed mesh holds it up to |η_b|, 0.4 N m.
  ElasticTrain elastic;
  elastic.fast_rad = -1.0 / elastic.stiffness_Nm_rad;
  double elastic_s = 0.0;
  for (; elastic.output_rad < 0.02 && elastic_s < 2.0; elastic_s += elastic.step_s) {
    elastic.step(0.5 * elastic_s, 1.0);
  }
  Scenario s;
  s.duration_s = elastic_s;
  s.command = {.time_s = {0.0, 2.0}, .value = {0.0, 1.0}};
  s.load.torque_Nm.constant = 1.0;
  const Motion m = simulate(locking(), s);
  ASSERT_FALSE(m.events.empty());
  EXPECT_EQ(m.events[0].what, "starts");
  EXPECT_NEAR(m.events[0].time_s, 0.8, 1e-9);
  // The elastic one has turned by 0.02 rad, where the rigid one is a little further.
  EXPECT_GT(elastic_s, 0.8);
  EXPECT_LT(elastic_s, 0.85);
  EXPECT_NEAR(m.end.sides.output_rad, 0.02, 5e-3);
}

TEST(Jam, ATrainThatIsOvertakenStopsWhereAnElasticOneDoes) {
  // The motor gives 0.2 N m, the load's torque rises by 10 N m/s: at 5 N m the output would run
  // ahead.
  ElasticTrain elastic;
  elastic.stiffness_Nm_rad = 2e6;
  elastic.step_s = 2e-7;
  // At first the mesh gives J2 a to the output, forward.
  elastic.fast_rad = kOutput_kgm2 * kForward * 0.2 / (kForward * kFast_kgm2 + kOutput_kgm2) /
                     elastic.stiffness_Nm_rad;
  elastic.fast_rad_s = elastic.output_rad_s = 1.0;
  double elastic_s = 0.0;
  while (elastic_s < 0.48 || std::abs(elastic.fast_rad_s) > 0.1) {
    elastic.step(0.2, 10.0 * elastic_s);
    elastic_s += elastic.step_s;
    ASSERT_LT(elastic_s, 0.6);
  }
  Scenario s;
  s.duration_s = 0.6;
  s.start_speed_rad_s = 1.0;
  s.command.constant = 0.2;
  s.load.torque_Nm = {.time_s = {0.0, 1.0}, .value = {0.0, 10.0}};
  const Motion m = simulate(locking(), s);
  const auto jams = [](const auto& event) { return event.what == "jams"; };
  ASSERT_EQ(std::ranges::count_if(m.events, jams), 1);
  EXPECT_NEAR(std::ranges::find_if(m.events, jams)->time_s, 0.5, 1e-9);
  EXPECT_NEAR(elastic_s, 0.5, 5e-3);
  EXPECT_EQ(m.end.sides.output_rad_s, 0.0);
}

TEST(Jam, AVoltageThatLowersALoadJamsAndStartsAgainAtThePeriodOfItsClosedForm) {
  // From rest the motor's torque is τ0 − D w; at J2 (τ0 − D w) = J1 F0 the output runs ahead: jam,
  // at rest again, with τ0 > |η_b| F0.  Between, (η_f J1 + J2) w' = η_f (τ0 − D w) + F0.
  Actuator a = locking();
  a.motor.torque_constant_Nm_A = 0.5;
  a.motor.resistance_ohm = 0.5;
  const double damping = 0.5, torque = 0.6, load = 1.0;
  Scenario s;
  s.duration_s = 3.0;
  s.control = Control::kVoltage;
  s.command.constant = torque;  // τ0 = K_t V/R
  s.load.torque_Nm.constant = load;
  const Motion m = simulate(a, s);
  const double jam_speed = (torque - kFast_kgm2 / kOutput_kgm2 * load) / damping;
  const double final_speed = (kForward * torque + load) / (kForward * damping);
  const double period = (kForward * kFast_kgm2 + kOutput_kgm2) / (kForward * damping) *
                        std::log(final_speed / (final_speed - jam_speed));
  int jams = 0;
  for (const auto& event : m.events) {
    if (event.what != "jams") continue;
    ++jams;
    EXPECT_NEAR(event.time_s, jams * period, 1e-8 * jams);
    EXPECT_NEAR(event.loss_J, 0.5 * (kFast_kgm2 + kOutput_kgm2) * jam_speed * jam_speed, 1e-9);
  }
  EXPECT_EQ(jams, static_cast<int>(3.0 / period));
  EXPECT_LT(m.ledger.balance_error, 1e-9);
  ASSERT_EQ(m.notes.size(), 2U);
  EXPECT_NE(m.notes[1].find("it jams " + std::to_string(jams) + " times"), std::string::npos);
}

TEST(Jam, WithoutAnyTorqueNothingHappens) {
  // u = 0 throughout: neither side is ahead by anything at all.
  for (const double backward : {0.7, 0.01, -0.01, -0.4}) {
    Scenario s;
    s.control = Control::kOpen;
    s.start_speed_rad_s = 2.0;
    const Motion m = simulate(
        plain_actuator({.fast_kgm2 = kFast_kgm2, .output_kgm2 = kOutput_kgm2}, 0.5, backward), s);
    EXPECT_TRUE(m.complete);
    EXPECT_LE(m.events.size(), 1U) << backward;
    EXPECT_NEAR(m.end.sides.output_rad, 2.0, 1e-12) << backward;
  }
}

// What repeats itself without end is named before it has come to 100,000 events.
TEST(Jam, AJudderThatWouldNotEndInTimeIsNamed) {
  Actuator a = locking();
  a.motor.torque_constant_Nm_A = 0.5;
  a.motor.resistance_ohm = 0.5;
  Scenario s;
  s.duration_s = 1e6;
  s.sample_s = 1e5;
  s.control = Control::kVoltage;
  s.command.constant = 0.6;
  s.load.torque_Nm.constant = 1.0;
  s.solver.max_events = 4000;
  const Motion m = simulate(a, s);
  EXPECT_FALSE(m.complete);
  EXPECT_LT(m.events.size(), 1500U);
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes[0].find("judders"), std::string::npos) << m.notes[0];
  // The rate is that of the closed form of the test above.
  const double period =
      (kForward * kFast_kgm2 + kOutput_kgm2) / (kForward * 0.5) * std::log(5.2 / (5.2 - 1.12));
  EXPECT_NE(m.notes[0].find(fmt::format("{:.4g} times a second", 1.0 / period)), std::string::npos)
      << m.notes[0];
  // Where it ends in time nothing is cut short.
  s.duration_s = 1000.0 * period;
  EXPECT_TRUE(simulate(a, s).complete);
}

TEST(Jam, GainsThatChatterAcrossAGapAreNamed) {
  Actuator a =
      plain_actuator({.fast_kgm2 = 1.65e-7, .output_kgm2 = 0.00455, .ratio = 20.8}, 0.7, -0.183);
  a.motor.coulomb_Nm = a.motor.static_Nm = 0.142 / 20.8;
  a.gearbox.backlash_rad = 1.27e-5;
  Scenario s;
  s.duration_s = 1000.0;
  s.sample_s = 100.0;
  s.control = Control::kPosition;
  s.control_stiffness_Nm_rad = 16.2;
  s.control_damping_Nms = 3.4;
  s.command = {.amplitude = 0.3, .frequency_Hz = 1.0};
  s.load.torque_Nm.constant = 0.5;
  s.solver.max_events = 8000;
  const Motion m = simulate(a, s);
  EXPECT_FALSE(m.complete);
  EXPECT_LT(m.events.size(), 8000U);
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes[0].find("unstable: the gains of the control"), std::string::npos) << m.notes[0];
}

Actuator random_locking(RandomNumbers& random) {
  const auto coin = [&] { return random.count(0, 1) == 0; };
  const auto spread = [&](double low, double high) {
    return std::exp(random.between(std::log(low), std::log(high)));
  };
  Actuator a = plain_actuator({.fast_kgm2 = spread(1e-7, 1e-4),
                               .output_kgm2 = spread(1e-3, 1.0),
                               .ratio = spread(5.0, 200.0) * (coin() ? 1.0 : -1.0)},
                              random.between(0.2, 0.9), random.between(-2.0, 0.05));
  a.motor.resistance_ohm = spread(0.3, 5.0);
  a.motor.torque_constant_Nm_A = spread(0.01, 0.1);
  a.motor.coulomb_Nm = coin() ? 0.0 : random.between(0.0, 0.01);
  a.motor.static_Nm = a.motor.coulomb_Nm * (coin() ? 1.0 : random.between(1.0, 2.0));
  a.gearbox.coulomb_Nm = coin() ? 0.0 : random.between(0.0, 0.6);
  a.gearbox.static_Nm = a.gearbox.coulomb_Nm + (coin() ? 0.0 : random.between(0.0, 0.4));
  a.gearbox.viscous_Nms = coin() ? 0.0 : random.between(0.0, 0.1);
  a.gearbox.backlash_rad = coin() ? 0.0 : spread(1e-5, 0.03);
  return a;
}

Scenario random_scenario(RandomNumbers& random, double ratio) {
  const auto coin = [&] { return random.count(0, 1) == 0; };
  Scenario s;
  s.duration_s = 1.0;
  s.start_angle_rad = random.between(-1.0, 1.0);
  s.start_speed_rad_s = coin() ? 0.0 : random.between(-4.0, 4.0);
  s.control = static_cast<Control>(random.count(0, 4));
  const double scale = s.control == Control::kTorque     ? 5.0 / std::abs(ratio)
                       : s.control == Control::kVoltage  ? 12.0
                       : s.control == Control::kPosition ? 0.5
                                                         : 0.0;
  const auto signal = [&](double size) {
    motion::Signal drawn{.constant = coin() ? 0.0 : random.between(-size, size),
                         .amplitude = coin() ? 0.0 : random.between(0.0, size),
                         .frequency_Hz = random.between(0.3, 3.0)};
    if (coin()) return drawn;
    drawn.time_s = {0.0, 0.4, 0.4, 0.8};
    for (int k = 0; k < 4; ++k) drawn.value.push_back(random.between(-size, size));
    return drawn;
  };
  s.command = signal(scale);
  s.control_stiffness_Nm_rad = random.between(1.0, 100.0);
  s.control_damping_Nms = random.between(0.01, 5.0);
  s.load.torque_Nm = signal(coin() ? 0.0 : 3.0);
  s.load.stiffness_Nm_rad = coin() ? 0.0 : random.between(0.1, 50.0);
  if (coin()) s.load.pendulum = {.mass_kg = random.between(0.1, 3.0), .length_m = 0.3};
  return s;
}

TEST(Jam, RandomTrainsUnderAnyDriveAndLoadEndWithTheirLedgersClosed) {
  RandomNumbers random(23);
  int jams = 0;
  for (int k = 0; k < 60; ++k) {
    const Actuator a = random_locking(random);
    const Motion m = simulate(a, random_scenario(random, a.gearbox.ratio));
    EXPECT_LT(m.ledger.balance_error, 1e-9) << k;
    EXPECT_TRUE(m.complete) << k;
    EXPECT_LT(m.events.size(), 5000U) << k;
    for (const auto& event : m.events) {
      if (event.what != "jams") continue;
      ++jams;
      EXPECT_EQ(event.after.phase, motion::Phase::kStick);
      EXPECT_EQ(event.speed_rad_s, 0.0);
    }
  }
  EXPECT_GT(jams, 10);
}

}  // namespace
}  // namespace gear3k::jam_test
