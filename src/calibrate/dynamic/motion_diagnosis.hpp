#pragma once
// What a log of motion says about a drive: verdict, causes, numbers, what to move next.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/dynamic/drive_parameters.hpp"
#include "calibrate/dynamic/motion_holdout.hpp"
#include "calibrate/dynamic/motion_record.hpp"
#include "calibrate/dynamic/motion_windows.hpp"

namespace gear3k::calibrate {

/// p below which the causes do not explain.
inline constexpr double kMisfit = 1e-4;

enum class MotionVerdict { kNoDiscrepancy, kExplained, kAmbiguous, kUnexplained };

struct MotionDiagnoseOptions {
  double false_discovery_rate = 0.05;  ///< of any cause where nothing is wrong
};

/// A number with its 95 % interval; SI, at the output.
struct MotionEstimate {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct MotionAlternative {
  std::size_t cause = 0;  ///< DriveChange
  MotionEstimate estimate;
  double statistic = 0.0;  ///< its χ² less that of the effect
  double probability = 0.0;
};

struct MotionEffect {
  std::size_t cause = 0;  ///< DriveChange
  MotionEstimate estimate;
  double delta_bic = 0.0;
  double p_value = 1.0;
  double probability = 0.0;
  std::vector<MotionAlternative> alternatives;  ///< most likely first
};

/// What the log shows of a number of the drive with all others free; without: it does not.
struct MotionQuantity {
  std::string name, unit;
  double stated = 0.0;
  std::optional<MotionEstimate> found{};
};

/// A motion to log next.
struct MotionProposal {
  std::string id;      ///< "gravity", "second_inertia", "chirp"
  std::string advice;  ///< what to do, in words
  double amplitude_rad_s = 0.0, frequency_Hz = 0.0, duration_s = 0.0;
  double load_Nm = 0.0, inertia_kgm2 = 0.0;  ///< to add; 0: none
  std::vector<std::size_t> separates;        ///< DriveChange
  double expected_statistic = 0.0;           ///< χ² between the closest two afterwards
  double half_width = 0.0;  ///< of the 95 % interval of the first effect, all of them free
};

/// What is stated of a drive between its sides.
struct StatedWindup {
  double play_rad = 0.0;           ///< j, lost motion of the output
  double compliance_rad_Nm = 0.0;  ///< 1/K_g at the output; 0: rigid
};

struct MotionDiagnosis {
  MotionVerdict verdict = MotionVerdict::kNoDiscrepancy;
  std::vector<MotionEffect> effects;
  std::vector<MotionQuantity> quantities;
  std::optional<MotionProposal> next;
  std::array<std::size_t, 2> windows{0, 0};  ///< forward, backward
  double p_value = 1.0;                      ///< of the greatest finding where nothing is wrong
  double lack_of_fit = 1.0;                  ///< p of what the causes leave
  double baseline_Nm = 0.0, extended_Nm = 0.0, noise_Nm = 0.0;  ///< rms of a window's mean torque
  double correlation = 0.0;                                     ///< between neighbouring windows
  /// Inertia and drag of both sides together explain as well: no load is logged.
  bool sides_as_well = false;
  DriveParameters drive;  ///< as found
  std::vector<MotionWindow> rows;
  std::vector<double> baseline, extended;  ///< residuals of each window's mean torque [N m]
  MotionHoldout held_out{};
  std::vector<std::string> notes;
  /// Whether what the causes leave is more than noise.
  [[nodiscard]] bool leaves_something() const { return lack_of_fit < kMisfit; }
};

/// Diagnoses logs of one drive by windows (motion_windows()), every set of at most three causes
/// compared by BIC.
/// @returns empty where too few windows have a clear sense and flow
/// Source: docs/theory §70.
std::optional<MotionDiagnosis> diagnose_motion(const MotionRecord& record,
                                               const DriveParameters& stated,
                                               const MotionDiagnoseOptions& options);

}  // namespace gear3k::calibrate
