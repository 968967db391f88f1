#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/text/printable.hpp"
#include "report/analysis_report.hpp"
#include "report/built_series_report.hpp"
#include "report/check_subject.hpp"
#include "report/display.hpp"
#include "report/first_screen.hpp"
#include "report/mass_report.hpp"
#include "report/operation_report.hpp"
#include "report/sensitivity_report.hpp"
#include "report/strength_report.hpp"
#include "report/text_table.hpp"
#include "report/thermal_report.hpp"
#include "report/tolerance_report.hpp"
#include "report/torque_angle_report.hpp"

namespace gear3k::report {

namespace {

using design::CheckResult, design::Evaluation, design::GearResult, design::MeshResult,
    design::PairEvaluation, units::Unit;

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
  std::string without;
  for (const GearResult& g : gears) {
    if (!g.tooth.pins) without += fmt::format("  {}: {}\n", g.name, design::why_no_pins(g.tooth));
  }
  return "\nTeeth and measures (mm; rings: span over spaces, pins between; x_E and its root: if a "
         "nominal tool is fed deeper to thin the teeth)\n" +
         table.text(2) + without;
}

std::string mesh_table(const std::vector<MeshResult>& meshes) {
  const auto efficiency = [](double eta) {
    return std::isfinite(eta) ? fmt::format("{:.5f}", eta) : std::string("undefined");
  };
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
         efficiency(m.efficiency_forward), efficiency(m.efficiency_backward)});
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

/// Digits by unit: what a workshop can tell apart.
std::string with_check_unit(const CheckResult& c, double value) {
  const Unit unit = c.record->unit;
  const std::string name(units::unit_name(unit));
  const int digits = unit == Unit::kMicrometre || unit == Unit::kArcmin ? 2 : 4;
  return fmt::format("{}{}{}", fixed(value, digits), name.empty() ? "" : " ", name);
}

std::string in_check_unit(const CheckResult& c, double si) {
  return with_check_unit(c, units::from_si(si, c.record->unit));
}

std::string margin_text(const CheckResult& c) {
  return with_check_unit(c, units::difference_from_si(c.margin, c.record->unit));
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
               limit_text(c), margin_text(c), std::string(c.record->name)});
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
                 margin_text(c)});
      first = false;
    }
  }
  return fmt::format("\nChecks: {} of {} passed\n", passed, checks.size()) + table.text(2);
}

std::string paragraph(const std::string& line) { return line.empty() ? "" : "\n" + line + "\n"; }

std::string note_lines(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += fmt::format("\nNote: {}", io::printable(note));
  return text.empty() ? "" : text + "\n";
}

/// What an evaluation is silent about, as its file has no table of it.
template <class Result>
std::string not_checked(const Result& e) {
  std::vector<std::string> missing;
  if (!e.strength) missing.emplace_back("strength (no [strength])");
  for (const std::string& what : not_judged(e)) {
    missing.push_back(fmt::format("{} (no limit stress of the material is stated)", what));
  }
  if (!e.tolerance_limits) missing.emplace_back("tolerances (no [tolerances])");
  return missing.empty() ? "" : fmt::format("Not checked: {}.", fmt::join(missing, ", "));
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

/// Names of both gears of every mesh.
std::vector<std::array<std::string, 2>> mesh_gear_names() {
  std::vector<std::array<std::string, 2>> gears;
  gears.reserve(train::kMeshGears.size());
  for (const auto& [first, second] : train::kMeshGears) {
    gears.push_back({std::string(train::kGearNames[static_cast<std::size_t>(first)]),
                     std::string(train::kGearNames[static_cast<std::size_t>(second)])});
  }
  return gears;
}

/// Part of a train's whole table.
std::string section_text(Section section, const Evaluation& e, const design::Sensitivities& s,
                         const design::BuiltSeries* built) {
  switch (section) {
    case Section::kGears:
      return gear_table(e.gears);
    case Section::kTeeth:
      return tooth_table(e.gears);
    case Section::kMeshes:
      return mesh_table(e.meshes);
    case Section::kLosses:
      return operation_table(e);
    case Section::kStrength:
      return strength_table(e);
    case Section::kFlanks:
      return flank_table(e.meshes, mesh_gear_names());
    case Section::kPhases:
      return phase_table(e.meshes);
    case Section::kMasses:
      return mass_table(e);
    case Section::kChecks:
      return passed_table(e.checks);
    case Section::kTolerances:
      return tolerance_table(e.tolerance_limits);
    case Section::kThermal:
      return thermal_table(e.thermal);
    case Section::kBuilt:
      return built != nullptr ? built_series_table(*built) : "";
    case Section::kSensitivities:
      return sensitivity_table(s);
    case Section::kNotes:
      break;
  }
  return note_lines(e.notes);
}

/// The same of a pair, which has fewer parts.
std::string section_text(Section section, const PairEvaluation& e) {
  switch (section) {
    case Section::kGears:
      return gear_table(e.gears);
    case Section::kTeeth:
      return tooth_table(e.gears);
    case Section::kMeshes:
      return mesh_table({e.mesh});
    case Section::kStrength:
      return strength_table(e);
    case Section::kFlanks:
      return flank_table({e.mesh}, {{"1", "2"}});
    case Section::kPhases:
      return phase_table({e.mesh});
    case Section::kChecks:
      return passed_table(e.checks);
    case Section::kTolerances:
      return tolerance_table(e.tolerance_limits);
    case Section::kNotes:
      return note_lines(e.notes);
    default:
      return "";
  }
}

/// Why a part that is asked for has nothing in it.
template <class Result>
std::string lacking_text(Section section, const Result& e) {
  const auto without = [](std::string_view what, std::string_view table) {
    return fmt::format("\n{}: nothing without {}\n", what, table);
  };
  switch (section) {
    case Section::kLosses:
      return without("Losses", "[operating_point]");
    case Section::kStrength:
      return without("Strength", "[strength]");
    case Section::kTolerances:
      return without("Limits of the built gearing", "[tolerances]");
    case Section::kThermal:
      return without("Temperature", "[thermal]");
    case Section::kBuilt:
      return without("Built gearboxes", "[tolerances]");
    case Section::kMasses:
      if constexpr (requires { e.total_mass_missing; }) {
        return fmt::format("\nMasses: not known: lacks {}\n", e.total_mass_missing);
      }
      break;
    case Section::kNotes:
      return "\nNotes: none\n";
    case Section::kChecks:
      return "";  // all failed, and were told
    default:
      break;
  }
  return fmt::format("\nNothing to show of {}\n", kSectionNames[static_cast<std::size_t>(section)]);
}

/// A part that is asked for by name.
template <class Result>
std::string part_or_lack(const std::string& text, Section section, const Result& e) {
  return text.empty() ? lacking_text(section, e) : text;
}

constexpr std::array kAllSections{Section::kGears,         Section::kTeeth,    Section::kMeshes,
                                  Section::kLosses,        Section::kStrength, Section::kFlanks,
                                  Section::kPhases,        Section::kMasses,   Section::kChecks,
                                  Section::kTolerances,    Section::kThermal,  Section::kBuilt,
                                  Section::kSensitivities, Section::kNotes};

/// Failed checks in full where the checks are asked for.
bool shows_checks(const TableChoice& choice) {
  return std::ranges::find(choice.sections, Section::kChecks) != choice.sections.end();
}

}  // namespace

