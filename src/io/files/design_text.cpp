#include "design/rating_inputs.hpp"
#include "io/files/design_file.hpp"
#include "io/keys/design_keys.hpp"

namespace gear3k::io {

namespace {

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
  input.axial = design.axial;
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
