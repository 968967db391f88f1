#pragma once
// The forces between the teeth of a loaded 3K train.

#include <array>
#include <optional>

#include "train/power_flow.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::strength {

/// Forces of the three meshes on one of N planets that share the load evenly.  Signs as those of
/// train::PowerFlow: along the sense in which R2 turns.
template <class T>
struct MeshForces {
  /// F_k ≥ 0 [N], along the line of action.
  std::array<T, train::kMeshCount> normal_N{};
  /// f_k [N], of mesh k on the planet, tangential at the planet's centre, friction included.
  std::array<T, train::kMeshCount> tangential_N{};
  /// Friction work of mesh k per radian that R2 turns, of one planet [N m]; 0 without losses.
  std::array<T, train::kMeshCount> loss_Nm{};
};

/// Normal forces over the output's torque, of all planets together: F_k = T a_k/N.
///
///   a_1 = 1/(|i| rb_S),   a_2 = (G1 + G2)/((1 + G1) rb_R1),   a_3 = 1/rb_R2
///
/// The coefficients of the lost motion, by virtual work: the same for G2 < 1 and G2 > 1.
/// Source: own derivation, docs/theory §51.
/// @returns a_k [1/m]
template <class T>
std::array<T, train::kMeshCount> normal_forces_per_torque(const train::TrainGeometry<T>& train);

/// Forces without losses at an output torque.
///
///   F_k = |T| a_k/N,   f_k = s_k F_k cos α_w,k
///   (s_1, s_2, s_3) = (+, +, −) for G2 < 1, (−, +, −) for G2 > 1, times the sign of T
///
/// Source: own derivation, docs/theory §51.  Tangential forces sum to zero: the carrier is free.
/// @param output_torque_Nm  of the planets' teeth on R2
template <class T>
MeshForces<T> lossless_mesh_forces(const train::TrainGeometry<T>& train, const T& output_torque_Nm);

/// Forces of a power flow.
///
///   F_k = |T_k|/(N rb),   f_k = −(T_k + M_k)/(N d),   M_k = −(loss_k + T_k w'_k)/w'_P,
///   loss per planet = loss_k/N
///
/// rb the base radius of the central gear, M_k the moment of mesh k on the planets about their own
/// axes.  F_k is the force that would bring T_k along the line of action: friction, which turns the
/// force by up to atan μ, is in T_k and f_k but not separated from F_k.
/// Source: own derivation, docs/theory §51; power flow: §24.
template <class T>
MeshForces<T> mesh_forces(const train::TrainGeometry<T>& train, const train::PowerFlow<T>& flow);

/// Forces with the losses of one drive direction and no other torques.
///
/// @param efficiency        by mesh, when gear 1 and when gear 2 drives
/// @param output_torque_Nm  > 0, of the load on R2 (forward), of the drive on R2 (backward)
/// @param forward           the sun drives; else R2 does
/// @returns empty where no flow is in balance (solve_power_flow())
template <class T>
std::optional<MeshForces<T>> driven_mesh_forces(
    const train::TrainGeometry<T>& train,
    const std::array<train::DriverEfficiencies<T>, train::kMeshCount>& efficiency,
    const T& output_torque_Nm, bool forward);

}  // namespace gear3k::strength
