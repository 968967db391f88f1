#include "app/search.hpp"

namespace gear3k::app {

ToothSets search(const SearchRequest& request, optimize::Progress& progress) {
  ToothSets sets{.search = {},
                 .ranking = optimize::ZeroShiftRanking(request.spec, request.most_ranked)};
  sets.search = optimize::search_teeth(
      request.spec, progress, [&](const auto& candidates) { sets.ranking.add(candidates); });
  return sets;
}

}  // namespace gear3k::app
