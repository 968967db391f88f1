#include "drawing/section_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "drawing/drawing.hpp"
#include "drawing/planet_marks.hpp"
#include "report/display.hpp"
#include "train/axial_layout.hpp"

namespace gear3k::drawing {

namespace {

using geometry::GearKind, geometry::Point;
using report::mm;
using train::kP1, train::kP2, train::kR1, train::kR2, train::kS;

constexpr double kUnknownWidth = 10.0;  // modules

/// Where the bodies lie along the axis, and what is to be said of it.
struct AxialPlaces {
  std::array<std::optional<train::AxialInterval>, train::kBodyCount> extent;
  bool known = true;  ///< widths are the design's
  std::string note;
};

AxialPlaces axial_places(const design::Design& design) {
  AxialPlaces places{.extent = design.axial.extent, .known = true, .note = {}};
  std::string missing;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    if (places.extent[gear]) continue;
    missing += fmt::format("{}{}", missing.empty() ? "" : ", ", train::kGearNames[gear]);
  }
  if (missing.empty()) return places;
  std::array<double, 2> width{};
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const double stated = design::bodies_of(design).face_width_m[stage];
    places.known = places.known && stated > 0.0;
    width[stage] = stated > 0.0 ? stated : kUnknownWidth * design.train.module_m[stage];
  }
  const train::GearPlaces<double> gears = train::placed_gears(design.axial, width);
  const bool any = std::any_of(places.extent.begin(), places.extent.begin() + train::kGearCount,
                               [](const auto& extent) { return extent.has_value(); });
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    places.extent[gear] = {.from_m = gears.from_m[gear], .to_m = gears.to_m[gear]};
  }
  if (!places.known) {
    places.note = "face widths are not stated: gears are drawn 10 modules wide";
  } else if (any) {
    places.note = fmt::format(
        "no place along the axis is stated ([axial]) for {}: drawn in the middle of their stage",
        missing);
  } else {
    places.note =
        "the places of all gears along the axis are not stated ([axial]): the stages are drawn "
        "side by side";
  }
  return places;
}

/// Places dimensions in columns beside the bodies and in rows above and below them.
class SectionMaker {
 public:
  SectionMaker(const design::Design& design, const design::Evaluation& e)
      : design_(design), e_(e), places_(axial_places(design)) {
    train::TrainParameters<double> parameters = design.train;
    parameters.center_distance_m = e.center_distance_m;  // as the KHK tip rule needs it
    gears_ = train::make_train_gears(parameters);
    drawing_.title = e.name;
  }

  SectionDrawing make(const std::vector<std::string>& notes) {
    for (const int gear : {kR1, kR2, kS, kP1, kP2}) add_gear(static_cast<std::size_t>(gear));
    add_carrier();
    low_ = high_ = drawing_.bodies.front().low;
    for (const SectionBody& body : drawing_.bodies) {
      low_ = {.x_m = std::min(low_.x_m, body.low.x_m), .y_m = 0.0};
      high_ = {.x_m = std::max(high_.x_m, body.high.x_m),
               .y_m = std::max(high_.y_m, body.high.y_m)};
    }
    drawing_.text_height_m = 0.03 * std::max(high_.y_m, high_.x_m - low_.x_m);
    add_radial_dimensions();
    if (places_.known) add_axial_dimensions();
    add_notes(notes);
    const double room = 3.0 * drawing_.text_height_m;
    drawing_.low = {.x_m = left_ - room, .y_m = below_ - room};
    drawing_.high = {.x_m = right_ + room, .y_m = above_ + room};
    return std::move(drawing_);
  }

 private:
  [[nodiscard]] double axis_of(std::size_t gear) const {
    return gear == kP1 || gear == kP2 ? e_.center_distance_m : 0.0;
  }
  [[nodiscard]] const train::AxialInterval& extent_of(std::size_t gear) const {
    return *places_.extent[gear];
  }
  [[nodiscard]] std::optional<double> outer_radius(std::size_t ring) const {
    return ring == kR1 ? design_.masses.ring1_outer_radius_m : design_.masses.ring2_outer_radius_m;
  }

  void add_gear(std::size_t gear) {
    const auto& g = gears_[gear];
    const double axis = axis_of(gear);
    SectionBody body{.name = std::string(train::kGearNames[gear]),
                     .body = static_cast<int>(gear),
                     .low = {.x_m = extent_of(gear).from_m, .y_m = 0.0},
                     .high = {.x_m = extent_of(gear).to_m, .y_m = 0.0},
                     .axis_m = axis,
                     .reference_m = {},
                     .root_m = {}};
    if (g.gear.kind == GearKind::kRing) {
      body.low.y_m = g.tip_radius_m;
      body.high.y_m = outer_radius(gear).value_or(g.root_radius_m + kDrawnRim * g.gear.module_m);
      body.reference_m = {g.reference_radius_m};
      body.root_m = {g.root_radius_m};
    } else if (gear == kS) {
      body.low.y_m = design_.masses.bore_radius_m[kS];
      body.high.y_m = g.tip_radius_m;
      body.reference_m = {g.reference_radius_m};
      body.root_m = {g.root_radius_m};
    } else {
      body.low.y_m = axis - g.tip_radius_m;
      body.high.y_m = axis + g.tip_radius_m;
      body.reference_m = {axis - g.reference_radius_m, axis + g.reference_radius_m};
      body.root_m = {axis - g.root_radius_m, axis + g.root_radius_m};
      if (const double bore = design_.masses.bore_radius_m[gear]; bore > 0.0) {
        body.root_m.push_back(axis - bore);
        body.root_m.push_back(axis + bore);
      }
    }
    drawing_.bodies.push_back(std::move(body));
  }

