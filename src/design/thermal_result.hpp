#pragma once
// A gearbox over the temperatures that it is stated for.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "train/thermal_growth.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::design {

/// A mesh at a temperature.
struct ThermalMesh {
  double base_pitch_difference_m = 0.0;  ///< of gear 2 less that of gear 1
  double working_pressure_angle_rad = 0.0;
  double contact_ratio = 0.0;  ///< over the larger base pitch
  /// See backlash::UnequalMesh.
  double normal_backlash_m = 0.0, least_backlash_m = 0.0;
  std::array<double, 2> root_clearance_m{};  ///< between the tip of gear 1, 2 and its mate's root
};

/// The drawn gearbox at a temperature.
struct ThermalStateResult {
  train::ThermalState state;
  double center_distance_m = 0.0;
  std::array<ThermalMesh, train::kMeshCount> meshes{};
  double lost_motion_rad = 0.0;  ///< kinematic, at the output
};

/// Where a mesh has no play left: the first temperature below and above the reference at which
/// ThermalMesh::least_backlash_m is 0, dry or wet.  Empty: none from 0 K to kGreatestJam_K.
struct JamRange {
  std::optional<double> below_K, above_K;
};
inline constexpr double kGreatestJam_K = 1000.0;

struct ThermalResult {
  double reference_K = 0.0;
  std::vector<ThermalStateResult> states;  ///< the reference, as drawn, then the ends
  std::array<JamRange, train::kMeshCount> jams{};
};

/// Everything about the drawn gearbox at the reference and at the ends of a range.
///
/// Jams are searched in both directions from the reference, in steps of 1/256 of the way and by
/// bisection in the first that has one; a mesh that has no play at the reference jams there.
/// Source: docs/theory §64.
/// Accuracy of a jam: 1e-9 K, of the linear growth.
/// Does not cover: temperatures that differ between parts, play by tolerances (their margins are
/// those of the checks at the corners of the tolerances).
/// @returns empty where a mesh has no working pressure angle at an end
std::optional<ThermalResult> thermal_result(const train::TrainGeometry<double>& train,
                                            const train::ThermalRange& range);

/// Plays of a train in a state; every mesh must have a working angle there.
template <class T>
struct ThermalPlay {
  T lost_motion_rad{};  ///< kinematic, at the output
  /// Mean and least of each mesh, see backlash::UnequalMesh.
  std::array<T, train::kMeshCount> normal_backlash_m{}, least_backlash_m{};
};
template <class T>
ThermalPlay<T> thermal_play(const train::TrainGeometry<T>& drawn, const train::ThermalRange& range,
                            const train::ThermalState& state);

/// The state and the mesh that leave no working pressure angle; empty where all do.
struct NoThermalMesh {
  train::ThermalState state;
  std::size_t mesh = 0;
};
std::optional<NoThermalMesh> mesh_without_angle(
    const std::array<geometry::GearGeometry<double>, train::kGearCount>& gears,
    double center_distance_m, const train::ThermalRange& range);

}  // namespace gear3k::design
