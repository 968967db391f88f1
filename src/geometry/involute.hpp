#pragma once

#include <cmath>

#include "geometry/scalar.hpp"

namespace gear3k::geometry {

/// Involute function: the polar angle that the involute sweeps up to pressure angle a.
///
///   inv a = tan a − a
///
/// Source: ISO 21771 (involute function).
/// Valid: |a| < π/2.  Accuracy: rounding of tan a − a, that is 1 ulp of tan a.
/// @param angle  pressure angle a [rad]
/// @returns inv a [rad]
template <class T>
T involute(const T& angle);

/// Inverse of the involute function for non-negative arguments.
///
/// Newton's method from an upper bound of the root, where it descends monotonically because inv is
/// convex; derivatives are those of the implicit function, da/d(inv a) = 1/tan² a.
///
/// Source: own derivation, docs/theory §1.
/// Accuracy: 1e-14 rad for a in [0.02, 1.3] (property-tested).
/// @param value  inv a [rad], finite, value ≥ 0; above 0 for derivatives, which are infinite at 0
/// @returns a [rad] in [0, π/2)
/// @throws std::invalid_argument outside that range or NaN
template <class T>
T inverse_involute(const T& value);

/// Polar angle swept by an involute from its base circle to a radius.
///
///   inv(acos(rb/r)) = t/rb − atan(t/rb),   t = sqrt(r² − rb²)
///
/// Source: ISO 21771 (involute function).
/// @returns [rad]; 0 without derivatives from the base circle inwards
template <class T>
T involute_to(const T& base_radius_m, const T& radius_m) {
  using std::atan2, std::sqrt;
  if (!(value_of(radius_m) > value_of(base_radius_m))) return constant<T>(0.0);
  const T length = sqrt((radius_m - base_radius_m) * (radius_m + base_radius_m));
  return length / base_radius_m - atan2(length, base_radius_m);
}

}  // namespace gear3k::geometry
