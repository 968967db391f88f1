#include "units/units.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

namespace gear3k::units {

namespace {

double rounded(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", value, digits - 1);
  double result = value;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

}  // namespace

double decimal_from_si(double si, Unit unit) {
  const double quotient = from_si(si, unit);
  if (!std::isfinite(quotient)) return quotient;
  for (int digits = 1; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
    const double value = rounded(quotient, digits);
    if (to_si(value, unit) == si) return value;
  }
  // Where the unit's grid is the finer one, the quotient's rounding may have passed the value by.
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value :
       {std::nextafter(quotient, -kInfinity), std::nextafter(quotient, kInfinity)}) {
    if (to_si(value, unit) == si) return value;
  }
  return quotient;
}

double meant_si(double si, Unit unit) {
  constexpr int kDigits = 12;
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double few = to_si(rounded(from_si(si, unit), kDigits), unit);
  return std::abs(few - si) <= kRounding * std::abs(si) ? few : si;
}

}  // namespace gear3k::units
