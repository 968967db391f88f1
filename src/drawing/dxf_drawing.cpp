#include "drawing/dxf_drawing.hpp"

#include <dl_dxf.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/display.hpp"

namespace gear3k::drawing {

namespace {

using geometry::Point;
using report::mm;

/// Writes groups into a string: dxflib's own writer knows files only, and prints reals as the
/// locale wants them.
class TextWriter : public DL_WriterA {
 public:
  TextWriter() : DL_WriterA("") {}  // a stream without a file, not used

  void dxfReal(int code, double value) const override {
    std::string number = fmt::format("{:.9f}", value);
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number += '0';
    if (number == "-0.0") number = "0.0";
    group(code, number);
  }
  void dxfInt(int code, int value) const override { group(code, fmt::format("{}", value)); }
  void dxfHex(int code, int value) const override { group(code, fmt::format("{:X}", value)); }
  void dxfString(int code, const char* value) const override { group(code, value); }
  void dxfString(int code, const std::string& value) const override { group(code, value); }

  void variable(const char* name, int code, int value) const {
    dxfString(9, name);
    dxfInt(code, value);
  }
  void variable(const char* name, int code, double value) const {
    dxfString(9, name);
    dxfReal(code, value);
  }
  void variable(const char* name, const Point& point_m) const {
    dxfString(9, name);
    coord(10, mm(point_m.x_m), mm(point_m.y_m));
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void group(int code, const std::string& value) const {
    text_ += fmt::format("{:3}\n{}\n", code, value);
  }
  mutable std::string text_;  // dxflib's writing functions are const
};

struct Layer {
  std::string name;
  int color;  ///< AutoCAD colour index
  int width;  ///< 1/100 mm
  const char* line_type;
};

/// Colour indices that show on a black and on a white screen.
int color_of(train::GearId id) {
  static constexpr std::array<int, train::kGearCount> kColors{1, 4, 7, 3, 6};
  return kColors[id];
}

std::vector<Layer> layers_of(const Drawing& drawing) {
  std::vector<Layer> layers{{"0", 7, 13, "CONTINUOUS"}};
  for (const DrawnGear& gear : drawing.gears) {
    layers.push_back({gear.name, color_of(gear.id), 13, "CONTINUOUS"});
  }
  if (std::ranges::any_of(drawing.gears, [](const DrawnGear& g) { return g.mark.has_value(); }))
    layers.push_back({kTimingLayer, 1, 25, "CONTINUOUS"});
  layers.push_back({kConstructionLayer, 8, 5, "CENTER"});
  return layers;
}

struct Extent {
  Point low, high;
};

Extent extent_of(const Drawing& drawing) {
  Extent extent{.low = {.x_m = 1e9, .y_m = 1e9}, .high = {.x_m = -1e9, .y_m = -1e9}};
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

void write_header(DL_Dxf& dxf, TextWriter& writer, const Extent& extent) {
  dxf.writeHeader(writer);
  writer.variable("$INSUNITS", 70, 4);     // millimetres
  writer.variable("$MEASUREMENT", 70, 1);  // metric
  writer.variable("$LUNITS", 70, 2);       // decimal
  writer.variable("$LUPREC", 70, 4);
  // The line type's pattern is 10 mm long: some 25 dashes over the drawing.
  writer.variable("$LTSCALE", 40, mm(extent.high.x_m - extent.low.x_m) / 250.0);
  writer.variable("$EXTMIN", extent.low);
  writer.variable("$EXTMAX", extent.high);
  writer.sectionEnd();
}

void write_tables(DL_Dxf& dxf, TextWriter& writer, const Drawing& drawing) {
  writer.sectionTables();
  dxf.writeVPort(writer);

  writer.tableLinetypes(4);
  for (const char* name : {"BYBLOCK", "BYLAYER", "CONTINUOUS"}) {
    dxf.writeLinetype(writer, DL_LinetypeData(name, "", 0, 0, 0.0));
  }
  std::array<double, 4> pattern{6.25, -1.25, 1.25, -1.25};
  dxf.writeLinetype(writer,
                    DL_LinetypeData("CENTER", "Center ____ _ ____ _ ____", 0,
                                    static_cast<int>(pattern.size()), 10.0, pattern.data()));
  writer.tableEnd();

  const std::vector<Layer> layers = layers_of(drawing);
  writer.tableLayers(static_cast<int>(layers.size()));
  for (const Layer& layer : layers) {
    dxf.writeLayer(writer, DL_LayerData(layer.name, 0),
                   DL_Attributes("", layer.color, layer.width, layer.line_type, 1.0));
  }
  writer.tableEnd();

  writer.tableStyle(1);
  DL_StyleData style("Standard", 0, 0.0, 1.0, 0.0, 0, 2.5, "txt", "");
  style.bold = false;
  style.italic = false;
  dxf.writeStyle(writer, style);
  writer.tableEnd();

  dxf.writeView(writer);
  dxf.writeUcs(writer);
  writer.tableAppid(1);
  dxf.writeAppid(writer, "ACAD");
  writer.tableEnd();
  dxf.writeDimStyle(writer, 2.5, 1.25, 0.625, 0.625, 2.5);
  dxf.writeBlockRecord(writer);
  writer.tableEnd();
  writer.sectionEnd();
}

void write_blocks(DL_Dxf& dxf, TextWriter& writer) {
  writer.sectionBlocks();
  for (const char* name : {"*Model_Space", "*Paper_Space", "*Paper_Space0"}) {
    dxf.writeBlock(writer, DL_BlockData(name, 0, 0.0, 0.0, 0.0));
    dxf.writeEndBlock(writer, name);
  }
  writer.sectionEnd();
}

DL_Attributes on_layer(const std::string& layer) { return {layer, 256, -1, "BYLAYER", 1.0}; }

void write_circle(DL_Dxf& dxf, TextWriter& writer, const DrawnGear& gear, double radius_m,
                  const std::string& layer) {
  if (!(radius_m > 0.0)) return;  // a root circle may fail to exist
  dxf.writeCircle(writer,
                  DL_CircleData(mm(gear.center.x_m), mm(gear.center.y_m), 0.0, mm(radius_m)),
                  on_layer(layer));
}

void write_contour(DL_Dxf& dxf, TextWriter& writer, const DrawnGear& gear) {
  constexpr int kClosed = 1;
  dxf.writePolyline(writer, DL_PolylineData(static_cast<int>(gear.contour.size()), 0, 0, kClosed),
                    on_layer(gear.name));
  for (const Point& p : gear.contour) {
    dxf.writeVertex(writer, DL_VertexData(mm(p.x_m), mm(p.y_m), 0.0, 0.0));
  }
  dxf.writePolylineEnd(writer);
  if (gear.bore_radius_m) write_circle(dxf, writer, gear, *gear.bore_radius_m, gear.name);
  if (gear.outer_radius_m) write_circle(dxf, writer, gear, *gear.outer_radius_m, gear.name);
  if (gear.mark) {
    dxf.writeCircle(
        writer, DL_CircleData(mm(gear.mark->x_m), mm(gear.mark->y_m), 0.0, mm(mark_radius_m(gear))),
        on_layer(kTimingLayer));
  }
}

void write_center_mark(DL_Dxf& dxf, TextWriter& writer, const DrawnGear& gear) {
  const double x = mm(gear.center.x_m);
  const double y = mm(gear.center.y_m);
  const double half = 0.2 * mm(gear.reference_radius_m);
  const DL_Attributes attributes = on_layer(kConstructionLayer);
  dxf.writeLine(writer, DL_LineData(x - half, y, 0.0, x + half, y, 0.0), attributes);
  dxf.writeLine(writer, DL_LineData(x, y - half, 0.0, x, y + half, 0.0), attributes);
}

void write_construction(DL_Dxf& dxf, TextWriter& writer, const Drawing& drawing) {
  std::vector<Point> marked;
  for (const DrawnGear& gear : drawing.gears) {
    for (const double radius :
         {gear.reference_radius_m, gear.base_radius_m, gear.tip_radius_m, gear.root_radius_m}) {
      write_circle(dxf, writer, gear, radius, kConstructionLayer);
    }
    const bool shared = std::ranges::any_of(marked, [&](const Point& p) {
      return p.x_m == gear.center.x_m && p.y_m == gear.center.y_m;
    });
    if (shared) continue;
    write_center_mark(dxf, writer, gear);
    marked.push_back(gear.center);
  }
}

}  // namespace

std::string dxf_text(const Drawing& drawing) {
  DL_Dxf dxf;
  TextWriter writer;
  write_header(dxf, writer, extent_of(drawing));
  write_tables(dxf, writer, drawing);
  write_blocks(dxf, writer);
  writer.sectionEntities();
  for (const DrawnGear& gear : drawing.gears) write_contour(dxf, writer, gear);
  write_construction(dxf, writer, drawing);
  writer.sectionEnd();
  dxf.writeObjects(writer);
  dxf.writeObjectsEnd(writer);
  writer.dxfEOF();
  return writer.text();
}

}  // namespace gear3k::drawing
