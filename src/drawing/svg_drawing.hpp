#pragma once

#include <string>

#include "drawing/drawing.hpp"

namespace gear3k::drawing {

/// A drawing as the text of an SVG file: at true size, one unit = 1 mm.
///
/// Each stage is a panel of its own (S, P1, R1; P2, R2), side by side at the same scale; title,
/// legend and scale bar around them.  A gear's path has the gear's name as id.  Within a panel's
/// group the coordinates are those of the DXF drawing, y up.  A ring is an annulus out to
/// drawn_outer_radius().
/// Accuracy: coordinates are rounded to 1e-6 mm.
std::string svg_text(const Drawing& drawing);

}  // namespace gear3k::drawing
