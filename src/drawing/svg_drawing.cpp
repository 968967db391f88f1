#include "drawing/svg_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "drawing/svg_style.hpp"
#include "drawing/xml_text.hpp"
#include "io/text/utf8.hpp"
#include "report/display.hpp"

namespace gear3k::drawing {

namespace {

using geometry::Point;
using report::mm;

/// A circle of construction: what it is called, its radius, how its line is dashed (in units).
struct ConstructionCircle {
  const char* name;
  double radius_m;
  const char* color;
  std::array<double, 4> dashes;
};

std::array<ConstructionCircle, 4> circles_of(const DrawnGear& gear) {
  return {{{"reference circle", gear.reference_radius_m, "#202020", {2.0, 0.4, 0.4, 0.4}},
           {"base circle", gear.base_radius_m, "#0060a8", {1.0, 0.5, 1.0, 0.5}},
           {"tip circle", gear.tip_radius_m, "#b34700", {0.3, 0.3, 0.3, 0.3}},
           {"root circle", gear.root_radius_m, "#00734f", {0.3, 0.3, 0.3, 0.3}}}};
}

bool is_ring(const DrawnGear& gear) { return train::kind_of(gear.id) == geometry::GearKind::kRing; }

struct Panel {
  std::string caption;
  std::vector<const DrawnGear*> gears;  ///< in the order in which they are painted
  double radius_mm = 0.0;               ///< around the origin, holds everything
};

Panel make_panel(const Drawing& drawing, int stage, std::string caption) {
  Panel panel{.caption = std::move(caption), .gears = {}, .radius_mm = 0.0};
  for (const DrawnGear& gear : drawing.gears) {
    if (train::stage_of(gear.id) == stage) panel.gears.push_back(&gear);
  }
  std::ranges::stable_sort(panel.gears, std::greater{},
                           [](const DrawnGear* gear) { return is_ring(*gear); });
  for (const DrawnGear* gear : panel.gears) {
    double radius = is_ring(*gear) ? drawn_outer_radius(*gear) : 0.0;
    radius = std::max({radius, gear->reference_radius_m, gear->base_radius_m, gear->tip_radius_m});
    panel.radius_mm =
        std::max(panel.radius_mm, mm(radius + std::hypot(gear->center.x_m, gear->center.y_m)));
  }
  return panel;
}

std::vector<Panel> panels_of(const Drawing& drawing) {
  if (drawing.gears.size() == 1) {
    const train::GearId id = drawing.gears.front().id;
    return {make_panel(drawing, train::stage_of(id), fmt::format("Gear {}", drawing.name))};
  }
  return {make_panel(drawing, 0, "Stage 1: sun S, planets P1, fixed ring R1"),
          make_panel(drawing, 1, "Stage 2: planets P2, output ring R2")};
}

/// A length of 1, 2 or 5 times a power of ten, at most the given one.
double round_length(double at_most) {
  const double decade = std::pow(10.0, std::floor(std::log10(at_most)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= at_most) return step * decade;
  }
  return decade;
}

/// Writes elements; `unit_` is 1/100 of the larger panel, so that all drawings look alike.
class SvgWriter {
 public:
  explicit SvgWriter(double unit) : unit_(unit) {}

  void add(const std::string& element) { text_ += element + '\n'; }

  struct TextPlace {
    double x = 0.0, y = 0.0, size = 1.0;
    const char* color = "#202020";
  };
  void add_text(const std::string& words, const TextPlace& place) {
    add(fmt::format(R"(<text {} fill="{}">{}</text>)", svg_text_place(place.x, place.y, place.size),
                    place.color, xml_text(words)));
  }

  [[nodiscard]] std::string dashed_line(const ConstructionCircle& circle) const {
    return fmt::format(
        R"(fill="none" stroke="{}" stroke-width="{}" stroke-dasharray="{} {} {} {}")", circle.color,
        svg_millimetres(0.05 * unit_), svg_millimetres(circle.dashes[0] * unit_),
        svg_millimetres(circle.dashes[1] * unit_), svg_millimetres(circle.dashes[2] * unit_),
        svg_millimetres(circle.dashes[3] * unit_));
  }

