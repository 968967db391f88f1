#pragma once
// Limits of a tooth's thickness as a drawing states them, as thinning with a tolerance.

#include <cmath>

#include "backlash/tolerances.hpp"
#include "geometry/scalar.hpp"

namespace gear3k::backlash {

/// q of the middle of the thickness allowances A_sni ≤ A_sn ≤ A_sne, which are arcs on the
/// reference circle and negative where the tooth is thinner than without backlash:
///
///   q = −(A_sne + A_sni)/2 cos α/m,  of the same sense for external gears and rings
///
/// Source: ISO 21771 (A_sne, A_sni; s_n of a spur gear is s_t); q is measured normal to the flank,
/// docs/theory §4.
/// @returns q in modules
template <class T>
T machining_allowance_of(const DeviationLimits& allowance_m, const T& pressure_angle_rad,
                         const T& module_m) {
  using std::cos;
  return -allowance_m.middle() * cos(pressure_angle_rad) / module_m;
}

/// What is left of the allowances about their middle: GearTolerances::tooth_thickness_m.
inline DeviationLimits thickness_tolerance_of(const DeviationLimits& allowance_m) {
  return {.lower = -allowance_m.half_width(), .upper = allowance_m.half_width()};
}

}  // namespace gear3k::backlash
