// Energies of motors with gearboxes still to be designed: against the exact cycle, against every
// motor and gearbox of a box, and in the search against one search for each tooth set and motor.
#include "actuator/co_design.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actuator/design_gear.hpp"
#include "actuator/duty_cycle.hpp"
#include "actuator/felt.hpp"
#include "actuator/reflected.hpp"
#include "io/files/selection_file.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/energy_box.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/refinement_problem.hpp"
#include "tests/rig/deterministic_random.hpp"
#include "tests/sample.hpp"

namespace gear3k::co_design_test {
namespace {

using actuator::CoDesign, actuator::PairResult, actuator::SelectionTask;
using rig::DeterministicRandom;

actuator::CatalogueMotor random_motor(DeterministicRandom& random, bool limited) {
  actuator::CatalogueMotor m;
  m.motor.resistance_ohm = random.between(0.1, 3.0);
  m.motor.torque_constant_Nm_A = random.between(0.01, 0.2);
  m.motor.rotor_inertia_kgm2 = random.between(0.0, 1e-4);
  m.motor.coulomb_Nm = random.between(0.0, 0.01);
  m.motor.static_Nm = m.motor.coulomb_Nm * random.between(1.0, 1.5);
  m.motor.viscous_Nms = random.between(0.0, 2e-5);
  if (limited) {
    m.nominal_current_A = random.between(1.0, 20.0);
    m.nominal_voltage_V = random.between(6.0, 60.0);
    m.motor.max_speed_rad_s = random.between(100.0, 1000.0);
    m.motor.heat.winding_housing_K_W = random.between(0.5, 5.0);
    m.motor.heat.housing_ambient_K_W = random.between(0.5, 5.0);
    m.motor.heat.max_winding_K = 273.15 + random.between(80.0, 150.0);
  }
  return m;
}

/// Rows with rests, turns and changes of the flow.
actuator::Cycle random_cycle(DeterministicRandom& random) {
  actuator::Cycle c;
  c.angles = random.uniform() < 0.3;
  double time = 0.0;
  const std::size_t rows = 5 + random.index(12);
  bool rest = false;
  for (std::size_t k = 0; k < rows; ++k) {
    c.time_s.push_back(time);
    time += random.between(0.02, 0.2);
    c.load_Nm.push_back(random.between(-10.0, 10.0));
    const bool still = !c.angles && random.uniform() < 0.3;
    c.motion.push_back(rest || still ? 0.0 : random.between(-5.0, 5.0));
    rest = still;
  }
  c.time_s.push_back(time);
  c.load_Nm.push_back(c.load_Nm.front());
  c.motion.push_back(c.motion.front());
  return c;
}

SelectionTask random_task(DeterministicRandom& random, bool limited) {
  SelectionTask task;
  for (std::size_t k = 0; k < 4; ++k) task.motors.push_back(random_motor(random, limited));
  for (std::size_t k = 0; k < 2; ++k) {
    task.cycles.push_back(random_cycle(random));
    task.weights.push_back(random.between(0.5, 3.0));
  }
  task.load_inertia_kgm2 = random.uniform() < 0.5 ? 0.0 : random.between(0.0, 0.3);
  if (random.uniform() < 0.6) {
    task.drive.efficiency_motoring = random.between(0.7, 1.0);
    task.drive.efficiency_regenerating = random.uniform() < 0.3 ? 0.0 : random.between(0.2, 1.0);
    task.drive.standby_W = random.between(0.0, 5.0);
  }
  if (limited) task.peak_current_factor = random.between(1.0, 4.0);
  return task;
}

/// With limits of what is felt, each now and then.
SelectionTask random_felt_task(DeterministicRandom& random) {
  SelectionTask task = random_task(random, false);
  actuator::FeltLimits& felt = task.felt;
  if (random.uniform() < 0.5) felt.max_inertia_kgm2 = random.between(0.05, 3.0);
  if (random.uniform() < 0.5) felt.max_breakaway_Nm = random.between(0.1, 2.0);
  felt.transparency_torque_Nm = random.between(0.2, 10.0);
  if (random.uniform() < 0.5) felt.max_transparency = random.between(0.2, 1.8);
  return task;
}

using RandomGearbox = optimize::EnergyGearbox;
RandomGearbox random_gearbox(DeterministicRandom& random) {
  return {.ratio = random.between(10.0, 150.0) * (random.uniform() < 0.5 ? -1.0 : 1.0),
          .forward = random.between(0.3, 1.0),
          .backward = random.between(0.05, 1.0),
          .inertia_kgm2 = random.uniform() < 0.5 ? 0.0 : random.between(0.0, 0.3)};
}

/// Gearboxes with efficiencies up to these.
optimize::EnergyBox box_of(const RandomGearbox& most) {
  return {.ratio = most.ratio, .most_forward = most.forward, .most_backward = most.backward};
}

/// Least energy of the motors that keep their limits, by their exact cycles; empty where none does.
std::optional<double> least_of_exact(const CoDesign& co_design, const RandomGearbox& g) {
  std::optional<double> least;
  for (std::size_t k = 0; k < co_design.task().motors.size(); ++k) {
    const PairResult r = co_design.run(k, g);
    if (!(r.excess > 0.0) && !(least && *least <= r.energy_J)) least = r.energy_J;
  }
  return least;
}

TEST(CoDesign, EnergyAndLimitsAreThoseOfTheExactCyclesOfEveryMotor) {
  int within = 0;
  int beyond = 0;
  for (std::uint64_t seed = 1; seed <= sample(150U, 2000U); ++seed) {
    DeterministicRandom random(seed);
    const CoDesign co_design(random_task(random, seed % 2 == 0));
    const RandomGearbox g = random_gearbox(random);
    const auto at = co_design.at(g);
    const auto exact = least_of_exact(co_design, g);
    ASSERT_EQ(at.within_limits, exact.has_value()) << seed;
    (exact ? within : beyond) += 1;
    if (!exact) continue;
    EXPECT_NEAR(at.energy_J, *exact, 1e-10 * (std::abs(*exact) + co_design.scale_j())) << seed;
  }
  EXPECT_GT(within, 50);
  EXPECT_GT(beyond, 20);
}

TEST(CoDesign, WhatIsFeltIsThatOfTheActuatorWithEveryMotor) {
  int within = 0;
  std::array<int, 3> broken{};
  for (std::uint64_t seed = 1; seed <= sample(150U, 2000U); ++seed) {
    DeterministicRandom random(seed + 5000);
    const CoDesign co_design(random_felt_task(random));
    const RandomGearbox g = random_gearbox(random);
    const SelectionTask& task = co_design.task();
    std::optional<double> least;
    for (std::size_t k = 0; k < task.motors.size(); ++k) {
      // As `gear3k actuator` checks them.
      actuator::Actuator a;
      a.motor = task.motors[k].motor;
      a.gearbox.ratio = g.ratio;
      a.gearbox.efficiency_forward = g.forward;
      a.gearbox.efficiency_backward = g.backward;
      a.gearbox.input_inertia_kgm2 = g.inertia_kgm2 / (g.ratio * g.ratio);
      a.load_inertia_kgm2 = task.load_inertia_kgm2;
      a.felt = task.felt;
      const auto torque = actuator::felt_torque(a, *task.felt.transparency_torque_Nm);
      bool kept = true;
      for (const auto& check : actuator::felt_checks(a, actuator::reflected(a), torque)) {
        kept = kept && check.ok;
      }
      const PairResult r = co_design.run(k, g);
      EXPECT_EQ(kept, !(r.excess > 0.0)) << seed << " motor " << k;
      if (!kept) {
        const auto limit = static_cast<std::size_t>(r.limit.value());
        const auto first = static_cast<std::size_t>(actuator::PairLimit::kFeltInertia);
        ASSERT_GE(limit, first);
        ++broken.at(limit - first);
      }
      if (kept && !(least && *least <= r.energy_J)) least = r.energy_J;
    }
    const auto at = co_design.at(g);
    ASSERT_EQ(at.within_limits, least.has_value()) << seed;
    if (!least) continue;
    ++within;
    EXPECT_NEAR(at.energy_J, *least, 1e-10 * (std::abs(*least) + co_design.scale_j())) << seed;
  }
  EXPECT_GT(within, 30);
  for (const int count : broken) EXPECT_GT(count, 10);
}

TEST(CoDesign, WhatIsFeltRulesNoGearboxOfABoxOutThatKeepsItsLimits) {
  int ruled_out = 0;
  for (std::uint64_t seed = 1; seed <= sample(25U, 3000U); ++seed) {
    DeterministicRandom random(seed + 6000);
    const CoDesign co_design(random_felt_task(random));
    const RandomGearbox most = random_gearbox(random);
    const double bound = co_design.least(box_of(most));
    if (std::isinf(bound)) ++ruled_out;
    for (int k = 0; k < 20; ++k) {
      const double forward = k == 0 ? most.forward : most.forward * random.between(0.5, 1.0);
      const double backward = k < 2 ? most.backward : most.backward * random.between(0.5, 1.0);
      const double inertia = most.inertia_kgm2 * (k == 0 ? 1.0 : random.between(0.9, 1.56));
      const auto exact = least_of_exact(co_design, {most.ratio, forward, backward, inertia});
      if (!exact) continue;
      EXPECT_LE(bound, *exact + 1e-9 * co_design.scale_j()) << seed;
    }
  }
  EXPECT_GT(ruled_out, 2);
}

TEST(CoDesign, SlopesAreThoseOfDifferences) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    DeterministicRandom random(seed + 1000);
    SelectionTask task = random_task(random, false);
    task.motors.resize(1);  // the best one may be another one a step away
    const CoDesign co_design(std::move(task));
    const RandomGearbox g = random_gearbox(random);
    const auto at = co_design.at(g);
    constexpr double kStep = 1e-5;
    const auto forward = [&](double step) {
      RandomGearbox other = g;
      other.forward = 1.0 / (1.0 / g.forward + step);
      return co_design.at(other).energy_J;
    };
    const auto backward = [&](double step) {
      RandomGearbox other = g;
      other.backward = g.backward + step;
      return co_design.at(other).energy_J;
    };
    const double size = co_design.scale_j() + std::abs(at.energy_J);
    EXPECT_NEAR(at.slope[0], (forward(kStep) - forward(-kStep)) / (2.0 * kStep), 1e-5 * size);
    EXPECT_NEAR(at.slope[1], (backward(kStep) - backward(-kStep)) / (2.0 * kStep), 1e-5 * size);
    const auto inertia = [&](double step) {
      RandomGearbox other = g;
      other.inertia_kgm2 = g.inertia_kgm2 + step;
      return co_design.at(other);
    };
    const auto up = inertia(kStep);
    const auto down = inertia(-kStep);
    EXPECT_NEAR(at.inertia_slope, (up.energy_J - down.energy_J) / (2.0 * kStep),
                1e-5 * (size + std::abs(at.inertia_slope)));
    // A drive with losses bends by jumps of its slope, too.
    const actuator::Drive& drive = co_design.task().drive;
    const bool smooth = drive.efficiency_motoring == 1.0 && drive.efficiency_regenerating == 1.0;
    for (const std::size_t flow : {0U, 1U}) {
      if (!smooth) break;
      EXPECT_NEAR(at.mixed[flow], (up.slope[flow] - down.slope[flow]) / (2.0 * kStep),
                  1e-4 * (size + std::abs(at.mixed[flow])));
    }
    EXPECT_GE(at.inertia_curvature, 0.0);
    EXPECT_GE(at.curvature[0], 0.0);
    EXPECT_GE(at.curvature[1], 0.0);
  }
}