  void add_gear(const DrawnGear& gear) {
    const Colors colors = colors_of(gear.id);
    std::string path = "M";  // the points after the first are lines to them
    for (const Point& p : gear.contour) {
      if (path.size() > 1) path += ' ';
      path += svg_millimetres(mm(p.x_m)) + ' ' + svg_millimetres(mm(p.y_m));
    }
    path += 'Z';
    if (is_ring(gear)) path += full_circle(gear.center, drawn_outer_radius(gear));
    if (gear.bore_radius_m) path += full_circle(gear.center, *gear.bore_radius_m);
    add(fmt::format(
        R"(<path id="{}" fill="{}" fill-opacity="0.8" fill-rule="evenodd" stroke="{}" stroke-width="{}" )"
        R"(stroke-linejoin="round" d="{}"/>)",
        gear.name, colors.fill, colors.line, svg_millimetres(0.04 * unit_), path));
  }

  void add_circle(const DrawnGear& gear, const ConstructionCircle& circle) {
    if (!(circle.radius_m > 0.0)) return;  // a root circle may fail to exist
    add(fmt::format(R"(<circle cx="{}" cy="{}" r="{}" {}/>)", svg_millimetres(mm(gear.center.x_m)),
                    svg_millimetres(mm(gear.center.y_m)), svg_millimetres(mm(circle.radius_m)),
                    dashed_line(circle)));
  }

  void add_timing_mark(const DrawnGear& gear) {
    if (!gear.mark) return;
    add(fmt::format(R"(<circle class="timing" cx="{}" cy="{}" r="{}" fill="#d00000"/>)",
                    svg_millimetres(mm(gear.mark->x_m)), svg_millimetres(mm(gear.mark->y_m)),
                    svg_millimetres(mm(mark_radius_m(gear)))));
  }

  void add_center_mark(const DrawnGear& gear) {
    const double x = mm(gear.center.x_m);
    const double y = mm(gear.center.y_m);
    const double half = 0.2 * mm(gear.reference_radius_m);
    add(fmt::format(
        R"(<path fill="none" stroke="#202020" stroke-width="{}" d="M{} {}H{}M{} {}V{}"/>)",
        svg_millimetres(0.04 * unit_), svg_millimetres(x - half), svg_millimetres(y),
        svg_millimetres(x + half), svg_millimetres(x), svg_millimetres(y - half),
        svg_millimetres(y + half)));
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string full_circle(const Point& center, double radius_m) {
    const std::string r = svg_millimetres(mm(radius_m));
    const std::string y = svg_millimetres(mm(center.y_m));
    const std::string left = svg_millimetres(mm(center.x_m - radius_m));
    const std::string right = svg_millimetres(mm(center.x_m + radius_m));
    return fmt::format("M{2} {1}A{0} {0} 0 1 0 {3} {1}A{0} {0} 0 1 0 {2} {1}Z", r, y, right, left);
  }

  double unit_;
  std::string text_;
};

void add_legend(SvgWriter& svg, const Panel& panel, double unit, Point corner) {
  const double size = 2.2 * unit;
  double y = corner.y_m;
  std::vector<train::GearId> listed;
  const auto add_row = [&](const std::string& sample, const std::string& words) {
    svg.add(sample);
    svg.add_text(words, {.x = corner.x_m + 7.0 * unit, .y = y + 0.8 * unit, .size = size});
    y += 3.4 * unit;
  };
  const auto line_row = [&](const ConstructionCircle& circle, const std::string& words) {
    add_row(
        fmt::format(R"(<path {} d="M{} {}h{}"/>)", svg.dashed_line(circle),
                    svg_millimetres(corner.x_m), svg_millimetres(y), svg_millimetres(5.6 * unit)),
        words);
  };
  for (const DrawnGear* gear : panel.gears) {
    if (std::ranges::find(listed, gear->id) != listed.end()) continue;
    listed.push_back(gear->id);
    const Colors colors = colors_of(gear->id);
    add_row(fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="{}" stroke="{}" )"
                        R"(stroke-width="{}"/>)",
                        svg_millimetres(corner.x_m), svg_millimetres(y - unit),
                        svg_millimetres(5.6 * unit), svg_millimetres(2.0 * unit), colors.fill,
                        colors.line, svg_millimetres(0.1 * unit)),
            fmt::format("{}: {} teeth, module {:.6g} mm, profile shift {:.4f}",
                        train::kGearNames[gear->id], gear->teeth, mm(gear->module_m),
                        gear->profile_shift));
  }
  const DrawnGear& first = *panel.gears.front();
  if (std::ranges::any_of(panel.gears, [](const DrawnGear* g) { return g->mark.has_value(); })) {
    add_row(fmt::format(R"(<circle cx="{}" cy="{}" r="{}" fill="#d00000"/>)",
                        svg_millimetres(corner.x_m + 2.8 * unit), svg_millimetres(y),
                        svg_millimetres(0.8 * unit)),
            "timing mark: the teeth of P1 and P2 that belong together");
  }
  if (panel.gears.size() > 1) {
    line_row(circles_of(first)[0], "reference circles");
    return;
  }
  for (const ConstructionCircle& circle : circles_of(first)) {
    line_row(circle, fmt::format("{}, diameter {:.4f} mm", circle.name, mm(2.0 * circle.radius_m)));
  }
}

}  // namespace

