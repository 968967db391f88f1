#pragma once
// Friction loss of a mesh of fixed geometry, with its slopes by the friction.

#include "efficiency/mesh_loss.hpp"

namespace gear3k::efficiency {

/// mesh_efficiency() and its derivatives by the members of FlankFriction.
struct MeshEfficiencySlopes {
  double efficiency = 1.0;
  double by_coefficient = 0.0, by_approach_factor = 0.0, by_recess_factor = 0.0;
};

/// Which slopes are wanted: those by the factors cost the most in the models of first order, and
/// are left out by kByCoefficient where both factors are 1.
enum class LossSlopes { kNone, kByCoefficient, kByAll };

/// Efficiency of a mesh whose geometry does not vary, in a small part of the time that derivatives
/// by all its numbers take.
///
/// Slopes that are not wanted are not given.  Accuracy: as mesh_efficiency() of a scalar with
/// derivatives, to rounding.  Source: docs/theory §9, §23.
MeshEfficiencySlopes mesh_efficiency_slopes(const MeshContact<double>& contact,
                                            const FlankFriction<double>& mu, LossModel model,
                                            LossSlopes wanted);

}  // namespace gear3k::efficiency
