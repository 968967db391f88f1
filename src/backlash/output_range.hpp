#pragma once
// How far the output of an assembled gearbox can turn when its planets differ.

#include <array>
#include <span>

#include "train/train_geometry.hpp"

namespace gear3k::backlash {

/// Where the flanks of one mesh of one planet let it stand: lower ≤ u ≤ upper, u the relative
/// motion of the two flanks along the line of action as in docs/theory §8.  upper − lower is the
/// normal backlash there; the middle is not 0 where the planet stands off its place.
struct MeshPlay {
  double lower_m = 0.0, upper_m = 0.0;
};
using PlanetPlay = std::array<MeshPlay, train::kMeshCount>;

/// Coefficients of the range, from base radii only.
struct OutputLevers {
  double planet = 0.0;    ///< κ = rb_P2/rb_P1
  double sun_side = 0.0;  ///< e = (rb_R2 + κ rb_S)/(rb_S + rb_R1)
  double ring_side = 0.0;  ///< f = (rb_R2 − κ rb_R1)/(rb_S + rb_R1), e − f = κ; sign of 1 − G2
  double output_m = 0.0;  ///< rb_R2
};
OutputLevers output_levers(const train::TrainGeometry<double>& train);

/// Range of the output's angle, sun and R1 held, all bodies rigid.
///
/// Each planet takes part in three meshes, and may turn on its pin as long as all three let it.
/// Three intervals on a line meet when every two of them do (Helly), so that the planets' own
/// angles drop out and three strips in carrier angle and output angle remain,
///
///   w = u1 + u2        ∈ [max_p, min_p] of the sums of bounds
///   s13 = κ u1 + u3    ∈ ...
///   s23 = u3 − κ u2    ∈ ...
///   rb_R2 δ_R2 = s13 − e w = s23 − f w = (e s23 − f s13)/κ
///
/// of which the last line gives the greatest and the least output angle by linear duality.
/// Alike planets: the range is kinematic_lost_motion().
/// Source: own derivation, docs/theory §33.  Accuracy: rounding.
struct OutputRange {
  /// Whether any position of carrier, planets and output fits: margin_m ≥ 0.
  [[nodiscard]] bool assembles() const { return margin_m >= 0.0; }
  double lower_rad = 0.0, upper_rad = 0.0;  ///< of no meaning unless it assembles
  /// Least room, along a line of action, in any mesh and any chain of meshes; negative: that much
  /// must be ground away before it assembles.
  double margin_m = 0.0;
  [[nodiscard]] double width_rad() const { return upper_rad - lower_rad; }
};
/// @param planets  of every planet the three meshes  @throws std::invalid_argument without planets
OutputRange output_range(const OutputLevers& levers, std::span<const PlanetPlay> planets);

}  // namespace gear3k::backlash
