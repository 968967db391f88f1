#pragma once
// Slow drift of the angle over the loops of a torque-angle record.

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/loops/branch_zero.hpp"
#include "calibrate/loops/filtered_record.hpp"
#include "calibrate/loops/torque_angle_loop.hpp"

namespace gear3k::calibrate {

/// Slope in time that branches of the same sense have in common at zero torque, as weights of their
/// angles: least squares with a mean of its own for each sense.
///
///   slope = Σ_k w_k θ_k,   w_k = (t_k - t̄)/Σ (t_l - t̄)²      (t̄: mean of the branch's sense)
///
/// Source: own derivation, docs/theory §31 (creep).
struct CommonSlope {
  bool repeats = false;              ///< two branches of one sense at different times
  std::vector<double> weight_per_s;  ///< of each branch's angle; 0 where it has none
};

CommonSlope common_slope(const std::vector<BranchZero>& branches);

/// The common slope; where no branch repeats, the closing error of the first loop that has one over
/// its duration.
/// Source: own derivation, docs/theory §31 (creep).
/// Valid: drift linear in time over the whole record.
/// @param branches  in order of time, loop b from branch b and b + 1
/// @returns empty where no branch repeats and no loop has a closing error
std::optional<Creep> find_creep(const FilteredRecord& record,
                                const std::vector<BranchZero>& branches,
                                const std::vector<Loop>& loops);

}  // namespace gear3k::calibrate
