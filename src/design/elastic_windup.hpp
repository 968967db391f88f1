#pragma once
// How far the output of a design winds up against its locked input, over the torque.

#include <array>
#include <optional>
#include <vector>

#include "design/design.hpp"
#include "strength/locked_train.hpp"

namespace gear3k::design {

/// Elasticity of a held train, its meshes' springs over their load.
struct ElasticTrain {
  strength::LockedTrain train;
  /// Of each mesh, by rising load: normal force of one planet [N] and 1/(k̄ b) [m/N] there.
  struct MeshSpring {
    double normal_N = 0.0, compliance_m_N = 0.0;
  };
  std::array<std::vector<MeshSpring>, train::kMeshCount> mesh;
};

/// The springs of a design that states [strength], without friction.
///
/// k̄ is that of strength::rate_train() at 14 torques, 2^−10 to 8 times the stated one, each twice
/// the last; the rest as the rating has it.
/// Source: docs/theory §53, §57.
/// @returns empty without a rating task, or where a mesh has no path of contact
std::optional<ElasticTrain> elastic_train(const Design& design);

/// 1/(k̄ b) of a mesh under a normal force: linear between the torques in the force's logarithm,
/// constant beyond their ends.
/// Source: the contact's share is linear in the logarithm but for H ~ 1, docs/theory (52.7).
double mesh_compliance(const std::vector<ElasticTrain::MeshSpring>& spring, double normal_N);

/// Turn of the output under a torque without friction, φ(T) = C_TT(T) T, C_TT at the springs'
/// forces there; odd in T. Source: docs/theory §57.
/// @returns [rad], of the sign of the torque
double elastic_windup(const ElasticTrain& train, double torque_Nm);

}  // namespace gear3k::design
