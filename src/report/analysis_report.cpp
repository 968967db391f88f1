#include "report/analysis_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "report/display.hpp"
#include "report/mass_report.hpp"
#include "report/operation_report.hpp"
#include "report/sensitivity_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::CheckResult, design::Evaluation, design::GearResult, design::MeshResult,
    design::PairEvaluation, design::Unit;
using nlohmann::ordered_json;

// --- tables

std::string gear_table(const std::vector<GearResult>& gears) {
  TextTable table({"gear", "teeth", "shift x", "tip shortening", "pitch dia", "base dia", "tip dia",
                   "form dia", "root dia", "tip thickness"});
  for (const GearResult& g : gears) {
    table.add(
        {g.name, fmt::format("{}", g.teeth), fmt::format("{:.4f}", g.profile_shift),
         fmt::format("{:.4f}", g.tip_shortening), fmt::format("{:.4f}", mm(g.pitch_diameter_m)),
         fmt::format("{:.4f}", mm(g.base_diameter_m)), fmt::format("{:.4f}", mm(g.tip_diameter_m)),
         fmt::format("{:.4f}{}", mm(g.tooth.form_diameter_m), g.tooth.undercut ? " u" : ""),
         fmt::format("{:.4f}", mm(g.root_diameter_m)),
         fmt::format("{:.4f}", mm(g.tip_thickness_m))});
  }
  const bool undercut =
      std::ranges::any_of(gears, [](const GearResult& g) { return g.tooth.undercut; });
  return "\nGears (mm; shift and shortening in modules; the involute begins, on a ring ends, at "
         "the form circle)\n" +
         table.text(2) + (undercut ? "  u = undercut\n" : "");
}

std::string tool_name(const design::ToothResult& t) {
  switch (t.tool) {
    case geometry::RootTool::kRack:
      return "rack";
    case geometry::RootTool::kCutter:
      return fmt::format("cutter z {}, dia {:.4f}", t.cutter_teeth, mm(t.cutter_tip_diameter_m));
    case geometry::RootTool::kArc:
      break;
  }
  return "arc";
}

std::string tooth_table(const std::vector<GearResult>& gears) {
  TextTable table({"gear", "root cut by", "rounding", "thickness at form dia", "span W_k", "k",
                   "pin", "over pins", "chord", "chord height", "x_E", "root dia by infeed"});
  table.align_left(1);
  for (const GearResult& g : gears) {
    const design::ToothResult& t = g.tooth;
    const auto length = [](double value_m) { return fmt::format("{:.4f}", mm(value_m)); };
    table.add({g.name, tool_name(t), length(t.fillet_radius_m) + (t.full_round ? " full" : ""),
               length(t.form_thickness_m), t.span ? length(t.span->length_m) : "none",
               t.span ? fmt::format("{}", t.span->count) : "",
               t.pins ? length(t.pins->pin_diameter_m) : "none",
               t.pins ? length(t.pins->over_pins_m) : "none", length(t.chordal.chord_m),
               length(t.chordal.height_m), fmt::format("{:.4f}", t.infeed.profile_shift),
               length(2.0 * t.infeed.root_radius_m)});
  }
  return "\nTeeth and measures (mm; rings: span over spaces, pins between; x_E and its root: if a "
         "nominal tool is fed deeper to thin the teeth)\n" +
         table.text(2);
}

std::string mesh_table(const std::vector<MeshResult>& meshes) {
  TextTable table({"mesh", "working angle", "zero-backlash d", "contact ratio", "approach",
                   "recess", "backlash j_bn", "eta forward", "eta backward"});
  for (const MeshResult& m : meshes) {
    table.add(
        {m.name, fmt::format("{:.4f} deg", degrees(m.working_pressure_angle_rad)),
         m.zero_backlash_center_distance_m
             ? fmt::format("{:.4f} mm", mm(*m.zero_backlash_center_distance_m))
             : "none",
         fmt::format("{:.3f}", m.contact_ratio), fmt::format("{:.3f}", m.approach_contact_ratio),
         fmt::format("{:.3f}", m.recess_contact_ratio), fixed(um(m.normal_backlash_m), 2) + " um",
         fmt::format("{:.5f}", m.efficiency_forward),
         fmt::format("{:.5f}", m.efficiency_backward)});
  }
  return "\nMeshes (approach and recess of the forward drive direction)\n" + table.text(2);
}

