#pragma once
// A second bench for logs of motion, written from the contract of `kind: dynamic` and the two sides
// of a drive alone: motion and load are prescribed, the motor's torque follows.  Its laws and its
// noise are not those of the library or of the other bench.

#include <array>
#include <cstdint>

#include "calibrate/dynamic/drive_parameters.hpp"
#include "calibrate/dynamic/motion_record.hpp"

namespace gear3k::test {

/// A drive on the bench; all at the output.
struct RigDrive {
  double j1 = 0.0, j2 = 0.0, d1 = 0.0, d2 = 0.0, c1 = 0.0, c2 = 0.0;
  double loss_forward = 0.0;   ///< 1/η_f − 1
  double loss_backward = 0.0;  ///< 1 − η_b
  double gain = 1.0;           ///< true over logged torque
  double play_rad = 0.0;       ///< lost motion of the output
  double compliance = 0.0;     ///< rad per N m
};

/// Drive, motion, load, sensors, of a seed.
struct MotionRig {
  RigDrive drive;
  bool has_load = true;       ///< weight, spring and their sensor; else inertia alone
  double load_inertia = 0.0;  ///< that moves with the output, known
  double torque_noise = 0.0;  ///< root mean square of the logged motor torque's noise [N m]
  double speed_noise = 0.0, load_noise = 0.0;
  std::uint64_t seed = 0;
  std::array<double, 4> size{}, frequency{}, phase{};  ///< of the motion
  double weight_Nm = 0.0, weight_at = 0.0, spring_Nm = 0.0, constant_Nm = 0.0;
  // Of the motor's side, where it is logged: as angles, else as speeds.
  bool logs_motor_angle = false, logs_motor_speed = false;
  double angle_noise = 0.0;       ///< of either angle [rad]
  double eccentricity_rad = 0.0;  ///< once a turn of the motor's shaft, ratio 40
  double delay_s = 0.0;           ///< of the motor's side
  double motor_ripple_Nm = 0.0;   ///< twice a turn of the motor's shaft, of the logged torque
  double stribeck = 0.0;          ///< share by which drag at creep exceeds that in motion
};

MotionRig motion_rig(std::uint64_t seed, bool has_load);
/// 12 s at 200 Hz, sampled unevenly.
calibrate::MotionRecord rig_log(const MotionRig& rig, const RigDrive& drive);
/// Root mean square of what the log's torque without noise changes between two drives [N m].
double rig_effect(const MotionRig& rig, const RigDrive& before, const RigDrive& after);
/// Root mean square of the wind-up's change between two drives [rad].
double rig_windup_effect(const MotionRig& rig, const RigDrive& before, const RigDrive& after);
calibrate::DriveParameters rig_stated(const MotionRig& rig);

}  // namespace gear3k::test
