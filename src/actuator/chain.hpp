#pragma once
// Both sides of an actuator, reflected to the output.

#include "actuator/actuator.hpp"

namespace gear3k::actuator {

/// Equation (1) of docs/theory §58 in numbers, all at the output:
///
///   fast side   J1 a + D1 w + c1 s = τ − u        output side   J2 a + D2 w + c2 s = m + T_L
///   mesh        u = m/η_f where s m > 0,  η_b m where s m < 0
///
/// With a train the gearbox has no share in J1, J2, D2, c2, and η = 1.
struct Chain {
  double ratio = 1.0;                   ///< i, signed
  double j1_kgm2 = 0.0, j2_kgm2 = 0.0;  ///< i² (J_m + J_I), J_O + J_L
  double d1_Nms = 0.0, d2_Nms = 0.0;    ///< i² D_m
  double c1_Nm = 0.0, c2_Nm = 0.0;      ///< |i| T_c; running
  double c1_static_Nm = 0.0, c2_static_Nm = 0.0;
  double efficiency_forward = 1.0, efficiency_backward = 1.0;
};

Chain chain_of(const Actuator& actuator);
/// The same of a gearbox by values.
Chain chain_of(const Motor& motor, const Gearbox& gearbox, double load_kgm2);

/// u = h_s(m): torque that the fast side has to give to the mesh for a torque of the mesh on the
/// output body, both at the output.
///
///   h_s(m) = m/η_f where s m > 0,  η_b m where s m < 0;    (u − m) w ≥ 0 for η_b ≤ 1
///
/// @param sense  s, the sign of the output's speed
/// Source: own derivation, docs/theory §58.
inline double mesh_input(const Chain& chain, double mesh_Nm, double sense) {
  return sense * mesh_Nm > 0.0 ? mesh_Nm / chain.efficiency_forward
                               : mesh_Nm * chain.efficiency_backward;
}

/// Torques of the fast side between which the output stays at rest.
struct RestBand {
  double low_Nm, high_Nm;
};

/// Band of u, without the motor's own friction: h₋(−c2s − T_L) ≤ u ≤ h₊(c2s − T_L).
/// Source: own derivation, docs/theory §58.
RestBand rest_band(const Chain& chain, double load_Nm);

}  // namespace gear3k::actuator