TEST(CoDesign, NoGearboxOfABoxNeedsLessThanItsBound) {
  int inner = 0;
  for (std::uint64_t seed = 1; seed <= sample(30U, 3000U); ++seed) {
    DeterministicRandom random(seed + 2000);
    const CoDesign co_design(random_task(random, seed % 3 == 0));
    const RandomGearbox most = random_gearbox(random);
    const double bound = co_design.least(box_of(most));
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 40; ++k) {
      const double forward = k == 0 ? most.forward : most.forward * random.between(0.05, 1.0);
      const double backward = k < 2 ? most.backward : most.backward * random.uniform();
      const double inertia = most.inertia_kgm2 * (k == 0 ? 1.0 : random.between(0.9, 1.56));
      const auto exact = least_of_exact(co_design, {most.ratio, forward, backward, inertia});
      if (exact) least = std::min(least, *exact);
      if (exact && k > 1 && *exact == least) ++inner;
    }
    EXPECT_LE(bound, least + 1e-9 * co_design.scale_j()) << seed;
  }
  EXPECT_GT(inner, 0);  // the most efficient gearbox is not always the best
}

TEST(CoDesign, TheBoundOfABoxIsReachedInIt) {
  for (std::uint64_t seed = 1; seed <= sample(8U, 100U); ++seed) {
    DeterministicRandom random(seed + 3000);
    const CoDesign co_design(random_task(random, false));
    RandomGearbox most = random_gearbox(random);
    most.inertia_kgm2 = 0.0;  // bounds with inertia leave room for what it may be at any time
    const double bound = co_design.least(box_of(most));
    // Energies forward and backward add up for one motor: two lines instead of a grid.
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < co_design.task().motors.size(); ++k) {
      SelectionTask task = co_design.task();
      task.motors = {task.motors[k]};
      const CoDesign own(std::move(task));
      constexpr int kSteps = 400;
      double forward = std::numeric_limits<double>::infinity();
      double backward = forward;
      const double corner = own.at(most).energy_J;
      for (int n = 0; n <= kSteps; ++n) {
        const double share = static_cast<double>(n) / kSteps;
        forward = std::min(
            forward,
            own.at({most.ratio, most.forward * (1.0 - 0.999 * share), most.backward}).energy_J);
        backward = std::min(
            backward, own.at({most.ratio, most.forward, most.backward * (1.0 - share)}).energy_J);
      }
      least = std::min(least, forward + backward - corner);
    }
    EXPECT_NEAR(bound, least, 2e-4 * (std::abs(least) + co_design.scale_j())) << seed;
  }
}

