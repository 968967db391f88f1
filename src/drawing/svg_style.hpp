#pragma once
// What the SVG drawings have in common: numbers and colours.

#include <string>

#include "train/tooth_set.hpp"

namespace gear3k::drawing {

/// A length in mm, rounded to 1e-6, without trailing zeros.
std::string svg_millimetres(double value_mm);

/// Attributes of a text that begins, or has its middle, at x, y [mm] in letters of that height.
/// Where that is below a millimetre, in which librsvg draws crumbs, ten units and a scale.
/// @param up  the text runs upwards
std::string svg_text_place(double x_mm, double y_mm, double size_mm, bool up = false);

struct Colors {
  const char* line;
  const char* fill;
};
Colors colors_of(train::GearId gear);

}  // namespace gear3k::drawing
