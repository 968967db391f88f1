#pragma once
// Measurements of a gearbox or of gear pairs, row by row, in SI units.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/loops/loop_session.hpp"
#include "design/operation.hpp"

namespace gear3k::calibrate {

/// What is measured, by the layouts of the interface.
enum class Kind { kTransmission, kLostMotion, kTorqueAngle, kPairLoss };
inline constexpr std::array<std::string_view, 4> kKindNames{"transmission", "lost_motion",
                                                            "torque_angle", "pair_loss"};

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Under what a response was measured.  Magnitudes as the interface defines them; NaN = the file
/// does not state it.
struct Condition {
  design::Direction direction = design::Direction::kForward;
  double sun_speed_rad_s = 0.0, output_torque_Nm = 0.0;  ///< transmission
  int rotation = 1;                                      ///< sense of the sun's turning, ±1
  double test_torque_Nm = 0.0;                           ///< lost_motion, applied as ±T
  int driving_teeth = 0, driven_teeth = 0;               ///< pair_loss
  double module_m = 0.0;                                 ///< pair_loss; 0: 1 mm
  double output_angle_rad = kUnknown;                    ///< unwrapped
  double temperature_K = kUnknown;
  double time_s = kUnknown;
  double cycles = kUnknown;
  int run = -1;  ///< of MeasurementSet::runs; -1: no column
  bool reference_sensor =
      false;  ///< measured with a calibrated sensor (note `# sensor: reference`)
};

struct Observation {
  Condition condition;
  double response = 0.0;    ///< sun torque [Nm], lost motion [rad] or loss factor
  double sigma = kUnknown;  ///< one standard deviation of the response
  /// Its deviation over that of another row, a ratio without unit, where how it was read tells only
  /// that; used where all rows have one and not all a sigma.
  double scatter = kUnknown;
  int file = 0, line = 0;  ///< where it stands, of MeasurementSet::files
};

/// A column that the layout does not name.
struct Covariate {
  std::string name;
  std::vector<double> value;  ///< by row; NaN = blank
};

/// What the digits of the responses say of how they were taken.
struct Readings {
  double resolution = 0.0;  ///< resolution_of()
  bool commanded = false;   ///< is_commanded()
};

/// Rows of one kind, of one or several files.
struct MeasurementSet {
  Kind kind = Kind::kTransmission;
  std::vector<std::string> files;
  std::vector<std::string> runs;  ///< labels, in order of first appearance
  std::vector<Observation> rows;
  std::vector<Covariate> covariates;
  /// What was found and how it was handled, in words: rows left out, duplicates, saturation.
  std::vector<std::string> notes;
  std::uint64_t fingerprint = 0;  ///< FNV-1a, 64 bit, of the files' bytes
  /// When the first record began that rows were read from [s]: before the first row.  NaN: rows
  /// were not read from records.
  double record_start_s = kUnknown;
  std::vector<LoopSession> loops{};  ///< from which rows were read, where they were
  /// By file: the gearbox of a series that it was measured on; empty where no file states one.
  std::vector<std::string> units{};
  /// Conditions that many rows lack: no cause that follows one is looked for.
  std::vector<double Condition::*> unused{};
  /// Where the responses are no longer as they were read; else empty: they say it themselves.
  std::optional<Readings> readings{};
};

/// A gearbox of which only the catalogue values are known; the sun is its fast shaft.
struct BlackBox {
  std::string name;
  double ratio = 1.0;
  double efficiency_forward = 1.0, efficiency_backward = 1.0;
  double backlash_rad = kUnknown;  ///< lost motion at the output; NaN = not stated
};

}  // namespace gear3k::calibrate
