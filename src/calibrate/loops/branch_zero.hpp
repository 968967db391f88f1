#pragma once
// The angle of a branch at zero torque, and how well it is known.

#include <optional>

#include "calibrate/loops/correlated_noise.hpp"
#include "calibrate/loops/filtered_record.hpp"
#include "calibrate/loops/torque_angle_loop.hpp"
#include "calibrate/loops/torque_branch.hpp"

namespace gear3k::calibrate {

struct BranchZero {
  bool rising = false;                    ///< in torque
  std::optional<Crossing> at, at_double;  ///< at the cut-off and at twice the cut-off
  LoopOutcome outcome = LoopOutcome::kMeasured;
  CorrelatedNoise noise;             ///< of the angle, that of the torque turned into angle [rad²]
  double noise_variance_rad2 = 0.0;  ///< of the angle at zero torque
  double variance_rad2 = 0.0;        ///< with the spread of several passages, evenly distributed
  bool at_edge = false;              ///< the record does not tell it: see zeros_before_jumps()
};

/// Angle at zero torque of the filtered branch and its variance.
///
///   u_i = (θ - θ̂)_i - (dθ/dT) (T - T̂)_i          scatter on the way to zero about a smooth curve
///   var θ(T = 0) = σ² Σ_j Σ_l w_j w_l φ^|j-l| + spread²/12
///
/// with σ² and φ of the noise that leaves u, and the weights w of all samples in the filtered and
/// interpolated angle.
/// Source: own derivation, docs/theory §31 (uncertainty).
/// Valid: noise faster than the filter.  dθ/dT is the secant over `secant` samples to either side
/// of zero: where the torque's noise after the filter nears what the torque climbs there, the
/// variance comes out too large.
/// @param zero_reach_fraction  as LoopOptions::zero_reach_fraction
/// @returns `at` empty unless the outcome is kMeasured
BranchZero find_branch_zero(const FilteredRecord& record, const Branch& branch,
                            double zero_reach_fraction);

}  // namespace gear3k::calibrate
