#include "drawing/dxf_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace gear3k::drawing {

namespace {

using geometry::Point;

std::vector<DxfLayer> layers_of(const Drawing& drawing) {
  std::vector<DxfLayer> layers;
  for (const DrawnGear& gear : drawing.gears) {
    layers.push_back({gear.name, dxf_color_of(gear.id), 13, "CONTINUOUS"});
  }
  if (std::ranges::any_of(drawing.gears, [](const DrawnGear& g) { return g.mark.has_value(); }))
    layers.push_back({kTimingLayer, 1, 25, "CONTINUOUS"});
  layers.push_back(kDxfConstruction);
  return layers;
}

DxfFile::Extent extent_of(const Drawing& drawing) {
  DxfFile::Extent extent{.low = {.x_m = 1e9, .y_m = 1e9}, .high = {.x_m = -1e9, .y_m = -1e9}};
  for (const DrawnGear& gear : drawing.gears) {
    double radius = std::max({gear.reference_radius_m, gear.base_radius_m, gear.tip_radius_m,
                              gear.root_radius_m, gear.outer_radius_m.value_or(0.0)});
    for (const Point& p : gear.contour) {
      radius = std::max(radius, std::hypot(p.x_m - gear.center.x_m, p.y_m - gear.center.y_m));
    }
    extent.low = {.x_m = std::min(extent.low.x_m, gear.center.x_m - radius),
                  .y_m = std::min(extent.low.y_m, gear.center.y_m - radius)};
    extent.high = {.x_m = std::max(extent.high.x_m, gear.center.x_m + radius),
                   .y_m = std::max(extent.high.y_m, gear.center.y_m + radius)};
  }
  return extent;
}

void write_contour(DxfFile& dxf, const DrawnGear& gear) {
  dxf.add_closed(gear.contour, gear.name);
  if (gear.bore_radius_m) dxf.add_circle(gear.center, *gear.bore_radius_m, gear.name);
  if (gear.outer_radius_m) dxf.add_circle(gear.center, *gear.outer_radius_m, gear.name);
  if (gear.mark) dxf.add_circle(*gear.mark, mark_radius_m(gear), kTimingLayer);
}

void write_center_mark(DxfFile& dxf, const DrawnGear& gear) {
  const auto [x, y] = gear.center;
  const double half = 0.2 * gear.reference_radius_m;
  dxf.add_line({.x_m = x - half, .y_m = y}, {.x_m = x + half, .y_m = y}, kConstructionLayer);
  dxf.add_line({.x_m = x, .y_m = y - half}, {.x_m = x, .y_m = y + half}, kConstructionLayer);
}

void write_construction(DxfFile& dxf, const Drawing& drawing) {
  std::vector<Point> marked;
  for (const DrawnGear& gear : drawing.gears) {
    for (const double radius :
         {gear.reference_radius_m, gear.base_radius_m, gear.tip_radius_m, gear.root_radius_m}) {
      if (!(radius > 0.0)) continue;  // a root circle may fail to exist
      dxf.add_circle(gear.center, radius, kConstructionLayer);
    }
    const bool shared = std::ranges::any_of(marked, [&](const Point& p) {
      return p.x_m == gear.center.x_m && p.y_m == gear.center.y_m;
    });
    if (shared) continue;
    write_center_mark(dxf, gear);
    marked.push_back(gear.center);
  }
}

}  // namespace

std::string dxf_text(const Drawing& drawing) {
  DxfFile dxf(extent_of(drawing), layers_of(drawing));
  for (const DrawnGear& gear : drawing.gears) write_contour(dxf, gear);
  write_construction(dxf, drawing);
  return dxf.finished();
}

}  // namespace gear3k::drawing