std::string svg_text(const Drawing& drawing) {
  const std::vector<Panel> panels = panels_of(drawing);
  const double radius = std::ranges::max(panels, {}, &Panel::radius_mm).radius_mm;
  const double unit = 2.0 * radius / 100.0;
  const double margin = 5.0 * unit;

  // From top to bottom: title, remark, captions, panels, legends, scale bar.
  const double panel_top = margin + (drawing.remark.empty() ? 11.0 : 14.5) * unit;
  const double legend_top = panel_top + 2.0 * radius + 5.0 * unit;
  const double bar_top = legend_top + 6.0 * 3.4 * unit + 2.0 * unit;
  const double height = bar_top + 2.0 * unit + margin;
  const auto panel_width = [&](const Panel& panel) {
    return std::max(2.0 * panel.radius_mm, 70.0 * unit);  // room for the legend's text
  };
  double width = 2.0 * margin + margin * static_cast<double>(panels.size() - 1);
  for (const Panel& panel : panels) width += panel_width(panel);

  SvgWriter svg(unit);
  svg.add(R"(<?xml version="1.0" encoding="UTF-8"?>)");
  svg.add(fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="{1}mm" )"
                      R"(viewBox="0 0 {0} {1}" font-family="DejaVu Sans, Arial, sans-serif">)",
                      svg_millimetres(width), svg_millimetres(height)));
  const std::string title =
      drawing.title.empty() ? drawing.name : fmt::format("{}: {}", drawing.title, drawing.name);
  svg.add(fmt::format("<title>{}</title>", xml_text(title)));
  svg.add(fmt::format(R"(<rect width="{}" height="{}" fill="#ffffff"/>)", svg_millimetres(width),
                      svg_millimetres(height)));
  // A letter is some 0.6 of its height wide.
  const double fitting =
      (width - 2.0 * margin) / (0.62 * static_cast<double>(io::characters_in(title)));
  svg.add_text(title,
               {.x = margin, .y = margin + 3.0 * unit, .size = std::min(4.0 * unit, fitting)});
  if (!drawing.remark.empty()) {
    svg.add_text(drawing.remark,
                 {.x = margin, .y = margin + 6.8 * unit, .size = 2.4 * unit, .color = "#a3331f"});
  }

  double left = margin;
  for (const Panel& panel : panels) {
    svg.add_text(panel.caption, {.x = left, .y = panel_top - 2.5 * unit, .size = 2.6 * unit});
    svg.add(fmt::format(R"-(<g transform="translate({} {}) scale(1 -1)">)-",
                        svg_millimetres(left + 0.5 * panel_width(panel)),
                        svg_millimetres(panel_top + radius)));
    for (const DrawnGear* gear : panel.gears) svg.add_gear(*gear);
    for (const DrawnGear* gear : panel.gears) svg.add_timing_mark(*gear);
    for (const DrawnGear* gear : panel.gears) {
      const auto circles = circles_of(*gear);
      const std::size_t shown = panel.gears.size() > 1 ? 1 : circles.size();
      for (std::size_t k = 0; k < shown; ++k) svg.add_circle(*gear, circles[k]);
    }
    for (const DrawnGear* gear : panel.gears) {
      // In an assembly the sun's mark, or none, is that of the ring.
      if (panel.gears.size() == 1 || !is_ring(*gear)) svg.add_center_mark(*gear);
    }
    svg.add("</g>");
    add_legend(svg, panel, unit, {.x_m = left, .y_m = legend_top});
    left += panel_width(panel) + margin;
  }

  const double length = round_length(25.0 * unit);
  svg.add(
      fmt::format(R"(<path fill="none" stroke="#202020" stroke-width="{}" d="M{} {}v{}h{}v{}"/>)",
                  svg_millimetres(0.2 * unit), svg_millimetres(margin), svg_millimetres(bar_top),
                  svg_millimetres(unit), svg_millimetres(length), svg_millimetres(-unit)));
  svg.add_text(fmt::format("{:g} mm", length),
               {.x = margin + length + 1.5 * unit, .y = bar_top + 1.2 * unit, .size = 2.2 * unit});
  svg.add("</svg>");
  return svg.text();
}

}  // namespace gear3k::drawing
