#include "train/train_geometry.hpp"

#include <cmath>
#include <numbers>

namespace gear3k::train {

template <class T>
std::array<geometry::GearGeometry<T>, kGearCount> make_train_gears(const TrainParameters<T>& p) {
  const geometry::PressureAngle<T> angle = geometry::make_pressure_angle(p.pressure_angle_rad);
  const std::array<int, kGearCount> z = teeth_of(p.teeth);
  std::array<T, kGearCount> shortening = p.tip_shortening;
  for (const std::size_t i : {kS, kP1}) {
    if (p.khk_tip[i] && value_of(p.center_distance_m) > 0.0) {
      shortening[i] =
          geometry::khk_tip_shortening<T>({.teeth_sum = z[kS] + z[kP1],
                                           .module_m = p.module_m[0],
                                           .shift_sum = p.profile_shift[kS] + p.profile_shift[kP1],
                                           .center_distance_m = p.center_distance_m});
    }
  }
  std::array<geometry::GearGeometry<T>, kGearCount> gears;
  for (std::size_t i = 0; i < kGearCount; ++i) {
    const int id = static_cast<int>(i);
    gears[i] = geometry::make_gear_geometry(
        geometry::Gear<T>{.teeth = z[i],
                          .kind = kind_of(id),
                          .module_m = p.module_m[static_cast<std::size_t>(stage_of(id))],
                          .profile_shift = p.profile_shift[i],
                          .machining_allowance = p.machining_allowance[i],
                          .tip_shortening = shortening[i],
                          .rack = p.rack[i],
                          .cutter = p.cutter[i]},
        angle);
  }
  return gears;
}

template <class T>
std::optional<TrainGeometry<T>> make_train_geometry(const TrainParameters<T>& p) {
  TrainGeometry<T> train;
  train.teeth = p.teeth;
  train.planets = p.planets;
  train.center_distance_m = p.center_distance_m;
  train.gears = make_train_gears(p);
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const auto [first, second] = kMeshGears[k];
    auto mesh = geometry::make_mesh_geometry(train.gears[static_cast<std::size_t>(first)],
                                             train.gears[static_cast<std::size_t>(second)],
                                             p.center_distance_m);
    if (!mesh) return std::nullopt;
    train.meshes[k] = *mesh;
  }
  return train;
}

template <class T>
T neighbour_gap(const TrainGeometry<T>& train, GearId planet_step) {
  const double half_spacing = std::sin(std::numbers::pi / train.planets);
  return 2.0 * (half_spacing * train.center_distance_m -
                train.gears[static_cast<std::size_t>(planet_step)].tip_radius_m);
}

#define INSTANTIATE(T)                                                                        \
  template std::array<geometry::GearGeometry<T>, kGearCount> make_train_gears<T>(             \
      const TrainParameters<T>&);                                                             \
  template std::optional<TrainGeometry<T>> make_train_geometry<T>(const TrainParameters<T>&); \
  template T neighbour_gap<T>(const TrainGeometry<T>&, GearId);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::train