std::string or_none(double value) { return std::isfinite(value) ? fixed(value, 3) : "none"; }

std::string flank_table(const std::vector<MeshResult>& meshes,
                        const std::vector<std::array<std::string, 2>>& gears) {
  TextTable table({"mesh", "gear", "active flank from dia", "tip clearance", "sliding at tip",
                   "sliding at root", "K_g at tip"});
  table.align_left(1);
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const MeshResult& m = meshes[k];
    for (const std::size_t i : {0U, 1U}) {
      const auto& active = m.active_root_diameter_m[i];
      table.add({i == 0 ? m.name : "", gears[k][i],
                 active ? fmt::format("{:.4f}", mm(*active)) : "beyond base",
                 fmt::format("{:.4f}", mm(m.root_clearance_m[i])),
                 or_none(m.tip_sliding[i].specific_at_tip),
                 or_none(m.tip_sliding[1 - i].specific_at_root),
                 fixed(m.tip_sliding[i].sliding_factor, 3)});
    }
  }
  return "\nFlanks (mm; clearance of the tip to its mate's root; specific sliding, its value over "
         "the pitch-line speed K_g)\n" +
         table.text(2);
}

std::string phase_table(const std::vector<MeshResult>& meshes) {
  TextTable table({"mesh", "common factor", "same teeth meet after", "phase of each planet"});
  table.align_left(3);
  for (const MeshResult& m : meshes) {
    std::string phases;
    for (const double phase : m.planet_phase) {
      phases += fmt::format("{}{:.4f}", phases.empty() ? "" : ", ", phase);
    }
    table.add({m.name,
               fmt::format("{}{}", m.common_factor, m.common_factor == 1 ? " (hunting)" : ""),
               fmt::format("{} teeth", m.hunting_period_teeth), phases});
  }
  return "\nTooth numbers and mesh phases (share of a pitch by which each planet's mesh is ahead "
         "of the first's)\n" +
         table.text(2);
}

