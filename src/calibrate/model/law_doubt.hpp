#pragma once
// How far a law of friction that other gears were measured with may be wrong about these.

#include <array>

#include "design/operation.hpp"
#include "efficiency/friction_extension.hpp"

namespace gear3k::calibrate {

/// What a mesh loses at an operating point in one drive direction.
struct MeshLoss {
  double share = 0.0;           ///< of the input power
  double normal_force_N = 0.0;  ///< on the flanks of one planet's mesh
  double sliding_speed_m_s = 0.0;
  double change = 0.0;  ///< |ln| of what the model makes of the friction that the design states
};
using MeshLosses = std::array<MeshLoss, train::kMeshCount>;

/// Geometric mean of the meshes' normal forces, of those that carry any [N]; 1 where none does.
double mean_force(const design::Operation<double>& operation);

/// Those of an operation in a direction with an extension's friction at a temperature.
MeshLosses mesh_losses(const design::Operation<double>& operation, design::Direction direction,
                       const efficiency::FrictionExtension<double>& friction, double temperature_K);

/// Standard deviation of the efficiency of a gearbox less that of another one, of what a campaign
/// leaves open about the friction that its model adds: it shows what all meshes lose together where
/// it measured, not how that divides among them nor the law's shape beside its own states.
///
/// The friction of mesh k in gearbox X is e^(d_kX) times the model's, normal with
///
///   Cov(d_kX, d_kY) = (κ A)² (1 + ρ_k),   ρ_k = exp(−(Δ ln F_k)²/2 − (Δ ln v_k)²/2)  (1 for X = Y)
///
/// κ: 0.35, twice that after an ambiguous diagnosis; A: greatest change; all d less the mean by the
/// losses of `before`, whose sum has been measured. With equal states and equal shares it is 0.
/// Source: own derivation, docs/theory §30; κ from benchmarks/redesign_gain.
/// @returns infinity where a friction of 0 leaves all in doubt
/// @param ambiguous  other causes explained the campaign as well as those of the model
double gain_doubt(const MeshLosses& before, const MeshLosses& after, bool ambiguous = false);

}  // namespace gear3k::calibrate