  void add_carrier() {
    const auto& extent = places_.extent[train::kCarrier];
    if (!extent || !(design_.axial.carrier_radius_m > 0.0)) return;
    drawing_.bodies.push_back({.name = std::string(train::kBodyNames[train::kCarrier]),
                               .body = train::kCarrier,
                               .low = {.x_m = extent->from_m, .y_m = 0.0},
                               .high = {.x_m = extent->to_m, .y_m = design_.axial.carrier_radius_m},
                               .axis_m = 0.0,
                               .reference_m = {},
                               .root_m = {}});
  }

  /// A diameter or a distance across the axis, in the next column of a side.
  void across(bool left, std::string name, const std::string& text, double value, Point from,
              Point to) {
    double& at = left ? left_ : right_;
    at += (left ? -2.2 : 2.2) * drawing_.text_height_m;
    drawing_.dimensions.push_back({.name = std::move(name),
                                   .text = text,
                                   .value_m = value,
                                   .along_axis = false,
                                   .from = from,
                                   .to = to,
                                   .line_m = at});
  }
  void diameter(bool left, std::size_t gear, const char* what, double radius) {
    const auto& extent = extent_of(gear);
    const double x = left ? extent.from_m : extent.to_m;
    const double axis = axis_of(gear);
    const bool whole = gear == kP1 || gear == kP2;
    constexpr double kBeyondAxis = 0.8;
    const std::string name = fmt::format("{} {}", train::kGearNames[gear], what);
    across(left, name + " diameter", fmt::format("{} ⌀{:.3f}", name, mm(2.0 * radius)),
           2.0 * radius,
           {.x_m = x, .y_m = whole ? axis - radius : -kBeyondAxis * drawing_.text_height_m},
           {.x_m = x, .y_m = axis + radius});
    drawing_.dimensions.back().half = !whole;
  }
  void ring_diameters(bool left, std::size_t ring) {
    diameter(left, ring, "tip", gears_[ring].tip_radius_m);
    diameter(left, ring, "root", gears_[ring].root_radius_m);
    if (const auto outer = outer_radius(ring)) {
      diameter(left, ring, "outer", *outer);
    } else {
      drawing_.notes.push_back(
          fmt::format("the outer diameter of {} is not stated", train::kGearNames[ring]));
    }
  }

  void add_radial_dimensions() {
    left_ = low_.x_m;
    right_ = high_.x_m;
    const bool first_left = extent_of(kP1).from_m <= extent_of(kP2).from_m;
    diameter(first_left, kS, "tip", gears_[kS].tip_radius_m);
    const double d = e_.center_distance_m;
    const double x = first_left ? extent_of(kP1).from_m : extent_of(kP1).to_m;
    std::string text = fmt::format("a {:.4f}", mm(d));
    if (design_.tolerances) {
      const auto& t = design_.tolerances->center_distance_m;
      if (t.lower != 0.0 || t.upper != 0.0) {
        text += fmt::format(" {:+.4f}/{:+.4f}", mm(t.upper), mm(t.lower));
      }
    }
    across(first_left, "centre distance", text, d, {.x_m = x, .y_m = 0.0}, {.x_m = x, .y_m = d});
    diameter(first_left, kP1, "tip", gears_[kP1].tip_radius_m);
    ring_diameters(first_left, kR1);
    diameter(!first_left, kP2, "tip", gears_[kP2].tip_radius_m);
    ring_diameters(!first_left, kR2);
  }

  void along(std::string name, const std::string& text, Point from, Point to, double line) {
    drawing_.dimensions.push_back({.name = std::move(name),
                                   .text = text,
                                   .value_m = to.x_m - from.x_m,
                                   .along_axis = true,
                                   .from = from,
                                   .to = to,
                                   .line_m = line});
  }
  void width(std::size_t gear, double line) {
    const auto body =
        std::ranges::find(drawing_.bodies, static_cast<int>(gear), &SectionBody::body);
    const bool above = line > 0.0;
    const double y = above ? body->high.y_m : body->low.y_m;
    along(body->name + " face width",
          fmt::format("{} {:.3f}", body->name, mm(body->high.x_m - body->low.x_m)),
          {.x_m = body->low.x_m, .y_m = y}, {.x_m = body->high.x_m, .y_m = y}, line);
  }

