#pragma once
// Which limits would have to give way, and how far, where no tooth set has a design.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "optimize/limit_prices.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/progress.hpp"

namespace gear3k::optimize {

/// A limit with a value at which there is a design.
struct RelaxedLimit {
  LimitOf of;  ///< of kind kCheck
  double stated_si = 0.0;
  /// Between the stated one and that which holds without a preset; empty: with the limit off.
  std::optional<double> relaxed_si{};
};

/// Limits that give way together, and a design that keeps them as relaxed and all others as stated.
struct Freed {
  std::vector<RelaxedLimit> limits;  ///< one, or two
  RefinedSet set;
};

struct RelaxedLimits {
  std::vector<Freed> freed;
  std::vector<LimitOf> alone;                  ///< tried by themselves
  std::vector<std::array<LimitOf, 2>> paired;  ///< tried together, where none suffices
  bool interrupted = false;
};

/// Refinements of one search without a limit, after which it is given up.
inline constexpr std::size_t kMostRefinedWithout = 224;

/// Limits that may give way: thresholds of checks, not those of the load, that are stated (by the
/// file or its preset) tighter than what holds without.  A mesh with a least backlash of its own
/// has a limit of its own, too.
std::vector<LimitOf> limits_that_may_give_way(const Specification& spec);

/// Leaves out each limit by itself (what holds without a preset stays; those that block few sets
/// first together: where nothing is found, only the blocked sets that miss one of them alone are
/// asked of each), and where none suffices two of those that block most sets; each time the search
/// ends with its first wave that has a design, or at `most_refined` refined sets.  Of its sets the
/// one that needs the limit to give way least has it relaxed to three digits and is refined anew
/// with it, so that what is told has a design; a few more searches half way to the stated value
/// bring it nearer, and so does the blocked set that misses this limit alone, and least.  A search
/// of all sets might find one that needs less.
///
/// @param blocked  of the specification: without a design, not interrupted
/// @param progress  its stop ends the searches, what was found before stays
/// @param most_refined  no wave of a search is begun when so many of its sets are refined
RelaxedLimits relax_limits(const Specification& spec, const OptimizeResult& blocked,
                           Progress& progress, std::size_t most_refined = kMostRefinedWithout);

}  // namespace gear3k::optimize
