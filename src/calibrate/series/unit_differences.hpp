#pragma once
// What differs between gearboxes of a series and no cause explains.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/series/joint_fit.hpp"

namespace gear3k::calibrate {

struct UnitDifference {
  std::optional<std::string> along;  ///< covariate; "" = the same in all rows; empty: none
  double p_value = 1.0;              ///< of the clearest one where there is nothing
};

/// Levels of each covariate (but time and sessions) in one gearbox's residuals, beside what is
/// fitted and beside the same levels in all gearboxes: by gearbox.
/// @param rate  of finding any where there is none
std::vector<UnitDifference> unit_differences(const std::deque<SeriesUnit>& units,
                                             const JointFit& fit, double rate, std::uint64_t seed);

}  // namespace gear3k::calibrate
