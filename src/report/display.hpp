#pragma once
// What the reports have in common: units as tables show them, and pieces of JSON.

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "design/checks.hpp"
#include "io/text/json.hpp"
#include "io/text/version.hpp"

namespace gear3k::report {

inline double mm(double m) { return units::from_si(m, units::Unit::kMillimetre); }
inline double um(double m) { return units::from_si(m, units::Unit::kMicrometre); }
inline double mpa(double Pa) { return units::from_si(Pa, units::Unit::kMegapascal); }
inline double arcmin(double rad) { return units::from_si(rad, units::Unit::kArcmin); }
inline double degrees(double rad) { return units::from_si(rad, units::Unit::kDegree); }

/// A stated number without the rounding of its way through SI units: 12 significant digits.
inline double clean(double value) {
  constexpr int kDigits = 12;
  if (value == 0.0 || !std::isfinite(value)) return value == 0.0 ? 0.0 : value;
  const double power = std::pow(10.0, kDigits - 1.0 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(power) ? std::round(value * power) / power : value;
}
inline double rpm(double rad_s) { return clean(rad_s * 30.0 / std::numbers::pi); }
inline double celsius(double kelvin) { return clean(kelvin - 273.15); }
inline double percent(double share) { return 100.0 * share; }

/// A number with fixed decimals; rounding noise below zero shows no minus sign.  "none" where there
/// is no number, "unbounded" where it has no bound.
inline std::string fixed(double value, int decimals) {
  if (std::isnan(value)) return "none";
  if (std::isinf(value)) return value > 0.0 ? "unbounded" : "-unbounded";
  const double shown = std::abs(value) < 0.5 * std::pow(10.0, -decimals) ? 0.0 : value;
  return fmt::format("{:.{}f}", shown, decimals);
}

inline io::Json tool_json() { return {{"version", io::version()}, {"git", io::git_commit()}}; }

/// NaN for nothing: what exact() writes as an empty field.
inline double or_nan(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

/// What a function makes of every item.
template <class Items, class ToJson>
io::Json list_json(const Items& items, ToJson to_json) {
  io::Json list = io::Json::array();
  for (const auto& item : items) list.push_back(to_json(item));
  return list;
}

/// A quantity in a unit of this file, none where there is none.
inline std::optional<double> if_any(const std::optional<double>& si, double (*unit)(double)) {
  if (!si) return std::nullopt;
  return unit(*si);
}

}  // namespace gear3k::report
