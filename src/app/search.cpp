#include "app/search.hpp"

namespace gear3k::app {

ToothSets search(const SearchRequest& request, optimize::Progress& progress) {
  ToothSets sets{.search = optimize::search_teeth(request.spec, progress), .ranked = {}};
  if (!sets.search.interrupted) {
    sets.ranked = optimize::rank_at_zero_shift(request.spec, sets.search.candidates);
  }
  return sets;
}

}  // namespace gear3k::app
