#include <fmt/format.h>

#include <cmath>

#include "report/analysis_report.hpp"
#include "report/check_subject.hpp"
#include "report/display.hpp"
#include "report/mass_report.hpp"
#include "report/operation_report.hpp"
#include "report/sensitivity_report.hpp"
#include "report/text_table.hpp"
#include "report/tolerance_report.hpp"
#include "report/yield_report.hpp"

namespace gear3k::report {

namespace {

using design::CheckResult, design::Evaluation, design::GearResult, design::MeshResult,
    design::PairEvaluation, design::Unit;

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

std::string analysis_csv(const Evaluation& e, const design::Sensitivities& s,
                         const design::BuiltSeries* built) {
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
  if (e.backlash.measured_rad) {
    rows.add("train", "lost_motion_measured", arcmin(*e.backlash.measured_rad), "arcmin");
  }
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
  return rows.text() + tolerance_csv(e.tolerance_limits) +
         (built != nullptr ? yield_csv(*built) : "") + operation_csv(e) + mass_csv(e) +
         sensitivity_csv(s);
}

std::string analysis_csv(const PairEvaluation& e) {
  CsvRows rows;
  rows.add("pair", "center_distance", mm(e.center_distance_m), "mm");
  rows.add_mesh(e.mesh);
  for (const GearResult& g : e.gears) rows.add_gear(g);
  for (const CheckResult& c : e.checks) rows.add_check(c);
  return rows.text() + tolerance_csv(e.tolerance_limits);
}

}  // namespace gear3k::report
