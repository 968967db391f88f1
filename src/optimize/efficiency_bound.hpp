#pragma once
// The efficiency of a train whose meshes lose at least so much.

#include <array>

#include "efficiency/train_efficiency.hpp"

namespace gear3k::optimize {

/// The losses (1 − η) of stage 1's meshes: that of S-P1 at least `sun`, that of P1-R1 at least
/// `ring`, and sun_weight · (loss of S-P1) + (loss of P1-R1) at least `weighted`.
struct LossRegion {
  double sun = 0.0, ring = 0.0, weighted = 0.0, sun_weight = 1.0;
};

/// −∂ ln η/∂(loss of S-P1) and −∂ ln η/∂(loss of P1-R1) of the train's efficiency.
/// @param eta  of the meshes  @param forward  the sun drives, else R2
std::array<double, 2> loss_weights(double g1, double g2,
                                   const efficiency::MeshEfficiencies<double>& eta, bool forward);

/// Greatest backward efficiency over a region, the mesh P2-R2 losing `stage2`.
///
/// 1/η_b is convex in the losses, so that tangents bound it along the region's edge.
/// Source: own derivation, docs/theory §32.
/// @returns η_b; 0 where the train cannot run backwards
double most_backward(const train::ToothSet& z, const LossRegion& region, double stage2);

/// Greatest forward efficiency over a region, the mesh P2-R2 losing `stage2`.
///
/// ln η_f is convex in λ = −ln(1 − loss), in which the region's cuts hold too: it is greatest in a
/// corner.
/// Source: own derivation, docs/theory §32.
/// @returns η_f; 0 where a mesh passes nothing on
double most_forward(const train::ToothSet& z, const LossRegion& region, double stage2);

}  // namespace gear3k::optimize
