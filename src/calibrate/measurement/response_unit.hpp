#pragma once
// The unit in which a response is told: that of its column.

#include <numbers>
#include <string_view>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

struct ResponseUnit {
  std::string_view name;
  double si;  ///< SI per unit
};

constexpr ResponseUnit response_unit(Kind kind) {
  if (kind == Kind::kTransmission) return {.name = "Nm", .si = 1.0};
  if (kind == Kind::kPairLoss) return {.name = "", .si = 1.0};
  return {.name = "arcmin", .si = std::numbers::pi / 180.0 / 60.0};
}

}  // namespace gear3k::calibrate
