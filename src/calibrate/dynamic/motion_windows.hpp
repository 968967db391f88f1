#pragma once
// Balances of impulse over windows of a log, each in one sense and one flow.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/dynamic/drive_parameters.hpp"
#include "calibrate/dynamic/motion_record.hpp"

namespace gear3k::calibrate {

/// Terms of a window: means over the test function φ, times Σφ/√(Σφ²) so that the torque's
/// white noise scatters all rows alike.
struct MotionWindow {
  std::array<double, 5> term{};      ///< of acceleration, speed, sense, −T_L, and 1
  std::array<double, 2> variance{};  ///< of the terms of acceleration and −T_L, by their noise
  double motor_Nm = 0.0;
  double time_s = 0.0, duration_s = 0.0;
  double load_kgm2 = 0.0;
  int flow = 1, sense = 1;
  bool follows = false;  ///< begins where the window before it ended
  /// Mean over φ of MotionStretch::windup_rad; empty: not logged.
  std::optional<double> windup_rad{};
  bool windup_drifts = false;
  int session = 0;
  int log = 0;  ///< its file
};

/// Cuts a log where the sense or the flow changes and weighs each piece by φ = (1 − x²)^p, which
/// vanishes at both ends with its slopes: ∫ φ a dt = −∫ φ' w dt (p = 3) = ∫ φ'' θ dt (p = 4),
/// settled so that sums over samples are exact for accelerations up to third degree in time, at
/// any sampling.
/// No signal is differentiated; sense and flow are told by a parabola through 2 h + 1 samples, and
/// samples where they are in doubt are in no window.
/// Source: Shinbrot, M., On the analysis of linear and nonlinear systems, Trans. ASME 79 (1957)
/// (modulating functions); docs/theory §69.
/// @param drive  tells which flow a sample has
std::vector<MotionWindow> motion_windows(const MotionRecord& record, const DriveParameters& drive);

/// What a drive leaves of a window's mean motor torque [N m at the output].
///
///   τ − β_a a − β_w w − β_s s + β_T T_L,   β of drive_coefficients()
double window_residual(const MotionWindow& window, const DriveParameters& drive);

/// What is left of the motor's torque at a sample, over the output's angle.
struct TorqueSample {
  double angle_rad = 0.0, speed_rad_s = 0.0, left_Nm = 0.0;
  /// The same with torques and speed weighed over the 13 samples as the parabola's slope weighs the
  /// accelerations there, φ ~ h² − t² within h; empty near the end of a piece.  It has none of what
  /// a slope misses of an acceleration that bends, and of waves of a frequency ω the share
  ///   3 (sin x − x cos x)/x³, x = ω h.
  std::optional<double> even_Nm{};
  double half_s = 0.0;  ///< h
};
/// Samples of clear sense and flow with speed and acceleration of the parabola through 13 of them:
/// of all stretches where the angle is logged, else of the longest one, its speed summed up.
/// @param most  samples, the first of them
std::vector<TorqueSample> torque_samples(const MotionRecord& record, const DriveParameters& drive,
                                         std::size_t most);

}  // namespace gear3k::calibrate
