#pragma once
// What the SVG drawings have in common: numbers and colours.

#include <string>

#include "train/tooth_set.hpp"

namespace gear3k::drawing {

/// A length in mm, rounded to 1e-6, without trailing zeros.
std::string svg_millimetres(double value_mm);

struct Colors {
  const char* line;
  const char* fill;
};
Colors colors_of(train::GearId gear);

}  // namespace gear3k::drawing
