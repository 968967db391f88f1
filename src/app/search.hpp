#pragma once
// The tooth sets that fit a ratio, ranked before any refinement.

#include <cstddef>
#include <limits>

#include "optimize/progress.hpp"
#include "optimize/tooth_search.hpp"
#include "optimize/zero_shift.hpp"

namespace gear3k::app {

struct SearchRequest {
  optimize::Specification spec;
  /// How many sets are ranked, the first ones; the others are counted only.
  std::size_t most_ranked = std::numeric_limits<std::size_t>::max();
};

struct ToothSets {
  optimize::ToothSearchResult search;  ///< without its candidates
  optimize::ZeroShiftRanking ranking;  ///< of what was found when the search was interrupted
};

/// Searches all tooth sets of a specification and ranks them at zero profile shift.
/// @param progress  may be watched, and ends the search by its `stop`
ToothSets search(const SearchRequest& request, optimize::Progress& progress);

}  // namespace gear3k::app
