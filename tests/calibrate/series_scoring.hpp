#pragma once

#include <string>
#include <vector>

#include "tests/series_rig/series_rig.hpp"

namespace gear3k::series_rig {

/// What `diagnose` says of one hidden difference.
struct TruthScore {
  bool named = false;      ///< its cause, or one that it lists as an alternative
  bool right = false;      ///< ... and whose it is
  bool measured = false;   ///< the cause itself, so that its parameter can be compared
  double deviation = 0.0;  ///< estimated from part to part over that of the gearboxes as built
  bool mean_inside = false, deviation_inside = false;  ///< the population's, in the 95 % intervals
};

struct SeriesScore {
  bool right = false;  ///< every difference is named with its owner, and nothing else is
  std::vector<TruthScore> truths;
  bool unexplained = false;  ///< some gearbox is said to differ by what no cause explains
  std::string answer;
  double seconds = 0.0;
};

/// Reads, diagnoses and scores a series as the program would.
/// @param whole  false: what the gearboxes have in common is not diagnosed by itself, which takes
/// most of the time
SeriesScore score(const SeriesCampaign& campaign, bool whole);

}  // namespace gear3k::series_rig
