#pragma once
// What a log of motion shows beside its causes: run-downs, reversals, ripple of the torque.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/dynamic/motion_diagnosis.hpp"

namespace gear3k::calibrate {

/// The drive slows down by itself, neither motor nor load acting.
struct RunDown {
  double time_s = 0.0, duration_s = 0.0;
  double from_rad_s = 0.0, to_rad_s = 0.0;
  std::size_t windows = 0;
};

/// Drag of all run-downs of one flow, where the windows decelerate: with τ = T_L = 0 in (69.1)
///   −(J1 + h J2) a s = (c1 + h c2) + (D1 + h D2) |w|
/// at the motor's side, by the inertias and h that are stated.
struct RunDownDrag {
  int flow = 1;
  std::size_t windows = 0;
  MotionEstimate constant_Nm{};
  std::optional<MotionEstimate> viscous_Nms{};  ///< empty: one speed
  double stated_constant_Nm = 0.0, stated_viscous_Nms = 0.0;
};

/// A wave of the motor's torque over the angle of a shaft.
struct TorqueRipple {
  std::string shaft;  ///< "motor", "output"
  int harmonic = 1;
  double order = 0.0;         ///< per turn of the output
  double amplitude_Nm = 0.0;  ///< at the output
  double p_value = 1.0;
};

struct MotionReadings {
  std::vector<RunDown> run_downs;
  std::vector<RunDownDrag> drags;
  std::size_t reversals = 0, flank_changes = 0;
  std::vector<TorqueRipple> ripple;  ///< that stand out of their neighbours
  double highest_order = 0.0;        ///< that the sampling shows at the greatest speed
};

/// Source: docs/theory §72.
/// @param ratio  i, signed
MotionReadings motion_readings(const MotionRecord& record, const DriveParameters& drive,
                               const std::vector<MotionWindow>& windows, double ratio);

}  // namespace gear3k::calibrate
