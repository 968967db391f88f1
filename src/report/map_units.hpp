#pragma once
// Units of operating maps in reports.

#include <cmath>
#include <numbers>

namespace gear3k::report {

/// A stated number without the rounding of its way through SI units: 12 significant digits.
inline double clean(double value) {
  if (value == 0.0 || !std::isfinite(value)) return 0.0 * value + 0.0;
  const double power = std::pow(10.0, 11.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * power) / power;
}
inline double rpm(double rad_s) { return clean(rad_s * 30.0 / std::numbers::pi); }
inline double celsius(double kelvin) { return clean(kelvin - 273.15); }
inline double percent(double share) { return 100.0 * share; }

}  // namespace gear3k::report
