#pragma once
// Temperatures of measurements: their range, and whether they are in kelvin.

#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace gear3k::io {

inline constexpr double kAbsoluteZero_C = -273.15;
inline constexpr std::string_view kTemperatureHint = " (degrees Celsius)";

/// Least and greatest of a column of temperatures.
struct TemperatureSpan {
  double low_C = std::numeric_limits<double>::infinity();
  double high_C = -std::numeric_limits<double>::infinity();

  void add(double temperature_C);
  /// What is to be noted of a column without a value below 250: are they kelvin?
  [[nodiscard]] std::optional<std::string> doubt() const;
};

}  // namespace gear3k::io
