#pragma once
// The inertia that a 3K train shows at its output or at its sun.

#include <optional>

#include "efficiency/train_efficiency.hpp"
#include "train/power_flow.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::inertia {

/// Inertia of the moving bodies, each about its own axis.
template <class T>
struct BodyInertias {
  T sun_kgm2;
  T planet1_kgm2;    ///< step P1 of one planet
  T planet2_kgm2;    ///< step P2 of one planet
  T planet_mass_kg;  ///< one planet, both steps
  T carrier_kgm2;    ///< about the main axis, without planets
  T ring2_kgm2;
};

/// A train as its inertia sees it.
template <class T>
struct InertialTrain {
  train::ToothSet teeth;
  int planets = 3;
  T center_distance_m;
  BodyInertias<T> bodies;
};

/// Inertia torques of the bodies (d'Alembert) where R2 accelerates, along its turn.
///
///   K_S = −J_S (w_S/w_R2) a,         K_P = −N (J_P1 + J_P2) (w_P/w_R2) a
///   K_C = −(J_C + N m_P d²) (w_C/w_R2) a,   K_R2 = −J_R2 a
///
/// Source: docs/theory §24 (by d'Alembert).
/// @param acceleration_rad_s2  a of R2
template <class T>
train::BodyTorques<T> inertia_torques(const InertialTrain<T>& train, double acceleration_rad_s2);

/// Effective inertia at the output without losses.
///
///   J = Σ J_k (w_k/w_R2)² + N m_P d² (w_C/w_R2)²   (absolute speeds; twice the kinetic energy)
///
/// Source: kinetic energy, docs/theory §11.  @returns [kg m²]
template <class T>
T lossless_inertia(const InertialTrain<T>& train);

/// Efficiencies of the meshes in the two drive directions of the train.
template <class T>
struct DirectionalEfficiencies {
  efficiency::MeshEfficiencies<T> forward, backward;
};

/// Effective inertia seen from the output (backward) or the sun (forward), with mesh losses.
///
/// Torque over acceleration of the driving end when nothing loads the train but the inertia torque
/// of its own bodies, by train::solve_power_flow(): each mesh loses in the direction in which its
/// power flows.
/// Reduces to J_S i²/η_b (backward, sun only) and to the kinetic energy without losses.
/// Source: own derivation, docs/theory §11 (errata 9 on the paper's eq. 32).
/// @returns [kg m²]; empty where no direction of the power flows is consistent: the train locks
template <class T>
std::optional<T> effective_inertia(const InertialTrain<T>& train,
                                   const DirectionalEfficiencies<T>& eta, bool forward);

/// The low-backlash paper's eqs. 32-33, with i_T for the sun, rolling speeds for the planets and
/// the carrier's absolute speed; for comparison only (errata 9).  @returns [kg m²] at the output
template <class T>
T paper_inertia(const InertialTrain<T>& train, const efficiency::MeshEfficiencies<T>& eta);

}  // namespace gear3k::inertia
