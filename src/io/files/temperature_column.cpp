#include "io/files/temperature_column.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gear3k::io {

void TemperatureSpan::add(double temperature_C) {
  low_C = std::min(low_C, temperature_C);
  high_C = std::max(high_C, temperature_C);
}

std::optional<std::string> TemperatureSpan::doubt() const {
  constexpr double kLeastKelvin = 250.0;  // -23 C
  if (!(low_C >= kLeastKelvin && low_C <= high_C)) return std::nullopt;
  return fmt::format(
      "temperature_c is {:g} to {:g} throughout: it is read as degrees Celsius, is this file's in "
      "kelvin?",
      low_C, high_C);
}

}  // namespace gear3k::io
