#include "drawing/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "drawing/planet_marks.hpp"
#include "report/display.hpp"

namespace gear3k::drawing {

namespace {

using report::degrees, report::mm;
using train::kGearNames, train::kP1, train::kP2, train::kR1, train::kR2, train::kS, train::GearId;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// The fraction numerator/denominator of a turn, modulo 1/teeth of a turn: less than one tooth.
double turned_rad(long long numerator, long long denominator, int teeth) {
  // numerator/denominator = k/teeth + rest/(denominator teeth)
  const long long scaled = numerator * teeth;
  const long long rest = ((scaled % denominator) + denominator) % denominator;
  return kTurn * static_cast<double>(rest) /
         (static_cast<double>(denominator) * static_cast<double>(teeth));
}

/// Orientation (3) of planet i of n: θ_i (1 − zR/zP), modulo one tooth.
double rolled_rad(int planet_teeth, int ring_teeth, int i, int n) {
  return turned_rad(1LL * i * (planet_teeth - ring_teeth), 1LL * n * planet_teeth, planet_teeth);
}

DrawnGear blank_gear(const geometry::GearGeometry<double>& g, GearId id,
                     const design::Masses& masses) {
  DrawnGear drawn;
  drawn.name = kGearNames[id];
  drawn.id = id;
  drawn.reference_radius_m = g.reference_radius_m;
  drawn.base_radius_m = g.base_radius_m;
  drawn.tip_radius_m = g.tip_radius_m;
  drawn.root_radius_m = g.root_radius_m;
  drawn.teeth = g.gear.teeth;
  drawn.module_m = g.gear.module_m;
  drawn.profile_shift = g.gear.profile_shift;
  const double bore = masses.bore_radius_m[id];
  if (train::kind_of(id) == geometry::GearKind::kExternal && bore > 0.0) drawn.bore_radius_m = bore;
  if (id == kP1 || id == kP2) {
    drawn.mark = {.x_m = 0.5 * (g.root_radius_m + g.tip_radius_m), .y_m = 0.0};
  }
  if (id == kR1) drawn.outer_radius_m = masses.ring1_outer_radius_m;
  if (id == kR2) drawn.outer_radius_m = masses.ring2_outer_radius_m;
  return drawn;
}

struct Place {
  double angle_rad = 0.0;
  geometry::Point center;
  int planet = 0;
  double mark_rad = 0.0;  ///< direction of the marked tooth
};

/// A gear drawn at the origin, moved to its place.
DrawnGear moved(DrawnGear gear, const Place& place) {
  gear.angle_rad = place.angle_rad;
  gear.center = place.center;
  gear.planet = place.planet;
  if (place.planet > 0) gear.name += fmt::format("_{}", place.planet);
  gear.contour = geometry::placed(gear.contour, place.angle_rad, place.center);
  if (gear.mark) gear.mark = geometry::placed({*gear.mark}, place.mark_rad, place.center).front();
  return gear;
}

std::string phases_text(const train::Assembly& assembly) {
  std::string phases;
  for (const double phase : assembly.planet_phase_rad) {
    phases += fmt::format("{}{:.4f}", phases.empty() ? "" : ", ", degrees(phase));
  }
  return fmt::format("the planets are not one part: P2 is turned against P1 by {} deg", phases);
}

std::vector<std::string> notes_of(const design::Evaluation& e) {
  std::vector<std::string> notes;
  if (!e.center_distance_given) {
    notes.push_back(
        fmt::format("no center_distance_mm given: drawn at the zero-backlash distance of mesh "
                    "P1-R1, {:.4f} mm",
                    mm(e.center_distance_m)));
  }
  if (!e.assembly.equal_spacing) {
    notes.push_back(fmt::format(
        "{} planets cannot be equally spaced (zS + zR1 = {} is not divisible by {}): the train is "
        "drawn with planet 1 alone",
        e.planets, e.teeth.S + e.teeth.R1, e.planets));
  } else if (!e.assembly.identical_planets) {
    notes.push_back(phases_text(e.assembly));
  }
  if (std::string failed = failed_checks_text(e.checks); !failed.empty()) {
    notes.push_back(std::move(failed));
  }
  return notes;
}

}  // namespace

TrainPlacement place_train(const train::ToothSet& z, int planets) {
  const bool all = train::assembly(z, planets).equal_spacing;
  TrainPlacement placement;
  placement.sun_rad = turned_rad(1LL + z.P1, 2LL * z.S, z.S);
  placement.ring1_rad = turned_rad(1, 2LL * z.R1, z.R1);
  placement.ring2_rad = turned_rad(1, 2LL * z.R2, z.R2);
  for (int i = 0; i < (all ? planets : 1); ++i) {
    placement.planets.push_back({.carrier_rad = kTurn * i / planets,
                                 .p1_rad = rolled_rad(z.P1, z.R1, i, planets),
                                 .p2_rad = rolled_rad(z.P2, z.R2, i, planets)});
  }
  return placement;
}

double drawn_outer_radius(const DrawnGear& ring) {
  return ring.outer_radius_m.value_or(ring.root_radius_m + kDrawnRim * ring.module_m);
}

std::string failed_checks_text(const std::vector<design::CheckResult>& checks) {
  std::string names;
  std::size_t failed = 0;
  for (const design::CheckResult& c : checks) {
    if (c.ok) continue;
    ++failed;
    const std::string subject =
        fmt::format("{}{}{}", c.mesh, c.mesh.empty() || c.gear.empty() ? "" : ", ", c.gear);
    names += fmt::format("{}{}{}", names.empty() ? "" : "; ", c.record->title,
                         subject.empty() ? "" : fmt::format(" ({})", subject));
  }
  if (failed == 0) return "";
  return fmt::format("{} of {} checks failed, drawn all the same: {}", failed, checks.size(),
                     names);
}

DrawingSet make_drawings(const design::Design& design, const design::Evaluation& evaluation,
                         double chord_error_m) {
  train::TrainParameters<double> parameters = design.train;
  parameters.center_distance_m = evaluation.center_distance_m;  // as the KHK tip rule needs it
  const auto gears = train::make_train_gears(parameters);
  DrawingSet set;
  std::vector<DrawnGear> alone;
  for (const GearId id : {kS, kP1, kR1, kP2, kR2}) {
    DrawnGear gear = blank_gear(gears[id], id, design.masses);
    gear.contour = geometry::gear_outline(gears[id], chord_error_m);
    set.drawings.push_back(
        {.name = gear.name, .title = evaluation.name, .remark = "", .gears = {gear}});
    alone.push_back(std::move(gear));
  }

  const TrainPlacement placement = place_train(evaluation.teeth, evaluation.planets);
  const bool complete = evaluation.assembly.equal_spacing;
  Drawing assembled{
      .name = "train",
      .title = evaluation.name,
      .remark = complete ? ""
                         : fmt::format("planet 1 alone: {} planets cannot be equally spaced",
                                       evaluation.planets),
      .gears = {}};
  assembled.gears.push_back(
      moved(alone[kS], {.angle_rad = placement.sun_rad, .center = {}, .planet = 0}));
  assembled.gears.push_back(
      moved(alone[kR1], {.angle_rad = placement.ring1_rad, .center = {}, .planet = 0}));
  assembled.gears.push_back(
      moved(alone[kR2], {.angle_rad = placement.ring2_rad, .center = {}, .planet = 0}));
  const std::vector<PlanetMarks> marks = planet_marks(evaluation.teeth, evaluation.planets);
  int number = 0;
  for (const TrainPlacement::Planet& planet : placement.planets) {
    const geometry::Point center =
        geometry::placed({{.x_m = evaluation.center_distance_m, .y_m = 0.0}}, planet.carrier_rad,
                         {})
            .front();
    const PlanetMarks& mark = marks[static_cast<std::size_t>(number)];
    ++number;
    assembled.gears.push_back(moved(
        alone[kP1],
        {.angle_rad = planet.p1_rad, .center = center, .planet = number, .mark_rad = mark.p1_rad}));
    assembled.gears.push_back(moved(alone[kP2], {.angle_rad = planet.p2_rad,
                                                 .center = center,
                                                 .planet = number,
                                                 .mark_rad = mark.p1_rad + mark.phase_rad}));
  }
  set.drawings.push_back(std::move(assembled));
  set.notes = notes_of(evaluation);
  return set;
}

}  // namespace gear3k::drawing
