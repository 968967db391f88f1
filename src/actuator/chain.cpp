#include "actuator/chain.hpp"

#include <cmath>

namespace gear3k::actuator {

Chain chain_of(const Actuator& actuator) {
  const Motor& motor = actuator.motor;
  const Gearbox& gearbox = actuator.gearbox;
  const double i = gearbox.ratio;
  const double fast = std::abs(i);
  Chain chain{.ratio = i,
              .j1_kgm2 = i * i * motor.rotor_inertia_kgm2,
              .j2_kgm2 = actuator.load_inertia_kgm2,
              .d1_Nms = i * i * motor.viscous_Nms,
              .c1_Nm = fast * motor.coulomb_Nm,
              .c1_static_Nm = fast * motor.static_Nm};
  if (actuator.train != nullptr) return chain;
  chain.j1_kgm2 = i * i * (motor.rotor_inertia_kgm2 + gearbox.input_inertia_kgm2);
  chain.j2_kgm2 = gearbox.output_inertia_kgm2 + actuator.load_inertia_kgm2;
  chain.d2_Nms = gearbox.viscous_Nms;
  chain.c2_Nm = gearbox.coulomb_Nm;
  chain.c2_static_Nm = gearbox.static_Nm;
  chain.efficiency_forward = gearbox.efficiency_forward;
  chain.efficiency_backward = gearbox.efficiency_backward;
  return chain;
}

double mesh_input(const Chain& chain, double mesh_Nm, double sense) {
  return sense * mesh_Nm > 0.0 ? mesh_Nm / chain.efficiency_forward
                               : mesh_Nm * chain.efficiency_backward;
}

RestBand rest_band(const Chain& chain, double load_Nm) {
  return {.low_Nm = mesh_input(chain, -chain.c2_static_Nm - load_Nm, -1.0),
          .high_Nm = mesh_input(chain, chain.c2_static_Nm - load_Nm, 1.0)};
}

}  // namespace gear3k::actuator
