#pragma once
// The least value of a function of one variable, by golden sections.

#include <numbers>
#include <utility>

namespace gear3k::numerics {

/// Narrows an interval about the least value of a function, by a factor of (√5 − 1)/2 a step.
///
/// Exact where the function falls up to one place in the interval and rises from there; else the
/// interval ends at one of its least values.
/// @param done  of the ends so far: whether the interval is narrow enough
/// @returns the last interval
/// Source: Kiefer, Sequential minimax search for a maximum, Proc. Amer. Math. Soc. 4 (1953).
template <typename Function, typename Done>
std::pair<double, double> golden_sections(double low, double high, const Function& function,
                                          const Done& done) {
  constexpr double kShare = 1.0 / std::numbers::phi;
  while (!done(low, high)) {
    const double left = high - kShare * (high - low);
    const double right = low + kShare * (high - low);
    const double at_left = function(left);
    const double at_right = function(right);
    (at_left < at_right ? high : low) = at_left < at_right ? right : left;
  }
  return {low, high};
}

}  // namespace gear3k::numerics
