#pragma once
// Torques and power in a running 3K train: one solver for both drive directions, either sign of
// the ratio, losses on any shaft, and inertia torques.

#include <array>
#include <optional>

#include "train/tooth_set.hpp"

namespace gear3k::train {

/// The two ends of the train.
enum class End { kSun, kOutput };

/// Torques on the bodies other than from the meshes and at the ends: drag, inertia.  Each [Nm],
/// positive in the sense in which R2 turns; for G2 > 1 sun and carrier turn against it.
template <class T>
struct BodyTorques {
  T sun{};
  T planet{};   ///< on all planets together about their own axes, from outside the carrier
  T pin{};      ///< on all planets together about their own axes, from their pins on the carrier
  T carrier{};  ///< on carrier and planets about the main axis
  T ring2{};
};

/// Efficiencies of a mesh when gear 1 drives and when gear 2 drives.
template <class T>
using DriverEfficiencies = std::array<T, 2>;

template <class T>
struct LoadedTrain {
  ToothSet teeth;
  /// A value ≤ 0 says that the mesh cannot run with that driver.
  std::array<DriverEfficiencies<T>, kMeshCount> efficiency;
  BodyTorques<T> known;
  End given_end = End::kOutput;
  T given_torque_Nm{};  ///< from outside, on the sun or on R2, positive along w_R2 = 1
};

/// Torques in balance.  All of N planets together, positive along the rotation at w_R2 = 1.
template <class T>
struct PowerFlow {
  T sun_torque_Nm, output_torque_Nm;         ///< from outside
  std::array<T, kMeshCount> mesh_torque_Nm;  ///< of the planets on S, R1, R2
  std::array<bool, kMeshCount> gear1_drives;
  /// Friction power of each mesh over |w_R2| [Nm], ≥ 0.
  std::array<T, kMeshCount> mesh_loss_Nm;
};

/// Speeds of S, R1 and R2 relative to the carrier over w_R2: a mesh's power on the central gear is
/// its torque times these.
std::array<double, kMeshCount> central_rolling_speeds(const ToothSet& z);

/// Balances the torques of a train in steady motion (or, by d'Alembert, in accelerated motion).
///
///   sun     T_1 + K_S + A_S = 0           planets   Σ m_k T_k + K_P + K_pin = 0
///   R2      T_3 + K_R2 + A_R2 = 0         carrier   K_C + K_P = T_1 + T_2 + T_3
///
///   m_k: moment on the planets per torque on the central gear, λ_k η_k where the central gear
///   drives, λ_k/η_k where the planet drives; λ = zP1/zS, −zP1/zR1, −zP2/zR2
///
/// Which member of each mesh drives is found, not assumed: of the eight combinations the one whose
/// powers agree with it, that of the train without losses first.  The low-backlash paper's eqs. 18
/// and 19 are the case without K.
/// Source: own derivation, docs/theory §24.
/// @returns empty where no combination is in balance: the train locks
template <class T>
std::optional<PowerFlow<T>> solve_power_flow(const LoadedTrain<T>& train);

}  // namespace gear3k::train
