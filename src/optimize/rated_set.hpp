#pragma once
// A tooth set of the search as strength rates it.

#include <array>
#include <span>

#include "optimize/specification.hpp"
#include "strength/train_rating.hpp"

namespace gear3k::optimize {

/// The train with the friction and the planets' masses of the specification; refers to its parts.
/// @param forms  by gear; those of roots that are not rated may be empty
template <class T>
strength::RatedTrain<T> rated_train(const Specification& spec, const train::TrainGeometry<T>& train,
                                    std::span<const geometry::ToothForm<T>> forms,
                                    const std::array<T, 2>& face_width_m);

}  // namespace gear3k::optimize
