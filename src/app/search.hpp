#pragma once
// The tooth sets that fit a ratio, ranked before any refinement.

#include <vector>

#include "optimize/progress.hpp"
#include "optimize/tooth_search.hpp"
#include "optimize/zero_shift.hpp"

namespace gear3k::app {

struct SearchRequest {
  optimize::Specification spec;
};

struct ToothSets {
  optimize::ToothSearchResult search;
  std::vector<optimize::ZeroShiftSet> ranked;  ///< empty when the search was interrupted
};

/// Searches all tooth sets of a specification and ranks them at zero profile shift.
/// @param progress  may be watched, and ends the search by its `stop`
ToothSets search(const SearchRequest& request, optimize::Progress& progress);

}  // namespace gear3k::app
