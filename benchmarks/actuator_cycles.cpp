// Duty cycles and selections a second on one core, for benchmarks/peers/actuator_numpy.py:
//   actuator_cycles      prints a line for each: name, amount a second, energy of the last cycle
//   [J]

#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <limits>
#include <memory>
#include <string>

#include "actuator/design_gear.hpp"
#include "actuator/duty_cycle.hpp"
#include "actuator/selection.hpp"
#include "benchmarks/program.hpp"
#include "io/files/cycle_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/selection_file.hpp"

namespace actuator_cycles_benchmark {
namespace {

using gear3k::actuator::Actuator;

const std::string kExamples = std::string(GEAR3K_SOURCE_DIR) + "/examples/";

/// The same numbers stand in actuator_numpy.py.
Actuator knee_drive() {
  Actuator a;
  a.motor.resistance_ohm = 0.608;
  a.motor.torque_constant_Nm_A = 0.0369;
  a.motor.rotor_inertia_kgm2 = 1.81e-5;
  a.motor.viscous_Nms = 1.3e-5;
  a.gearbox.ratio = 100.0;
  a.gearbox.efficiency_forward = 0.85;
  a.gearbox.efficiency_backward = 0.82;
  a.gearbox.coulomb_Nm = 0.5;
  a.gearbox.static_Nm = 0.5;
  return a;
}

Actuator designed() {
  gear3k::design::Design design = gear3k::io::read_design(kExamples + "designs/loaded.toml");
  design.masses = {};
  design.shafts = {};
  design.rating.reset();
  Actuator a = knee_drive();
  auto train = std::make_shared<const gear3k::actuator::DesignTrain>(design);
  a.gearbox = {};
  a.gearbox.ratio = train->ratio();
  a.train = std::move(train);
  return a;
}

/// Shortest processor time of a call over some tries [s]: other work on the machine does not count.
template <class F>
double seconds(int tries, F call) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < tries; ++k) {
    const std::clock_t begin = std::clock();
    call();
    best = std::min(best, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return best;
}

int run_all() {
  omp_set_num_threads(1);
  const auto cycle = gear3k::io::read_cycle(kExamples + "actuators/knee_walking.csv");
  const auto rate = [&](const char* name, const Actuator& actuator, int cycles) {
    double energy_J = 0.0;
    const double taken_s = seconds(5, [&] {
      for (int k = 0; k < cycles; ++k) {
        const auto result = run_cycle(actuator, cycle);
        energy_J = result.drawn_J - result.regenerated_J;
      }
    });
    std::printf("%s %.6g %.12g\n", name, cycles / taken_s, energy_J);
  };
  rate("catalogue_cycles", knee_drive(), 2000);
  rate("design_cycles", designed(), 50);
  auto task = gear3k::io::read_selection(kExamples + "actuators/knee_selection.toml").task;
  task.objectives = {gear3k::actuator::Objective::kEnergy};
  const auto pairs = static_cast<double>(task.motors.size() * task.gearboxes.size());
  gear3k::actuator::Selection selection;
  const double screened_s = seconds(3, [&] { selection = select(task); });
  // By energy alone hardly any pair is run: what takes time is the screening.
  std::printf("screened_pairs %.6g %zu\n", pairs / screened_s, selection.run);
  task.objectives = {gear3k::actuator::Objective::kEnergy, gear3k::actuator::Objective::kMass};
  const double front_s = seconds(3, [&] { selection = select(task); });
  std::printf("selection_s %.6g %zu\n", front_s, selection.run);
  return 0;
}

}  // namespace
}  // namespace actuator_cycles_benchmark

PROGRAM(actuator_cycles)(int, char**) { return actuator_cycles_benchmark::run_all(); }
