#pragma once
// Play and compliance between the motor's side and the output, from logs of both.

#include <array>
#include <optional>
#include <vector>

#include "calibrate/dynamic/motion_diagnosis.hpp"

namespace gear3k::calibrate {

struct WindupDiagnosis {
  std::vector<MotionEffect> effects;                     ///< kClearanceChange, kComplianceChange
  std::array<std::optional<MotionEstimate>, 2> found{};  ///< j and 1/K, both free
  double p_value = 1.0;
  double delay_s = 0.0, delay_error_s = 0.0;  ///< of the motor's side after the output's, σ
  std::size_t windows = 0, flank_changes = 0;
  bool of_speeds = false;
};

/// Diagnoses the wind-up of windows, each on one flank p = flow · sense:
///
///   δ = o + p j/2 + C m + t w,   m = J2 a + D2 w + c2 s − T_L
///
/// o of the session, t a delay between both sensors; of summed-up speeds differences of
/// neighbouring windows, with a drift.  m's noise is taken off (errors in variables), correlation
/// between neighbours out.
/// @param rate  of any cause where nothing is wrong
/// @returns empty where too few windows have both sides, or all of them one flank and one torque
/// Source: docs/theory §71.
std::optional<WindupDiagnosis> diagnose_windup(const std::vector<MotionWindow>& windows,
                                               const DriveParameters& drive,
                                               const StatedWindup& stated, double rate);

/// Adds its effects, numbers and notes to a diagnosis of the torques.
void add_windup(const WindupDiagnosis& windup, const StatedWindup& stated, MotionDiagnosis& d);

}  // namespace gear3k::calibrate
