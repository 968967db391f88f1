#pragma once
// Friction loss of a mesh of fixed geometry, with its slopes by the friction.

#include "efficiency/mesh_loss.hpp"

namespace gear3k::efficiency {

/// mesh_efficiency() and its derivatives by the members of FlankFriction.
struct MeshEfficiencySlopes {
  double efficiency = 1.0;
  double by_coefficient = 0.0, by_approach_factor = 0.0, by_recess_factor = 0.0;
};

/// Efficiency of a mesh whose geometry does not vary, in a tenth of the time that derivatives by
/// all its numbers take: along the path of contact the torques of all pairs in contact together are
/// linear in the position, and depend on two numbers, μ times the factors of both sides.
///
/// @param by_sides  false: the slopes by the factors are not wanted where both are 1 (they cost the
/// most in the models of first order)
/// Accuracy: as mesh_efficiency() of a scalar with derivatives, to rounding.
MeshEfficiencySlopes mesh_efficiency_slopes(const MeshContact<double>& contact,
                                            const FlankFriction<double>& mu, LossModel model,
                                            bool by_sides);

}  // namespace gear3k::efficiency
