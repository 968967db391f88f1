#pragma once
// Actuators that are little more than two inertias and a mesh.

#include <cmath>
#include <string>

#include "motion/simulate.hpp"

namespace gear3k::motion_test {

using actuator::Actuator;
using motion::Control, motion::Motion, motion::MotionRow, motion::Scenario;

struct TwoBodies {
  double fast_kgm2 = 0.0;    ///< at the motor
  double output_kgm2 = 0.0;  ///< of the load
  double ratio = 1.0;
};

inline Actuator plain_actuator(const TwoBodies& bodies, double forward, double backward) {
  Actuator a;
  a.motor.resistance_ohm = 1.0;
  a.motor.torque_constant_Nm_A = 1.0;
  a.motor.rotor_inertia_kgm2 = bodies.fast_kgm2;
  a.gearbox.ratio = bodies.ratio;
  a.gearbox.efficiency_forward = forward;
  a.gearbox.efficiency_backward = backward;
  a.load_inertia_kgm2 = bodies.output_kgm2;
  return a;
}

inline double loss_of(const Motion& m, const std::string& cause) {
  for (const auto& [name, energy] : m.ledger.losses) {
    if (name == cause) return energy;
  }
  return std::nan("");
}

}  // namespace gear3k::motion_test
