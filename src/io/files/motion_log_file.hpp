#pragma once
// DATA.csv of kind `dynamic`: logs of a drive in motion.

#include <string>
#include <string_view>
#include <vector>

#include "calibrate/dynamic/motion_record.hpp"

namespace gear3k::io {

/// What turns logged numbers into torques and inertias at the output.
struct MotionLogScale {
  double ratio = 1.0;                 ///< i, signed
  double torque_constant_Nm_A = 0.0;  ///< K_t
  double load_kgm2 = 0.0;             ///< unless the note `# load_inertia_kgm2:` states another
  bool known = true;  ///< false: of an ACTUATOR with errors; logs are not held against it
};

/// Whether any of these files has the note `# kind: dynamic`; files that cannot be read have not.
bool any_motion_log(const std::vector<std::string>& paths);

/// Reads logs of one drive.
///
/// Columns: time_s; speed_rad_s or angle_rad of the output (the speed where both are there);
/// motor_angle_rad or motor_speed_rad_s of the motor's shaft; motor_torque_nm or motor_current_a
/// (the torque where both are); output_torque_nm of the load on
/// the output (with a note `# torque: actuator` that of the actuator on the load); run.  Others are
/// ignored and noted.  A log is cut into stretches where the run changes, where a step of time is
/// more than eight times the median, and where the motor's signal is held at its greatest or least
/// value for eight samples and more (clipped, left out).
/// @throws InvalidInput with all errors of all files: time that does not increase within a run,
/// numbers that are none, columns or notes that are missing or wrong, a signal clipped in more
/// than half of its rows, a file with the same bytes as one before
calibrate::MotionRecord read_motion_logs(const std::vector<std::string>& paths,
                                         const MotionLogScale& scale);
/// The same of a text; `path` stands for the file in messages.
calibrate::MotionRecord parse_motion_log(const std::string& path, std::string_view text,
                                         const MotionLogScale& scale);

}  // namespace gear3k::io
