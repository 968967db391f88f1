#pragma once
// What a drive that was found predicts of a log that it has not seen.

#include <limits>
#include <string>
#include <vector>

#include "calibrate/dynamic/drive_parameters.hpp"
#include "calibrate/dynamic/motion_windows.hpp"

namespace gear3k::calibrate {

struct MotionHoldout {
  /// "log", where there are at least three; "time": five parts of the log, one after the other, as
  /// many windows in each; "": nothing can be held out.
  std::string blocks;
  /// Residual of each window by the causes' numbers fitted without its block [N m at the output];
  /// NaN: the others do not fix them.
  std::vector<double> residual;
  /// Root mean squares, as stated and with the causes, over the windows that have a residual; NaN:
  /// none has.
  double baseline_Nm = std::numeric_limits<double>::quiet_NaN(), extended_Nm = baseline_Nm;
  [[nodiscard]] double gain() const { return 1.0 - extended_Nm / baseline_Nm; }
};

/// Refits the numbers of the given causes without each block, and predicts it by them.
/// @param causes  DriveChange, ascending; empty: the drive as stated predicts
MotionHoldout hold_out(const std::vector<MotionWindow>& windows, const DriveParameters& stated,
                       const std::vector<std::size_t>& causes);

}  // namespace gear3k::calibrate