constexpr const char* kSmallTask = R"(
objective = "cycle_energy"
[actuator]
motors = "../../data/motor_catalogue.csv"
[cycle]
files = "knee_walking.csv"
[ratio]
target = 45.0
tolerance = 0.3
[teeth]
S = [15, 15]
P1 = [30, 30]
R1_max = 90
P2 = [LEAST, 33]
R2_max = 90
[module]
stage1_mm = { min = 0.5, max = 0.8 }
stage2_mm = { min = 0.5, max = 0.8 }
[size]
max_ring_root_diameter_mm = 60.0
[backlash]
max_output_arcmin = 10.0
min_normal_um = 5.0
machining_allowance = 0.02
[friction]
coefficient = 0.08
)";

constexpr const char* kMasses =
    "[stage1]\nface_width_mm = 8.0\n[stage2]\nface_width_mm = 10.0\n[inertia]\ndensity_kg_m3 = "
    "7850.0\n";

/// The small task with some of the catalogue's motors.
optimize::Specification small_task(std::size_t step, bool masses = false) {
  std::string text = kSmallTask;
  if (masses) {
    text += kMasses;
    const std::string size = "[size]\n";
    text.insert(text.find(size) + size.size(), "ring_rim_mm = 2.0\n");
  }
  text.replace(text.find("LEAST"), 5, sample("32", "28"));
  optimize::Specification spec = io::parse_specification(
      text, std::string(GEAR3K_SOURCE_DIR) + "/examples/actuators/small.toml");
  SelectionTask task = actuator::co_design_of(spec.cycle_energy.get())->task();
  std::vector<actuator::CatalogueMotor> some;
  for (std::size_t k = 0; k < task.motors.size(); k += step) some.push_back(task.motors[k]);
  task.motors = std::move(some);
  spec.cycle_energy = std::make_shared<const CoDesign>(std::move(task));
  return spec;
}

