#pragma once
// Which motor torques drive a load, hold it, or let it drive the motor.

#include <vector>

#include "actuator/actuator.hpp"

namespace gear3k::actuator {

/// Motor torques at one load, slowly and steadily.
struct DrivePoint {
  double load_Nm = 0.0;  ///< −T_L: that the actuator has to overcome with w > 0
  /// Ends of the band in which the output sticks, at the motor.
  double stick_low_Nm = 0.0, stick_high_Nm = 0.0;
  double running_down_Nm = 0.0, running_up_Nm = 0.0;  ///< with w < 0, w > 0
};

/// Points at loads from −most to most.
/// Source: own derivation, docs/theory §58.
/// @throws std::runtime_error as GearModel::band()
std::vector<DrivePoint> drive_diagram(const Actuator& actuator, double most_load_Nm);

}  // namespace gear3k::actuator
