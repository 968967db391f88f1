#include <cmath>

#include "backlash/thickness_allowance.hpp"
#include "design/rating_inputs.hpp"
#include "io/files/design_file.hpp"
#include "io/keys/design_keys.hpp"

namespace gear3k::io {

namespace {

/// The thickness allowance of a gear, where thinning and tolerance still are what it says.
std::optional<backlash::DeviationLimits> allowance_in_force(const design::Design& design,
                                                            std::size_t gear) {
  const auto& stated = design.thickness_allowance_m[gear];
  if (!stated || !design.tolerances) return std::nullopt;
  constexpr double kAccuracy_m = 1e-12;
  const train::TrainParameters<double>& t = design.train;
  const double module_m =
      t.module_m[static_cast<std::size_t>(train::stage_of(static_cast<int>(gear)))];
  const double q = backlash::machining_allowance_of(*stated, t.pressure_angle_rad, module_m);
  const auto tolerance = backlash::thickness_tolerance_of(*stated);
  const auto& in_force = design.tolerances->gears[gear].tooth_thickness_m;
  const bool holds = std::abs(q - t.machining_allowance[gear]) * module_m <= kAccuracy_m &&
                     std::abs(tolerance.lower - in_force.lower) <= kAccuracy_m &&
                     std::abs(tolerance.upper - in_force.upper) <= kAccuracy_m;
  return holds ? stated : std::nullopt;
}

/// What a file states of this design.
DesignInput stated_design(const design::Design& design) {
  const train::TrainParameters<double>& t = design.train;
  DesignInput input;
  input.name = design.name;
  input.pressure_angle_rad = t.pressure_angle_rad;
  if (design.center_distance_given) input.center_distance_m = t.center_distance_m;
  input.rack = t.rack[0];
  const auto z = train::teeth_of(t.teeth);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    input.gears[i] = {.teeth = z[i],
                      .profile_shift = t.profile_shift[i],
                      .machining_allowance = t.machining_allowance[i],
                      .tip_shortening = t.tip_shortening[i],
                      .normal_thinning_m = {},
                      .thickness_allowance_m = allowance_in_force(design, i),
                      .khk_tip = t.khk_tip[i],
                      .cutter = t.cutter[i],
                      .pin_diameter_m = design.pin_diameter_m[i]};
  }
  input.limits = stated_limits(design.limits);
  if (design.tolerances) input.tolerances = stated_input(*design.tolerances, design.sampling);
  input.planets = t.planets;
  input.module_m = t.module_m;
  input.masses = design.masses;
  input.outer_radius_m[train::kR1] = design.masses.ring1_outer_radius_m;
  input.outer_radius_m[train::kR2] = design.masses.ring2_outer_radius_m;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    if (input.gears[i].thickness_allowance_m) input.tolerances.gears[i].tooth_thickness_m = {};
  }
  input.axial = design.axial;
  input.thermal = stated_thermal(design.thermal, design.limits, input.limits);
  input.losses = stated_losses(design);
  input.strength = stated_strength(design.rating);
  if (design.masses.planet_pin_radius_m) input.strength.task.pin_diameter_m.reset();
  if (design.rating &&
      design::common_density_kgm3(design.rating->material) == design.masses.density_kgm3) {
    input.masses.density_kgm3.reset();  // the materials state it
  }
  if (!design.rating && !design.masses.density_kgm3) {
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      input.strength.gear_material[i].density_kgm3 = design.masses.gear_density_kgm3[i];
    }
  }
  return input;
}

}  // namespace

std::string design_text(const design::Design& design) {
  return text_by_schema(design_schema(), stated_design(design));
}

design::Design as_written(const design::Design& design) {
  return parse_design(design_text(design), design.name);
}

}  // namespace gear3k::io
