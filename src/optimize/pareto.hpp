#pragma once
// Sets that no other one dominates.

#include <cstddef>
#include <vector>

#include "optimize/refined_set.hpp"

namespace gear3k::optimize {

/// Indices of the sets with a design that no other one beats or equals in all of eta_b, eta_f, lost
/// motion and ring root diameter at once, in the order of the sets.  Values are compared in steps
/// of ObjectiveRecord::resolution, so that the front is not decided by what rounding leaves of a
/// limit that many sets reach; of equal sets the first stays.  With `by_model` the efficiencies are
/// those with the model; sets that do not run with it are beaten by any that do. Time: n log n for
/// the sort, then n times the size of the front.
std::vector<std::size_t> pareto_front(const std::vector<RefinedSet>& sets, bool by_model = false);

}  // namespace gear3k::optimize
