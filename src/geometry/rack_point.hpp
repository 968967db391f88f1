#pragma once
// Where the flanks of the basic rack's teeth, as the tool that cuts external gears, meet.

#include <cmath>
#include <numbers>

#include "geometry/gear.hpp"
#include "geometry/scalar.hpp"

namespace gear3k::geometry {

/// Half a tooth of the rack on its datum line, in modules: thicker by what it thins.
template <class T>
T half_rack_tooth(const GearGeometry<T>& external) {
  return external.gear.machining_allowance / (2.0 * external.angle.cos) + std::numbers::pi / 4.0;
}

/// Depth to which the rack's teeth reach, in modules: hfP*, or where their flanks meet if that is
/// less:
///   h ≤ (π/4 + q/(2 cos α))/tan α
/// Source: own derivation, docs/theory §14.
template <class T>
T rack_depth(const GearGeometry<T>& external) {
  return smaller(external.gear.rack.dedendum, T(half_rack_tooth(external) / external.angle.tan));
}

/// Standard pressure angle from which on the rack's teeth, without thinning, are pointed above
/// their tip line:
///   tan α = π/(4 hfP*)
/// Source: own derivation, docs/theory §14.
/// @returns [rad]
inline double pointed_rack_angle(const BasicRack<double>& rack) {
  return std::atan2(std::numbers::pi, 4.0 * rack.dedendum);
}

}  // namespace gear3k::geometry
