#pragma once
// What a design asks of its teeth and of the motor for what it gives at the output: terms in which
// designs of different ratio and size can be compared.

#include <array>
#include <optional>

#include "design/design.hpp"
#include "design/evaluation.hpp"

namespace gear3k::design {

/// Forces and torques per torque at the output, of the meshes' losses alone, and the size.
struct OutputTerms {
  /// F_k/T = a_k/N [1/m]: normal force of each mesh on one planet, without losses.
  std::array<double, train::kMeshCount> tooth_force_per_torque_1_m{};
  /// |T_S/T| = 1/(|i| η_f): what the motor gives, driven forward; empty where the train locks.
  std::optional<double> driving_torque_share;
  /// (1/η_f − 1)/|i|: the part of it that is friction.
  std::optional<double> friction_torque_share;
  /// η_b/|i|: what reaches the sun, driven backward; 0 or less: it locks.
  std::optional<double> back_driven_torque_share;
  /// The larger ring: over its outer surface where it is stated, else its root circle [m].
  double outer_diameter_m = 0.0;
  bool outer_surface_stated = false;  ///< of both rings
  double ring_root_diameter_m = 0.0;  ///< the larger ring's
};

/// Source: forces by virtual work, docs/theory §51; efficiencies, §6.
/// @param evaluation  of this design
/// @throws std::invalid_argument where the train's geometry is not defined
OutputTerms output_terms(const Design& design, const Evaluation& evaluation);

/// Over the outer surfaces of the rings, the larger one; empty where one of them is not stated.
std::optional<double> stated_outer_diameter_m(const Design& design);

}  // namespace gear3k::design
