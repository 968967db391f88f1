#pragma once
// K_γ of a design from its tolerances.

#include <cstdint>
#include <optional>

#include "design/design.hpp"
#include "strength/load_sharing.hpp"
#include "strength/train_rating.hpp"

namespace gear3k::design {

/// Gearboxes whose planets on their common carrier give K_γ.
struct PlanetSharing {
  double quantile = 0.0;                   ///< share of them that K_γ covers
  std::uint64_t drawn = 0, assembled = 0;  ///< those that do not assemble do not count
  /// At the stated torque; empty, K_γ is not known, where none assembles or a mesh has no path of
  /// contact.
  std::optional<strength::LoadFactorSeries> series{};
};

/// The sharing at the stated torque, and K_γ at any.
struct SharedMeshLoad {
  PlanetSharing sharing;
  /// NaN where it is not known.  Refers to the design and its loaded train, and keeps the series of
  /// each torque that it was asked for: not thread-safe, copies included.
  strength::MeshLoadFunction mesh_load;
};

/// Gearboxes that are drawn for K_γ, the first ones of the series that `tolerances` draws.
inline constexpr std::uint64_t kSharingSamples = 10'000;

/// K_γ from the tolerances of a design with MeshLoadSource::kTolerances.
///
/// Gearboxes are drawn once, at one position of the turn, and solved at each torque: the nominal
/// one, without K_A.  The springs are k̄ b of the meshes driven forward under that torque, evenly
/// shared, for all planets and both senses.  K_γ tends to 1 as the torque rises without bound;
/// between, it may rise too, and above N.  A capacity is that at its own K_γ. Source: own
/// derivation, docs/theory §55.
/// @param loaded  the drawn train; its mesh_load is not read
/// @returns empty for any other source
/// @throws std::invalid_argument without tolerances
std::optional<SharedMeshLoad> shared_mesh_load(const Design& design,
                                               const strength::RatedTrain<double>& loaded);

}  // namespace gear3k::design
