#pragma once
// How far the output of a loaded train turns against its locked input.

#include <array>
#include <optional>

#include "strength/planet_loads.hpp"

namespace gear3k::strength {

/// Bearings of a planet: where they are, and how stiff.  What is empty is rigid.
template <class T>
struct PlanetBearings {
  PlanetAxis<T> axis{};
  std::array<std::optional<T>, 2> stiffness_N_m{};  ///< k_A, k_B, alike in all radial directions
  std::optional<T> pin_stiffness_N_m{};  ///< of the pin under each bearing, in series with it
};

/// Springs of a train.  What is empty is rigid.
template <class T>
struct TrainSprings {
  std::array<T, train::kMeshCount> mesh_N_m{};  ///< k̄_k b_k: mean mesh stiffness times face width
  std::optional<T> planet_torsion_Nm_rad{};     ///< k_t, between P1 and P2
  std::optional<PlanetBearings<T>> bearings{};
  std::optional<T> sun_shaft_Nm_rad{};  ///< k_S, between the sun's teeth and the input
  std::optional<T> ring2_Nm_rad{};      ///< k_R2, between R2's teeth and the output
};

/// Torsional compliances at the output [rad/(N m)].
template <class T>
struct TrainCompliance {
  std::array<T, train::kMeshCount> mesh{};
  T planet_torsion{}, bearings{}, sun_shaft{}, ring2{};
};

template <class T>
struct TrainStiffness {
  T output_Nm_rad{};  ///< K_out: R2 loaded, sun locked
  T input_Nm_rad{};   ///< K_in = K_out/i²: sun loaded, R2 locked
  TrainCompliance<T> compliance{};
};

/// Torsional stiffness with R1 held and the carrier free, by the unit-load theorem.
///
///   1/K_out = Σ_k a_k²/(N k̄_k b_k) + (rb_P2/rb_R2)²/(N k_t) + Σ_A,B N |R|² (1/k_B + 1/k_pin)
///             + 1/(i² k_S) + 1/k_R2
///
/// R are the reactions of support_reactions() per unit of output torque.  Alike planets that share
/// the load evenly.
/// Source: own derivation, docs/theory §53; equal to an assembled network of springs to 1e-9
/// (tested).  Does not account for: friction, which adds hysteresis (docs/theory §31); backlash;
/// the change of stiffness within a base pitch; the bodies of rings and carrier.
/// @throws std::invalid_argument for a stiffness that is not positive, or as check_planet_axis()
template <class T>
TrainStiffness<T> train_stiffness(const train::TrainGeometry<T>& train,
                                  const TrainSprings<T>& springs);

}  // namespace gear3k::strength
