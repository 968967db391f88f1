#pragma once
// A simulated drive that shares no code with the library: its own equations of motion, integrated
// by Runge and Kutta's method with a fixed step and a friction without a jump, and sensors with
// steps, bias and noise that remembers.

#include <cstdint>

#include "calibrate/dynamic/drive_parameters.hpp"
#include "calibrate/dynamic/motion_record.hpp"

namespace gear3k::test {

struct DriveBench {
  // All at the output.
  double j1 = 0.12, j2 = 0.02, load_inertia = 0.15, d1 = 0.05, d2 = 0.04, c1 = 0.15, c2 = 0.35;
  double eta_f = 0.82, eta_b = 0.76;
  double gain = 1.0;  ///< true over logged motor torque
  double gravity_Nm = 6.0;
  double seconds = 12.0, rate_hz = 200.0;
  double amplitude_rad = 0.8, frequency_hz = 0.7;
  double torque_noise = 0.05, torque_memory = 0.5, torque_bias = 0.02;
  double speed_noise = 0.01, load_noise = 0.03;
  double encoder_lines = 65536.0;  ///< steps of an angle per turn
  bool logs_angle = false, logs_load = true;
  double turn_rad_s = 0.0;  ///< a steady speed on top: one sense, where it is great
};

/// A log of the bench following sines of two frequencies under an arm's weight.
calibrate::MotionRecord log_of(const DriveBench& bench, std::uint64_t seed);

/// What is stated of a bench.
calibrate::DriveParameters stated_of(const DriveBench& bench);

}  // namespace gear3k::test
