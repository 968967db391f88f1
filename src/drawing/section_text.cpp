// Sections as SVG and DXF.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>

#include "drawing/dxf_file.hpp"
#include "drawing/section_drawing.hpp"
#include "drawing/svg_style.hpp"
#include "drawing/xml_text.hpp"
#include "io/text/utf8.hpp"
#include "report/display.hpp"

namespace gear3k::drawing {

namespace {

using geometry::Point;
using report::mm;

struct Stroke {
  Point from, to;
};

/// The strokes of a dimension: its line, the lines to what is measured and the ticks.
struct DimensionStrokes {
  std::vector<Stroke> strokes;
  Point text;  ///< middle of its baseline
  double angle_rad = 0.0;
};

DimensionStrokes strokes_of(const Dimension& d, double height) {
  const Point from = d.along_axis ? Point{.x_m = d.from.x_m, .y_m = d.line_m}
                                  : Point{.x_m = d.line_m, .y_m = d.from.y_m};
  const Point to = d.along_axis ? Point{.x_m = d.to.x_m, .y_m = d.line_m}
                                : Point{.x_m = d.line_m, .y_m = d.to.y_m};
  DimensionStrokes result;
  result.strokes = {{from, to}};
  const double tick = 0.3 * height;
  const auto end_at = [&](const Point& measured, const Point& end) {
    result.strokes.push_back({measured, end});
    result.strokes.push_back({{.x_m = end.x_m - tick, .y_m = end.y_m - tick},
                              {.x_m = end.x_m + tick, .y_m = end.y_m + tick}});
  };
  if (!d.half) end_at(d.from, from);
  end_at(d.to, to);
  const Point middle{.x_m = 0.5 * (from.x_m + to.x_m), .y_m = 0.5 * (from.y_m + to.y_m)};
  constexpr double kGap = 0.35;
  if (d.along_axis) {
    result.text = {.x_m = middle.x_m, .y_m = middle.y_m + kGap * height};
  } else {
    // Beside its column, at least as far up as half its length; longer than the column, beyond it.
    const double half = 0.31 * height * static_cast<double>(io::characters_in(d.text));
    const double top = std::max(from.y_m, to.y_m);
    const bool beyond = 2.0 * half > std::abs(to.y_m - from.y_m);
    result.text = {.x_m = middle.x_m - kGap * height,
                   .y_m = beyond ? top + tick + kGap * height + half : std::max(middle.y_m, half)};
    result.angle_rad = 0.5 * std::numbers::pi;
  }
  return result;
}

/// The axes of the sun and of the planet, a little beyond the bodies.
std::vector<Stroke> axes_of(const SectionDrawing& drawing) {
  double left = drawing.high.x_m, right = drawing.low.x_m;
  for (const SectionBody& body : drawing.bodies) {
    left = std::min(left, body.low.x_m);
    right = std::max(right, body.high.x_m);
  }
  std::vector<double> heights;
  std::vector<Stroke> axes;
  for (const SectionBody& body : drawing.bodies) {
    if (std::ranges::find(heights, body.axis_m) != heights.end()) continue;
    heights.push_back(body.axis_m);
    const double reach = drawing.text_height_m;
    axes.push_back(
        {{.x_m = left - reach, .y_m = body.axis_m}, {.x_m = right + reach, .y_m = body.axis_m}});
  }
  return axes;
}

/// A text as the words of a DXF file of release 15 (AC1015), which is of one code page: what is no
/// printable ASCII, and what would begin an escape, as \U+XXXX of UTF-16; signs of per cent that
/// stand together, which would begin one too, by three each.
std::string dxf_words(std::string_view text) {
  constexpr std::uint32_t kDiameter = 0x2300, kFirstBeyond = 0x10000;
  constexpr std::uint32_t kHighSurrogate = 0xD800, kLowSurrogate = 0xDC00, kReplacement = 0xFFFD;
  std::string words;
  const auto escape = [&](std::uint32_t unit) { words += fmt::format("\\U+{:04X}", unit); };
  bool after_percent = false;
  while (!text.empty()) {
    const bool percent = text.front() == '%';
    const bool several = percent && (after_percent || (text.size() > 1 && text[1] == '%'));
    after_percent = percent;
    const io::Utf8Character character = io::first_character(text);
    const std::uint32_t code = character.whole ? character.code : kReplacement;
    text.remove_prefix(character.bytes);
    if (code == kDiameter) {
      words += "%%c";
    } else if (several) {
      words += "%%%";
    } else if (code == '\n') {
      words += ' ';
    } else if (code >= kFirstBeyond) {
      escape(kHighSurrogate + ((code - kFirstBeyond) >> 10U));
      escape(kLowSurrogate + ((code - kFirstBeyond) & 0x3FFU));
    } else if (code < ' ' || code > '~' || code == '\\' || code == '^') {
      escape(code);
    } else {
      words += static_cast<char>(code);
    }
  }
  return words;
}

/// Words in lines of at most so many letters.
std::vector<std::string> lines_of(const std::string& words, std::size_t most) {
  std::vector<std::string> lines;
  std::string line;
  std::size_t letters = 0;  // of the line
  std::size_t from = 0;
  while (from < words.size()) {
    const std::size_t to = std::min(words.find(' ', from), words.size());
    const std::string word = words.substr(from, to - from);
    const std::size_t more = io::characters_in(word);
    if (!line.empty() && letters + 1 + more > most) {
      lines.push_back(line);
      line = "    ";
      letters = line.size();
    } else if (!line.empty()) {
      line += ' ';
      ++letters;
    }
    line += word;
    letters += more;
    from = to + 1;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

/// The lines of all notes below the drawing, as wide as it is or wider.
std::vector<std::string> note_lines(const SectionDrawing& drawing) {
  constexpr std::size_t kLetters = 90;
  const double width = drawing.high.x_m - drawing.low.x_m;
  const auto fitting =
      static_cast<std::size_t>(std::max(0.0, width / (0.62 * 0.9 * drawing.text_height_m)));
  std::vector<std::string> lines;
  for (const std::string& note : drawing.notes) {
    const auto own = lines_of(note, std::max(kLetters, fitting));
    lines.insert(lines.end(), own.begin(), own.end());
  }
  return lines;
}

constexpr double kNoteHeight = 0.9, kNoteStep = 1.6;  // of the text height

const char* fill_of(int body) {
  return body == train::kCarrier ? "none" : colors_of(static_cast<train::GearId>(body)).fill;
}

/// Writes elements with y downwards from the top.
class SectionSvg {
 public:
  SectionSvg(const Point& corner, double height) : corner_(corner), height_(height) {}

  [[nodiscard]] std::string x(double x_m) const { return svg_millimetres(mm(x_m - corner_.x_m)); }
  [[nodiscard]] std::string y(double y_m) const { return svg_millimetres(mm(corner_.y_m - y_m)); }

  void add(const std::string& element) { text_ += element + '\n'; }
  void add_line(const Stroke& line, const char* dashes, double width) {
    add(fmt::format(R"(<path fill="none" stroke="#202020" stroke-width="{}"{} d="M{} {}L{} {}"/>)",
                    svg_millimetres(mm(width * height_)), dashes, x(line.from.x_m),
                    y(line.from.y_m), x(line.to.x_m), y(line.to.y_m)));
  }
  void add_body(const SectionBody& body) {
    add(fmt::format(R"(<rect id="{}" x="{}" y="{}" width="{}" height="{}" fill="{}" )"
                    R"(stroke="#202020" stroke-width="{}"{}/>)",
                    body.name, x(body.low.x_m), y(body.high.y_m),
                    svg_millimetres(mm(body.high.x_m - body.low.x_m)),
                    svg_millimetres(mm(body.high.y_m - body.low.y_m)), fill_of(body.body),
                    svg_millimetres(mm(0.08 * height_)),
                    body.body == train::kCarrier ? dashes_of(0.6, 0.4) : ""));
  }
  [[nodiscard]] std::string dashes_of(double on, double off) const {
    return fmt::format(R"( stroke-dasharray="{} {}")", svg_millimetres(mm(on * height_)),
                       svg_millimetres(mm(off * height_)));
  }
  void add_text(const std::string& words, const Point& at, double size, const char* more,
                bool up = false) {
    add(fmt::format(
        R"(<text {} fill="#202020"{}>{}</text>)",
        svg_text_place(mm(at.x_m - corner_.x_m), mm(corner_.y_m - at.y_m), mm(size * height_), up),
        more, xml_text(words)));
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  Point corner_;
  double height_;
  std::string text_;
};

void add_dimension(SectionSvg& svg, const Dimension& dimension, double height) {
  const DimensionStrokes strokes = strokes_of(dimension, height);
  svg.add(fmt::format(R"(<g class="dimension" data-name="{}" data-value="{:.6f}">)",
                      xml_text(dimension.name), mm(dimension.value_m)));
  for (const Stroke& stroke : strokes.strokes) svg.add_line(stroke, "", 0.04);
  svg.add_text(dimension.text, strokes.text, 1.0, R"( text-anchor="middle")",
               strokes.angle_rad != 0.0);
  svg.add("</g>");
}

}  // namespace

std::string svg_text(const SectionDrawing& drawing) {
  const double height = drawing.text_height_m;
  const std::vector<std::string> notes = note_lines(drawing);
  std::size_t longest = io::characters_in(drawing.title) + 12;
  for (const std::string& line : notes) longest = std::max(longest, io::characters_in(line));
  const double width = std::max(drawing.high.x_m - drawing.low.x_m,
                                0.62 * kNoteHeight * height * static_cast<double>(longest)) +
                       2.0 * height;
  const Point corner{.x_m = drawing.low.x_m - height, .y_m = drawing.high.y_m + 3.0 * height};
  const double total = corner.y_m - drawing.low.y_m +
                       kNoteStep * height * static_cast<double>(notes.size() + 1) + height;
  SectionSvg svg(corner, height);
  svg.add(R"(<?xml version="1.0" encoding="UTF-8"?>)");
  svg.add(fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="{1}mm" )"
                      R"(viewBox="0 0 {0} {1}" font-family="DejaVu Sans, Arial, sans-serif">)",
                      svg_millimetres(mm(width)), svg_millimetres(mm(total))));
  svg.add(fmt::format("<title>{}</title>", xml_text(drawing.title + ": assembly")));
  svg.add(fmt::format(R"(<rect width="{}" height="{}" fill="#ffffff"/>)",
                      svg_millimetres(mm(width)), svg_millimetres(mm(total))));
  svg.add_text(drawing.title + ": assembly",
               {.x_m = drawing.low.x_m, .y_m = drawing.high.y_m + 0.5 * height}, 1.3, "");
  for (const SectionBody& body : drawing.bodies) svg.add_body(body);
  const std::string chain = svg.dashes_of(0.8, 0.4);
  for (const SectionBody& body : drawing.bodies) {
    const auto across = [&](double y) {
      return Stroke{{.x_m = body.low.x_m, .y_m = y}, {.x_m = body.high.x_m, .y_m = y}};
    };
    for (const double y : body.reference_m) svg.add_line(across(y), chain.c_str(), 0.04);
    for (const double y : body.root_m) svg.add_line(across(y), "", 0.06);
  }
  for (const Stroke& axis : axes_of(drawing)) svg.add_line(axis, chain.c_str(), 0.06);
  for (const Dimension& dimension : drawing.dimensions) add_dimension(svg, dimension, height);
  double y = drawing.low.y_m;
  for (const std::string& line : notes) {
    y -= kNoteStep * height;
    svg.add_text(line, {.x_m = drawing.low.x_m, .y_m = y}, kNoteHeight,
                 R"( class="note" xml:space="preserve")");
  }
  svg.add("</svg>");
  return svg.text();
}

std::string dxf_text(const SectionDrawing& drawing) {
  const double height = drawing.text_height_m;
  const std::vector<std::string> notes = note_lines(drawing);
  const double below = drawing.low.y_m - kNoteStep * height * static_cast<double>(notes.size() + 1);
  std::vector<DxfLayer> layers;
  for (const SectionBody& body : drawing.bodies) {
    const bool carrier = body.body == train::kCarrier;
    layers.push_back({body.name, carrier ? 8 : dxf_color_of(body.body), 25, "CONTINUOUS"});
  }
  layers.push_back({kDimensionLayer, 7, 9, "CONTINUOUS"});
  layers.push_back({kNotesLayer, 7, 9, "CONTINUOUS"});
  layers.push_back(kDxfConstruction);
  DxfFile dxf({.low = {.x_m = drawing.low.x_m, .y_m = below}, .high = drawing.high}, layers);
  for (const SectionBody& body : drawing.bodies) {
    dxf.add_closed({body.low,
                    {.x_m = body.high.x_m, .y_m = body.low.y_m},
                    body.high,
                    {.x_m = body.low.x_m, .y_m = body.high.y_m}},
                   body.name);
    const auto across = [&](double y, const std::string& layer) {
      dxf.add_line({.x_m = body.low.x_m, .y_m = y}, {.x_m = body.high.x_m, .y_m = y}, layer);
    };
    for (const double y : body.root_m) across(y, body.name);
    for (const double y : body.reference_m) across(y, kConstructionLayer);
  }
  for (const Stroke& axis : axes_of(drawing)) dxf.add_line(axis.from, axis.to, kConstructionLayer);
  for (const Dimension& dimension : drawing.dimensions) {
    const DimensionStrokes strokes = strokes_of(dimension, height);
    for (const Stroke& stroke : strokes.strokes) {
      dxf.add_line(stroke.from, stroke.to, kDimensionLayer);
    }
    dxf.add_text(
        dxf_words(dimension.text),
        {.at = strokes.text, .height_m = height, .angle_rad = strokes.angle_rad, .centered = true},
        kDimensionLayer);
  }
  double y = drawing.low.y_m;
  const auto add_note = [&](const std::string& line, double size) {
    y -= kNoteStep * height;
    dxf.add_text(dxf_words(line),
                 {.at = {.x_m = drawing.low.x_m, .y_m = y}, .height_m = size * height},
                 kNotesLayer);
  };
  add_note(drawing.title, 1.3);
  for (const std::string& line : notes) add_note(line, kNoteHeight);
  return dxf.finished();
}

}  // namespace gear3k::drawing
