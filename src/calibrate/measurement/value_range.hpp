#pragma once
// The range of what rows state.

#include <cmath>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// From the least to the greatest of values; NaN while there is none.
struct ValueRange {
  double low = kUnknown, high = kUnknown;

  /// Takes a value in; NaN and infinities (not stated) change nothing.
  void extend(double value) {
    if (!std::isfinite(value)) return;
    if (!(low <= value)) low = value;
    if (!(high >= value)) high = value;
  }
  [[nodiscard]] bool known() const { return std::isfinite(low); }
  /// Whether there are values, and not all the same.
  [[nodiscard]] bool varies() const { return high > low; }
};

inline ValueRange range_of(const std::vector<double>& values) {
  ValueRange range;
  for (const double value : values) range.extend(value);
  return range;
}

inline ValueRange range_of(const MeasurementSet& data, double Condition::*member) {
  ValueRange range;
  for (const Observation& row : data.rows) range.extend(row.condition.*member);
  return range;
}

}  // namespace gear3k::calibrate
