#pragma once
// What a train is worth by each objective.

#include <optional>

#include "backlash/lost_motion.hpp"
#include "optimize/objective.hpp"
#include "optimize/specification.hpp"
#include "strength/train_rating.hpp"

namespace gear3k::optimize {

/// Whether masses follow from a specification: densities and both face widths are stated.
bool knows_masses(const Specification& spec);

/// Objectives that are the larger of two smooth values, which the optimiser takes one by one: the
/// outer diameter (R1's, R2's) and the lost motion by the paper's model (φ_1 + φ_2, φ_1 + φ_3).
bool has_objective_branches(Objective objective, const Specification& spec);

/// Whether a design's gears have an inertia that its duty cycles feel: knows_masses(), and rings of
/// a rim, as R2 turns.
bool knows_inertia(const Specification& spec);

/// Whether an objective or a limit asks for a value.
bool asks_for(const Specification& spec, Objective objective);

/// What objectives are computed from.
template <class T>
struct ObjectiveInput {
  const Specification& spec;
  const train::TrainGeometry<T>& train;
  const std::array<T, train::kMeshCount>& normal_backlash_m;
  std::array<T, 2> face_width_m{};                   ///< by stage; of mass, inertia, density
  T torque_Nm{};                                     ///< of capacity and density
  const strength::TrainRating<T>* rating = nullptr;  ///< of the stiffness
};

/// Mass of one planet, both steps, from sizes and density [kg].
/// @throws std::invalid_argument unless knows_masses(spec)
template <class T>
T planet_mass_kg(const Specification& spec, const train::TrainGeometry<T>& train,
                 const std::array<T, 2>& face_width_m);

/// Value of an objective for a train, SI.
///
///   outer diameter  2 max(rf_R1, rf_R2) + 2 rim
///   mass            m_S + N (m_P1 + m_P2) + m_R1 + m_R2, inertia::gear_body() of solid gears;
///                   rings reach from their teeth to the root circle plus the rim
///   inertia         inertia::lossless_inertia() of these bodies; nothing of carrier and shafts
///   ratio error     |i/target − 1|
///   torque capacity, density   the torque of the input, and over the mass
///   torsional stiffness        K_out of the input's rating
///
/// @param branch  of an objective with branches: 0 the larger value, 1 or 2 one of the two
/// @throws std::invalid_argument for mass and inertia unless knows_masses(spec), and for the
///   torsional stiffness without a rating that has it
template <class T>
T objective_value(Objective objective, const ObjectiveInput<T>& input, int branch = 0);
/// With the stated face widths; not for objectives of the load.
template <class T>
T objective_value(Objective objective, const Specification& spec,
                  const train::TrainGeometry<T>& train,
                  const std::array<T, train::kMeshCount>& normal_backlash_m, int branch = 0);

/// What the limits of spec.felt see of a train; its gears' inertia where masses and a rim of the
/// rings are stated.
template <class T>
FeltGearbox<T> felt_gearbox(const ObjectiveInput<T>& input);

/// Best value [SI] of an objective other than an efficiency that any shifts and modules of a tooth
/// set can have, from the least modules, shifts and face widths: nothing feasible is better;
/// infinite for those of the load.
double best_value(Objective objective, const Specification& spec, const train::ToothSet& teeth,
                  int planets);

/// Number that brings an objective to order 1 in a refinement.
double objective_scale(Objective objective, const Specification& spec);

}  // namespace gear3k::optimize
