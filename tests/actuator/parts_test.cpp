// Winding temperature, reflected quantities, splines, impedance.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "actuator/impedance.hpp"
#include "actuator/reflected.hpp"
#include "actuator/winding.hpp"
#include "tests/actuator/reference_actuators.hpp"

namespace gear3k::actuator_parts_test {
namespace {

using namespace actuator_test;
using actuator::Actuator;
using Complex = std::complex<double>;

actuator::Motor warm_motor() {
  actuator::Motor motor;
  motor.resistance_ohm = 0.6;
  motor.heat.winding_housing_K_W = 2.0;
  motor.heat.housing_ambient_K_W = 5.0;
  return motor;
}

TEST(Winding, HasTheReferencesTemperature) {
  const auto state =
      winding_state(warm_motor(), {.mean_square_current_A2 = 10.0, .friction_W = 1.0});
  EXPECT_NEAR(*state->winding_K - 273.15, 81.29147, 5e-6);
  EXPECT_FALSE(winding_state(warm_motor(), {.mean_square_current_A2 = 60.58402})->runaway);
  EXPECT_TRUE(winding_state(warm_motor(), {.mean_square_current_A2 = 60.58404})->runaway);
}

TEST(Winding, BalancesHeatAtBothNodes) {
  actuator::Motor motor = warm_motor();
  motor.heat.ambient_K = 273.15 + 40.0;
  const double square = 12.0;
  const auto state = winding_state(motor, {.mean_square_current_A2 = square, .friction_W = 1.5});
  const double resistance = 0.6 * (1.0 + 0.00393 * (*state->winding_K - 298.15));
  EXPECT_NEAR((*state->winding_K - *state->housing_K) / 2.0, resistance * square, 1e-11);
  EXPECT_NEAR((*state->housing_K - 313.15) / 5.0, resistance * square + 1.5, 1e-11);
}

TEST(Winding, OneResistanceIsPassedByAllHeat) {
  actuator::Motor motor = warm_motor();
  motor.heat = {};
  motor.heat.winding_ambient_K_W = 3.0;
  motor.heat.winding_time_constant_s = 60.0;
  motor.heat.ambient_K = 290.0;
  const auto state = winding_state(motor, {.mean_square_current_A2 = 12.0, .friction_W = 1.5});
  const double resistance = 0.6 * (1.0 + 0.00393 * (*state->winding_K - 298.15));
  EXPECT_NEAR((*state->winding_K - 290.0) / 3.0, resistance * 12.0 + 1.5, 1e-11);
  EXPECT_FALSE(state->housing_K);
  EXPECT_DOUBLE_EQ(*state->winding_J_K, 20.0);
  // Half a path tells no temperature.
  motor.heat = {};
  motor.heat.winding_housing_K_W = 3.0;
  EXPECT_FALSE(winding_state(motor, {.mean_square_current_A2 = 12.0}));
}

TEST(Reflected, HasTheReferencesBreakaway) {
  const auto r = reflected(first_reference());
  EXPECT_NEAR(*r.breakaway_Nm, 2.33333, 5e-6);
  EXPECT_NEAR(*r.breakaway_motor_Nm, 0.054, 1e-15);
  Actuator locking = first_reference();
  locking.gearbox.efficiency_backward = 0.0;
  EXPECT_FALSE(reflected(locking).breakaway_Nm);
}

TEST(Reflected, SpringsStandInSeries) {
  Actuator a = first_reference();
  a.motor.shaft_stiffness_Nm_rad = 4.861;
  a.gearbox.stiffness_Nm_rad = 10000.0;
  const auto r = reflected(a);
  EXPECT_NEAR(*r.total_Nm_rad * (10000.0 + 2500.0 * 4.861), 10000.0 * 2500.0 * 4.861, 1e-4);
}

Actuator lossy_inertia() {
  Actuator a;
  a.motor.resistance_ohm = 1.0;
  a.motor.torque_constant_Nm_A = 0.1;
  a.gearbox.ratio = 20.0;
  a.motor.rotor_inertia_kgm2 = 0.02 / 400.0;
  a.gearbox.efficiency_forward = 0.85;
  a.gearbox.efficiency_backward = 0.8;
  return a;
}

actuator::ImpedancePoint at_2_hertz(const Actuator& a, double amplitude_rad) {
  return impedance(a, {.low_Hz = 2.0, .high_Hz = 2.0, .points = 1, .amplitude_rad = amplitude_rad})
      .front();
}

TEST(FirstHarmonic, HasTheReferencesImpedance) {
  const auto inertia = *at_2_hertz(lossy_inertia(), 0.3).first_harmonic_Nms;
  EXPECT_NEAR(inertia.real(), 0.032, 5e-8);
  EXPECT_NEAR(inertia.imag(), 0.2638938, 5e-8);
  Actuator rough = lossy_inertia();
  rough.motor.coulomb_Nm = 0.01;
  rough.gearbox.coulomb_Nm = 0.4;
  rough.gearbox.viscous_Nms = 0.02;
  rough.load_inertia_kgm2 = 0.03;
  const auto point = at_2_hertz(rough, 0.3);
  EXPECT_NEAR(point.first_harmonic_Nms->real(), 0.2594456, 5e-8);
  EXPECT_NEAR(point.first_harmonic_Nms->imag(), 0.6542934, 5e-8);
  EXPECT_NEAR(*point.flow_change_rad * 180.0 / std::numbers::pi, 12.18599, 5e-6);
}

TEST(FirstHarmonic, OfCoulombFrictionAloneIsFourOverPi) {
  Actuator a = lossy_inertia();
  a.motor.rotor_inertia_kgm2 = 0.0;
  a.gearbox.coulomb_Nm = 0.7;
  const double speed = 0.3 * 4.0 * std::numbers::pi;
  EXPECT_NEAR(at_2_hertz(a, 0.3).first_harmonic_Nms->real(), 4.0 * 0.7 / (std::numbers::pi * speed),
              1e-13);
}

/// The first harmonic of a moved output, by stepping through one period of the motion.
Complex stepped(double eta_f, double eta_b, double j1, double d1, double c1, double j2, double d2,
                double c2, double omega, double amplitude) {
  constexpr int kSteps = 2000000;
  const double speed = amplitude * omega;
  Complex sum;
  for (int k = 0; k < kSteps; ++k) {
    const double x = 2.0 * std::numbers::pi * (k + 0.5) / kSteps;
    const double w = speed * std::cos(x);
    const double a = -speed * omega * std::sin(x);
    const double s = w > 0.0 ? 1.0 : -1.0;
    const double u = -(j1 * a + d1 * w + c1 * s);  // motor off
    const double m = u * s > 0.0 ? eta_f * u : u / eta_b;
    const double torque = j2 * a + d2 * w + c2 * s - m;
    sum += torque * std::exp(Complex(0.0, -x));
  }
  return sum * (2.0 / kSteps / speed);
}

TEST(FirstHarmonic, AgreesWithAStepThroughTheMotion) {
  Actuator a = lossy_inertia();
  a.motor.coulomb_Nm = 0.02;
  a.motor.viscous_Nms = 2e-4;
  a.gearbox.coulomb_Nm = 0.3;
  a.gearbox.viscous_Nms = 0.05;
  a.load_inertia_kgm2 = 0.04;
  const auto found = *at_2_hertz(a, 0.2).first_harmonic_Nms;
  const Complex expected = stepped(0.85, 0.8, 0.02, 400.0 * 2e-4, 20.0 * 0.02, 0.04, 0.05, 0.3,
                                   4.0 * std::numbers::pi, 0.2);
  EXPECT_NEAR(std::abs(found - expected), 0.0, 2e-6 * std::abs(expected));
}

TEST(Impedance, OfALockedMotorIsThatOfItsSprings) {
  Actuator a = lossy_inertia();
  a.motor.shaft_stiffness_Nm_rad = 5.0;
  a.gearbox.stiffness_Nm_rad = 3000.0;
  const auto point = impedance(a, {.low_Hz = 1e-3,
                                   .high_Hz = 1e-3,
                                   .points = 1,
                                   .motor = actuator::MotorTerminals::kLocked})
                         .front();
  EXPECT_NEAR(point.stiffness_Nm_rad->real(), 1.0 / (1.0 / 2000.0 + 1.0 / 3000.0), 1e-9);
}

/// The linear chain of two springs as an assembled network of three masses.
TEST(Impedance, OfTheChainIsThatOfItsNetwork) {
  Actuator a = lossy_inertia();
  a.motor.viscous_Nms = 1e-4;
  a.motor.shaft_stiffness_Nm_rad = 5.0;
  a.gearbox.stiffness_Nm_rad = 3000.0;
  a.gearbox.input_inertia_kgm2 = 3e-5;
  a.gearbox.viscous_Nms = 0.07;
  a.load_inertia_kgm2 = 0.05;
  const auto point = impedance(a, {.low_Hz = 30.0,
                                   .high_Hz = 30.0,
                                   .points = 1,
                                   .motor = actuator::MotorTerminals::kShorted})
                         .front();
  const double omega = 60.0 * std::numbers::pi;
  const Complex j(0.0, 1.0);
  const double d1 = 400.0 * 1e-4 + std::pow(20.0 * 0.1, 2) / 1.0;
  // Moved output x3 = 1: solve the two inner nodes.
  const Complex a11 = -omega * omega * 0.02 + j * omega * d1 + 2000.0;
  const Complex a22 = -omega * omega * 400.0 * 3e-5 + 2000.0 + 3000.0;
  const Complex x2 = 3000.0 / (a22 - 2000.0 * 2000.0 / a11);
  const Complex force = -omega * omega * 0.05 + j * omega * 0.07 + 3000.0 * (1.0 - x2);
  EXPECT_NEAR(std::abs(*point.stiffness_Nm_rad - force), 0.0, 1e-10 * std::abs(force));
}

Actuator springy(double load_kgm2) {
  Actuator a = lossy_inertia();
  a.motor.viscous_Nms = 1e-4;
  a.motor.shaft_stiffness_Nm_rad = 5.0;
  a.gearbox.stiffness_Nm_rad = 3000.0;
  a.gearbox.input_inertia_kgm2 = 3e-5;
  a.gearbox.output_inertia_kgm2 = 0.01;
  a.gearbox.viscous_Nms = 0.07;
  a.gearbox.coulomb_Nm = 0.3;
  a.motor.coulomb_Nm = 0.02;
  a.load_inertia_kgm2 = load_kgm2;
  return a;
}

Complex sum_of(const std::vector<actuator::ImpedanceCause>& causes) {
  Complex sum;
  for (const auto& cause : causes) sum += cause.impedance_Nms;
  return sum;
}
Complex of(const std::vector<actuator::ImpedanceCause>& causes, const std::string& name) {
  for (const auto& cause : causes) {
    if (cause.name == name) return cause.impedance_Nms;
  }
  ADD_FAILURE() << name;
  return {};
}

TEST(Impedance, ItsCausesAddUpWithAnyTerminals) {
  using enum actuator::MotorTerminals;
  for (const auto terminals : {kOpen, kShorted, kLocked}) {
    const auto points = impedance(
        springy(0.05),
        {.low_Hz = 0.5, .high_Hz = 80.0, .points = 7, .amplitude_rad = 0.2, .motor = terminals});
    for (const auto& p : points) {
      EXPECT_NEAR(std::abs(sum_of(p.causes) - *p.impedance_Nms), 0.0,
                  1e-12 * std::abs(*p.impedance_Nms));
      EXPECT_EQ(p.first_harmonic_Nms.has_value(), terminals != kLocked);
      if (!p.first_harmonic_Nms) continue;
      EXPECT_NEAR(std::abs(sum_of(p.harmonic_causes) - *p.first_harmonic_Nms), 0.0,
                  1e-12 * std::abs(*p.first_harmonic_Nms));
    }
  }
}

/// A cause's real part is what its damper dissipates: moved to and fro in the time domain.
TEST(Impedance, ADampersPartIsThePowerThatItTakes) {
  Actuator a = springy(0.05);
  a.motor.viscous_Nms = 5e-3;  // free motions die out
  const auto p = impedance(a, {.low_Hz = 9.0, .high_Hz = 9.0, .points = 1}).front();
  const double omega = 18.0 * std::numbers::pi;
  // Rotor and input behind a prescribed output sin(omega t), by small steps until they repeat.
  const double rotor = 0.02;
  const double input = 400.0 * 3e-5;
  const double damper = 400.0 * 5e-3;
  constexpr int kSteps = 4000;
  const double h = 2.0 * std::numbers::pi / omega / kSteps;
  std::array<double, 4> y{};  // rotor, input, and their speeds
  const auto slope = [&](const std::array<double, 4>& s, double t) {
    const double twist = 2000.0 * (s[0] - s[1]);
    return std::array<double, 4>{s[2], s[3], (-twist - damper * s[2]) / rotor,
                                 (twist + 3000.0 * (std::sin(omega * t) - s[1])) / input};
  };
  double taken = 0.0;
  constexpr int kPeriods = 60;
  for (int k = 0; k < kPeriods * kSteps; ++k) {
    const double t = k * h;
    const auto step = [&](const std::array<double, 4>& d, double by) {
      std::array<double, 4> next = y;
      for (std::size_t n = 0; n < y.size(); ++n) next[n] += by * d[n];
      return next;
    };
    const auto k1 = slope(y, t);
    const auto k2 = slope(step(k1, 0.5 * h), t + 0.5 * h);
    const auto k3 = slope(step(k2, 0.5 * h), t + 0.5 * h);
    const auto k4 = slope(step(k3, h), t + h);
    if (k >= (kPeriods - 1) * kSteps) taken += damper * y[2] * y[2] * h;
    for (std::size_t n = 0; n < y.size(); ++n) {
      y[n] += h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]);
    }
  }
  // Over a period |W|^2 Re Z/2 times the period, |W| = omega.
  const double expected = 0.5 * omega * omega * of(p.causes, "motor_viscous").real() * kSteps * h;
  EXPECT_NEAR(taken, expected, 1e-6 * expected);
}