/// With one motor alone.
optimize::Specification with_motor(const optimize::Specification& spec, std::size_t motor) {
  optimize::Specification own = spec;
  SelectionTask task = actuator::co_design_of(spec.cycle_energy.get())->task();
  task.motors = {task.motors[motor]};
  own.cycle_energy = std::make_shared<const CoDesign>(std::move(task));
  return own;
}

void expect_the_best_of_each_set_and_motor(const optimize::Specification& spec) {
  optimize::Progress progress;
  const auto result = optimize::optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best && result.certificate);
  const double found = -optimize::merit_of(spec, *result.best);
  double least = std::numeric_limits<double>::infinity();
  std::size_t refined = 0;
  const std::size_t motors = actuator::co_design_of(spec.cycle_energy.get())->task().motors.size();
  for (std::size_t motor = 0; motor < motors; ++motor) {
    const optimize::Specification own = with_motor(spec, motor);
    for (const optimize::Candidate& candidate : result.search.candidates) {
      const optimize::RefinedSet set = optimize::refine(own, candidate);
      if (set.status != optimize::Status::kOptimal) continue;
      ++refined;
      least = std::min(least, -optimize::merit_of(own, set));
    }
  }
  EXPECT_GT(refined, 3U);
  EXPECT_LT(result.refined.size(), refined);
  // A stride may give back more than it takes.
  EXPECT_NEAR(found, least, 1e-6 * std::abs(least));
  EXPECT_LE(-result.certificate->global_bound, least + 1e-9 * std::abs(least));
}

