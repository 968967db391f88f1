#pragma once

#include <array>

#include "efficiency/friction_law.hpp"
#include "efficiency/mesh_loss.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::efficiency {

/// Efficiencies of the three meshes in one drive direction, in the order of train::MeshId.
template <class T>
using MeshEfficiencies = std::array<T, train::kMeshCount>;

/// A mesh as its friction sees it when gear 1 or gear 2 drives.
template <class T>
MeshContact<T> contact_of(const geometry::GearGeometry<T>& gear1,
                          const geometry::GearGeometry<T>& gear2,
                          const geometry::MeshGeometry<T>& mesh, bool gear1_drives);

/// Approach and recess contact ratio of a mesh in a drive direction of the train.
template <class T>
MeshContact<T> mesh_contact(const train::TrainGeometry<T>& train, train::MeshId mesh, bool forward);

/// Friction of the flanks of the three meshes in one drive direction.
template <class T>
using MeshFlanks = std::array<FlankFriction<T>, train::kMeshCount>;

/// Those of FrictionLaw::kConstant, as constants of a scalar.
template <class T>
MeshFlanks<T> constant_friction(const Friction<double>& friction, const train::ToothSet& teeth,
                                bool forward) {
  const bool g2_below_one = train::g2(teeth) < 1.0;
  MeshFlanks<T> flanks;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto mesh = static_cast<train::MeshId>(k);
    flanks[k] = constant_friction<T>(friction, forward, mesh != train::kMeshSP1,
                                     train::gear1_drives(mesh, g2_below_one, forward));
  }
  return flanks;
}

/// Efficiency of each mesh for a drive direction of the train.
template <class T>
MeshEfficiencies<T> mesh_efficiencies(const train::TrainGeometry<T>& train, const MeshFlanks<T>& mu,
                                      LossModel model, bool forward);
template <class T>
MeshEfficiencies<T> mesh_efficiencies(const train::TrainGeometry<T>& train,
                                      const FlankFriction<T>& mu, LossModel model, bool forward) {
  return mesh_efficiencies(train, MeshFlanks<T>{mu, mu, mu}, model, forward);
}
template <class T>
MeshEfficiencies<T> mesh_efficiencies(const train::TrainGeometry<T>& train, const T& mu,
                                      LossModel model, bool forward) {
  return mesh_efficiencies(train, FlankFriction<T>{.coefficient = mu}, model, forward);
}

/// Efficiency when the sun drives and R2 is the output.
///
///   G2 < 1: η_f = (1 + η1 η2 G1)(1 − G2)/((1 + G1)(1 − η2 η3 G2))
///   G2 > 1: η_f = η3 (η2 + η1 G1)(G2 − 1)/((1 + G1)(G2 − η2 η3))
///
/// Source: low-backlash paper, eq. 18 with the misprint mended (errata 1); G2 > 1: own derivation,
/// docs/theory §10.  Valid: 0 < η_k ≤ 1, G2 ≠ 1.
template <class T>
T forward_efficiency(const train::ToothSet& z, const MeshEfficiencies<T>& eta);

/// Efficiency when R2 drives and the sun is the output.
///
///   G2 < 1: η_b = η1 (1 + G1)(η2 η3 − G2)/(η3 (G1 + η1 η2)(1 − G2))
///   G2 > 1: η_b = η1 (1 + G1)(η2 η3 G2 − 1)/((η1 + η2 G1)(G2 − 1))
///
/// Source: low-backlash paper, eq. 19; G2 > 1: own derivation, docs/theory §10.
/// Values ≤ 0 mean that the train locks; they keep the sign and size of the formula, which is
/// smooth, so that an optimiser can climb out.  See backdriving_margin().
template <class T>
T backward_efficiency(const train::ToothSet& z, const MeshEfficiencies<T>& eta);

/// Positive iff the output can drive the sun: η2 η3 − G2 for G2 < 1, η2 η3 G2 − 1 for G2 > 1
/// (with the meshes' efficiencies of the backward direction).
template <class T>
T backdriving_margin(const train::ToothSet& z, const MeshEfficiencies<T>& eta);

}  // namespace gear3k::efficiency
