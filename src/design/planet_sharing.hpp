#pragma once
// K_γ of a design from its tolerances.

#include <cstdint>
#include <functional>
#include <optional>

#include "design/design.hpp"
#include "strength/load_sharing.hpp"
#include "strength/train_rating.hpp"

namespace gear3k::design {

/// Gearboxes whose planets on their common carrier give K_γ.
struct PlanetSharing {
  double quantile = 0.0;                   ///< share of them that K_γ covers
  std::uint64_t drawn = 0, assembled = 0;  ///< those that do not assemble do not count
  /// At the stated torque; empty where none assembles or a mesh has no path of contact.
  std::optional<strength::LoadFactorSeries> series{};
};

/// K_γ at any output torque; N where it could not be computed.
using MeshLoadFunction = std::function<strength::MeshLoadFactors(double torque_Nm)>;

/// The sharing at the stated torque, and K_γ at any.
struct SharedMeshLoad {
  PlanetSharing sharing;
  MeshLoadFunction mesh_load;  ///< refers to the design and its loaded train
};

/// Gearboxes that are drawn for K_γ, the first ones of the series that `tolerances` draws.
inline constexpr std::uint64_t kSharingSamples = 10'000;

/// K_γ from the tolerances of a design with MeshLoadSource::kTolerances.
///
/// Gearboxes are drawn once, at one position of the turn, and solved at each torque, with the
/// meshes' mean stiffness there and the nominal torque, without K_A: K_γ falls as the torque rises,
/// and a capacity is that at its own K_γ.
/// Source: own derivation, docs/theory §55.
/// @param loaded  the drawn train, without mesh_load
/// @returns empty for any other source
/// @throws std::invalid_argument without tolerances
std::optional<SharedMeshLoad> shared_mesh_load(const Design& design,
                                               const strength::RatedTrain<double>& loaded);

}  // namespace gear3k::design
