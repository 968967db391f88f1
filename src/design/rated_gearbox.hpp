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

/// What a gearbox carries, and the rating that its checks read.
struct RatedGearbox {
  StrengthResult result;
  strength::TrainRating<double> deciding;  ///< of each mesh the drive direction that loads it more
  std::vector<std::string> notes;          ///< where losses do not count
};
/// Rates a gearbox at its stated load, in both drive directions, and finds its capacity.
///
/// Losses are those of `meshes`; a mesh whose friction is not known counts without.
/// @param meshes  of the evaluation
/// @returns empty without a rating task
/// @throws std::invalid_argument as strength::rate_train()
std::optional<RatedGearbox> rate_gearbox(const Design& design,
                                         const train::TrainGeometry<double>& geometry,
                                         std::span<const geometry::ToothForm<double>> forms,
                                         std::span<const MeshResult> meshes);

/// Rates a pair at the torque on its gear 1, which drives.
/// @returns empty without a rating task
/// @throws std::invalid_argument as strength::rate_mesh()
std::optional<strength::MeshRating<double>> rate_pair(
    const PairDesign& design, const std::array<geometry::GearGeometry<double>, 2>& gears,
    const std::array<geometry::ToothForm<double>, 2>& forms,
    const geometry::MeshGeometry<double>& mesh, const MeshResult& result);

}  // namespace gear3k::design
