#pragma once
// A train with what its strength depends on besides geometry: losses and face widths.

#include <array>
#include <optional>
#include <span>

#include "efficiency/friction_law.hpp"
#include "efficiency/train_efficiency.hpp"
#include "strength/train_rating.hpp"

namespace gear3k::design {

/// Friction of the flanks by mesh, when the train is driven forward and backward.
template <class T>
using DirectionalFriction =
    std::array<std::array<efficiency::FlankFriction<T>, train::kMeshCount>, 2>;

/// The train as strength rates it; refers to geometry and forms, which must outlive it.
///
/// Each mesh has its efficiency with either member driving, at the friction of the direction.
/// @param face_width_m  by stage
template <class T>
strength::RatedTrain<T> loaded_train(const train::TrainGeometry<T>& geometry,
                                     std::span<const geometry::ToothForm<T>> forms,
                                     const std::array<T, 2>& face_width_m,
                                     const DirectionalFriction<T>& friction,
                                     efficiency::LossModel model);

/// Both directions with one friction for all meshes.
template <class T>
DirectionalFriction<T> even_friction(const efficiency::FlankFriction<T>& forward,
                                     const efficiency::FlankFriction<T>& backward);

}  // namespace gear3k::design
