#include "drawing/inspection_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "backlash/pitch_grade.hpp"
#include "drawing/planet_marks.hpp"
#include "geometry/tooth_measures.hpp"
#include "report/display.hpp"

namespace gear3k::drawing {

namespace {

using backlash::DeviationLimits, backlash::GearTolerances;
using geometry::GearGeometry, geometry::GearKind;
using report::degrees, report::mm, report::um;

/// One gear and what is known of it.
struct SheetGear {
  GearGeometry<double> geometry{};
  const design::GearResult* result = nullptr;
  std::optional<GearTolerances> tolerances{};
  std::optional<DeviationLimits> thickness_allowance_m{};  ///< as stated
  const design::GearLimits* limits = nullptr;  ///< of the gear as built; null without tolerances
  std::optional<double> active_root_diameter_m{};  ///< the farthest that a mate reaches
  std::optional<double> face_width_m{}, bore_diameter_m{}, outer_diameter_m{};
  std::string material{};
};

/// Lines of one gear.
class SheetRows {
 public:
  explicit SheetRows(const SheetGear& gear) : gear_(gear) {}

  std::vector<Characteristic> take() {
    add_gear();
    add_blank();
    add_teeth();
    add_deviations();
    return std::move(rows_);
  }

 private:
  [[nodiscard]] bool ring() const { return gear_.geometry.gear.kind == GearKind::kRing; }

  Characteristic& add(const char* group, std::string name, std::string symbol, const char* unit,
                      std::optional<double> nominal) {
    return rows_.emplace_back(Characteristic{.group = group,
                                             .name = std::move(name),
                                             .symbol = std::move(symbol),
                                             .unit = unit,
                                             .nominal = nominal,
                                             .lower = {},
                                             .upper = {},
                                             .note = ""});
  }

  /// The gear as drawn with its teeth thicker by an arc on the reference circle.
  [[nodiscard]] GearGeometry<double> thicker(double deviation_m) const {
    GearGeometry<double> g = gear_.geometry;
    g.gear.machining_allowance -= deviation_m * g.angle.cos / g.gear.module_m;
    return g;
  }

  /// Limits of what follows from the thickness of the teeth.
  template <class Measure>
  void limit_by_thickness(Characteristic& row, const Measure& measure) const {
    if (!gear_.tolerances) return;
    const DeviationLimits& limits = gear_.tolerances->tooth_thickness_m;
    if (limits.lower == limits.upper) return;  // not stated
    const std::optional<double> a = measure(thicker(limits.lower));
    const std::optional<double> b = measure(thicker(limits.upper));
    if (!a || !b) return;
    row.lower = std::min(*a, *b);
    row.upper = std::max(*a, *b);
  }

  void add_gear() {
    const geometry::Gear<double>& g = gear_.geometry.gear;
    add("gear", ring() ? "teeth, internal" : "teeth", "z", "", g.teeth);
    add("gear", "module", "m", "mm", mm(g.module_m));
    add("gear", "pressure angle", "alpha", "deg", degrees(gear_.geometry.angle.alpha_rad));
    add("gear", "profile shift", "x", "modules", g.profile_shift).note =
        ring() ? "positive: thinner teeth, larger diameters (KHK)" : "";
    add("gear", "reference diameter", "d", "mm", mm(2.0 * gear_.geometry.reference_radius_m));
    add("gear", "base diameter", "d_b", "mm", mm(2.0 * gear_.geometry.base_radius_m));
    add_tool();
    if (gear_.face_width_m) add("gear", "face width", "b", "mm", mm(*gear_.face_width_m));
    if (!gear_.material.empty()) add("gear", "material", "", "", {}).note = gear_.material;
  }

  /// What cuts the root: with these the gear that is drawn, and rated, can be made.
  void add_tool() {
    const geometry::Gear<double>& g = gear_.geometry.gear;
    const design::ToothResult& tooth = gear_.result->tooth;
    const auto length = [&](const char* name, const char* symbol, double value_m) {
      add("gear", name, symbol, "mm", mm(value_m));
    };
    const bool arc = tooth.tool == geometry::RootTool::kArc;
    const bool cutter = tooth.tool == geometry::RootTool::kCutter;
    add("gear", "dedendum of the tool", "h_fP", "mm", mm(g.rack.dedendum * g.module_m)).note =
        cutter ? fmt::format("pinion cutter of {} teeth", g.cutter.teeth)
        : arc  ? "basic rack; the root is rounded by an arc"
               : "rack";
    if (!cutter) {
      length(arc ? "radius of the root's arc" : "tip rounding of the tool",
             arc ? "rho_F" : "rho_fP", tooth.fillet_radius_m);
      return;
    }
    add("gear", "teeth of the pinion cutter", "z_0", "", g.cutter.teeth);
    add("gear", "profile shift of the pinion cutter", "x_0", "modules", g.cutter.profile_shift);
    length("tip diameter of the pinion cutter", "d_a0", tooth.cutter_tip_diameter_m);
    length("tip rounding of the pinion cutter", "rho_a0", tooth.fillet_radius_m);
  }