TEST(CoDesignSearch, FindsWhatOneSearchForEachToothSetAndMotorFinds) {
  expect_the_best_of_each_set_and_motor(small_task(sample<std::size_t>(45, 15)));
}

TEST(CoDesignSearch, WithTheInertiaOfTheGearsFindsWhatOneSearchForEachToothSetAndMotorFinds) {
  expect_the_best_of_each_set_and_motor(small_task(sample<std::size_t>(45, 15), true));
}

/// A feasible design drawn between a set's optimum and a place anywhere in its box.
std::optional<optimize::RefinedSet> random_design(DeterministicRandom& random,
                                                  const optimize::Specification& spec,
                                                  const optimize::RefinedSet& optimum) {
  const auto problem = optimize::make_refinement_problem(spec, optimum.candidate, {});
  const optimize::Point best = point_of(problem, train_of(spec, optimum), {});
  optimize::Point end{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
    end[k] = random.between(problem.lower[k], problem.upper[k]);
  }
  std::vector<double> g(problem.rows.size());
  for (double share = random.uniform(); share > 1e-6; share *= 0.5) {
    optimize::Point v = best;
    for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
      v[k] += share * (end[k] - best[k]);
    }
    if (!optimize::evaluate<double>(problem, used(problem, v), g)) continue;
    if (!(optimize::worst_violation(g) <= 0.0)) continue;
    const auto parameters = parameters_at(problem, used(problem, v));
    optimize::RefinedSet set = optimum;
    set.train.profile_shift = parameters.profile_shift;
    set.train.module_m = parameters.module_m;
    set.train.center_distance_m = parameters.center_distance_m;
    return set;
  }
  return std::nullopt;
}

/// @param within  how near the least energy of all comes to the bound, over its size
void expect_no_random_design_below_the_bound(const optimize::Specification& spec, double within) {
  const SelectionTask& task = actuator::co_design_of(spec.cycle_energy.get())->task();
  optimize::Progress progress;
  const auto best = optimize::optimize(spec, progress, {.best_only = true});
  const auto all = optimize::optimize(spec, progress);
  ASSERT_TRUE(best.certificate);
  const double bound = -best.certificate->global_bound;
  std::vector<const optimize::RefinedSet*> optima;
  for (const optimize::RefinedSet& set : all.refined) {
    if (set.status == optimize::Status::kOptimal) optima.push_back(&set);
  }
  ASSERT_FALSE(optima.empty());
  DeterministicRandom random(7);
  std::size_t designs = 0;
  std::size_t judged = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; designs < sample<std::size_t>(200, 10000); ++n) {
    ASSERT_LT(n, 200000U);
    const auto set = random_design(random, spec, *optima[random.index(optima.size())]);
    if (!set) continue;
    ++designs;
    // The power flow of the design itself, with the motor that is best for the optimum or any.
    actuator::Actuator a;
    a.train = std::make_shared<const actuator::DesignTrain>(design_of(spec, *set));
    a.gearbox.ratio = a.train->ratio();
    const std::size_t chosen =
        n % 2 == 0 ? spec.cycle_energy->at({a.gearbox.ratio, set->eta_f, set->eta_b}).motor
                   : random.index(task.motors.size());
    a.motor = task.motors[chosen].motor;
    const actuator::DutyCycle d = actuator::run_cycle(a, task.cycles.front());
    const auto& nominal = task.motors[chosen].nominal_current_A;
    const auto& volts = task.motors[chosen].nominal_voltage_V;
    if ((nominal && d.rms_current_A > *nominal) || (volts && d.peak_voltage_V > *volts)) continue;
    ++judged;
    EXPECT_GE(d.drawn_J - d.regenerated_J, bound - 1e-9 * std::abs(bound));
    nearest = std::min(nearest, d.drawn_J - d.regenerated_J);
  }
  EXPECT_GT(judged, designs / 4);
  EXPECT_LT(nearest, bound + within * std::abs(bound));
}

TEST(CoDesignSearch, NoRandomDesignWithAnyMotorNeedsLessThanTheBound) {
  expect_no_random_design_below_the_bound(small_task(sample<std::size_t>(45, 15)), 0.2);
}

TEST(CoDesignSearch, NoRandomDesignWithInertiaNeedsLessThanTheBound) {
  expect_no_random_design_below_the_bound(small_task(sample<std::size_t>(45, 15), true), 0.5);
}

