#pragma once
// The greatest torque that every safety allows.

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/scalar.hpp"

namespace gear3k::strength {

/// One safety at a torque.
template <class T>
struct SafetyRatio {
  T ratio{};         ///< S/S_min; it falls as the torque rises; 0 and less: nothing is left
  int exponent = 1;  ///< 1: stress ∝ torque (root), 2: stress² ∝ torque (flank)
};
/// Safeties at an output torque [N m], always in the same order.
template <class T>
using SafetyFunction = std::function<std::vector<SafetyRatio<T>>(const T& torque_Nm)>;

template <class T>
struct TorqueCapacity {
  T torque_Nm{};
  std::size_t governing = 0;  ///< index of the item with ratio 1; the first one at a tie
};

struct CapacityOptions {
  double start_Nm = 1.0;     ///< > 0: where the search begins, of any size
  double tolerance = 1e-12;  ///< of ln ratio at the capacity
  /// How far below a torque found others are looked for, at start · 2^(n/4); 0: not.  For ratios
  /// that may rise with the torque.
  int scanned_octaves = 0;
};

/// Torque at which the least ratio comes down to 1.
///
/// Doubles the torque until a ratio stays below 1 for three doublings, then scales it down,
///   T ← T min ratio^exponent,
/// from above.  Where T min ratio^exponent rises with T (factors that fall with the load), no step
/// passes a fixed point and the first one met is the largest; where a step goes too far (factors
/// that rise with the load), halving and false position between the two torques, in which the
/// least ratio is taken to cross 1 once.
/// With scanned_octaves the same is done again from the least scanned torque below it at which a
/// ratio is below 1, until there is none: then it is the least such torque as far as scanned.  Dips
/// of the ratio below 1 that are narrower than a step of the scan may be missed.
/// Source: own derivation, docs/theory §56.
/// @returns empty where no torque in start · 2^±200 is the capacity: the ratios do not depend on
///   it, are below 1 at any torque, or are not numbers
/// @throws std::invalid_argument unless start_Nm > 0, without items, or for an exponent below 1
std::optional<TorqueCapacity<double>> torque_capacity(const SafetyFunction<double>& safeties,
                                                      const CapacityOptions& options = {});

/// The capacity with its derivatives by one implicit step at the solution.
///
///   dT/dp = −(∂r/∂p)/(∂r/∂T),   r the governing ratio
///
/// Two evaluations: one with the torque as a number, one with its derivative.
/// Source: implicit function theorem, docs/theory §56.  At a tie of two items: that of `governing`.
/// @param safeties  with the derivatives of the design
TorqueCapacity<Jet1> capacity_with_derivatives(const SafetyFunction<Jet1>& safeties,
                                               const TorqueCapacity<double>& capacity);

}  // namespace gear3k::strength
