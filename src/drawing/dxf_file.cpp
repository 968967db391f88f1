#include "drawing/dxf_file.hpp"

#include <dl_dxf.h>
#include <fmt/format.h>

#include <array>

#include "report/display.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::drawing {

using geometry::Point;
using report::mm;

/// Writes groups into a string: dxflib's own writer knows files only, and prints reals as the
/// locale wants them.
class DxfTextWriter : public DL_WriterA {
 public:
  DxfTextWriter() : DL_WriterA("") {}  // a stream without a file, not used

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

namespace {

void write_header(DL_Dxf& dxf, DxfTextWriter& writer, const DxfFile::Extent& extent) {
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

void write_tables(DL_Dxf& dxf, DxfTextWriter& writer, const std::vector<DxfLayer>& layers) {
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

  writer.tableLayers(static_cast<int>(layers.size()));
  for (const DxfLayer& layer : layers) {
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

void write_blocks(DL_Dxf& dxf, DxfTextWriter& writer) {
  writer.sectionBlocks();
  for (const char* name : {"*Model_Space", "*Paper_Space", "*Paper_Space0"}) {
    dxf.writeBlock(writer, DL_BlockData(name, 0, 0.0, 0.0, 0.0));
    dxf.writeEndBlock(writer, name);
  }
  writer.sectionEnd();
}

DL_Attributes on_layer(const std::string& layer) { return {layer, 256, -1, "BYLAYER", 1.0}; }

}  // namespace

int dxf_color_of(int gear) {
  static constexpr std::array<int, train::kGearCount> kColors{1, 4, 7, 3, 6};
  return kColors.at(static_cast<std::size_t>(gear));
}

struct DxfFile::State {
  DL_Dxf dxf;
  DxfTextWriter writer;
};

DxfFile::DxfFile(const Extent& extent, const std::vector<DxfLayer>& layers)
    : state_(std::make_unique<State>()) {
  std::vector<DxfLayer> all{{"0", 7, 13, "CONTINUOUS"}};
  all.insert(all.end(), layers.begin(), layers.end());
  write_header(state_->dxf, state_->writer, extent);
  write_tables(state_->dxf, state_->writer, all);
  write_blocks(state_->dxf, state_->writer);
  state_->writer.sectionEntities();
}

DxfFile::~DxfFile() = default;

void DxfFile::add_closed(const std::vector<Point>& contour, const std::string& layer) {
  constexpr int kClosed = 1;
  state_->dxf.writePolyline(state_->writer,
                            DL_PolylineData(static_cast<int>(contour.size()), 0, 0, kClosed),
                            on_layer(layer));
  for (const Point& p : contour) {
    state_->dxf.writeVertex(state_->writer, DL_VertexData(mm(p.x_m), mm(p.y_m), 0.0, 0.0));
  }
  state_->dxf.writePolylineEnd(state_->writer);
}

void DxfFile::add_circle(const Point& center, double radius_m, const std::string& layer) {
  state_->dxf.writeCircle(state_->writer,
                          DL_CircleData(mm(center.x_m), mm(center.y_m), 0.0, mm(radius_m)),
                          on_layer(layer));
}

void DxfFile::add_line(const Point& from, const Point& to, const std::string& layer) {
  state_->dxf.writeLine(state_->writer,
                        DL_LineData(mm(from.x_m), mm(from.y_m), 0.0, mm(to.x_m), mm(to.y_m), 0.0),
                        on_layer(layer));
}

void DxfFile::add_text(const std::string& words, const TextPlace& place, const std::string& layer) {
  const double x = mm(place.at.x_m);
  const double y = mm(place.at.y_m);
  state_->dxf.writeText(state_->writer,
                        DL_TextData(x, y, 0.0, x, y, 0.0, mm(place.height_m), 1.0, 0,
                                    place.centered ? 1 : 0, 0, words, "Standard", place.angle_rad),
                        on_layer(layer));
}

std::string DxfFile::finished() {
  state_->writer.sectionEnd();
  state_->dxf.writeObjects(state_->writer);
  state_->dxf.writeObjectsEnd(state_->writer);
  state_->writer.dxfEOF();
  return state_->writer.text();
}

}  // namespace gear3k::drawing
