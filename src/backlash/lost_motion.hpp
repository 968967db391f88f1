#pragma once
// From the three meshes' normal backlash to the angle that the output can move.

#include <array>

#include "train/train_geometry.hpp"

namespace gear3k::backlash {

enum class LostMotionModel {
  kKinematic,  ///< exact for rigid bodies and equal planets, sun locked
  kPaper       ///< low-backlash paper, eqs. 16-17
};

/// Normal backlash of the three meshes [m], in the order of train::MeshId.
template <class T>
std::array<T, train::kMeshCount> normal_backlashes(const train::TrainGeometry<T>& train);

/// Share of each mesh in the lost motion at the output, by the kinematic model.
///
///   j1/(|i| rb_S),  j2 (G1 + G2)/((1 + G1) rb_R1),  j3/rb_R2
///
/// Their sum is the angle that R2 can turn with the sun locked, all bodies rigid and all planets
/// alike; at the input (output locked) it is |i| times that.
/// Source: own derivation, docs/theory §8 (errata 8).
/// @returns [rad] each; a negative share is interference, kept with its sign
template <class T>
std::array<T, train::kMeshCount> kinematic_lost_motion(
    const train::TrainGeometry<T>& train, const std::array<T, train::kMeshCount>& j_bn);

/// The angles φ_k of the low-backlash paper.
///
///   φ_k = j_k/(cos α r_k),  r_1 = |i| r_S, r_2 = r_R1, r_3 = r_R2  (reference radii)
///
/// The paper does not define its effective radii; these are our reading (errata 4).
/// Source: low-backlash paper, eq. 16.  @returns [rad] each
template <class T>
std::array<T, train::kMeshCount> paper_lost_motion(const train::TrainGeometry<T>& train,
                                                   const std::array<T, train::kMeshCount>& j_bn);

/// Lost motion at the output: the sum of kinematic_lost_motion(), or φ_1 + max(φ_2, φ_3) (eq. 17).
/// @returns [rad]
template <class T>
T output_lost_motion(const train::TrainGeometry<T>& train,
                     const std::array<T, train::kMeshCount>& j_bn, LostMotionModel model);

}  // namespace gear3k::backlash
