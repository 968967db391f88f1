#pragma once
// The train cut along its axis, with dimensions and how it is put together.

#include <array>
#include <string>
#include <vector>

#include "design/evaluation.hpp"
#include "geometry/outline.hpp"

namespace gear3k::drawing {

/// A body above the axis: x along the axis, y from it.
struct SectionBody {
  std::string name;                         ///< S, P1, R1, P2, R2, carrier
  int body = 0;                             ///< train::GearId, or train::kCarrier
  geometry::Point low, high;                ///< corners of its section, teeth included
  double axis_m = 0.0;                      ///< y of its own axis
  std::vector<double> reference_m, root_m;  ///< y of these lines, where the section has them
};

/// A length that is told.  The line lies at `line_m`: y of one along the axis, x of one across it.
struct Dimension {
  std::string name;  ///< R1 root diameter
  std::string text;  ///< as it is printed; a diameter sign stands as U+2300
  double value_m = 0.0;
  bool along_axis = false;
  geometry::Point from, to;  ///< what is measured
  double line_m = 0.0;
  /// Of a diameter of which the half section shows the upper half: `from` lies a little beyond the
  /// axis, where the dimension line ends without extension line and terminator (ISO 129-1).
  bool half = false;
};

struct SectionDrawing {
  std::string title;
  std::vector<SectionBody> bodies;
  std::vector<Dimension> dimensions;
  std::vector<std::string> notes;
  double text_height_m = 0.0;
  geometry::Point low, high;  ///< of bodies and dimension lines
};

/// The section through the axes of the sun and of planet 1, from the sun's axis outwards.
///
/// Bodies lie where `[axial]` says.  A gear that it does not have lies in the middle of its stage,
/// which is where the planet's step is stated to be, else the ring, else the sun; a stage of which
/// nothing is stated lies beside the other.  Such gears are as wide as their faces; without those
/// 10 modules wide, and without dimensions along the axis.  A
/// ring without an outer diameter is drawn to 2.5 modules beyond its root, and that is not told as
/// a dimension.  Notes: what is not stated, where each planet goes and how it is turned, and past
/// which gears S, R1 and R2 go along the axis, by the gaps
///
///   S past P2: d − r_aP2 − r_aS,   R1 past P2: r_aR1 − d − r_aP2,   R2 past P1: r_aR2 − d − r_aP1.
///
/// @param notes  of the drawings, which stand in this one too
SectionDrawing make_section(const design::Design& design, const design::Evaluation& evaluation,
                            const std::vector<std::string>& notes);

/// As SVG: bodies have their name as id, dimension lines the class `dimension` and their name and
/// value in mm as data-name and data-value.
std::string svg_text(const SectionDrawing& drawing);

/// Layers of the DXF besides those of bodies.
inline constexpr const char* kDimensionLayer = "DIMENSIONS";
inline constexpr const char* kNotesLayer = "NOTES";

/// As DXF, in millimetres: bodies are closed LWPOLYLINEs on the layer of their name, dimensions
/// lines and texts on DIMENSIONS, notes texts on NOTES; axes and reference lines on CONSTRUCTION.
std::string dxf_text(const SectionDrawing& drawing);

}  // namespace gear3k::drawing