TEST(EnergyBox, HoldsTheInertiaOfRandomDesignsAsTheMotorFeelsIt) {
  const optimize::Specification spec = small_task(45, true);
  optimize::Progress progress;
  const auto all = optimize::optimize(spec, progress);
  std::vector<const optimize::RefinedSet*> optima;
  for (const optimize::RefinedSet& set : all.refined) {
    if (set.status == optimize::Status::kOptimal) optima.push_back(&set);
  }
  ASSERT_FALSE(optima.empty());
  DeterministicRandom random(8);
  int mixed = 0;
  for (std::size_t n = 0, designs = 0; designs < sample<std::size_t>(30, 2000); ++n) {
    ASSERT_LT(n, 40000U);
    const auto& optimum = *optima[random.index(optima.size())];
    const auto set = random_design(random, spec, optimum);
    if (!set) continue;
    ++designs;
    const auto& z = set->candidate.teeth;
    const optimize::EnergyBox box = optimize::energy_box(spec, z, set->candidate.planets, 1.0, 1.0);
    ASSERT_TRUE(box.known);
    actuator::Actuator a;
    a.train = std::make_shared<const actuator::DesignTrain>(design_of(spec, *set));
    a.gearbox.ratio = a.train->ratio();
    const double inertia = a.train->inertia_kgm2();
    EXPECT_GE(inertia, box.least_inertia_kgm2);
    EXPECT_LE(inertia, box.most_inertia_kgm2);
    const auto gear = actuator::gear_model(a);
    for (int k = 0; k < 20; ++k) {
      actuator::OutputMotion motion{.speed_rad_s = 1.0, .load_Nm = random.between(-1.0, 1.0)};
      const double still = gear->at(motion).input_Nm;
      motion.acceleration_rad_s2 =
          random.between(-1.0, 1.0) * std::pow(10.0, random.between(-1.0, 4.0));
      const double felt = (gear->at(motion).input_Nm - still) / motion.acceleration_rad_s2;
      EXPECT_GE(felt, box.inertia_factor[0] * inertia);
      EXPECT_LE(felt, box.inertia_factor[1] * inertia);
      if (std::abs(felt / inertia - 1.0) > 1e-3) ++mixed;
    }
  }
  EXPECT_GT(mixed, 10);
}

TEST(CoDesignSearch, OfADesignWithInertiaIsTheLeastOfItsMotorsCycles) {
  const optimize::Specification spec = small_task(45, true);
  optimize::Progress progress;
  const auto result = optimize::optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best && result.best->cycle_energy_J);
  const auto& co_design = *actuator::co_design_of(spec.cycle_energy.get());
  const auto train = std::make_shared<const actuator::DesignTrain>(design_of(spec, *result.best));
  EXPECT_NEAR(train->inertia_kgm2(), result.best->inertia_kgm2, 1e-12 * result.best->inertia_kgm2);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < co_design.task().motors.size(); ++k) {
    const PairResult r = co_design.run(k, train);
    if (!(r.excess > 0.0)) least = std::min(least, r.energy_J);
  }
  EXPECT_EQ(*result.best->cycle_energy_J, least);
  // The model of the search, with all inertia on the motor's side, is near it.
  const auto at = co_design.at({.ratio = train->ratio(),
                                .forward = result.best->eta_f,
                                .backward = result.best->eta_b,
                                .inertia_kgm2 = result.best->inertia_kgm2});
  EXPECT_NEAR(at.energy_J, least, 1e-2 * co_design.scale_j());
}

TEST(CoDesignSearch, TheGearboxOfEfficienciesIsTheDesign) {
  const optimize::Specification spec = small_task(60);
  optimize::Progress progress;
  const auto result = optimize::optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  const auto at = spec.cycle_energy->at(
      {train::ratio(result.best->candidate.teeth), result.best->eta_f, result.best->eta_b});
  const SelectionTask& task = actuator::co_design_of(spec.cycle_energy.get())->task();
  actuator::Actuator a;
  a.train = std::make_shared<const actuator::DesignTrain>(design_of(spec, *result.best));
  a.gearbox.ratio = a.train->ratio();
  a.motor = task.motors[at.motor].motor;
  const actuator::DutyCycle d = actuator::run_cycle(a, task.cycles.front());
  EXPECT_NEAR(d.drawn_J - d.regenerated_J, at.energy_J, 1e-10 * d.drawn_J);
}

}  // namespace
}  // namespace gear3k::co_design_test
