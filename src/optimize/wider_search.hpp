#pragma once
// What lies just beyond the ends of a search's ranges.

#include <cstddef>
#include <optional>

#include "optimize/limit_prices.hpp"
#include "optimize/progress.hpp"
#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// Above as many tooth sets only ranges are widened that leave all other sets out.
inline constexpr std::size_t kMostSearchedAgain = 20000;

/// Searches anew with each bound that the best set sits at given way: tooth ranges and greatest
/// rings by two teeth, the coaxial offset and the internal difference by one, the ratio's tolerance
/// by a tenth; of tooth ranges only the sets beyond are searched.  Fills SearchBound::wider.
///
/// Nothing is tried where the first objective is no efficiency or the task has no bounds: every set
/// would have to be refined; nor, but for tooth ranges, above kMostSearchedAgain sets.
/// @param best  whose bounds `held` has
/// @param sets  tooth sets of the task
/// @param progress  its stop ends the searches: what was not tried stays empty, and `held` is
///   interrupted
void search_beyond(const Specification& spec, const RefinedSet& best, std::size_t sets,
                   HeldBack& held, Progress& progress);

/// Refines the best set with each limit that has a price given way by its step: a price holds to
/// first order, and ends where another limit becomes active.  Fills LimitPrice::refined_gain_si;
/// leaves it empty where search_relaxed() does not give the limit way, and where the solver failed.
/// @param progress  its stop ends it: what was not refined stays empty, and `held` is interrupted
void refine_gains(const Specification& spec, const RefinedSet& best, HeldBack& held,
                  Progress& progress);

/// Searches of tooth sets that search_beyond() and search_relaxed() make together.
std::size_t searches_again(const Specification& spec, std::size_t sets, const HeldBack& held);

/// Refines the best set, and searches all sets where the task has bounds and up to
/// kMostSearchedAgain of them, with the dearest() limit given way by its step.  Fills
/// HeldBack::relaxed; leaves it empty where no limit has a price or it is none of checks, shifts,
/// modules, tips and pressure angle, and with `[robust]`; and where it was stopped, which makes
/// `held` interrupted.
void search_relaxed(const Specification& spec, const RefinedSet& best, std::size_t sets,
                    HeldBack& held, Progress& progress);

}  // namespace gear3k::optimize