  /// The root form diameter with the farthest that a mate's tip reaches.
  void add_form_diameter() {
    Characteristic& form =
        add("blank", "root form diameter", "d_Ff", "mm", mm(gear_.result->tooth.form_diameter_m));
    if (gear_.active_root_diameter_m) {
      (ring() ? form.lower : form.upper) = mm(*gear_.active_root_diameter_m);
      form.note = fmt::format("limit: where the mate's tip reaches {}",
                              gear_.limits != nullptr ? "within the tolerances" : "as drawn");
    }
    if (gear_.limits == nullptr) return;
    const design::BuiltRange& built = gear_.limits->form_diameter_m;
    if (!std::isfinite(built.least) || !std::isfinite(built.greatest)) return;
    form.note += fmt::format("{}built {:.4f} to {:.4f} mm", form.note.empty() ? "" : "; ",
                             mm(built.least), mm(built.greatest));
  }

  void add_blank() {
    const double tip_mm = mm(2.0 * gear_.geometry.tip_radius_m);
    Characteristic& tip = add("blank", "tip diameter", "d_a", "mm", tip_mm);
    if (gear_.tolerances &&
        gear_.tolerances->tip_diameter_m.lower != gear_.tolerances->tip_diameter_m.upper) {
      tip.lower = tip_mm + mm(gear_.tolerances->tip_diameter_m.lower);
      tip.upper = tip_mm + mm(gear_.tolerances->tip_diameter_m.upper);
    }
    const double root_mm = mm(2.0 * gear_.geometry.root_radius_m);
    Characteristic& root = add("blank", "root diameter", "d_f", "mm", root_mm);
    if (gear_.tolerances && gear_.tolerances->root_diameter_m) {
      root.lower = root_mm + mm(gear_.tolerances->root_diameter_m->lower);
      root.upper = root_mm + mm(gear_.tolerances->root_diameter_m->upper);
    } else {
      // The drawn root is that of a tool at nominal depth with thicker teeth; deviations of the
      // thickness from the drawn one are fed in, or all of the allowance by a nominal tool.
      const auto fed_in = [](const GearGeometry<double>& g) -> std::optional<double> {
        return mm(2.0 * geometry::infeed(g).root_radius_m);
      };
      Characteristic nominal_tool{};
      limit_by_thickness(nominal_tool, fed_in);
      if (nominal_tool.lower) {
        const double thicker_tool = root_mm - *fed_in(gear_.geometry);
        root.lower = *nominal_tool.lower + std::min(thicker_tool, 0.0);
        root.upper = *nominal_tool.upper + std::max(thicker_tool, 0.0);
        root.note =
            "limits: of a nominal tool fed in for the tooth thickness, and of one whose teeth are "
            "thicker";
      }
    }
    add_form_diameter();
    if (gear_.bore_diameter_m) add("blank", "bore diameter", "", "mm", mm(*gear_.bore_diameter_m));
    if (gear_.outer_diameter_m)
      add("blank", "outer diameter", "", "mm", mm(*gear_.outer_diameter_m));
  }

