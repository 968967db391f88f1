#pragma once
// A change of the coefficient of friction as a whole: by itself, or beside a law.

#include <algorithm>

#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate {

/// Friction over the design's, less 1.
constexpr ParameterRecord level_parameter() {
  return {.name = "relative_change",
          .unit = "",
          .lower = -0.99,
          .upper = 9.0,
          .plausible_low = -0.7,
          .plausible_high = 2.0};
}

/// Whether a form has that change as a parameter of its own.
inline bool has_level_parameter(const std::vector<ParameterRecord>& parameters) {
  return std::ranges::any_of(
      parameters, [](const ParameterRecord& r) { return r.name == level_parameter().name; });
}

inline void change_level(const Scalar& change, Modification& m) {
  m.gearbox.friction.level = m.gearbox.friction.level * (1.0 + change);
}

}  // namespace gear3k::calibrate
