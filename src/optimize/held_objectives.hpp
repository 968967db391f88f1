#pragma once
// A design bettered in some objectives while it keeps what it has of the others.

#include <optional>
#include <vector>

#include "optimize/refined_set.hpp"
#include "optimize/stop_flag.hpp"

namespace gear3k::optimize {

/// The specification with one objective and limits on the others [SI].
Specification with_limits(const Specification& spec, Objective first,
                          const std::vector<ObjectiveLimit>& limits);

/// What a design may lose of an objective where others are bettered, and what counts as better:
/// relative to its value.
inline constexpr double kHeldWithin = 1e-6;

/// The share of a value [SI] that it may lose: kHeldWithin of it.
inline double held_slack(double value) { return kHeldWithin * (value < 0.0 ? -value : value); }

/// A design of the same tooth set that is better in some of the specification's objectives and
/// worse in none, where the refinement finds one; else the design itself.
///
/// A design that is best in the first objective f_1 within limits may be far from best in the
/// others: where f_1 does not change, nothing asked for them.  Each other one in turn is optimised
/// with the rest held, f_1 to kHeldWithin of its value, then f_1 with all others held.  After that
/// no design of the set is better in one by more than kHeldWithin and as good in all, as far as
/// refinements find their optima.
/// Source: own derivation, docs/theory §12 ("Pareto front").
/// @param set  with a design
/// @returns empty when `stop` became true
std::optional<RefinedSet> bettered(const Specification& spec, const RefinedSet& set,
                                   const StopFlag& stop);

}  // namespace gear3k::optimize