double or_nan(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

std::string subject_of(const CheckResult& c) {
  if (!c.mesh.empty() && !c.gear.empty()) return fmt::format("{}, {}", c.mesh, c.gear);
  return c.mesh + c.gear;
}

/// Digits by unit: what a workshop can tell apart.
std::string in_check_unit(const CheckResult& c, double si) {
  const Unit unit = c.record->unit;
  const double value = design::in_unit(si, unit);
  const std::string name(design::unit_name(unit));
  const int digits = unit == Unit::kMicrometre || unit == Unit::kArcmin ? 2 : 4;
  return fmt::format("{}{}{}", fixed(value, digits), name.empty() ? "" : " ", name);
}

std::string limit_text(const CheckResult& c) {
  return fmt::format("{} {}", c.record->at_least ? ">=" : "<=", in_check_unit(c, c.limit));
}

/// Every check that failed, one row each; nothing when all passed.
std::string failed_table(const std::vector<CheckResult>& checks) {
  TextTable table({"", "check", "of", "value", "limit", "margin", "key in [limits]"});
  for (const std::size_t column : {1U, 2U, 6U}) table.align_left(column);
  std::size_t failed = 0;
  for (const CheckResult& c : checks) {
    if (c.ok) continue;
    ++failed;
    table.add({"FAILED", std::string(c.record->title), subject_of(c), in_check_unit(c, c.value),
               limit_text(c), in_check_unit(c, c.margin), std::string(c.record->name)});
  }
  if (failed == 0) return "";
  return fmt::format("\nChecks: {} of {} failed\n", failed, checks.size()) + table.text(2);
}

/// The checks that passed, by group: of each the subject with the least margin.
std::string passed_table(const std::vector<CheckResult>& checks) {
  struct Row {
    const CheckResult* tightest = nullptr;
    int count = 0;
  };
  std::vector<Row> rows;
  std::vector<std::string_view> groups;
  std::size_t passed = 0;
  for (const CheckResult& c : checks) {
    if (!c.ok) continue;
    ++passed;
    auto row =
        std::ranges::find_if(rows, [&](const Row& r) { return r.tightest->record == c.record; });
    if (row == rows.end()) {
      rows.push_back({.tightest = &c, .count = 1});
      if (std::ranges::find(groups, c.record->group) == groups.end()) {
        groups.push_back(c.record->group);
      }
    } else {
      ++row->count;
      if (c.margin < row->tightest->margin) row->tightest = &c;
    }
  }
  if (rows.empty()) return "";
  TextTable table({"", "group", "check", "tightest", "of", "value", "limit", "margin"});
  for (const std::size_t column : {1U, 2U, 3U}) table.align_left(column);
  for (const std::string_view group : groups) {
    bool first = true;
    for (const Row& row : rows) {
      const CheckResult& c = *row.tightest;
      if (c.record->group != group) continue;
      table.add({"ok", first ? std::string(group) : "", std::string(c.record->title), subject_of(c),
                 fmt::format("{}", row.count), in_check_unit(c, c.value), limit_text(c),
                 in_check_unit(c, c.margin)});
      first = false;
    }
  }
  return fmt::format("\nChecks: {} of {} passed\n", passed, checks.size()) + table.text(2);
}

std::string note_lines(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += fmt::format("\nNote: {}", note);
  return text.empty() ? "" : text + "\n";
}

std::string assembly_text(const Evaluation& e) {
  if (!e.assembly.equal_spacing) {
    return fmt::format("{} planets cannot be equally spaced: zS + zR1 = {} is not divisible by {}",
                       e.planets, e.teeth.S + e.teeth.R1, e.planets);
  }
  if (e.assembly.identical_planets) {
    return fmt::format("{} identical planets fit at equal spacing", e.planets);
  }
  std::string phases;
  for (const double phase : e.assembly.planet_phase_rad) {
    phases += fmt::format("{}{:.4f}", phases.empty() ? "" : ", ", degrees(phase));
  }
  return fmt::format(
      "{} planets fit at equal spacing, but not as one part: P2 against P1 turned by {} deg "
      "(modulo {:.4f} deg)",
      e.planets, phases,
      360.0 / static_cast<double>(train::hunting_period_teeth(e.teeth.P1, e.teeth.P2)));
}

std::string backward_text(const design::EfficiencyResult& e) {
  if (!e.backward) return "undefined";
  if (!e.backdrivable) {
    return fmt::format("not back-drivable (margin {:.4f})", e.backdriving_margin);
  }
  return fmt::format("{:.2f} %   (back-drivable, margin {:.4f})", 100.0 * *e.backward,
                     e.backdriving_margin);
}

std::string inertia_text(const Evaluation& e) {
  if (!e.inertia) return fmt::format("not known: lacks {}", e.inertia_missing);
  const auto value = [](const std::optional<double>& x) {
    return x ? fmt::format("{:.4e}", *x) : std::string("locked");
  };
  return fmt::format(
      "at output {} kg m2 (lossless {:.4e}; the paper's eq. 32: {}), at sun {} kg m2",
      value(e.inertia->backward_kgm2), e.inertia->lossless_kgm2,
      e.inertia->paper_kgm2 ? value(e.inertia->paper_kgm2) : std::string("undefined"),
      value(e.inertia->forward_kgm2));
}

// --- JSON

template <class Items, class ToJson>
ordered_json list_json(const Items& items, ToJson to_json) {
  ordered_json list = ordered_json::array();
  for (const auto& item : items) list.push_back(to_json(item));
  return list;
}

/// A number, or null where there is none (NaN, infinite).
ordered_json finite_json(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json mesh_json(const MeshResult& m) {
  std::optional<double> zero = m.zero_backlash_center_distance_m;
  if (zero) zero = mm(*zero);
  return {{"name", m.name},
          {"working_pressure_angle_deg", degrees(m.working_pressure_angle_rad)},
          {"zero_backlash_center_distance_mm", number_or_null(zero)},
          {"contact_ratio", m.contact_ratio},
          {"approach_contact_ratio", m.approach_contact_ratio},
          {"recess_contact_ratio", m.recess_contact_ratio},
          {"normal_backlash_um", um(m.normal_backlash_m)},
          {"friction_forward", m.friction_forward},
          {"friction_backward", m.friction_backward},
          {"efficiency_forward", m.efficiency_forward},
          {"efficiency_backward", m.efficiency_backward},
          {"loss_model_in_range", m.loss_model_in_range},
          {"hunting_period_teeth", m.hunting_period_teeth},
          {"common_factor", m.common_factor},
          {"planet_phase", m.planet_phase},
          {"active_root_diameter_mm", list_json(m.active_root_diameter_m,
                                                [](const std::optional<double>& d) {
                                                  return d ? ordered_json(mm(*d))
                                                           : ordered_json(nullptr);
                                                })},
          {"root_clearance_mm", list_json(m.root_clearance_m, mm)},
          {"specific_sliding_tip",
           list_json(m.tip_sliding, [](const auto& t) { return finite_json(t.specific_at_tip); })},
          {"specific_sliding_root",
           {finite_json(m.tip_sliding[1].specific_at_root),
            finite_json(m.tip_sliding[0].specific_at_root)}},
          {"sliding_factor_tip",
           list_json(m.tip_sliding, [](const auto& t) { return finite_json(t.sliding_factor); })}};
}

std::string_view root_name(geometry::RootTool tool) {
  switch (tool) {
    case geometry::RootTool::kRack:
      return "rack";
    case geometry::RootTool::kCutter:
      return "cutter";
    case geometry::RootTool::kArc:
      break;
  }
  return "arc";
}

ordered_json tooth_json(const design::ToothResult& t) {
  ordered_json json{{"root", root_name(t.tool)},
                    {"form_diameter_mm", mm(t.form_diameter_m)},
                    {"undercut", t.undercut},
                    {"fillet_radius_mm", mm(t.fillet_radius_m)},
                    {"full_round", t.full_round},
                    {"form_circle_thickness_mm", mm(t.form_thickness_m)},
                    {"root_space_width_mm", nullptr},
                    {"span", nullptr},
                    {"pins", nullptr},
                    {"chordal_thickness_mm", mm(t.chordal.chord_m)},
                    {"chordal_height_mm", mm(t.chordal.height_m)},
                    {"infeed",
                     {{"profile_shift", t.infeed.profile_shift},
                      {"root_diameter_mm", 2.0 * mm(t.infeed.root_radius_m)}}},
                    {"cutter", nullptr}};
  if (t.root_space_m) json["root_space_width_mm"] = mm(*t.root_space_m);
  if (t.span) {
    json["span"] = {{"count", t.span->count},
                    {"length_mm", mm(t.span->length_m)},
                    {"contact_diameter_mm", 2.0 * mm(t.span->contact_radius_m)}};
  }
  if (t.pins) {
    json["pins"] = {{"pin_diameter_mm", mm(t.pins->pin_diameter_m)},
                    {"over_pins_mm", mm(t.pins->over_pins_m)},
                    {"contact_diameter_mm", 2.0 * mm(t.pins->contact_radius_m)}};
  }
  if (t.cutter_teeth > 0) {
    json["cutter"] = {{"teeth", t.cutter_teeth},
                      {"tip_diameter_mm", mm(t.cutter_tip_diameter_m)},
                      {"center_distance_mm", mm(t.cutter_center_distance_m)}};
  }
  return json;
}

ordered_json gear_json(const GearResult& g) {
  return {{"name", g.name},
          {"teeth", g.teeth},
          {"profile_shift", g.profile_shift},
          {"pitch_diameter_mm", mm(g.pitch_diameter_m)},
          {"base_diameter_mm", mm(g.base_diameter_m)},
          {"tip_diameter_mm", mm(g.tip_diameter_m)},
          {"root_diameter_mm", mm(g.root_diameter_m)},
          {"tip_thickness_mm", mm(g.tip_thickness_m)},
          {"tip_shortening", g.tip_shortening},
          {"tooth", tooth_json(g.tooth)}};
}

ordered_json check_json(const CheckResult& c) {
  ordered_json json{{"name", c.record->name}, {"group", c.record->group}};
  if (!c.mesh.empty()) json["mesh"] = c.mesh;
  if (!c.gear.empty()) json["gear"] = c.gear;
  const Unit unit = c.record->unit;
  json["value"] = design::in_unit(c.value, unit);
  json["limit"] = design::in_unit(c.limit, unit);
  json["margin"] = design::in_unit(c.margin, unit);
  json["unit"] = design::unit_name(unit);
  json["ok"] = c.ok;
  return json;
}

// --- CSV

class CsvRows {
 public:
  void add(const std::string& item, const std::string& quantity, double value,
           const std::string& unit) {
    if (std::isnan(value)) return;
    text_ += csv_line({item, quantity, exact(value), unit, "", ""});
  }
  void add_mesh(const MeshResult& m) {
    add(m.name, "working_pressure_angle", degrees(m.working_pressure_angle_rad), "deg");
    if (m.zero_backlash_center_distance_m) {
      add(m.name, "zero_backlash_center_distance", mm(*m.zero_backlash_center_distance_m), "mm");
    }
    add(m.name, "contact_ratio", m.contact_ratio, "");
    add(m.name, "approach_contact_ratio", m.approach_contact_ratio, "");
    add(m.name, "recess_contact_ratio", m.recess_contact_ratio, "");
    add(m.name, "normal_backlash", um(m.normal_backlash_m), "um");
    add(m.name, "efficiency_forward", m.efficiency_forward, "");
    add(m.name, "efficiency_backward", m.efficiency_backward, "");
    add(m.name, "common_factor", m.common_factor, "");
    add(m.name, "hunting_period", static_cast<double>(m.hunting_period_teeth), "teeth");
    for (const std::size_t i : {0U, 1U}) {
      const std::string of = fmt::format("_gear{}", i + 1);
      if (m.active_root_diameter_m[i]) {
        add(m.name, "active_root_diameter" + of, mm(*m.active_root_diameter_m[i]), "mm");
      }
      add(m.name, "root_clearance" + of, mm(m.root_clearance_m[i]), "mm");
      add(m.name, "specific_sliding_tip" + of, m.tip_sliding[i].specific_at_tip, "");
      add(m.name, "specific_sliding_root" + of, m.tip_sliding[1 - i].specific_at_root, "");
      add(m.name, "sliding_factor_tip" + of, m.tip_sliding[i].sliding_factor, "");
    }
    for (std::size_t k = 0; k < m.planet_phase.size(); ++k) {
      add(m.name, fmt::format("phase_planet{}", k), m.planet_phase[k], "pitch");
    }
  }
  void add_gear(const GearResult& g) {
    add(g.name, "teeth", g.teeth, "");
    add(g.name, "profile_shift", g.profile_shift, "module");
    add(g.name, "pitch_diameter", mm(g.pitch_diameter_m), "mm");
    add(g.name, "base_diameter", mm(g.base_diameter_m), "mm");
    add(g.name, "tip_diameter", mm(g.tip_diameter_m), "mm");
    add(g.name, "root_diameter", mm(g.root_diameter_m), "mm");
    add(g.name, "tip_thickness", mm(g.tip_thickness_m), "mm");
    add(g.name, "tip_shortening", g.tip_shortening, "module");
    add(g.name, "form_diameter", mm(g.tooth.form_diameter_m), "mm");
    add(g.name, "undercut", g.tooth.undercut ? 1.0 : 0.0, "");
    add(g.name, "full_round", g.tooth.full_round ? 1.0 : 0.0, "");
    add(g.name, "infeed_profile_shift", g.tooth.infeed.profile_shift, "module");
    add(g.name, "infeed_root_diameter", 2.0 * mm(g.tooth.infeed.root_radius_m), "mm");
    if (g.tooth.root_space_m) add(g.name, "root_space_width", mm(*g.tooth.root_space_m), "mm");
    if (g.tooth.cutter_teeth > 0) {
      add(g.name, "cutter_tip_diameter", mm(g.tooth.cutter_tip_diameter_m), "mm");
      add(g.name, "cutter_center_distance", mm(g.tooth.cutter_center_distance_m), "mm");
    }
    add(g.name, "form_circle_thickness", mm(g.tooth.form_thickness_m), "mm");
    add(g.name, "fillet_radius", mm(g.tooth.fillet_radius_m), "mm");
    if (g.tooth.span) {
      add(g.name, "span_count", g.tooth.span->count, "");
      add(g.name, "span", mm(g.tooth.span->length_m), "mm");
    }
    if (g.tooth.pins) {
      add(g.name, "pin_diameter", mm(g.tooth.pins->pin_diameter_m), "mm");
      add(g.name, "over_pins", mm(g.tooth.pins->over_pins_m), "mm");
    }
    add(g.name, "chordal_thickness", mm(g.tooth.chordal.chord_m), "mm");
    add(g.name, "chordal_height", mm(g.tooth.chordal.height_m), "mm");
  }
  void add_check(const CheckResult& c) {
    const Unit unit = c.record->unit;
    text_ += csv_line({subject_of(c), fmt::format("check {}", c.record->name),
                       exact(design::in_unit(c.value, unit)), std::string(design::unit_name(unit)),
                       exact(design::in_unit(c.limit, unit)), c.ok ? "true" : "false"});
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_ = "item,quantity,value,unit,limit,ok\n";
};

}  // namespace

std::string analysis_table(const Evaluation& e, const design::Sensitivities& s) {
  std::string text;
  text += fmt::format("{}: S {} / P1 {} / R1 {} / P2 {} / R2 {}, {} planets\n",
                      e.name.empty() ? "gearbox" : e.name, e.teeth.S, e.teeth.P1, e.teeth.R1,
                      e.teeth.P2, e.teeth.R2, e.planets);
  TextTable table({"  ratio", fmt::format("{:.4f}:1   (G1 {:.5f}, G2 {:.5f}){}", e.ratio, e.g1,
                                          e.g2, e.g2 > 1.0 ? ", output turns backwards" : "")});
  table.align_left(1);
  table.add({"  module", fmt::format("stage 1 {:.5g} mm, stage 2 {:.5g} mm", mm(e.module_m[0]),
                                     mm(e.module_m[1]))});
  table.add({"  centre distance",
             fmt::format("{:.4f} mm{}", mm(e.center_distance_m),
                         e.center_distance_given ? "" : " (zero-backlash distance of P1-R1)")});
  table.add({"  efficiency forward", e.efficiency.forward
                                         ? fmt::format("{:.2f} %", 100.0 * *e.efficiency.forward)
                                         : std::string("undefined")});
  table.add({"  efficiency backward", backward_text(e.efficiency)});
  if (e.operation) table.add({"  with all losses", operation_summary(e)});
  const auto& share = e.backlash.kinematic_share_rad;
  table.add({"  lost motion at output",
             fmt::format("{} arcmin, kinematic   (S-P1 {}, P1-R1 {}, P2-R2 {}; by the paper's eq. "
                         "17: {})",
                         fixed(arcmin(e.backlash.kinematic_rad), 2), fixed(arcmin(share[0]), 2),
                         fixed(arcmin(share[1]), 2), fixed(arcmin(share[2]), 2),
                         fixed(arcmin(e.backlash.paper_rad), 2))});
  table.add({"  lost motion at input",
             fmt::format("{:.1f} arcmin", arcmin(e.backlash.input_kinematic_rad))});
  table.add({"  effective inertia", inertia_text(e)});
  table.add({"  assembly", assembly_text(e)});
  text += table.text(0);
  std::vector<std::array<std::string, 2>> gears;
  gears.reserve(train::kMeshGears.size());
  for (const auto& [first, second] : train::kMeshGears) {
    gears.push_back({std::string(train::kGearNames[static_cast<std::size_t>(first)]),
                     std::string(train::kGearNames[static_cast<std::size_t>(second)])});
  }
  return text + failed_table(e.checks) + gear_table(e.gears) + tooth_table(e.gears) +
         mesh_table(e.meshes) + operation_table(e) + flank_table(e.meshes, gears) +
         phase_table(e.meshes) + mass_table(e) + passed_table(e.checks) + sensitivity_table(s) +
         note_lines(e.notes) + "\nNot checked by this version: strength, tolerances.\n";
}

std::string analysis_table(const PairEvaluation& e) {
  return fmt::format("{}: centre distance {:.4f} mm{}\n", e.name.empty() ? "pair" : e.name,
                     mm(e.center_distance_m),
                     e.center_distance_given ? "" : " (zero-backlash distance)") +
         failed_table(e.checks) + gear_table(e.gears) + tooth_table(e.gears) +
         mesh_table({e.mesh}) + flank_table({e.mesh}, {{"1", "2"}}) + phase_table({e.mesh}) +
         passed_table(e.checks) + note_lines(e.notes) +
         "\nNot checked by this version: strength, tolerances.\n";
}

std::string analysis_json(const Evaluation& e, const design::Sensitivities& s) {
  ordered_json json{{"tool", tool_json()},
                    {"name", e.name},
                    {"planets", e.planets},
                    {"ratio", e.ratio},
                    {"g1", e.g1},
                    {"g2", e.g2},
                    {"center_distance_mm", mm(e.center_distance_m)},
                    {"center_distance_given", e.center_distance_given},
                    {"module_mm", {mm(e.module_m[0]), mm(e.module_m[1])}},
                    {"efficiency",
                     {{"forward", number_or_null(e.efficiency.forward)},
                      {"backward", number_or_null(e.efficiency.backward)},
                      {"backdrivable", e.efficiency.backdrivable},
                      {"backdriving_margin", e.efficiency.backdriving_margin}}},
                    {"meshes", list_json(e.meshes, mesh_json)},
                    {"gears", list_json(e.gears, gear_json)},
                    {"backlash",
                     {{"paper_arcmin", arcmin(e.backlash.paper_rad)},
                      {"kinematic_arcmin", arcmin(e.backlash.kinematic_rad)},
                      {"input_kinematic_arcmin", arcmin(e.backlash.input_kinematic_rad)}}}};
  if (e.inertia) {
    json["inertia"] = {{"backward_kgm2", number_or_null(e.inertia->backward_kgm2)},
                       {"forward_kgm2", number_or_null(e.inertia->forward_kgm2)},
                       {"lossless_kgm2", e.inertia->lossless_kgm2},
                       {"paper_kgm2", number_or_null(e.inertia->paper_kgm2)}};
  } else {
    json["inertia"] = nullptr;
  }
  add_masses(json, e);
  add_operation(json, e);
  json["assembly"] = {{"equal_spacing", e.assembly.equal_spacing},
                      {"identical_planets", e.assembly.identical_planets},
                      {"planet_phase_deg", list_json(e.assembly.planet_phase_rad, degrees)}};
  json["checks"] = list_json(e.checks, check_json);
  add_sensitivities(json, s);
  json["notes"] = e.notes;
  return json.dump(2) + "\n";
}

std::string analysis_json(const PairEvaluation& e) {
  const ordered_json json{{"tool", tool_json()},
                          {"name", e.name},
                          {"center_distance_mm", mm(e.center_distance_m)},
                          {"center_distance_given", e.center_distance_given},
                          {"meshes", list_json(std::vector<MeshResult>{e.mesh}, mesh_json)},
                          {"gears", list_json(e.gears, gear_json)},
                          {"checks", list_json(e.checks, check_json)},
                          {"notes", e.notes}};
  return json.dump(2) + "\n";
}

std::string analysis_csv(const Evaluation& e, const design::Sensitivities& s) {
  CsvRows rows;
  rows.add("train", "ratio", e.ratio, "");
  rows.add("train", "center_distance", mm(e.center_distance_m), "mm");
  rows.add("train", "planets", e.planets, "");
  rows.add("train", "g1", e.g1, "");
  rows.add("train", "g2", e.g2, "");
  rows.add("stage 1", "module", mm(e.module_m[0]), "mm");
  rows.add("stage 2", "module", mm(e.module_m[1]), "mm");
  rows.add("train", "efficiency_forward", or_nan(e.efficiency.forward), "");
  rows.add("train", "efficiency_backward", or_nan(e.efficiency.backward), "");
  rows.add("train", "backdriving_margin", e.efficiency.backdriving_margin, "");
  rows.add("train", "lost_motion_kinematic", arcmin(e.backlash.kinematic_rad), "arcmin");
  rows.add("train", "lost_motion_paper", arcmin(e.backlash.paper_rad), "arcmin");
  rows.add("train", "lost_motion_input_kinematic", arcmin(e.backlash.input_kinematic_rad),
           "arcmin");
  if (e.inertia) {
    rows.add("train", "inertia_lossless", e.inertia->lossless_kgm2, "kg m2");
    if (e.inertia->backward_kgm2) {
      rows.add("train", "inertia_backward", *e.inertia->backward_kgm2, "kg m2");
    }
    if (e.inertia->forward_kgm2) {
      rows.add("train", "inertia_forward", *e.inertia->forward_kgm2, "kg m2");
    }
  }
  if (e.inertia && e.inertia->paper_kgm2) {
    rows.add("train", "inertia_paper", *e.inertia->paper_kgm2, "kg m2");
  }
  for (std::size_t k = 0; k < e.assembly.planet_phase_rad.size(); ++k) {
    rows.add(fmt::format("planet {}", k), "phase", degrees(e.assembly.planet_phase_rad[k]), "deg");
  }
  for (const MeshResult& m : e.meshes) rows.add_mesh(m);
  for (const GearResult& g : e.gears) rows.add_gear(g);
  for (const CheckResult& c : e.checks) rows.add_check(c);
  return rows.text() + operation_csv(e) + mass_csv(e) + sensitivity_csv(s);
}

std::string analysis_csv(const PairEvaluation& e) {
  CsvRows rows;
  rows.add("pair", "center_distance", mm(e.center_distance_m), "mm");
  rows.add_mesh(e.mesh);
  for (const GearResult& g : e.gears) rows.add_gear(g);
  for (const CheckResult& c : e.checks) rows.add_check(c);
  return rows.text();
}

}  // namespace gear3k::report
