#pragma once
// The five gears and three meshes of a 3K train on one carrier.

#include <array>
#include <optional>

#include "geometry/mesh.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::train {

/// What is given of a train.  One carrier: one centre distance for all three meshes.
template <class T>
struct TrainParameters {
  ToothSet teeth;
  int planets = 3;
  T pressure_angle_rad{};
  T center_distance_m{};
  std::array<T, 2> module_m{};  ///< stage 1 (S, P1, R1), stage 2 (P2, R2)
  std::array<T, kGearCount> profile_shift{};
  std::array<T, kGearCount> machining_allowance{};
  std::array<T, kGearCount> tip_shortening{};
  /// S and P1: the tip is shortened by the KHK rule of mesh S-P1 instead of by tip_shortening.
  std::array<bool, kGearCount> khk_tip{};
  std::array<geometry::BasicRack<T>, kGearCount> rack{};
  std::array<geometry::PinionCutter, kGearCount> cutter{};
};

/// Stage (0 or 1) that a gear belongs to.
constexpr int stage_of(int gear) { return gear >= kP2 ? 1 : 0; }
constexpr geometry::GearKind kind_of(int gear) {
  return gear == kR1 || gear == kR2 ? geometry::GearKind::kRing : geometry::GearKind::kExternal;
}

template <class T>
struct TrainGeometry {
  ToothSet teeth;
  int planets = 3;
  T center_distance_m{};
  std::array<geometry::GearGeometry<T>, kGearCount> gears{};
  std::array<geometry::MeshGeometry<T>, kMeshCount> meshes{};
};

/// Base radius of the central gear of a mesh: S, R1, R2.
template <class T>
const T& central_base_radius(const TrainGeometry<T>& train, std::size_t mesh) {
  return train.gears[kCentralGears[mesh]].base_radius_m;
}

/// The gears alone.  The centre distance matters only where khk_tip asks for it; while it is not
/// known (0), those tips are as tip_shortening says.
template <class T>
std::array<geometry::GearGeometry<T>, kGearCount> make_train_gears(const TrainParameters<T>& p);

/// Geometry of the whole train; empty where a mesh has no real working angle at this distance.
/// @throws std::invalid_argument for values outside the geometry functions' ranges
template <class T>
std::optional<TrainGeometry<T>> make_train_geometry(const TrainParameters<T>& p);

/// Gap between the tip circles of neighbouring planets of one step (kP1 or kP2):
///   2 d sin(π/N) − 2 ra
/// @returns [m], negative = overlap; for one planet the gap is unlimited and the formula unused
template <class T>
T neighbour_gap(const TrainGeometry<T>& train, GearId planet_step);

}  // namespace gear3k::train
