#include "optimize/loss_factor_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace gear3k::optimize {

namespace {

double share_cost(double e, bool sliding) {
  const double off = std::abs(e - 0.5);
  return sliding && off > 0.5 ? off - 0.25 : off * off;
}

/// Part of an interval.
Interval part_of(const Interval& all, double lo, double hi) {
  return {std::max(all.lo, lo), std::min(all.hi, hi)};
}

/// Twice the mean of |s| of n pairs a base pitch apart, the outermost at e in one of two ranges.
double most_of_pairs(const Interval& e1, const Interval& e2, int n) {
  double most = 0.0;
  for (const double e : {e1.lo, e1.hi, e2.lo, e2.hi}) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) sum += std::abs(k - e);
    most = std::max(most, 2.0 * sum / n);
  }
  return most;
}

}  // namespace

LeastShares least_shares(const Interval& e1, const Interval& e2, const Interval& epsilon,
                         bool sliding) {
  LeastShares least;
  if (e1.empty() || e2.empty() || epsilon.empty() || e1.lo + e2.lo > epsilon.hi ||
      e1.hi + e2.hi < epsilon.lo) {
    return least;
  }
  least.e1 = std::clamp(0.5, e1.lo, e1.hi);
  least.e2 = std::clamp(0.5, e2.lo, e2.hi);
  const double sum = least.e1 + least.e2;
  const double nearest = std::clamp(sum, epsilon.lo, epsilon.hi);
  if (nearest != sum) {
    // On the line e1 + e2 = nearest: the nearest point to its middle.
    least.e1 =
        std::clamp(0.5 * nearest, std::max(e1.lo, nearest - e2.hi),
                   std::max(std::max(e1.lo, nearest - e2.hi), std::min(e1.hi, nearest - e2.lo)));
    least.e2 = nearest - least.e1;
  }
  least.factor = 0.5 + share_cost(least.e1, sliding) + share_cost(least.e2, sliding);
  return least;
}

double least_loss_factor(const Interval& e1, const Interval& e2, const Interval& epsilon,
                         bool sliding) {
  if (!sliding) return least_shares(e1, e2, epsilon, false).factor;
  double least = kInfinity;
  const auto part = [&](double lo, double hi) {
    return Interval{std::max(epsilon.lo, lo), std::min(epsilon.hi, hi)};
  };
  if (const Interval below = part(-kInfinity, 1.0); !below.empty() && below.lo < 1.0) {
    if (least_shares(e1, e2, below, true).factor < kInfinity) {
      least = std::max(0.0, 0.5 * below.lo);
    }
  }
  if (const Interval usual = part(1.0, 2.0); !usual.empty()) {
    least = std::min(least, least_shares(e1, e2, usual, true).factor);
  }
  if (const Interval above = part(2.0, kInfinity); !above.empty() && above.hi > 2.0) {
    if (least_shares(e1, e2, above, true).factor < kInfinity) {
      least = std::min(least, 1.0 + std::min(above.lo - 2.0, 1.0) / 3.0);
    }
  }
  return least;
}

double most_loss_factor(const Interval& e1, const Interval& e2, const Interval& epsilon,
                        bool sliding) {
  // What their sum leaves of each.
  const Interval a = part_of(e1, epsilon.lo - e2.hi, epsilon.hi - e2.lo);
  const Interval b = part_of(e2, epsilon.lo - e1.hi, epsilon.hi - e1.lo);
  const Interval sum = part_of(epsilon, e1.lo + e2.lo, e1.hi + e2.hi);
  if (e1.empty() || e2.empty() || sum.empty()) return 0.0;
  const auto most_cost = [&](const Interval& e) {
    return std::max(share_cost(e.lo, sliding), share_cost(e.hi, sliding));
  };
  double most = 0.0;
  if (!sliding || !part_of(sum, 1.0, 2.0).empty()) most = 0.5 + most_cost(a) + most_cost(b);
  if (!sliding) return most;
  if (sum.lo < 1.0) {
    most = std::max({most, std::min(sum.hi, 1.0), a.hi - b.lo, b.hi - a.lo, -sum.lo});
  }
  const int last = static_cast<int>(std::floor(std::min(sum.hi, 100.0))) + 1;
  const int first = std::max(2, static_cast<int>(std::floor(std::clamp(sum.lo, 0.0, 100.0))));
  for (int n = first; sum.hi > 2.0 && n <= last; ++n) {
    most = std::max(most, most_of_pairs(a, b, n));
  }
  return most;
}

}  // namespace gear3k::optimize
