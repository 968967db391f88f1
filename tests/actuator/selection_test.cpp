// Selection against running every pair, and its moments against the exact cycle.
#include "actuator/selection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <utility>

#include "io/files/selection_file.hpp"
#include "tests/actuator/reference_actuators.hpp"
#include "tests/sample.hpp"

namespace gear3k::selection_test {
namespace {

using namespace actuator_test;
using actuator::PairResult, actuator::SelectionTask;

/// The catalogues and the knee of 25 kg; of the motors every `step`-th.
SelectionTask knee_task(std::size_t step) {
  SelectionTask task =
      io::read_selection(std::string(GEAR3K_SOURCE_DIR) + "/examples/actuators/knee_selection.toml")
          .task;
  std::vector<actuator::CatalogueMotor> some;
  for (std::size_t k = 0; k < task.motors.size(); k += step) some.push_back(task.motors[k]);
  task.motors = std::move(some);
  return task;
}

using Places = std::set<std::pair<std::size_t, std::size_t>>;

/// All pairs run; those that no feasible one is better than.
Places front_of_all(const SelectionTask& task) {
  std::vector<PairResult> feasible;
  for (std::size_t m = 0; m < task.motors.size(); ++m) {
    for (std::size_t g = 0; g < task.gearboxes.size(); ++g) {
      const PairResult r = run_pair(task, {.motor = m, .gearbox = g});
      if (!(r.excess > 0.0)) feasible.push_back(r);
    }
  }
  Places front;
  for (const PairResult& r : feasible) {
    const bool beaten = std::ranges::any_of(
        feasible, [&](const PairResult& other) { return dominates(task, other, r); });
    if (!beaten) front.emplace(r.pair.motor, r.pair.gearbox);
  }
  return front;
}

void expect_front_of_all(const SelectionTask& task) {
  const actuator::Selection selection = select(task);
  EXPECT_EQ(selection.verdicts.size(), task.motors.size() * task.gearboxes.size());
  Places front;
  for (const PairResult& r : selection.front) front.emplace(r.pair.motor, r.pair.gearbox);
  EXPECT_EQ(front, front_of_all(task));
  EXPECT_FALSE(front.empty());
  EXPECT_LT(selection.run, selection.verdicts.size() / 10);
}

TEST(Selection, FindsTheFrontOfRunningEveryPairOfSome) {
  SelectionTask task = knee_task(69);
  expect_front_of_all(task);
  using enum actuator::Objective;
  task.objectives = {kEnergy, kMass, kPeakCurrent, kInertia};
  task.drive.efficiency_regenerating = 0.5;
  task.drive.standby_W = 1.0;
  task.max_winding_K = 273.15 + 120.0;
  task.peak_current_factor = 3.0;
  expect_front_of_all(task);
}

TEST(Selection, WithFeltLimitsFindsTheFrontOfRunningEveryPair) {
  SelectionTask task = knee_task(69);
  task.felt = {.max_inertia_kgm2 = 0.5,
               .max_breakaway_Nm = 3.0,
               .max_transparency = 0.6,
               .transparency_torque_Nm = 10.0};
  expect_front_of_all(task);
  // Each of the three rejects pairs that the others leave.
  const auto front_size = [&] { return select(task).front.size(); };
  task.felt.max_inertia_kgm2 = 1e-9;
  EXPECT_EQ(front_size(), 0U);
  const auto nearest = select(task).nearest;
  ASSERT_TRUE(nearest);
  EXPECT_EQ(nearest->limit, actuator::PairLimit::kFeltInertia);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < task.motors.size(); ++m) {
    for (std::size_t g = 0; g < task.gearboxes.size(); ++g) {
      least = std::min(least, run_pair(task, {.motor = m, .gearbox = g}).excess);
    }
  }
  EXPECT_EQ(nearest->excess, least);
}

TEST(Selection, FindsTheFrontOfRunningEveryPair) {
  // All 131,238 pairs in the long run, those of every fifth motor else.
  const std::size_t step = sample<std::size_t>(5, 1);
  const SelectionTask task = knee_task(step);
  EXPECT_EQ(task.motors.size(), (207U + step - 1U) / step);
  EXPECT_EQ(task.gearboxes.size(), 634U);
  expect_front_of_all(task);
}

TEST(Selection, CountsEveryPairOnce) {
  const SelectionTask task = knee_task(1);
  const actuator::Selection selection = select(task);
  EXPECT_EQ(selection.verdicts.size(), 131238U);
  std::size_t rejected = 0;
  for (const std::size_t count : selection.rejected) rejected += count;
  const auto with = [&](actuator::PairStatus status) {
    return static_cast<std::size_t>(
        std::ranges::count(selection.verdicts, status, &actuator::PairVerdict::status));
  };
  EXPECT_EQ(with(actuator::PairStatus::kInfeasible), rejected) << "each with a named limit";
  EXPECT_EQ(with(actuator::PairStatus::kFront), selection.front.size());
}

TEST(Selection, WithoutAFeasiblePairNamesTheNearest) {
  SelectionTask task = knee_task(103);
  task.drive.bus_voltage_V = 0.5;
  const actuator::Selection selection = select(task);
  EXPECT_TRUE(selection.front.empty());
  ASSERT_TRUE(selection.nearest);
  EXPECT_GT(selection.nearest->excess, 0.0);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < task.motors.size(); ++m) {
    for (std::size_t g = 0; g < task.gearboxes.size(); ++g) {
      least = std::min(least, run_pair(task, {.motor = m, .gearbox = g}).excess);
    }
  }
  EXPECT_EQ(selection.nearest->excess, least);
}

