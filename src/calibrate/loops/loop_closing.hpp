#pragma once
// Whether the two ends of a torque-angle loop meet.

#include <cstddef>
#include <optional>

#include "calibrate/loops/branch_zero.hpp"
#include "calibrate/loops/filtered_record.hpp"
#include "calibrate/loops/torque_angle_loop.hpp"

namespace gear3k::calibrate {

/// A point of a torque-angle curve.
struct TorqueAnglePoint {
  double torque_Nm = 0.0, angle_rad = 0.0;
};

/// Torque and angle at a turning point: the end of the straight line through the m samples that
/// lead to it (at the record's start: that follow it), m = secant + 1, without the filter, which
/// would round the turn. Source: own derivation, docs/theory §31 (creep).
TorqueAnglePoint point_at_turn(const TorqueAngleRecord& record, std::size_t turn,
                               std::size_t secant);

/// Last less first angle of a loop, referred to the same torque along the flank that both ends lie
/// on.
///
///   Δθ = θ_end - θ_start - (T_end - T_start)/k      (k with the sign of angle_sense)
///
/// Source: own derivation, docs/theory §31 (creep).
/// Valid: end torques that agree to 20 %.
/// @returns [rad]; empty where they do not, or the flank's stiffness is not known
std::optional<double> closing_error_rad(const FilteredRecord& record, const Loop& loop);

/// Standard deviation of closing_error_rad(): the end of a straight line through m values has the
/// variance 4 σ²/m, times (1 + φ)/(1 - φ) where neighbours correlate.
/// Source: own derivation, docs/theory §31.
/// @returns [rad], from the noise of the loop's two branches
double closing_deviation_rad(std::size_t secant, const BranchZero& one, const BranchZero& two);

}  // namespace gear3k::calibrate
