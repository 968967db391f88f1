#pragma once
// The text of a DXF file, entity by entity.

#include <memory>
#include <string>
#include <vector>

#include "geometry/outline.hpp"

namespace gear3k::drawing {

/// Layer of circles, axes and centre marks.
inline constexpr const char* kConstructionLayer = "CONSTRUCTION";

struct DxfLayer {
  std::string name;
  int color;  ///< AutoCAD colour index
  int width;  ///< 1/100 mm
  const char* line_type;
};
inline const DxfLayer kDxfConstruction{kConstructionLayer, 8, 5, "CENTER"};

/// Colour index of a gear (train::GearId), which shows on a black and on a white screen.
int dxf_color_of(int gear);

/// AutoCAD 2000 (AC1015), in millimetres; coordinates are rounded to 1e-9 mm.
class DxfFile {
 public:
  struct Extent {
    geometry::Point low, high;
  };
  /// @param layers  besides layer 0
  DxfFile(const Extent& extent, const std::vector<DxfLayer>& layers);
  DxfFile(const DxfFile&) = delete;
  DxfFile& operator=(const DxfFile&) = delete;
  ~DxfFile();

  void add_closed(const std::vector<geometry::Point>& contour, const std::string& layer);
  void add_circle(const geometry::Point& center, double radius_m, const std::string& layer);
  void add_line(const geometry::Point& from, const geometry::Point& to, const std::string& layer);
  struct TextPlace {
    geometry::Point at;  ///< of the baseline's middle, or its left end
    double height_m = 0.0, angle_rad = 0.0;
    bool centered = false;
  };
  void add_text(const std::string& words, const TextPlace& place, const std::string& layer);

  /// Ends the file; nothing may be added after it.
  [[nodiscard]] std::string finished();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gear3k::drawing
