#pragma once
// A check as a constraint of the optimiser: how far its value is from the limit, for a solver.

#include <algorithm>
#include <cmath>

#include "design/checks.hpp"
#include "geometry/sliding.hpp"

namespace gear3k::optimize {

/// The load that a safety S leaves, over the one that its limit L allows, is (L/S)^p with p = 1 for
/// the root and 2 for the flank.  0: not a safety.
inline int load_exponent(design::CheckId id) {
  using design::CheckId;
  switch (id) {
    case CheckId::kRootSafety:
    case CheckId::kOverloadRootSafety:
      return 1;
    case CheckId::kFlankSafety:
    case CheckId::kOverloadFlankSafety:
      return 2;
    default:
      return 0;
  }
}

/// Below this share of its limit a safety, which may turn negative, counts by its tangent there.
inline constexpr double kLeastSafetyShare = 0.1;

/// By how much 1/w falls at a limit of root_sliding() where that rises.
inline double sliding_slope(double limit) {
  const double share = std::max(geometry::rolling_share(limit), geometry::kLeastRollingShare);
  return share * share;
}

/// g ≥ 0 where the check is met.
///
///   a safety    g = (L/p) (1 − (L/S)^p): linear in torque and 1/width, as solvers like it, and of
///               slope 1 at the limit as the margin; below a tenth of L its tangent there
///   sliding     g = (1/w − 1/w_L) w_L², w = 1 − ζ: linear in the flank's radius of curvature, also
///               where the mate's tip interferes, and of slope 1 at the limit as the margin
///   any other   margin over its scale
template <class T>
T constraint_of(const design::CheckInstance& check, const design::Gearing<T>& gearing) {
  const int p = load_exponent(check.record->id);
  if (check.record->id == design::CheckId::kSpecificSliding) {
    return (geometry::rolling_share(design::check_value(check, gearing)) -
            geometry::rolling_share(check.limit)) /
           sliding_slope(check.limit);
  }
  if (p == 0) return design::check_margin(check, gearing) / check.scale;
  const T share = design::check_value(check, gearing) / check.limit;
  const T held = larger(share, constant<T>(kLeastSafetyShare));
  const T load = p == 1 ? T(1.0 / held) : T(1.0 / (held * held));
  const double slope = p * std::pow(kLeastSafetyShare, -p - 1);
  return (check.limit / p) * (1.0 - load + slope * (share - held));
}

/// The miss of a check's value in SI from that of its constraint: the inverse of constraint_of().
/// @param violation  −g > 0
inline double miss_of_constraint(const design::CheckInstance& check, double violation) {
  const int p = load_exponent(check.record->id);
  if (check.record->id == design::CheckId::kSpecificSliding) {
    const double share =
        geometry::rolling_share(check.limit) - violation * sliding_slope(check.limit);
    return geometry::sliding_at(share) - check.limit;
  }
  if (p == 0) return violation * check.scale;
  const double over = violation * p / check.limit;  // (L/S)^p − 1
  const double greatest = std::pow(kLeastSafetyShare, -p) - 1.0;
  const double slope = p * std::pow(kLeastSafetyShare, -p - 1);
  const double share = over <= greatest ? std::pow(1.0 + over, -1.0 / p)
                                        : kLeastSafetyShare - (over - greatest) / slope;
  return check.limit * (1.0 - share);
}

}  // namespace gear3k::optimize
