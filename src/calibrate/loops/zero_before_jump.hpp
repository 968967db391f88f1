#pragma once
// Angles at zero torque where the dead band's jump is too near for the filter.

#include <vector>

#include "calibrate/loops/branch_zero.hpp"
#include "calibrate/loops/filtered_record.hpp"
#include "calibrate/loops/torque_branch.hpp"

namespace gear3k::calibrate {

/// Reads branches again whose dead band's jump lies within the filter's reach of zero torque, by
/// the samples before zero alone.
///
/// A branch comes to zero torque on its flank, and friction puts the jump after it.  Of the m
/// samples up to zero, torque and angle are straight lines over the index; the angle is read where
/// that of the torque is zero:
///
///   θ(T = 0) = Σ_k w_k θ_k,   Σ_k w_k T_k = 0,   var = σ² Σ_j Σ_l w_j w_l φ^|j-l| + 2 δ²
///
/// with σ² and φ of the noise short of zero.  Filtered, a jump d samples later would add the
/// share Σ_(k ≥ d) h_k of it, which is let be up to 0.2 %; the jump is where the branch passes the
/// middle between both branches' zeros.
///
/// m is 4, 6, 8, 12, 16 ... up to a quarter of the branch's first torque, the same for all such
/// branches of the record: the greatest at which the mean reading (outward of the loop) is within 3
/// deviations of those of all smaller m, or 0.1 % of the lost motion.  δ is the step of the mean to
/// it from the next smaller.  `at_edge` tells that the record does not tell the angle: those of 4
/// and 6 differ (3 deviations and 0.2 % of the lost motion), or the samples that agree (4.5
/// deviations) reach less far from zero than twice the jump: the flank leaves its line before zero
/// torque, in the dead band's rounded edge.
///
/// Source: own derivation, docs/theory §31 (lost motion).
/// Valid: T driven, or falling steadily up to zero.  Not read again: branches that end short of
/// zero, or pass it several times over an angle.
/// @param zeros  of the branches, in their order
std::vector<BranchZero> zeros_before_jumps(const FilteredRecord& record,
                                           const std::vector<Branch>& branches,
                                           std::vector<BranchZero> zeros);

}  // namespace gear3k::calibrate
