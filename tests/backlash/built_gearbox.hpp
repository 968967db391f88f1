#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "backlash/clearance_model.hpp"
#include "tests/backlash/flank_geometry.hpp"
#include "tests/random_train.hpp"

namespace gear3k::backlash {

/// By how much each gear is turned against the carrier [rad].
using GearAngles = std::array<double, train::kGearCount>;

struct Subject {
  train::TrainParameters<double> parameters;
  train::TrainGeometry<double> geometry;
};

class RandomSubject : public RandomTrain {
 public:
  explicit RandomSubject(std::uint_fast64_t seed) : RandomTrain(seed) {}

  /// A train whose working angles leave the second order small.
  Subject subject() {
    for (;;) {
      const auto t = train(count(0, 1) == 1);
      train::TrainParameters<double> p{};
      p.teeth = t.teeth;
      p.planets = count(1, 5);
      p.pressure_angle_rad = t.gears[train::kS].angle.alpha_rad;
      p.center_distance_m = t.center_distance_m;
      p.module_m = {t.gears[train::kS].gear.module_m, t.gears[train::kP2].gear.module_m};
      for (std::size_t g = 0; g < train::kGearCount; ++g) {
        p.profile_shift[g] = t.gears[g].gear.profile_shift;
        p.machining_allowance[g] = between(0.0, 0.05);
      }
      const auto made = make_train_geometry(p);
      if (made && std::ranges::all_of(made->meshes, [](const auto& m) {
            return m.alpha_w_rad > 0.2 && m.alpha_w_rad < 0.7;
          })) {
        return {.parameters = p, .geometry = *made};
      }
    }
  }
  DeviationLimits limits(double least, double greatest) {
    const double a = between(least, greatest);
    const double b = between(least, greatest);
    return {.lower = std::min(a, b), .upper = std::max(a, b)};
  }
  Tolerances tolerances() {
    Tolerances t;
    for (GearTolerances& g : t.gears) {
      g.tooth_thickness_m = limits(-60e-6, 0.0);
      g.runout_m = between(5e-6, 20e-6);
      g.cumulative_pitch_m = between(30e-6, 45e-6);
      g.single_pitch_m = between(1e-6, 10e-6);
    }
    t.center_distance_m = limits(-20e-6, 20e-6);
    t.pin_position_m = between(5e-6, 20e-6);
    t.planet_phase_rad = limits(-5e-3, 5e-3);
    return t;
  }
  /// Within the limits.
  DeviationValue value(const ClearanceModel& model, const Deviation& d) {
    const double limit = model.sources[d.source].half_width_m;
    if (!d.planar) return {.x_m = between(-limit, limit)};
    const double angle = between(-std::numbers::pi, std::numbers::pi);
    const double radius = between(0.0, limit);
    return {.x_m = radius * std::cos(angle), .y_m = radius * std::sin(angle)};
  }
};

/// Centre distance at the middle of its tolerance.
inline train::TrainGeometry<double> at_middle(const Subject& subject,
                                              const Tolerances& tolerances) {
  auto p = subject.parameters;
  p.center_distance_m += tolerances.center_distance_m.middle();
  return *make_train_geometry(p);
}

/// The meshes as built, by what each deviation is said to be: nothing of its effects is read but,
/// for single pitches, which tooth touches where.
inline std::vector<PlanetPlay> built_plays(const train::TrainGeometry<double>& t,
                                           const Tolerances& tolerances,
                                           const ClearanceModel& model,
                                           const std::vector<DeviationValue>& values,
                                           const GearAngles& turned = {}) {
  std::vector<PlanetPlay> result(static_cast<std::size_t>(model.planets));
  for (int planet = 0; planet < model.planets; ++planet) {
    const double angle = 2.0 * std::numbers::pi * planet / model.planets;
    for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
      const auto k = static_cast<std::size_t>(mesh);
      const bool internal = mesh != train::kMeshSP1;
      const int central_gear = train::kMeshGears[k][internal ? 1 : 0];
      const int planet_gear = train::kMeshGears[k][internal ? 0 : 1];
      const auto middle = [&](int gear) {
        return tolerances.gears[static_cast<std::size_t>(gear)].tooth_thickness_m.middle();
      };
      ToothChange central{.thicker_m = middle(central_gear)};
      ToothChange own{.thicker_m = middle(planet_gear)};
      if (mesh == train::kMeshP2R2) own.turned_rad = tolerances.planet_phase_rad.middle();
      Point central_off, planet_off;
      std::array<double, 2> single{};  // arcs on the base circle that take from u
      for (std::size_t i = 0; i < values.size(); ++i) {
        const Deviation& d = model.deviations[i];
        const ToleranceSource& source = model.sources[d.source];
        const DeviationValue& v = values[i];
        const bool of_central = source.gear == central_gear;
        const bool of_planet = source.gear == planet_gear && d.planet == planet;
        if (source.gear >= 0 && !of_central && !of_planet) continue;
        if (source.gear < 0 && d.planet >= 0 && d.planet != planet) continue;
        ToothChange& change = of_central ? central : own;
        Point& off = of_central ? central_off : planet_off;
        switch (source.kind) {
          case ToleranceKind::kCenterDistance:
            planet_off.x += v.x_m * std::cos(angle);
            planet_off.y += v.x_m * std::sin(angle);
            break;
          case ToleranceKind::kToothThickness:
            change.thicker_m += v.x_m;
            break;
          case ToleranceKind::kPinPosition:
            off.x += v.x_m;
            off.y += v.y_m;
            break;
          case ToleranceKind::kRunout: {
            const double by = turned[static_cast<std::size_t>(source.gear)];
            off.x += v.x_m * std::cos(by) - v.y_m * std::sin(by);
            off.y += v.x_m * std::sin(by) + v.y_m * std::cos(by);
            break;
          }
          case ToleranceKind::kPlanetPhase:
            if (mesh != train::kMeshP2R2) break;
            own.turned_rad += v.x_m / t.gears[train::kP2].base_radius_m;
            break;
          case ToleranceKind::kCumulativePitch: {
            // The tooth that stands towards the mesh, seen from the gear's own centre.
            const double at = (of_planet && !internal ? angle + std::numbers::pi : angle) -
                              turned[static_cast<std::size_t>(source.gear)];
            const double arc_m = v.x_m * std::cos(at) + v.y_m * std::sin(at);
            change.turned_rad +=
                arc_m / t.gears[static_cast<std::size_t>(source.gear)].reference_radius_m;
            break;
          }
          case ToleranceKind::kSinglePitch: {
            EXPECT_EQ(d.x.size(), 1U);
            const std::size_t bound = d.x.front().bound;
            if (static_cast<int>(bound / 2) != planet * train::kMeshCount + mesh) break;
            const auto& gear = t.gears[static_cast<std::size_t>(source.gear)];
            const double by_rad = v.x_m / gear.reference_radius_m;
            // Only the one flank: placed below.
            single[bound % 2] +=
                by_rad * gear.base_radius_m * (of_central || mesh == train::kMeshSP1 ? 1.0 : -1.0);
            break;
          }
        }
      }
      PlacedMesh placed = placed_mesh(t, mesh, angle, central, own);
      placed.central.x += central_off.x;
      placed.central.y += central_off.y;
      placed.planet.x += planet_off.x;
      placed.planet.y += planet_off.y;
      for (const std::size_t side : {0U, 1U}) {
        placed.central_origin[side] += single[side] / placed.central_rb;
      }
      const auto ends = placed.ends();
      result[static_cast<std::size_t>(planet)][k] = {.lower_m = ends.lower, .upper_m = ends.upper};
    }
  }
  return result;
}

}  // namespace gear3k::backlash
