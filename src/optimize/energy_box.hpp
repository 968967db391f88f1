#pragma once
// The gearboxes of a tooth set, as the energy of a duty cycle sees them.

#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// What the back-drivable gearboxes of a tooth set are at most and at least.
///
/// Efficiencies: as given.  Inertia: at least best_value(), at most that of cylinders up to the
/// longest tips of the greatest modules, planets as far out as their tips reach the sun's.
///
/// Behind lossy meshes an inertia J_k is felt at the motor's side as A_k J_k; A is 1 of the sun,
/// and of planets, carrier and R2, with λ1 = zP1/zS, λ2 = zP1/zR1, λ3 = zP2/zR2 and f_k between
/// η_k and 1/η_k,
///
///   A_P = (λ1 + λ2)(1 − λ2 f2)/((1 − λ2)(λ1 f1 + λ2 f2)),  A_C = f2 (λ1 + λ2)/(λ1 f1 + λ2 f2)
///   A_R = (λ3 f3 − λ2 f2)(λ1 + λ2)/((λ3 − λ2)(λ1 f1 + λ2 f2))
///
/// η_k ≥ 1 − 2π μ ε (1/z ± 1/z')/(1 − μ (1 + 2π ε/z)): of the farthest contact at ε base pitches.
/// Source: own derivation, docs/theory §75.  Without knows_inertia() there is none.
EnergyBox energy_box(const Specification& spec, const train::ToothSet& teeth, int planets,
                     double most_forward, double most_backward);

}  // namespace gear3k::optimize