  void add_teeth() {
    const GearGeometry<double>& g = gear_.geometry;
    const auto arc = [](const GearGeometry<double>& a) -> std::optional<double> {
      return mm(geometry::reference_tooth_thickness(a));
    };
    limit_by_thickness(add("teeth", "tooth thickness, arc on d", "s_n", "mm", arc(g)), arc);
    const auto allowance = [](const GearGeometry<double>& a) -> std::optional<double> {
      // No thinning is 0, not -0.
      return 0.0 - um(a.gear.module_m * a.gear.machining_allowance) / a.angle.cos;
    };
    Characteristic& a_sn = add("teeth", "thickness allowance", "A_sn", "um", allowance(g));
    limit_by_thickness(a_sn, allowance);
    a_sn.note = "of s_n, from the tooth without backlash";
    if (const auto& stated = gear_.thickness_allowance_m) {
      a_sn.nominal = um(stated->middle());
      a_sn.lower = um(stated->lower);
      a_sn.upper = um(stated->upper);
    }

    if (const auto& span = gear_.result->tooth.span) {
      const int count = span->count;
      const auto length = [&](const GearGeometry<double>& a) -> std::optional<double> {
        // W_k follows the thickness; the number of teeth stays that of the drawn gear.
        return mm(span->length_m + (geometry::reference_tooth_thickness(a) -
                                    geometry::reference_tooth_thickness(g)) *
                                       g.angle.cos * (ring() ? -1.0 : 1.0));
      };
      Characteristic& row =
          add("teeth",
              fmt::format("base tangent length over {} {}", count, ring() ? "spaces" : "teeth"),
              fmt::format("W_{}", count), "mm", mm(span->length_m));
      limit_by_thickness(row, length);
      row.note = fmt::format("touches at {:.3f} mm diameter", mm(2.0 * span->contact_radius_m));
    }
    if (const auto& pins = gear_.result->tooth.pins) {
      const auto over = [&](const GearGeometry<double>& a) -> std::optional<double> {
        const auto m = geometry::pin_measure(a, pins->pin_diameter_m);
        return m ? std::optional(mm(m->over_pins_m)) : std::nullopt;
      };
      Characteristic& row = add("teeth", ring() ? "between two pins" : "over two pins", "M_dR",
                                "mm", mm(pins->over_pins_m));
      limit_by_thickness(row, over);
      row.note = fmt::format("pins of {:.6g} mm, touch at {:.3f} mm diameter",
                             mm(pins->pin_diameter_m), mm(2.0 * pins->contact_radius_m));
    }
    const auto chord = [](const GearGeometry<double>& a) -> std::optional<double> {
      return mm(geometry::chordal_thickness(a).chord_m);
    };
    Characteristic& row = add("teeth", "tooth thickness, chord on d", "s_c", "mm", chord(g));
    limit_by_thickness(row, chord);
    const double height_m = gear_.result->tooth.chordal.height_m;
    row.note = fmt::format("{:.4f} mm {} the tip circle", mm(std::abs(height_m)),
                           height_m < 0.0 ? "beyond" : "below");
  }

  void add_deviations() {
    if (!gear_.tolerances) return;
    const GearTolerances& t = *gear_.tolerances;
    const auto at_most = [&](const char* name, const char* symbol, double limit_m) {
      if (!(limit_m > 0.0)) return;
      add("deviations", name, symbol, "um", {}).upper = um(limit_m);
    };
    const std::size_t before = rows_.size();
    at_most("single pitch deviation", "f_pt", t.single_pitch_m);
    if (rows_.size() > before) rows_.back().lower = -*rows_.back().upper;
    at_most("total cumulative pitch deviation", "F_p", t.cumulative_pitch_m);
    at_most("run-out", "F_r", t.runout_m);
    if (rows_.size() == before) return;
    const std::optional<int> grade = grade_of(gear_.geometry, t);
    if (!grade) return;
    for (std::size_t k = before; k < rows_.size(); ++k)
      rows_[k].note = fmt::format("ISO 1328-1:1995 grade {}", *grade);
  }