std::string not_checked_text(const Evaluation& e) { return not_checked(e); }
std::string not_checked_text(const PairEvaluation& e) { return not_checked(e); }

std::string analysis_table(const Evaluation& e, const design::Sensitivities& s,
                           const ModelUse* model, const design::BuiltSeries* built,
                           const design::TorqueAngleCurve* curve) {
  std::string text;
  text += fmt::format("{}: S {} / P1 {} / R1 {} / P2 {} / R2 {}, {} planets\n",
                      e.name.empty() ? "gearbox" : io::printable(e.name), e.teeth.S, e.teeth.P1,
                      e.teeth.R1, e.teeth.P2, e.teeth.R2, e.planets);
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
  const auto& share = e.lost_motion.kinematic_share_rad;
  table.add({"  lost motion at output",
             fmt::format("{} arcmin, kinematic   (S-P1 {}, P1-R1 {}, P2-R2 {}; by the paper's eq. "
                         "17: {})",
                         fixed(arcmin(e.lost_motion.kinematic_rad), 2), fixed(arcmin(share[0]), 2),
                         fixed(arcmin(share[1]), 2), fixed(arcmin(share[2]), 2),
                         fixed(arcmin(e.lost_motion.paper_rad), 2))});
  if (e.lost_motion.measured_rad) {
    table.add(
        {"  lost motion, measured",
         fmt::format(
             "{} arcmin with the model, {}", fixed(arcmin(*e.lost_motion.measured_rad), 2),
             e.operation ? "between +T and -T of the operating point" : "at T = 0 and 20 C")});
  }
  if (curve != nullptr) table.add({"  wind-up at output", torque_angle_summary(*curve)});
  table.add({"  lost motion at input",
             fmt::format("{:.1f} arcmin", arcmin(e.lost_motion.input_kinematic_rad))});
  table.add({"  effective inertia", inertia_text(e)});
  table.add({"  assembly", assembly_text(e)});
  if (model != nullptr) {
    table.add({"  model", model->file});
    for (const std::string& line : cause_lines(*model)) table.add({"", "  " + line});
  }
  text += table.text(0);
  text += failed_table(e.checks);
  for (const Section section : kAllSections) text += section_text(section, e, s, built);
  return text + paragraph(not_checked(e));
}

std::string analysis_table(const PairEvaluation& e) {
  std::string text =
      fmt::format("{}: centre distance {:.4f} mm{}\n",
                  e.name.empty() ? "pair" : io::printable(e.name), mm(e.center_distance_m),
                  e.center_distance_given ? "" : " (zero-backlash distance)") +
      failed_table(e.checks);
  for (const Section section : kAllSections) text += section_text(section, e);
  return text + paragraph(not_checked(e));
}

std::string analysis_text(const Evaluation& e, const std::vector<design::TightestCheck>& tightest,
                          const TableChoice& choice, const design::Sensitivities& s,
                          const ModelUse* model, const design::BuiltSeries* built,
                          const design::TorqueAngleCurve* curve,
                          std::optional<double> outer_diameter_m) {
  if (choice.full) return analysis_table(e, s, model, built, curve);
  std::string text = first_screen(e, tightest, built, choice.columns, outer_diameter_m);
  if (model != nullptr) {
    text += broken(fmt::format("Model: {}: {}", model->file, fmt::join(cause_lines(*model), "; ")),
                   choice.columns, 4);
  }
  if (shows_checks(choice)) text += failed_table(e.checks);
  for (const Section section : choice.sections) {
    text += part_or_lack(section_text(section, e, s, built), section, e);
  }
  return text;
}

std::string analysis_text(const PairEvaluation& e,
                          const std::vector<design::TightestCheck>& tightest,
                          const TableChoice& choice) {
  if (choice.full) return analysis_table(e);
  std::string text = first_screen(e, tightest, choice.columns);
  if (shows_checks(choice)) text += failed_table(e.checks);
  for (const Section section : choice.sections) {
    text += part_or_lack(section_text(section, e), section, e);
  }
  return text;
}

}  // namespace gear3k::report
