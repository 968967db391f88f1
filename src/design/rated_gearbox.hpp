#pragma once
// A design under the load that it states.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "design/evaluation.hpp"
#include "design/loaded_train.hpp"

namespace gear3k::design {

/// Friction for the tooth forces; none where the law has no value.
DirectionalFriction<double> force_friction(const Friction& friction,
                                           std::span<const MeshResult> meshes);

/// What a gearbox carries, and how its checks rate it.
struct RatedGearbox {
  StrengthResult result;
  GearingRating rating;            ///< Drive::kEither; refers to the design
  std::vector<std::string> notes;  ///< where losses do not count
};
/// Rates a gearbox at its stated load, in both drive directions, and finds its capacity.
///
/// Losses are those of `meshes`; a mesh whose friction is not known counts without.
/// @param meshes,parts  of the evaluation; the masses of the planets act as centrifugal forces
/// @returns empty without a rating task
/// @throws std::invalid_argument as strength::rate_train()
std::optional<RatedGearbox> rate_gearbox(const Design& design,
                                         const train::TrainGeometry<double>& geometry,
                                         std::span<const geometry::ToothForm<double>> forms,
                                         std::span<const MeshResult> meshes,
                                         const std::vector<PartMass>& parts);

/// A pair under the load that it states.
struct RatedPair {
  strength::MeshRating<double> rating;
  GearingRating rate;                                  ///< for its checks; refers to the design
  std::optional<strength::Capacity<double>> capacity;  ///< on gear 1
  std::vector<std::string> notes;
};
/// Rates a pair at the torque on its gear 1, which drives.
/// @returns empty without a rating task
/// @throws std::invalid_argument as strength::rate_mesh()
std::optional<RatedPair> rate_pair(const PairDesign& design,
                                   const std::array<geometry::GearGeometry<double>, 2>& gears,
                                   const std::array<geometry::ToothForm<double>, 2>& forms,
                                   const geometry::MeshGeometry<double>& mesh);

}  // namespace gear3k::design