TEST(Selection, NoMotorKeepsALimitOfItsWindingBelowItsSurroundings) {
  SelectionTask task = knee_task(9);
  task.ambient_K = 273.15 + 50.0;
  std::size_t known = 0;
  for (actuator::CatalogueMotor& motor : task.motors) {
    if (!motor.motor.heat.winding_housing_K_W) continue;
    motor.motor.heat.max_winding_K = 273.15 + 40.0;
    ++known;
  }
  EXPECT_GT(known, 3U);
  for (std::size_t m = 0; m < task.motors.size(); ++m) {
    const PairResult r = run_pair(task, {.motor = m, .gearbox = 0});
    if (!task.motors[m].motor.heat.max_winding_K) continue;
    EXPECT_GT(r.excess, 0.0) << task.motors[m].name;
    EXPECT_EQ(r.limit, actuator::PairLimit::kWinding) << task.motors[m].name;
  }
}

TEST(Moments, GiveTheSquareTorqueOfTheExactCycle) {
  // pᵀ M p: the motor's torque is linear in what it has and what the cycle asks.
  const auto square_torque = [](const actuator::CycleMoments& moments,
                                const std::array<double, 4>& p) {
    double sum = 0.0;
    for (std::size_t r = 0; r < p.size(); ++r) {
      for (std::size_t c = 0; c < p.size(); ++c) sum += p[r] * moments.square[r][c] * p[c];
    }
    return sum;
  };
  actuator::Actuator a = hip_reference();
  a.motor.coulomb_Nm = 0.003;
  const auto cycle = walking("knee_walking_digitised.csv", "knee", 25.0);
  const auto moments = cycle_moments(a, pieces_of(cycle));
  const auto d = run_cycle(a, cycle);
  const actuator::Chain chain = chain_of(a);
  const double mean =
      square_torque(moments, {1.0, 1e4 * a.motor.rotor_inertia_kgm2, chain.d1_Nms, chain.c1_Nm}) /
      moments.period_s;
  EXPECT_NEAR(std::sqrt(mean) / 100.0, d.rms_motor_torque_Nm, 1e-13);
}

}  // namespace
}  // namespace gear3k::selection_test
