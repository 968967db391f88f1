#include "actuator/chain.hpp"

#include <cmath>

namespace gear3k::actuator {

Chain chain_of(const Motor& motor, const Gearbox& gearbox, double load_kgm2) {
  const double i = gearbox.ratio;
  const double fast = std::abs(i);
  return {.ratio = i,
          .j1_kgm2 = i * i * (motor.rotor_inertia_kgm2 + gearbox.input_inertia_kgm2),
          .j2_kgm2 = gearbox.output_inertia_kgm2 + load_kgm2,
          .d1_Nms = i * i * motor.viscous_Nms,
          .d2_Nms = gearbox.viscous_Nms,
          .c1_Nm = fast * motor.coulomb_Nm,
          .c2_Nm = gearbox.coulomb_Nm,
          .c1_static_Nm = fast * motor.static_Nm,
          .c2_static_Nm = gearbox.static_Nm,
          .efficiency_forward = gearbox.efficiency_forward,
          .efficiency_backward = gearbox.efficiency_backward};
}

Chain chain_of(const Actuator& actuator) {
  if (actuator.train == nullptr) {
    return chain_of(actuator.motor, actuator.gearbox, actuator.load_inertia_kgm2);
  }
  // The train has its own inertia and losses.
  Gearbox alone;
  alone.ratio = actuator.gearbox.ratio;
  return chain_of(actuator.motor, alone, actuator.load_inertia_kgm2);
}

RestBand rest_band(const Chain& chain, double load_Nm) {
  return {.low_Nm = mesh_input(chain, -chain.c2_static_Nm - load_Nm, -1.0),
          .high_Nm = mesh_input(chain, chain.c2_static_Nm - load_Nm, 1.0)};
}

}  // namespace gear3k::actuator
