#pragma once
// What the rating of a gearbox takes from what else is stated of it.

#include <array>
#include <optional>

#include "design/design.hpp"

namespace gear3k::design {

/// Materials by gear, where they are known.
using GearMaterials = std::array<std::optional<strength::GearMaterial>, train::kGearCount>;

/// The task with what the design states beside it: face widths, speed of the sun, bores and outer
/// surfaces, pin, middle of the planet's toothings.
strength::RatingTask rating_of(strength::RatingTask task, const Design& design);

/// Middle of the toothings P1 and P2 along the axis; 0 where it is not stated.
std::array<double, 2> toothing_planes_m(const train::AxialLayout& axial);

/// Density of each gear's material.
GearDensities material_densities_kgm3(const GearMaterials& materials);

/// Density of the gears of one material, or of several of the same density; else empty.
std::optional<double> common_density_kgm3(const GearMaterials& materials);

}  // namespace gear3k::design