  /// The widths of two gears in one row, or in one beyond the other where their texts would run
  /// together.
  /// @param step  to the next row
  /// @returns the last row
  double widths(std::size_t gear1, std::size_t gear2, double row, double step) {
    const auto dimension = [&](std::size_t back) -> const Dimension& {
      return drawing_.dimensions[drawing_.dimensions.size() - back];
    };
    width(gear1, row);
    width(gear2, row);
    const auto middle = [](const Dimension& d) { return 0.5 * (d.from.x_m + d.to.x_m); };
    const double between = std::abs(middle(dimension(1)) - middle(dimension(2)));
    // A letter is some 0.62 of its height wide; two between the texts.
    const auto letters =
        static_cast<double>(dimension(1).text.size() + dimension(2).text.size()) / 2.0 + 2.0;
    if (between >= 0.62 * letters * drawing_.text_height_m) return row;
    drawing_.dimensions.back().line_m = row + step;
    return row + step;
  }

  void add_axial_dimensions() {
    const double h = drawing_.text_height_m;
    above_ = widths(kR1, kR2, high_.y_m + 2.5 * h, 2.5 * h) + 2.5 * h;
    along("length", fmt::format("{:.3f}", mm(high_.x_m - low_.x_m)),
          {.x_m = low_.x_m, .y_m = high_.y_m}, {.x_m = high_.x_m, .y_m = high_.y_m}, above_);
    below_ = -2.5 * h;
    width(kS, below_);
    below_ = widths(kP1, kP2, below_ - 2.5 * h, -2.5 * h);
    std::string places;
    for (const SectionBody& body : drawing_.bodies) {
      places += fmt::format("{}{} {:.3f} to {:.3f}", places.empty() ? "" : ", ", body.name,
                            mm(body.low.x_m), mm(body.high.x_m));
    }
    drawing_.notes.push_back("along the axis [mm]: " + places);
  }

  /// Whether a gear passes another one along the axis, and by how much.
  static std::string passing(double gap, const char* past) {
    return gap > 0.0 ? fmt::format("it passes {} by {:.3f} mm", past, mm(gap))
                     : fmt::format("{} is in its way by {:.3f} mm", past, mm(-gap));
  }

  void add_notes(const std::vector<std::string>& notes) {
    auto& all = drawing_.notes;
    const auto& z = e_.teeth;
    all.insert(all.begin(),
               fmt::format("S {}, P1 {}, R1 {} teeth of module {:.6g} mm; P2 {}, R2 {} of {:.6g} "
                           "mm; {} planets",
                           z.S, z.P1, z.R1, mm(design_.train.module_m[0]), z.P2, z.R2,
                           mm(design_.train.module_m[1]), e_.planets));
    if (!places_.note.empty()) all.push_back(places_.note);
    const double d = e_.center_distance_m;
    const auto tip = [&](std::size_t gear) { return gears_[gear].tip_radius_m; };
    all.push_back("S goes in along the axis from P1's side; from P2's, " +
                  passing(d - tip(kP2) - tip(kS), "P2"));
    all.push_back("R1 goes on from P1's side; from P2's, " +
                  passing(tip(kR1) - d - tip(kP2), "P2"));
    all.push_back("R2 goes on from P2's side; from P1's, " +
                  passing(tip(kR2) - d - tip(kP1), "P1"));
    add_planets();
    all.insert(all.end(), notes.begin(), notes.end());
  }

  /// How each planet is turned, and put in.
  void add_planets() {
    auto& all = drawing_.notes;
    const std::vector<PlanetMarks> marks = planet_marks(e_.teeth, e_.planets);
    all.emplace_back(
        "to assemble: hold R1 and R2 with a space on the axis of planet 1, set each planet in its "
        "direction with the mark of P1 turned by psi from the line sun - planet, then the sun "
        "(counter-clockwise, seen as the train is drawn)");
    for (std::size_t i = 0; i < marks.size(); ++i) {
      const double direction_deg = 360.0 * static_cast<double>(i) / e_.planets;
      all.push_back(
          fmt::format("planet {}: direction {:.4f} deg, psi {:.4f} deg, mark of P2 from that of P1 "
                      "{:.4f} deg",
                      i + 1, direction_deg, report::degrees(marks[i].p1_from_axis_rad),
                      report::degrees(marks[i].phase_rad)));
    }
  }

  const design::Design& design_;
  const design::Evaluation& e_;
  AxialPlaces places_;
  std::array<geometry::GearGeometry<double>, train::kGearCount> gears_;
  SectionDrawing drawing_;
  Point low_, high_;                  ///< of the bodies
  double left_ = 0.0, right_ = 0.0;   ///< the outermost columns
  double below_ = 0.0, above_ = 0.0;  ///< the outermost rows
};

}  // namespace

SectionDrawing make_section(const design::Design& design, const design::Evaluation& evaluation,
                            const std::vector<std::string>& notes) {
  return SectionMaker(design, evaluation).make(notes);
}

}  // namespace gear3k::drawing
