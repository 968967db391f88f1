#pragma once
// What a drive that was found predicts of a log that it has not seen.

#include <string>
#include <vector>

#include "calibrate/dynamic/motion_diagnosis.hpp"

namespace gear3k::calibrate {

/// What is left of a window's mean motor torque by the model.
/// @returns N m at the output
double window_residual(const MotionWindow& window, const DriveParameters& drive);

struct MotionHoldout {
  /// "log", where there are at least three; "time": five parts of the log, one after the other, as
  /// many windows in each; "": nothing can be held out.
  std::string blocks;
  /// Residual of each window by the causes' numbers fitted without its block [N m at the output];
  /// NaN: the others do not fix them.
  std::vector<double> residual;
  double baseline_Nm = 0.0, extended_Nm = 0.0;  ///< rms, over the same windows
};

/// Refits the numbers of the given causes without each block, and predicts it by them.
/// @param causes  DriveChange, ascending; empty: the drive as stated predicts
MotionHoldout hold_out(const std::vector<MotionWindow>& windows, const DriveParameters& stated,
                       const std::vector<std::size_t>& causes);

}  // namespace gear3k::calibrate
