#pragma once
// Least squares over the windows of a log.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrate/dynamic/drive_parameters.hpp"
#include "calibrate/dynamic/motion_windows.hpp"

namespace gear3k::calibrate {

/// Sums over the windows of one flow and one load.
struct WindowGroup {
  int flow = 1;
  double load_kgm2 = 0.0;
  std::size_t windows = 0;
  bool both_senses = false;  ///< of its load: an offset of the logged torque shows apart from drag
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();  ///< Σ x xᵀ, over σ²
  Eigen::Vector4d right = Eigen::Vector4d::Zero();   ///< Σ x y, over σ²
  double square = 0.0;                               ///< Σ y², over σ²
  Eigen::Vector4d offset = Eigen::Vector4d::Zero();  ///< Σ x · 1, over σ²
  double offset_square = 0.0, offset_right = 0.0;    ///< Σ 1 · 1 and Σ 1 · y, over σ²
};

/// All groups, scaled by the noise that the windows show: its variance is what the noise of speed
/// and load gives a window, plus one of the torque; correlation between windows that follow each
/// other is taken out (Prais-Winsten).
struct WindowSums {
  std::vector<WindowGroup> groups;
  double degrees = 0.0;       ///< of the noise
  double correlation = 0.0;   ///< between neighbours
  double deviation_Nm = 0.0;  ///< of a window's mean torque
  /// Of all groups one below the other, the offset of each load eliminated where both senses show
  /// it; see assemble().
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  double square = 0.0;
};

/// Fills matrix, right and square from the groups.
void assemble(WindowSums& sums);

/// A coefficient of all groups, place 4 k + j for term j of group k, with all others free.
struct OwnCoefficient {
  double value = 0.0, variance = 0.0;
};
/// @returns empty where the windows do not show it
std::optional<OwnCoefficient> own_coefficient(const WindowSums& sums, std::size_t place);

/// Sums of windows; the noise is that of the least squares with all coefficients of every group
/// free.  Variances of the terms by noise in speed and load are taken off (errors in variables).
/// @returns empty where fewer windows than coefficients + 6 are left
/// Source: docs/theory §70.
std::optional<WindowSums> window_sums(const std::vector<MotionWindow>& windows);

/// The drive with some numbers free, fitted to the windows.
struct DriveFit {
  std::vector<std::size_t> free;  ///< DriveChange, ascending
  DriveChanges changes{};
  Eigen::MatrixXd covariance;  ///< of the free ones
  double statistic = 0.0;      ///< χ² of the windows
  bool determined = true;      ///< false: these data do not fix the free ones
  bool physical = true;        ///< within three standard errors of what can exist
};

/// Gauss-Newton from no change at all.
DriveFit fit_drive(const WindowSums& sums, const DriveParameters& stated,
                   const std::vector<std::size_t>& free);

/// χ² with all coefficients of every group free (less what noise in speed and load adds to it: only
/// differences from other fits mean something), and how many there are.
struct FreeFit {
  double statistic = 0.0;
  int coefficients = 0;
};
FreeFit free_fit(const WindowSums& sums);

}  // namespace gear3k::calibrate
