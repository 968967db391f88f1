#pragma once
// The gearboxes of a tooth set, as the energy of a duty cycle sees them.

#include <array>

#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// Least efficiency of each mesh, S-P1, P1-R1 and P2-R2, in any design of a tooth set, whichever
/// gear drives.
///
///   η ≥ 1 − π μ (1/z1 ± 1/z2) B/(1 − μ (tan α_w + 2π s/z_R))
///
/// with the greatest loss factor B, distance s of contact from the pitch point in base pitches and
/// working angle α_w of teeth_reach(), μ with the factors of approach and recess; the last term of
/// the divisor of a ring, which may drive.  Without a path model the divisor is 1, and factors add
/// to the first order what they add to the path.
/// Source: own derivation, docs/theory §75.
/// @returns 0 where flanks may jam, and without has_bounds(); 1 where no design meets the limits
std::array<double, train::kMeshCount> least_mesh_efficiencies(const Specification& spec,
                                                              const train::ToothSet& teeth,
                                                              int planets);

/// What the back-drivable gearboxes of a tooth set are at most and at least.
///
/// Efficiencies: as given.  Inertia: at least best_value(), at most that of cylinders up to the
/// longest tips of the greatest modules, planets at the greatest centre distance of teeth_reach().
///
/// Behind lossy meshes an inertia J_k is felt at the motor's side as A_k J_k; A is 1 of the sun,
/// and of planets, carrier and R2, with λ1 = zP1/zS, λ2 = zP1/zR1, λ3 = zP2/zR2 and f_k between
/// η_k and 1/η_k,
///
///   A_P = (λ1 + λ2)(1 − λ2 f2)/((1 − λ2)(λ1 f1 + λ2 f2)),  A_C = f2 (λ1 + λ2)/(λ1 f1 + λ2 f2)
///   A_R = (λ3 f3 − λ2 f2)(λ1 + λ2)/((λ3 − λ2)(λ1 f1 + λ2 f2))
///
/// η_k from least_mesh_efficiencies(); where one is 0 nothing is known.
/// Source: own derivation, docs/theory §75.  Without knows_inertia() there is none.
EnergyBox energy_box(const Specification& spec, const train::ToothSet& teeth, int planets,
                     double most_forward, double most_backward);

}  // namespace gear3k::optimize
