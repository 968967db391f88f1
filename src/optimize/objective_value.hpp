#pragma once
// What a train is worth by each objective.

#include <optional>

#include "backlash/lost_motion.hpp"
#include "optimize/objective.hpp"
#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// Whether masses follow from a specification: density and both face widths are stated.
bool knows_masses(const Specification& spec);

/// Objectives that are the larger of two smooth values, which the optimiser takes one by one: the
/// outer diameter (R1's, R2's) and the lost motion by the paper's model (φ_1 + φ_2, φ_1 + φ_3).
bool has_objective_branches(Objective objective, const Specification& spec);

/// Value of an objective for a train, SI.
///
///   outer diameter  2 max(rf_R1, rf_R2) + 2 rim
///   mass            m_S + N (m_P1 + m_P2) + m_R1 + m_R2, inertia::gear_body() of solid gears;
///                   rings reach from their teeth to the root circle plus the rim
///   inertia         inertia::lossless_inertia() of these bodies; nothing of carrier and shafts
///   ratio error     |i/target − 1|
///
/// @param branch  of an objective with branches: 0 the larger value, 1 or 2 one of the two
/// @param forward_friction  used for the forward efficiency, the other one for the backward
/// @throws std::invalid_argument for mass and inertia unless knows_masses(spec)
template <class T>
T objective_value(Objective objective, const Specification& spec,
                  const train::TrainGeometry<T>& train,
                  const std::array<T, train::kMeshCount>& normal_backlash_m, int branch = 0);

/// Best value [SI] of an objective other than an efficiency that any shifts and modules of a tooth
/// set can have, from the least modules and shifts: nothing feasible is better.
double best_value(Objective objective, const Specification& spec, const train::ToothSet& teeth,
                  int planets);

/// Number that brings an objective to order 1 in a refinement.
double objective_scale(Objective objective, const Specification& spec);

}  // namespace gear3k::optimize
