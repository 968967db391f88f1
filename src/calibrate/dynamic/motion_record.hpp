#pragma once
// Logs of a drive in motion, as stretches without gaps.

#include <string>
#include <vector>

namespace gear3k::calibrate {

/// Samples in the order of time, without a gap.  Torques at the output, signs of docs/theory §58.
struct MotionStretch {
  std::vector<double> time_s;
  std::vector<double> speed_rad_s;  ///< of the output; empty: the angle is logged instead
  std::vector<double> angle_rad;    ///< of the output; empty: the speed is logged
  std::vector<double> motor_Nm;     ///< τ = i T_em
  std::vector<double> load_Nm;      ///< T_L; empty: none acts
  double load_kgm2 = 0.0;           ///< inertia that moves with the output, known
  /// Angle of the motor's side over i less that of the output, up to a constant of the session;
  /// empty: the motor's side is not logged.
  std::vector<double> windup_rad{};
  bool windup_drifts = false;  ///< summed up from speeds: its constant wanders
  int session = 0;             ///< of one constant
  int log = 0;                 ///< its file, in the order of MotionRecord::files
};

/// All logs of one drive.
struct MotionRecord {
  std::vector<std::string> files;
  std::vector<MotionStretch> stretches;
  std::vector<std::string> notes;
};

}  // namespace gear3k::calibrate
