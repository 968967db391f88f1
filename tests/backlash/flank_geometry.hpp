#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "train/train_geometry.hpp"

namespace gear3k::backlash {

struct Point {
  double x = 0.0, y = 0.0;
};

/// One planet's mesh in the frame of the carrier, with explicit centres and tooth flanks: strings
/// unwound from displaced base circles.  Finite displacements, involutes only.
struct PlacedMesh {
  Point central{}, planet{};  ///< centres [m]
  double central_rb = 0.0, planet_rb = 0.0;
  /// Origins on the base circles of the flanks that touch at the upper and at the lower end of u,
  /// as angles.
  std::array<double, 2> central_origin{}, planet_origin{};
  bool internal = false;

  struct Ends {
    double lower, upper;
  };
  /// Gaps along the two lines of action, that of the lower end with a minus: what bounds u.
  [[nodiscard]] Ends ends() const {
    const double dx = planet.x - central.x;
    const double dy = planet.y - central.y;
    const double distance = std::hypot(dx, dy);
    const double direction = std::atan2(dy, dx);
    const double alpha =
        std::acos((internal ? central_rb - planet_rb : central_rb + planet_rb) / distance);
    const double tangent = distance * std::sin(alpha);
    // Length of a string from its tangent point to the flank of given origin.
    const auto string = [](double rb, double from, double to) {
      return rb * std::remainder(to - from, 2.0 * std::numbers::pi);
    };
    if (internal) {
      const double up = direction + alpha;
      const double down = direction - alpha;
      return {.lower = -(string(central_rb, down, central_origin[0]) - tangent -
                         string(planet_rb, down, planet_origin[0])),
              .upper = string(central_rb, central_origin[1], up) - tangent -
                       string(planet_rb, planet_origin[1], up)};
    }
    const double up = direction - alpha;
    const double down = direction + alpha;
    constexpr double kHalfTurn = std::numbers::pi;
    return {.lower = -(tangent - string(central_rb, central_origin[0], down) -
                       string(planet_rb, planet_origin[0], down + kHalfTurn)),
            .upper = tangent - string(central_rb, up, central_origin[1]) -
                     string(planet_rb, up + kHalfTurn, planet_origin[1])};
  }
};

/// Changes of one gear's teeth against the drawing.
struct ToothChange {
  double thicker_m = 0.0;  ///< arc on the reference circle
  double turned_rad = 0.0;
};

/// The mesh of planet `index` of `t`, a tooth of one gear in the middle of a space of the other.
inline PlacedMesh placed_mesh(const train::TrainGeometry<double>& t, int mesh, double planet_angle,
                              const ToothChange& on_central = {},
                              const ToothChange& on_planet = {}) {
  const bool internal = mesh != train::kMeshSP1;
  const auto [first, second] = train::kMeshGears[static_cast<std::size_t>(mesh)];
  const auto& central = t.gears[static_cast<std::size_t>(internal ? second : first)];
  const auto& planet = t.gears[static_cast<std::size_t>(internal ? first : second)];
  constexpr double kPi = std::numbers::pi;
  // Half the angle that a tooth spans on the base circle; of a ring, that its space does.
  const auto half_angle = [&](const geometry::GearGeometry<double>& g, double thicker) {
    const double m = g.gear.module_m;
    const double tan = std::tan(g.angle.alpha_rad);
    const bool ring = g.gear.kind == geometry::GearKind::kRing;
    const double thickness = m * (kPi / 2.0 + (ring ? -2.0 : 2.0) * g.gear.profile_shift * tan) -
                             m * g.gear.machining_allowance / std::cos(g.angle.alpha_rad) + thicker;
    const double arc = ring ? kPi * m - thickness : thickness;
    return arc / (m * g.gear.teeth) + tan - g.angle.alpha_rad;
  };
  const double c = half_angle(central, on_central.thicker_m);
  const double p = half_angle(planet, on_planet.thicker_m);
  PlacedMesh result{.planet = {t.center_distance_m * std::cos(planet_angle),
                               t.center_distance_m * std::sin(planet_angle)},
                    .central_rb = central.base_radius_m,
                    .planet_rb = planet.base_radius_m,
                    .internal = internal};
  if (internal) {
    // u grows as the planet's tooth runs against the flank on the side of smaller angles.
    result.central_origin = {planet_angle + c, planet_angle - c};
    result.planet_origin = {planet_angle + p, planet_angle - p};
  } else {
    const double half_pitch = kPi / planet.gear.teeth;
    result.central_origin = {planet_angle - c, planet_angle + c};
    result.planet_origin = {planet_angle + kPi + half_pitch - p,
                            planet_angle + kPi - half_pitch + p};
  }
  for (const std::size_t side : {0U, 1U}) {
    result.central_origin[side] += on_central.turned_rad;
    result.planet_origin[side] += on_planet.turned_rad;
  }
  return result;
}

}  // namespace gear3k::backlash
