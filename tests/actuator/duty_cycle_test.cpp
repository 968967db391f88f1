// Duty cycles against published reference numbers and identities.
#include "actuator/duty_cycle.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/actuator/reference_actuators.hpp"

namespace gear3k::duty_cycle_test {
namespace {

using namespace actuator_test;
using actuator::Actuator, actuator::Cycle, actuator::DutyCycle, actuator::run_cycle;

TEST(DutyCycle, SteadyLoadsTakeTheReferencesCurrentPowerAndLoss) {
  const DutyCycle forward = run_cycle(first_reference(), steady(2.0, -10.0));
  EXPECT_NEAR(forward.peak_current_A, 5.58, 5e-13);
  EXPECT_NEAR(forward.drawn_J, 43.4682, 5e-5);
  EXPECT_NEAR(loss_of(forward, "mesh"), 5.5, 1e-12);
  const DutyCycle backward = run_cycle(first_reference(), steady(2.0, 10.0));
  EXPECT_NEAR(backward.peak_current_A, 2.08, 5e-13);
  EXPECT_NEAR(backward.regenerated_J, 8.2368, 5e-5);
  EXPECT_NEAR(loss_of(backward, "mesh"), 7.2, 1e-12);
}

TEST(DutyCycle, AHeldLoadTakesTheNearerEndOfTheBand) {
  const DutyCycle held = run_cycle(first_reference(), steady(0.0, -10.0));
  EXPECT_NEAR(held.peak_current_A, 1.84, 5e-13);
  EXPECT_NEAR(held.drawn_J, 0.5 * 1.84 * 1.84, 1e-12);
  const DutyCycle stuck = run_cycle(first_reference(), steady(0.0, -2.1));
  EXPECT_EQ(stuck.peak_current_A, 0.0) << "friction alone holds less than 2.3333 N m";
}

TEST(DutyCycle, ASwingingLoadHasTheReferencesLedger) {
  const DutyCycle d = run_cycle(second_reference(), cosine(5.0, 0.5, 720));
  EXPECT_TRUE(d.periodic);
  EXPECT_NEAR(loss_of(d, "mesh"), 3.25, 5e-3);
  EXPECT_NEAR(loss_of(d, "copper"), 6.746819, 5e-7);
  EXPECT_NEAR(d.drawn_J, 13.850847, 5e-7);
  EXPECT_NEAR(d.regenerated_J, 3.854028, 5e-7);
  EXPECT_LT(d.balance_error, 1e-12);
}

TEST(DutyCycle, TheHipOfAWalkerHasTheReferencesLedger) {
  const DutyCycle d =
      run_cycle(hip_reference(), walking("hip_ankle_walking_digitised.csv", "hip", 75.0));
  EXPECT_NEAR(d.drawn_J, 51.53674, 5e-6);
  EXPECT_NEAR(d.regenerated_J, 0.69883, 5e-6);
  EXPECT_NEAR(loss_of(d, "copper"), 41.53544, 5e-6);
  EXPECT_NEAR(loss_of(d, "mesh"), 2.47630, 5e-6);
  EXPECT_NEAR(d.rms_current_A, 7.880636, 5e-7);
  EXPECT_NEAR(d.peak_current_A, 22.55343, 5e-6);
  EXPECT_LT(d.balance_error, 1e-12);
  ASSERT_TRUE(d.winding);
  EXPECT_TRUE(d.winding->runaway);
  EXPECT_FALSE(d.feasible);
}

Cycle mirrored(Cycle cycle) {
  for (double& torque : cycle.load_Nm) torque = -torque;
  for (double& motion : cycle.motion) motion = -motion;
  return cycle;
}

void expect_same(const DutyCycle& a, const DutyCycle& b) {
  EXPECT_EQ(a.positive_J, b.positive_J);
  EXPECT_EQ(a.negative_J, b.negative_J);
  EXPECT_EQ(a.drawn_J, b.drawn_J);
  EXPECT_EQ(a.regenerated_J, b.regenerated_J);
  for (std::size_t k = 0; k < a.losses.size(); ++k) {
    EXPECT_EQ(a.losses[k].energy_J, b.losses[k].energy_J) << a.losses[k].cause;
  }
  EXPECT_EQ(a.peak_current_A, b.peak_current_A);
  EXPECT_EQ(a.rms_current_A, b.rms_current_A);
  EXPECT_EQ(a.balance_error, b.balance_error);
}

Cycle knee() { return walking("knee_walking_digitised.csv", "knee", 25.0); }

/// The angles that a cycle's speeds sum up to, as rows of its own.
Cycle as_angles(Cycle cycle) {
  double angle = 0.0;
  std::vector<double> angles{0.0};
  for (std::size_t k = 1; k < cycle.motion.size(); ++k) {
    angle +=
        0.5 * (cycle.motion[k] + cycle.motion[k - 1]) * (cycle.time_s[k] - cycle.time_s[k - 1]);
    angles.push_back(angle);
  }
  angles.back() = angles.front();
  cycle.motion = angles;
  cycle.angles = true;
  return cycle;
}

TEST(DutyCycle, AMirroredCycleIsTheSameToTheLastBit) {
  for (const Cycle& cycle : {knee(), as_angles(knee()), steady(0.0, -10.0)}) {
    expect_same(run_cycle(hip_reference(), cycle), run_cycle(hip_reference(), mirrored(cycle)));
  }
}

/// Three rows in place of each, on the same straight lines.
Cycle finer(const Cycle& cycle) {
  Cycle result = cycle;
  result.time_s = {cycle.time_s[0]};
  result.load_Nm = {cycle.load_Nm[0]};
  result.motion = {cycle.motion[0]};
  for (std::size_t k = 1; k < cycle.time_s.size(); ++k) {
    for (const double share : {0.3, 0.8, 1.0}) {
      const auto at = [&](const std::vector<double>& rows) {
        return share == 1.0 ? rows[k] : rows[k - 1] + share * (rows[k] - rows[k - 1]);
      };
      result.time_s.push_back(at(cycle.time_s));
      result.load_Nm.push_back(at(cycle.load_Nm));
      result.motion.push_back(at(cycle.motion));
    }
  }
  return result;
}

TEST(DutyCycle, FinerRowsOfTheSameStraightLinesChangeNothing) {
  const DutyCycle a = run_cycle(hip_reference(), knee());
  const DutyCycle b = run_cycle(hip_reference(), finer(knee()));
  EXPECT_NEAR(a.drawn_J, b.drawn_J, 1e-11 * a.drawn_J);
  EXPECT_NEAR(a.regenerated_J, b.regenerated_J, 1e-11 * a.drawn_J);
  EXPECT_NEAR(a.positive_J, b.positive_J, 1e-11 * a.drawn_J);
  for (std::size_t k = 0; k < a.losses.size(); ++k) {
    EXPECT_NEAR(a.losses[k].energy_J, b.losses[k].energy_J, 1e-11 * a.drawn_J);
  }
  EXPECT_NEAR(a.rms_current_A, b.rms_current_A, 1e-11 * a.rms_current_A);
  EXPECT_NEAR(a.shares->backdriven, b.shares->backdriven, 1e-11);
}

TEST(DutyCycle, ALosslessGearboxLosesNothingInTheMesh) {
  Actuator a = hip_reference();
  a.gearbox.efficiency_forward = 1.0;
  a.gearbox.efficiency_backward = 1.0;
  EXPECT_EQ(loss_of(run_cycle(a, knee()), "mesh"), 0.0);
}

TEST(DutyCycle, ARewoundMotorChangesVoltageAndCurrentOnly) {
  Actuator rewound = hip_reference();
  constexpr double kTurns = 2.5;
  rewound.motor.resistance_ohm *= kTurns * kTurns;
  rewound.motor.torque_constant_Nm_A *= kTurns;
  const DutyCycle a = run_cycle(hip_reference(), knee());
  const DutyCycle b = run_cycle(rewound, knee());
  EXPECT_NEAR(b.drawn_J, a.drawn_J, 1e-12 * a.drawn_J);
  for (std::size_t k = 0; k < a.losses.size(); ++k) {
    EXPECT_NEAR(b.losses[k].energy_J, a.losses[k].energy_J, 1e-12 * a.drawn_J);
  }
  EXPECT_NEAR(b.peak_current_A, a.peak_current_A / kTurns, 1e-12 * a.peak_current_A);
  EXPECT_NEAR(b.peak_voltage_V, a.peak_voltage_V * kTurns, 1e-12 * b.peak_voltage_V);
}

TEST(DutyCycle, PowerBalancesAtEveryInstant) {
  const Actuator actuator = hip_reference();
  const DutyCycle d = run_cycle(actuator, as_angles(knee()), true);
  ASSERT_GT(d.instants.size(), 200U);
  for (const actuator::MotorInstant& p : d.instants) {
    const double motor_w = 100.0 * p.speed_rad_s;
    EXPECT_NEAR(p.electrical_W, 0.608 * p.current_A * p.current_A + p.motor_Nm * motor_w, 1e-10);
  }
  EXPECT_LT(d.balance_error, 1e-12);
}

TEST(DutyCycle, ASelfLockingGearboxIsAResult) {
  Actuator a = hip_reference();
  a.gearbox.efficiency_backward = -0.3;
  a.motor.rotor_inertia_kgm2 = 0.0;  // a braked rotor would give power back
  a.gearbox.input_inertia_kgm2 = 0.0;
  const DutyCycle d = run_cycle(a, knee());
  EXPECT_EQ(d.shares->regenerating, 0.0) << "the motor has to drive down too";
  EXPECT_LT(d.balance_error, 1e-12);
}

TEST(DutyCycle, StandbyAndAChopperStandInTheDrive) {
  Actuator a = hip_reference();
  a.drive = {.bus_voltage_V = std::nullopt,
             .efficiency_motoring = 0.9,
             .efficiency_regenerating = 0.0,
             .standby_W = 2.0};
  const DutyCycle plain = run_cycle(hip_reference(), knee());
  const DutyCycle d = run_cycle(a, knee());
  EXPECT_EQ(d.regenerated_J, 0.0);
  EXPECT_NEAR(d.drawn_J, plain.drawn_J / 0.9 + 2.0 * 1.1, 1e-10);
  EXPECT_LT(d.balance_error, 1e-12);
}

TEST(DutyCycle, LimitsHaveMargins) {
  Actuator a = hip_reference();
  a.motor.max_current_A = 10.0;
  a.drive.bus_voltage_V = 100.0;
  const DutyCycle d = run_cycle(a, knee());
  ASSERT_EQ(d.checks.size(), 2U);
  EXPECT_EQ(d.checks[0].name, "current");
  EXPECT_EQ(*d.checks[0].margin, 10.0 - d.peak_current_A);
  EXPECT_TRUE(d.checks[1].ok);
  EXPECT_EQ(d.feasible, d.checks[0].ok && !d.winding->runaway);
}

// Copper has 0.393 % more resistance for each kelvin above 25 C.
TEST(DutyCycle, SaysWhatTheWarmWindingAddsToItsLoss) {
  Actuator a = hip_reference();
  a.motor.heat = {};
  a.motor.heat.winding_housing_K_W = 1.0;
  a.motor.heat.housing_ambient_K_W = 1.0;
  const auto told = [&a] {
    const DutyCycle d = run_cycle(a, knee());
    const double more = 100.0 * 0.00393 * (d.winding->winding_K.value() - 298.15);
    return std::pair(more, fmt::format("{}", fmt::join(d.notes, "; ")));
  };
  const auto [warm, text] = told();
  ASSERT_GT(warm, 1.5);
  EXPECT_NE(text.find(fmt::format("it is {:.0f} % more", warm)), std::string::npos) << text;
  // Cooled as well as that, it stays at 25 C.
  a.motor.heat.winding_housing_K_W = 1e-6;
  a.motor.heat.housing_ambient_K_W = 1e-6;
  const auto [cool, silent] = told();
  EXPECT_LT(cool, 0.1);
  EXPECT_EQ(silent.find("copper loss"), std::string::npos) << silent;
}

TEST(DutyCycle, SaysWhereNoInsulationLasts) {
  Actuator a = hip_reference();
  a.motor.heat = {};
  a.motor.heat.winding_ambient_K_W = 1.0;
  const auto told = [&a] {
    const DutyCycle d = run_cycle(a, knee());
    const std::string notes = fmt::format("{}", fmt::join(d.notes, "; "));
    return std::pair(d.winding->winding_K.value() - 273.15,
                     notes.find("no insulation lasts") != std::string::npos);
  };
  const auto [cool_C, cool_told] = told();
  EXPECT_LT(cool_C, 300.0);
  EXPECT_FALSE(cool_told);
  a.motor.heat.ambient_K = 273.15 + 301.0;
  const auto [hot_C, hot_told] = told();
  EXPECT_GT(hot_C, 300.0);
  EXPECT_TRUE(hot_told);
}

TEST(DutyCycle, AnOpenCycleHasKineticEnergyAndSaysSo) {
  Cycle cycle = steady(1.0, -2.0);
  cycle.motion = {1.0, 3.0};
  const DutyCycle d = run_cycle(second_reference(), cycle);
  EXPECT_FALSE(d.periodic);
  // J = 50^2 4e-5 + 0.2, from 1 to 3 rad/s.
  EXPECT_NEAR(d.kinetic_J, 0.5 * 0.3 * (9.0 - 1.0), 1e-12);
  EXPECT_FALSE(d.notes.empty());
  EXPECT_LT(d.balance_error, 1e-12);
}

TEST(DutyCycle, WhatACauseCostsIsTheDifferenceOfTwoCycles) {
  const Actuator actuator = hip_reference();
  const DutyCycle whole = run_cycle(actuator, knee());
  Actuator smooth = actuator;
  smooth.gearbox.viscous_Nms = 0.0;
  const DutyCycle without = run_cycle(smooth, knee());
  const auto each = actuator::without_each(actuator, knee(), whole);
  const auto found = std::ranges::find(each, "gear_viscous", &actuator::WithoutCause::cause);
  ASSERT_NE(found, each.end());
  EXPECT_DOUBLE_EQ(found->drawn_J, without.drawn_J);
  EXPECT_GT(found->saved_J, loss_of(whole, "gear_viscous")) << "and copper spent against it";
}

}  // namespace
}  // namespace gear3k::duty_cycle_test
