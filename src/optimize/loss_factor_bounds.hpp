#pragma once
// Bounds of the loss factor B of a mesh whose contact ratios lie in intervals.

#include <limits>

#include "optimize/shift_range.hpp"

namespace gear3k::optimize {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Least ½ + h(e1) + h(e2) over a rectangle cut by lo ≤ e1 + e2 ≤ hi, and where.
struct LeastShares {
  double factor = kInfinity, e1 = 0.5, e2 = 0.5;
};
LeastShares least_shares(const Interval& e1, const Interval& e2, const Interval& epsilon,
                         bool sliding);

/// Least value of the loss factor B for e1, e2 and ε = e1 + e2 in intervals.
///
/// With h(e) = (e − ½)², for `sliding` continued outside [0, 1] by |e − ½| − ¼:
///   1 ≤ ε ≤ 2            B = ½ + h(e1) + h(e2), convex: least at the point nearest to (½, ½)
///   2 < ε, sliding       B ≥ 2 ⟨⌊n²/4⌋/n⟩ over the n pairs in contact = 1 + (ε − 2)/3 up to ε = 3
///   ε < 1, sliding       B ≥ ε/2
/// Ohlendorf's B is the first form for every ε.
/// Source: own derivation, docs/theory §32.
/// @returns the bound; +infinity when the intervals have no point in common
double least_loss_factor(const Interval& e1, const Interval& e2, const Interval& epsilon,
                         bool sliding);

/// Greatest value of B in the same intervals.
///
///   1 ≤ ε ≤ 2            ½ + h(e1) + h(e2), convex: greatest at the ends of e1 and e2
///   2 < ε, sliding       n ≥ 2 pairs a base pitch apart: (2/n) Σ |k − e|, k = 0 … n − 1
///   (convex in the place of the outermost: greatest where that is at an end of the path)
///   ε < 1, sliding       the mean of |s| is at most that of both ends: |e1| + |e2|
/// No e need be positive.  Ohlendorf's B is the first form for every ε.
/// Source: own derivation, docs/theory §75.
/// @returns the bound; 0 when the intervals have no point in common
double most_loss_factor(const Interval& e1, const Interval& e2, const Interval& epsilon,
                        bool sliding);

}  // namespace gear3k::optimize
