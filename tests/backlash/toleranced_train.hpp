#pragma once

#include <cstdint>
#include <numbers>
#include <optional>

#include "backlash/clearance_model.hpp"
#include "tests/random_train.hpp"

namespace gear3k::backlash {

/// The bilateral drive gear (examples/designs/bilateral_drive_gear.toml), its teeth thinned.
inline train::TrainParameters<double> thinned_bilateral_drive_gear(double allowance = 0.05) {
  train::TrainParameters<double> p{};
  p.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  p.planets = 3;
  p.pressure_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.module_m = {0.8e-3, 0.8467e-3};
  p.profile_shift = {0.476, 0.762, 2.0, 0.536, 1.21};
  p.center_distance_m = 21.268e-3;
  p.machining_allowance.fill(allowance);
  return p;
}

/// Everything that can be stated of a gearbox, a few micrometres each.
inline Tolerances all_tolerances() {
  Tolerances t;
  for (GearTolerances& gear : t.gears) {
    gear.tooth_thickness_m = {.lower = -20e-6, .upper = 0.0};
    gear.runout_m = 10e-6;
    gear.cumulative_pitch_m = 20e-6;
    gear.single_pitch_m = 4e-6;
  }
  t.center_distance_m = {.lower = -5e-6, .upper = 5e-6};
  t.pin_position_m = 10e-6;
  t.planet_phase_rad = {.lower = -3e-4, .upper = 3e-4};
  return t;
}

/// Random trains, tolerances and numbers of planets; about every second can jam.
class RandomToleranced : public RandomTrain {
 public:
  using RandomTrain::RandomTrain;

  ClearanceModel model(bool g2_below_one, int least_planets = 1, int most_planets = 5) {
    for (;;) {
      train::TrainParameters<double> p{};
      p.teeth = teeth(g2_below_one);
      const train::ToothSet& z = p.teeth;
      p.planets = count(least_planets, most_planets);
      p.pressure_angle_rad = between(18.0, 25.0) * std::numbers::pi / 180.0;
      p.module_m[0] = between(0.4e-3, 1e-3);
      p.module_m[1] = p.module_m[0] * (z.R1 - z.P1) / (z.R2 - z.P2) * between(0.999, 1.001);
      p.center_distance_m = 0.5 * p.module_m[0] * (z.R1 - z.P1) * between(1.0, 1.03);
      Tolerances t;
      const double scale = between(0.2, 1.5);
      for (GearTolerances& gear : t.gears) {
        gear.tooth_thickness_m = {.lower = -scale * between(0.0, 20e-6), .upper = 0.0};
        gear.runout_m = scale * between(0.0, 20e-6);
        gear.cumulative_pitch_m = scale * between(0.0, 30e-6);
        gear.single_pitch_m = scale * between(0.0, 5e-6);
      }
      t.center_distance_m = {.lower = -scale * 5e-6, .upper = scale * 5e-6};
      t.pin_position_m = scale * 10e-6;
      t.planet_phase_rad = {.lower = -scale * 3e-4, .upper = scale * 3e-4};
      auto model = clearance_model(p, t);
      if (!model) continue;
      // The plays that the teeth leave are of no importance: others take their place.
      for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
        const double half = between(3e-6, 60e-6);
        for (int planet = 0; planet < p.planets; ++planet) {
          model->middle_m[bound_index(planet, mesh, false)] = -half;
          model->middle_m[bound_index(planet, mesh, true)] = half;
        }
      }
      return *model;
    }
  }
};

}  // namespace gear3k::backlash
