#pragma once
// What the flanks of a mesh ask of its size, whatever its profile shifts: for bounds.

#include <array>
#include <optional>

#include "strength/rating_task.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::strength {

/// What favours the flanks of a train's meshes most, over every design that is bounded.
struct FlankExtremes {
  train::ToothSet teeth;
  int planets = 3;
  std::array<double, 2> greatest_face_width_m{};  ///< by stage
  std::array<double, 2> greatest_module_m{};      ///< by stage
  /// By mesh, in modules: ρ_red at the pitch point.
  std::array<double, train::kMeshCount> greatest_curvature{};
  double pressure_angle_rad = 0.0;
  /// No mesh gains power (friction_is_dissipative()); else nothing is said of S-P1 and P1-R1.
  bool dissipative = true;
  double safety_slack = 0.0;  ///< by so much flank_safety may miss its limit
};

/// F_k m/b [N] of a mesh with its module m and face width b, at least: T c_k/(N b r_k) as below.
double least_line_force(const RatingTask& task, const FlankExtremes& extremes, std::size_t mesh);

/// Least K_A K_γ K_v times a face and a transverse factor: a K_v that is computed is 1 or more.
/// Plastics have K_A K_γ alone.
double least_load_factor(const RatingTask& task, const FlankExtremes& extremes, std::size_t mesh,
                         double face, double transverse);

/// What flank_safety asks of the module m of a mesh, by member: no rated design has less than
///
///   m² tan α_w ≥ load Z_ε² Z²,    Z = Z_B or Z_D of metals, 1 of plastics and rings
///   load = (T c_k/(N b r_k)) (1/ρ_1 ± 1/ρ_2) K Z_E² S²/σ_HG²
///   c = (1/|i|, |1 − 1/i|, 1);  r_k of the central gear, ρ_i = r_b,i: base radii in modules
///
/// with K = K_A K_γ K_v K_Hβ K_Hα at their stated values or 1 (K_γ as the task has it) and σ_HG
/// the greatest that the extremes allow.  Of a mesh the drive direction counts that loads it more;
/// its force is then at least T c_k/(N r_k m), that without losses.
/// Source: own derivation, docs/theory §36.
struct FlankNeed {
  std::array<double, 2> load_m2{};       ///< 0: nothing is asked
  std::array<bool, 2> single_contact{};  ///< whether Z is of metals
};
std::array<FlankNeed, train::kMeshCount> flank_needs(const RatingTask& task,
                                                     const FlankExtremes& extremes);

}  // namespace gear3k::strength
