// Time and end of a simulated pendulum with friction, both flows and both senses, for
// benchmarks/peers/motion_dop853.py:
//   pendulum_motion TOLERANCE...     prints a line for each: tolerance, seconds a run, angle,
//   speed,
//                                    events

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "benchmarks/program.hpp"
#include "motion/simulate.hpp"

namespace pendulum_motion_benchmark {
namespace {

using gear3k::actuator::Actuator;
using gear3k::motion::Motion, gear3k::motion::Scenario;

/// The same numbers stand in motion_dop853.py.
Actuator swinging() {
  Actuator a;
  a.motor.resistance_ohm = 0.6;
  a.motor.torque_constant_Nm_A = 0.04;
  a.motor.rotor_inertia_kgm2 = 2e-5;
  a.motor.coulomb_Nm = 0.004;
  a.motor.static_Nm = 0.008;
  a.motor.viscous_Nms = 1e-6;
  a.gearbox.ratio = 50.0;
  a.gearbox.efficiency_forward = 0.8;
  a.gearbox.efficiency_backward = 0.7;
  a.gearbox.coulomb_Nm = 0.3;
  a.gearbox.static_Nm = 0.6;
  a.gearbox.viscous_Nms = 0.02;
  a.load_inertia_kgm2 = 0.01;
  return a;
}

Scenario pendulum(double tolerance) {
  Scenario s;
  s.duration_s = 4.0;
  s.start_angle_rad = 0.2;
  s.command = {.amplitude = 0.12, .frequency_Hz = 0.6};
  s.load.pendulum = {.mass_kg = 1.5, .length_m = 0.3};
  s.solver.relative_tolerance = tolerance;
  s.solver.absolute_tolerance = 0.1 * tolerance;
  s.sample_s = 4.0;
  return s;
}

int run_all(int argc, char** argv) {
  const Actuator actuator = swinging();
  for (int k = 1; k < argc; ++k) {
    const Scenario scenario = pendulum(std::strtod(argv[k], nullptr));
    Motion motion = simulate(actuator, scenario);
    constexpr int kRuns = 20;
    double best = 1e9;
    for (int run = 0; run < kRuns; ++run) {
      const auto begin = std::chrono::steady_clock::now();
      motion = simulate(actuator, scenario);
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
      best = std::min(best, taken.count());
    }
    std::printf("%s %.9f %.17g %.17g %zu\n", argv[k], best, motion.end.sides.output_rad,
                motion.end.sides.output_rad_s, motion.events.size());
  }
  return 0;
}

}  // namespace
}  // namespace pendulum_motion_benchmark

PROGRAM(pendulum_motion)(int argc, char** argv) {
  return pendulum_motion_benchmark::run_all(argc, argv);
}
