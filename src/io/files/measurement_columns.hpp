#pragma once
// The columns of measurement files, kind by kind: one record drives reading, ranges and messages.

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "units/units.hpp"

namespace gear3k::io {

struct MeasurementColumn {
  enum class Type { kNumber, kInteger, kSense, kDirection, kRun };

  std::string_view name;
  /// What the name ends in for its unit, and what the quantity is called without it.
  std::string_view unit = {};
  Type type = Type::kNumber;
  bool required = false;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool ends_excluded = false;
  std::string_view hint = {};  ///< said after the allowed range
  units::Unit conversion = units::Unit::kNone;
  void (*store)(calibrate::Observation&, double si) = nullptr;

  /// Whether a value as written in the file is of the type and in the range.
  [[nodiscard]] bool allows(double written) const;
  /// "a number, at least 0 (...)"
  [[nodiscard]] std::string allowed_text() const;
};

/// The columns that a kind names.  A torque-angle sample is an observation of the torque under the
/// condition of an angle and a time.
const std::vector<MeasurementColumn>& columns_of(calibrate::Kind kind);

/// The column that a name of a header stands for when it is not written as it must be: another
/// case, the same quantity in another unit or without one, the end of a required one ("speed_rpm"),
/// or a slip of the pen.
struct MeantColumn {
  const MeasurementColumn* column = nullptr;  ///< null: none of them
  bool other_unit = false;
};
MeantColumn meant_column(std::string_view written,
                         const std::vector<const MeasurementColumn*>& absent);

}  // namespace gear3k::io
