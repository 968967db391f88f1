#pragma once
// A train whose sun and fixed ring are held: what torque and friction do to its springs.

#include <array>
#include <optional>

#include "strength/train_stiffness.hpp"
#include "train/power_flow.hpp"

namespace gear3k::strength {

/// (T, m_1, m_2, m_3) [N m], of all planets together: the torque on R2 from outside along its turn,
/// and of each mesh the couple of friction on the planets, whose opposite acts on the central gear.
using LockedLoads = std::array<double, 1 + train::kMeshCount>;
/// Compliances of these loads [rad/(N m)]: symmetric.
using LockedCompliance = std::array<LockedLoads, 1 + train::kMeshCount>;

/// Forces of a held train and what its springs make of them.
///
///   φ = ∂U/∂T,  ψ_k = ∂U/∂m_k,  U = half the sum of (force of a spring)²/stiffness
///
/// φ is the turn of R2, ψ_k that of the planet less that of the central gear of mesh k.
struct LockedTrain {
  /// t_k: torque of mesh k's normal forces on the central gear, per unit of each load.
  std::array<LockedLoads, train::kMeshCount> mesh_torque{};
  std::array<double, train::kMeshCount> normal_N_per_Nm{};  ///< F_k = |t_k|/(N rb)
  /// What the meshes' springs do not give: planets, bearings, shafts.
  LockedCompliance other{};
  int planets = 1;
};

/// Balances the forces of a train with its sun and R1 held and its carrier free.
///
///   t_3 = m_3 − T,   t_1 + t_2 = T + m_1 + m_2,   λ_1 t_1 + λ_2 t_2 + λ_3 t_3 + m_1 + m_2 + m_3 =
///   0
///
/// λ = train::planet_levers().
/// Source: own derivation, docs/theory §57; without couples 1/C_TT is K_out of train_stiffness().
/// @param springs  the meshes' are not read
/// @throws std::invalid_argument as train_stiffness()
LockedTrain locked_train(const train::TrainGeometry<double>& train,
                         const TrainSprings<double>& springs);

/// Adds the meshes' springs: C = C_other + Σ_k (∂F_k)(∂F_k)ᵀ N/(k̄_k b_k).
/// @param mesh_compliance_m_N  1/(k̄_k b_k)
LockedCompliance locked_compliance(
    const LockedTrain& train, const std::array<double, train::kMeshCount>& mesh_compliance_m_N);

/// m_k/t_k where the planets turn one way or the other against the central gear.
struct SlidingCouple {
  double central_drives = 0.0, planet_drives = 0.0;
};
/// The couple that makes a rolling mesh lose what its efficiencies say.
///
///   central gear drives (t_k ψ̇_k λ_k > 0): λ (η − 1)/(1 + λ η)
///   planet drives       (t_k ψ̇_k λ_k < 0): λ (1 − η)/(η + λ)
///
/// Source: own derivation from (24.4), docs/theory §57.
/// @param efficiency  when gear 1 drives and when gear 2 does
/// @returns empty where the mesh jams with one of its members driving
std::optional<SlidingCouple> sliding_couple(const train::ToothSet& teeth, std::size_t mesh,
                                            const train::DriverEfficiencies<double>& efficiency);

}  // namespace gear3k::strength
