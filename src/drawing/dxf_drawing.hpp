#pragma once

#include <string>

#include "drawing/drawing.hpp"
#include "drawing/dxf_file.hpp"

namespace gear3k::drawing {

/// Layer of the timing marks of the planets.
inline constexpr const char* kTimingLayer = "TIMING";

/// A drawing as the text of a DXF file (AutoCAD 2000, AC1015), in millimetres.
///
/// Each gear is one closed LWPOLYLINE on the layer of its name, with a circle for a bore or an
/// outer diameter that the design gives; a circle on the layer TIMING is the timing mark of P1 or
/// P2.  On the layer CONSTRUCTION, line type CENTER: reference, base, tip and root circle of each
/// gear (in this order) and a centre mark of two lines; gears on one axis share the mark.  y points
/// up; the sun's axis, or that of a gear drawn alone, is the origin. Accuracy: coordinates are
/// rounded to 1e-9 mm.
std::string dxf_text(const Drawing& drawing);

}  // namespace gear3k::drawing