  const SheetGear& gear_;
  std::vector<Characteristic> rows_;
};

InspectionSheet sheet_of(std::string name, const std::string& title, const SheetGear& gear) {
  InspectionSheet sheet{
      .name = std::move(name), .title = title, .rows = SheetRows(gear).take(), .notes = {}};
  if (!gear.tolerances) {
    sheet.notes.emplace_back("no tolerances are stated: only nominal values are given");
  }
  if (!gear.result->tooth.span) {
    sheet.notes.emplace_back("no base tangent length: the flanks do not carry one");
  }
  if (!gear.result->tooth.pins) {
    sheet.notes.push_back("no measurement with pins: " + design::why_no_pins(gear.result->tooth));
  }
  return sheet;
}

/// Where a mate's tip reaches on a gear: as built where that is known.
std::optional<double> reached_diameter_m(const std::optional<double>& drawn_m,
                                         const design::BuiltRange* built_m, GearKind kind) {
  if (built_m == nullptr) return drawn_m;
  const double worst_m = kind == GearKind::kRing ? built_m->greatest : built_m->least;
  return std::isfinite(worst_m) ? std::optional(worst_m) : drawn_m;
}

/// Of two active root diameters of a gear the one nearer to its root form circle.
void take_active_root(std::optional<double>& known, std::optional<double> other, GearKind kind) {
  if (!other) return;
  if (!known) {
    known = other;
  } else {
    known = kind == GearKind::kRing ? std::max(*known, *other) : std::min(*known, *other);
  }
}

/// In micrometres, 0 where it is the rounding of positions of some 0.1 m.
double play_um(double backlash_m) {
  constexpr double kRounding_m = 1e-15;
  return std::abs(backlash_m) < kRounding_m ? 0.0 : um(backlash_m);
}

/// The play of a mesh as drawn, to be felt when gear and mate are together.
/// @param built_m  with its limits; null without tolerances
Characteristic backlash_row(std::string_view mate, double normal_backlash_m,
                            const design::BuiltRange* built_m, double center_distance_m) {
  Characteristic row{
      .group = "mesh",
      .name = fmt::format("normal backlash with {}", mate),
      .symbol = "j_bn",
      .unit = "um",
      .nominal = play_um(normal_backlash_m),
      .lower = {},
      .upper = {},
      .note = fmt::format("as drawn, centre distance {:.4f} mm", mm(center_distance_m))};
  if (built_m != nullptr && built_m->least < built_m->greatest) {
    row.lower = play_um(built_m->least);
    row.upper = play_um(built_m->greatest);
  }
  return row;
}

std::string material_of(const std::optional<strength::RatingTask>& rating, std::size_t gear) {
  if (!rating || !rating->material[gear]) return "";
  return std::string(rating->material[gear]->record.name);
}

InspectionSheet planet_sheet(const design::Design& design, const design::Evaluation& e) {
  InspectionSheet sheet{.name = "planet", .title = e.name, .rows = {}, .notes = {}};
  const std::vector<PlanetMarks> marks = planet_marks(e.teeth, e.planets);
  const auto add = [&](const char* group, std::string name, const char* symbol,
                       double nominal) -> Characteristic& {
    return sheet.rows.emplace_back(Characteristic{.group = group,
                                                  .name = std::move(name),
                                                  .symbol = symbol,
                                                  .unit = "deg",
                                                  .nominal = nominal,
                                                  .lower = {},
                                                  .upper = {},
                                                  .note = ""});
  };
  const bool alike = e.assembly.identical_planets || marks.size() == 1;
  for (std::size_t i = 0; i < (alike ? 1 : marks.size()); ++i) {
    Characteristic& row =
        add("phase",
            alike ? "marked tooth of P2 from that of P1"
                  : fmt::format("planet {}: marked tooth of P2 from that of P1", i + 1),
            "phi", degrees(marks[i].phase_rad));
    row.note = "counter-clockwise, seen as drawn";
    if (!design.tolerances) continue;
    const DeviationLimits& limits = design.tolerances->planet_phase_rad;
    if (limits.lower == limits.upper) continue;  // not stated
    row.lower = *row.nominal + degrees(limits.lower);
    row.upper = *row.nominal + degrees(limits.upper);
  }
  if (!e.assembly.equal_spacing) {
    sheet.notes.push_back(
        fmt::format("{} planets cannot be equally spaced: planet 1 alone", e.planets));
  }
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double carrier_deg = 360.0 * static_cast<double>(i) / e.planets;
    add("assembly", fmt::format("planet {}: axis, seen from the sun's", i + 1), "theta",
        carrier_deg);
    add("assembly", fmt::format("planet {}: mark of P1, from the direction of its axis", i + 1),
        "psi", degrees(marks[i].p1_from_axis_rad));
  }
  if (e.assembly.equal_spacing) {
    sheet.notes.emplace_back(
        alike ? "all planets are one part: the marked teeth of P1 and P2 stand as `phi` says"
              : "the planets are different parts: each has its own `phi`");
  }
  sheet.notes.emplace_back(
      "to assemble: hold R1 and R2 with a space on the axis of planet 1 (as the train is drawn), "
      "set each planet with the mark of P1 turned by `psi` from the line sun - planet, then the "
      "sun");
  if (!design.tolerances) {
    sheet.notes.emplace_back("no tolerances are stated: only nominal values are given");
  }
  return sheet;
}

}  // namespace

