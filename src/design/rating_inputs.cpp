#include "design/rating_inputs.hpp"

#include <algorithm>

namespace gear3k::design {

strength::RatingTask rating_of(strength::RatingTask task, const Design& design) {
  const Masses& masses = design.masses;
  for (const std::size_t stage : {0U, 1U}) {
    task.face_width_m[stage] = masses.face_width_m[stage].value_or(0.0);
  }
  task.speed_rad_s = design.operating_point ? design.operating_point->sun_speed_rad_s : 0.0;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    task.rim_radius_m[gear].reset();
    if (masses.bore_radius_m[gear] > 0.0) task.rim_radius_m[gear] = masses.bore_radius_m[gear];
  }
  task.rim_radius_m[train::kR1] = masses.ring1_outer_radius_m;
  task.rim_radius_m[train::kR2] = masses.ring2_outer_radius_m;
  if (masses.planet_pin_radius_m) task.pin_diameter_m = 2.0 * *masses.planet_pin_radius_m;
  if (task.supports) task.supports->plane_m = toothing_planes_m(design.axial);
  return task;
}

std::array<double, 2> toothing_planes_m(const train::AxialLayout& axial) {
  std::array<double, 2> planes_m{};
  for (const std::size_t stage : {0U, 1U}) {
    const auto& extent = axial.extent[stage == 0 ? train::kP1 : train::kP2];
    if (extent) planes_m[stage] = 0.5 * (extent->from_m + extent->to_m);
  }
  return planes_m;
}

GearDensities material_densities_kgm3(const GearMaterials& materials) {
  GearDensities densities{};
  for (std::size_t gear = 0; gear < densities.size(); ++gear) {
    if (materials[gear]) densities[gear] = materials[gear]->record.density_kgm3;
  }
  return densities;
}

std::optional<double> common_density_kgm3(const GearMaterials& materials) {
  const GearDensities densities = material_densities_kgm3(materials);
  const bool same = std::ranges::all_of(
      densities, [&](const std::optional<double>& density) { return density == densities[0]; });
  return same ? densities[0] : std::nullopt;
}

}  // namespace gear3k::design
