#pragma once
// A change of the coefficient of friction as a whole: by itself, or beside a law.

#include <algorithm>

#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate {

/// The greatest coefficient of friction that teeth may show, of clean and dry metals (iron on iron
/// 1.0, hard steel 0.78; ecampusontario.pressbooks.pub, Physics Fundamentals, table A.1): only
/// metals that gall, copper or aluminium on itself, have more.  A least one there is not but 0,
/// below which flanks would drive each other: contacts that slide with less than 0.01 are made
/// (Ayyagari, Alam, Berman and Erdemir, Front. Mech. Eng. 8 (2022) 908497).
inline constexpr double kMostFriction = 1.0;

/// Bounds of a fit of friction over the design's, less 1.  At the lower one the data ask for none
/// or less; what the coefficient may be in the rows is another question (fit/row_friction.hpp).
inline constexpr double kLeastChange = -0.99, kMostChange = 9.0, kSomeFriction = -0.98;

/// Friction over the design's, less 1.
constexpr ParameterRecord level_parameter() {
  return {.name = "relative_change",
          .unit = "",
          .lower = kLeastChange,
          .upper = kMostChange,
          .plausible_low = kSomeFriction,
          .plausible_high = kMostChange};
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