std::optional<int> grade_of(const GearGeometry<double>& gear, const GearTolerances& tolerances) {
  for (int grade = backlash::kFinestGrade; grade <= backlash::kCoarsestGrade; ++grade) {
    const auto t = backlash::pitch_grade(
        {.module_m = gear.gear.module_m, .reference_diameter_m = 2.0 * gear.reference_radius_m},
        grade);
    if (t && t->single_pitch_m == tolerances.single_pitch_m &&
        t->cumulative_pitch_m == tolerances.cumulative_pitch_m &&
        t->runout_m == tolerances.runout_m) {
      return grade;
    }
  }
  return std::nullopt;
}

std::vector<InspectionSheet> inspection_sheets(const design::Design& design,
                                               const design::Evaluation& evaluation) {
  train::TrainParameters<double> parameters = design.train;
  parameters.center_distance_m = evaluation.center_distance_m;  // as the KHK tip rule needs it
  const auto gears = train::make_train_gears(parameters);
  std::vector<InspectionSheet> sheets;
  for (const train::GearId id : {train::kS, train::kP1, train::kR1, train::kP2, train::kR2}) {
    SheetGear gear{.geometry = gears[id], .result = &evaluation.gears[id]};
    const GearKind kind = gears[id].gear.kind;
    if (design.tolerances) gear.tolerances = design.tolerances->gears[id];
    gear.thickness_allowance_m = design.thickness_allowance_m[id];
    const auto& limits = evaluation.tolerance_limits;
    if (limits) gear.limits = &limits->gears[id];
    for (std::size_t m = 0; m < evaluation.meshes.size(); ++m) {
      for (std::size_t side = 0; side < 2; ++side) {
        if (train::kMeshGears[m][side] != id) continue;
        take_active_root(
            gear.active_root_diameter_m,
            reached_diameter_m(evaluation.meshes[m].active_root_diameter_m[side],
                               limits ? &limits->meshes[m].active_root_diameter_m[side] : nullptr,
                               kind),
            kind);
      }
    }
    gear.face_width_m = design.masses.face_width_m[static_cast<std::size_t>(train::stage_of(id))];
    const double bore_m = design.masses.bore_radius_m[id];
    if (kind == GearKind::kExternal && bore_m > 0.0) gear.bore_diameter_m = 2.0 * bore_m;
    const auto& outer_m =
        id == train::kR1 ? design.masses.ring1_outer_radius_m : design.masses.ring2_outer_radius_m;
    if (kind == GearKind::kRing && outer_m) gear.outer_diameter_m = 2.0 * *outer_m;
    gear.material = material_of(design.rating, id);
    sheets.push_back(sheet_of(std::string(train::kGearNames[id]), evaluation.name, gear));
    for (std::size_t m = 0; m < evaluation.meshes.size(); ++m) {
      for (std::size_t side = 0; side < 2; ++side) {
        if (train::kMeshGears[m][side] != id) continue;
        const auto mate = static_cast<std::size_t>(train::kMeshGears[m][1 - side]);
        sheets.back().rows.push_back(backlash_row(
            train::kGearNames[mate], evaluation.meshes[m].normal_backlash_m,
            limits ? &limits->meshes[m].normal_backlash_m : nullptr, evaluation.center_distance_m));
      }
    }
  }
  sheets.push_back(planet_sheet(design, evaluation));
  return sheets;
}

std::vector<InspectionSheet> inspection_sheets(const design::PairDesign& design,
                                               const design::PairEvaluation& evaluation) {
  const auto gears = design::resolved_gears(design);
  std::vector<InspectionSheet> sheets;
  for (std::size_t i = 0; i < 2; ++i) {
    SheetGear gear{.geometry = gears[i], .result = &evaluation.gears[i]};
    if (design.tolerances) gear.tolerances = design.tolerances->gears[i];
    gear.thickness_allowance_m = design.thickness_allowance_m[i];
    const auto& limits = evaluation.tolerance_limits;
    if (limits) gear.limits = &limits->gears[i];
    gear.active_root_diameter_m = reached_diameter_m(
        evaluation.mesh.active_root_diameter_m[i],
        limits ? &limits->meshes.front().active_root_diameter_m[i] : nullptr, gears[i].gear.kind);
    if (design.rating) gear.face_width_m = design.rating->face_width_m[0];
    gear.material = material_of(design.rating, i);
    sheets.push_back(sheet_of(fmt::format("gear{}", i + 1), evaluation.name, gear));
  }
  return sheets;
}

}  // namespace gear3k::drawing