TEST(Impedance, WithoutACauseItsPartIsZero) {
  Actuator a = springy(0.0);
  a.motor.rotor_inertia_kgm2 = 0.0;
  a.gearbox.efficiency_forward = 1.0;
  a.gearbox.efficiency_backward = 1.0;
  a.gearbox.stiffness_Nm_rad.reset();
  const auto p = at_2_hertz(a, 0.2);
  for (const char* name : {"motor_inertia", "load_inertia", "gear_stiffness", "short_circuit"}) {
    EXPECT_EQ(of(p.causes, name), Complex(0.0)) << name;
  }
  EXPECT_EQ(of(p.harmonic_causes, "mesh"), Complex(0.0));
  // The others stay: a rigid gearbox moves its input inertia as the output.
  const double omega = 4.0 * std::numbers::pi;
  EXPECT_NEAR(of(p.causes, "gear_inertia").imag(), omega * (400.0 * 3e-5 + 0.01), 1e-13);
}

TEST(Cycle, APeriodicSplineFollowsASine) {
  actuator::Cycle cycle;
  cycle.angles = true;
  constexpr int kRows = 200;
  for (int k = 0; k <= kRows; ++k) {
    cycle.time_s.push_back(0.01 * k);
    cycle.load_Nm.push_back(0.0);
    cycle.motion.push_back(std::sin(2.0 * std::numbers::pi * (k % kRows) / kRows));
  }
  const auto pieces = pieces_of(cycle);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double speed = std::numbers::pi * std::cos(std::numbers::pi * (cycle.time_s[k] + 0.005));
    EXPECT_NEAR(actuator::value_at(pieces[k].speed_rad_s, 0.5), speed, 1e-5);
    const auto& next = pieces[(k + 1) % pieces.size()];
    EXPECT_NEAR(actuator::value_at(pieces[k].speed_rad_s, 1.0), next.speed_rad_s[0], 1e-12);
    EXPECT_NEAR(pieces[k].acceleration(1.0), next.acceleration(0.0), 1e-9);
  }
}

TEST(Cycle, AnOpenSplineIsExactForACubic) {
  actuator::Cycle cycle;
  cycle.angles = true;
  cycle.time_s = {0.0, 0.3, 0.5, 1.1, 1.3, 2.0};
  for (const double t : cycle.time_s) {
    cycle.load_Nm.push_back(t);
    cycle.motion.push_back(1.0 + t * (2.0 + t * (-3.0 + t)));
  }
  const auto pieces = pieces_of(cycle);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double t = cycle.time_s[k] + 0.25 * pieces[k].duration_s;
    EXPECT_NEAR(actuator::value_at(pieces[k].speed_rad_s, 0.25), 2.0 + t * (-6.0 + 3.0 * t), 1e-12);
  }
}

}  // namespace
}  // namespace gear3k::actuator_parts_test
