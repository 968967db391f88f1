#include <fmt/format.h>

#include "report/analysis_report.hpp"
#include "report/built_series_report.hpp"
#include "report/check_subject.hpp"
#include "report/display.hpp"
#include "report/fields.hpp"
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

/// Parts of the CSV, in their order; what is said of the train itself comes before them.
enum Part : int {
  kMeshes = 20,
  kGears,
  kChecks,
  kTolerances,
  kBuilt,
  kOperation,
  kMasses,
  kInputs,
  kStrength,
  kTorqueAngle,
  kThermal
};

Fields mesh_fields(const MeshResult& m) {
  Fields f(m.name);
  f.add("name", m.name);
  f.add("working_pressure_angle_deg", degrees(m.working_pressure_angle_rad),
        {"working_pressure_angle", "deg"});
  f.add("zero_backlash_center_distance_mm", if_any(m.zero_backlash_center_distance_m, mm),
        {"zero_backlash_center_distance", "mm"});
  f.add("contact_ratio", m.contact_ratio, {"contact_ratio"});
  f.add("approach_contact_ratio", m.approach_contact_ratio, {"approach_contact_ratio"});
  f.add("recess_contact_ratio", m.recess_contact_ratio, {"recess_contact_ratio"});
  f.add("normal_backlash_um", um(m.normal_backlash_m), {"normal_backlash", "um"});
  f.add("friction_forward", m.friction_forward, {"friction_forward"});
  f.add("friction_backward", m.friction_backward, {"friction_backward"});
  f.add("efficiency_forward", m.efficiency_forward, {"efficiency_forward"});
  f.add("efficiency_backward", m.efficiency_backward, {"efficiency_backward"});
  f.add("loss_model_in_range", m.loss_model_in_range, {"loss_model_in_range"});
  f.add("hunting_period_teeth", m.hunting_period_teeth, {"hunting_period", "teeth", 1});
  f.add("common_factor", m.common_factor, {"common_factor"});
  f.add("planet_phase", io::Json::array());
  for (std::size_t k = 0; k < m.planet_phase.size(); ++k) {
    f.append("planet_phase", m.planet_phase[k], {fmt::format("phase_planet{}", k), "pitch", 3});
  }
  for (const std::size_t i : {0U, 1U}) {
    const std::string of = fmt::format("_gear{}", i + 1);
    const geometry::TipSliding& tip = m.tip_sliding[i];
    f.append("active_root_diameter_mm", if_any(m.active_root_diameter_m[i], mm),
             {"active_root_diameter" + of, "mm", 2});
    f.append("root_clearance_mm", mm(m.root_clearance_m[i]), {"root_clearance" + of, "mm", 2});
    f.append("specific_sliding_tip", tip.specific_at_tip, {"specific_sliding_tip" + of, "", 2});
    f.append("specific_sliding_root", m.tip_sliding[1 - i].specific_at_root,
             {"specific_sliding_root" + of, "", 2});
    f.append("sliding_factor_tip", tip.sliding_factor, {"sliding_factor_tip" + of, "", 2});
  }
  return f;
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

Fields tooth_fields(const std::string& gear, const design::ToothResult& t) {
  Fields f(gear);
  f.add("root", root_name(t.tool));
  f.add("form_diameter_mm", mm(t.form_diameter_m), {"form_diameter", "mm"});
  f.add("undercut", t.undercut, {"undercut"});
  f.add("fillet_radius_mm", mm(t.fillet_radius_m), {"fillet_radius", "mm", 5});
  f.add("full_round", t.full_round, {"full_round"});
  f.add("form_circle_thickness_mm", mm(t.form_thickness_m), {"form_circle_thickness", "mm", 4});
  f.add("root_space_width_mm", if_any(t.root_space_m, mm), {"root_space_width", "mm", 2});
  f.add("span", nullptr);
  if (t.span) {
    Fields span(gear);
    span.add("count", t.span->count, {"span_count", "", 6});
    span.add("length_mm", mm(t.span->length_m), {"span", "mm", 6});
    span.add("contact_diameter_mm", 2.0 * mm(t.span->contact_radius_m),
             {"span_contact_diameter", "mm", 6});
    f.add("span", std::move(span));
  }
  f.add("pins", nullptr);
  if (t.pins) {
    Fields pins(gear);
    pins.add("pin_diameter_mm", mm(t.pins->pin_diameter_m), {"pin_diameter", "mm", 6});
    pins.add("over_pins_mm", mm(t.pins->over_pins_m), {"over_pins", "mm", 6});
    pins.add("contact_diameter_mm", 2.0 * mm(t.pins->contact_radius_m),
             {"pin_contact_diameter", "mm", 6});
    f.add("pins", std::move(pins));
  }
  f.add("fitting_pins", nullptr);
  if (t.fitting_pins) {
    Fields fitting(gear);
    fitting.add("least_mm", mm(t.fitting_pins->least_m), {"least_pin_diameter", "mm", 6});
    fitting.add("greatest_mm", mm(t.fitting_pins->greatest_m), {"greatest_pin_diameter", "mm", 6});
    f.add("fitting_pins", std::move(fitting));
  }
  f.add("chordal_thickness_mm", mm(t.chordal.chord_m), {"chordal_thickness", "mm", 6});
  f.add("chordal_height_mm", mm(t.chordal.height_m), {"chordal_height", "mm", 6});
  Fields infeed(gear);
  infeed.add("profile_shift", t.infeed.profile_shift, {"infeed_profile_shift", "module", 1});
  infeed.add("root_diameter_mm", 2.0 * mm(t.infeed.root_radius_m),
             {"infeed_root_diameter", "mm", 1});
  f.add("infeed", std::move(infeed));
  f.add("cutter", nullptr);
  if (t.cutter_teeth > 0) {
    Fields cutter(gear);
    cutter.add("teeth", t.cutter_teeth, {"cutter_teeth", "", 3});
    cutter.add("tip_diameter_mm", mm(t.cutter_tip_diameter_m), {"cutter_tip_diameter", "mm", 3});
    cutter.add("center_distance_mm", mm(t.cutter_center_distance_m),
               {"cutter_center_distance", "mm", 3});
    f.add("cutter", std::move(cutter));
  }
  return f;
}

Fields gear_fields(const GearResult& g) {
  Fields f(g.name);
  f.add("name", g.name);
  f.add("teeth", g.teeth, {"teeth"});
  f.add("profile_shift", g.profile_shift, {"profile_shift", "module"});
  f.add("pitch_diameter_mm", mm(g.pitch_diameter_m), {"pitch_diameter", "mm"});
  f.add("base_diameter_mm", mm(g.base_diameter_m), {"base_diameter", "mm"});
  f.add("tip_diameter_mm", mm(g.tip_diameter_m), {"tip_diameter", "mm"});
  f.add("root_diameter_mm", mm(g.root_diameter_m), {"root_diameter", "mm"});
  f.add("tip_thickness_mm", mm(g.tip_thickness_m), {"tip_thickness", "mm"});
  f.add("tip_shortening", g.tip_shortening, {"tip_shortening", "module"});
  f.add("tooth", tooth_fields(g.name, g.tooth));
  return f;
}

Fields check_fields(const CheckResult& c) {
  Fields f(subject_of(c));
  f.add("name", c.record->name);
  f.add("group", c.record->group);
  if (!c.mesh.empty()) f.add("mesh", c.mesh);
  if (!c.gear.empty()) f.add("gear", c.gear);
  const Unit unit = c.record->unit;
  const double limit = units::from_si(c.limit, unit);
  f.add("value", units::from_si(c.value, unit),
        {.quantity = fmt::format("check {}", c.record->name),
         .unit = std::string(units::unit_name(unit)),
         .limit = exact(limit),
         .ok = c.ok ? "true" : "false"});
  f.add("limit", limit);
  f.add("margin", units::difference_from_si(c.margin, unit));
  f.add("unit", units::unit_name(unit));
  f.add("ok", c.ok);
  return f;
}

Fields efficiency_fields(const Evaluation& e) {
  Fields f("train");
  f.add("forward", e.efficiency.forward, {"efficiency_forward", "", 4});
  f.add("backward", e.efficiency.backward, {"efficiency_backward", "", 4});
  f.add("backdrivable", e.efficiency.backdrivable);
  f.add("backdriving_margin", e.efficiency.backdriving_margin, {"backdriving_margin", "", 4});
  return f;
}

Fields backlash_fields(const Evaluation& e) {
  Fields f("train");
  f.add("paper_arcmin", arcmin(e.lost_motion.paper_rad), {"lost_motion_paper", "arcmin", 6});
  f.add("kinematic_arcmin", arcmin(e.lost_motion.kinematic_rad),
        {"lost_motion_kinematic", "arcmin", 5});
  f.add("input_kinematic_arcmin", arcmin(e.lost_motion.input_kinematic_rad),
        {"lost_motion_input_kinematic", "arcmin", 6});
  if (e.lost_motion.measured_rad) {
    f.add("measured_arcmin", arcmin(*e.lost_motion.measured_rad),
          {"lost_motion_measured", "arcmin", 6});
  }
  return f;
}

Fields inertia_fields(const design::InertiaResult& inertia) {
  Fields f("train");
  f.add("backward_kgm2", inertia.backward_kgm2, {"inertia_backward", "kg m2", 8});
  f.add("forward_kgm2", inertia.forward_kgm2, {"inertia_forward", "kg m2", 8});
  f.add("lossless_kgm2", inertia.lossless_kgm2, {"inertia_lossless", "kg m2", 7});
  f.add("paper_kgm2", inertia.paper_kgm2, {"inertia_paper", "kg m2", 8});
  return f;
}

Fields assembly_fields(const Evaluation& e) {
  Fields f;
  f.add("equal_spacing", e.assembly.equal_spacing);
  f.add("identical_planets", e.assembly.identical_planets);
  f.add("planet_phase_deg", io::Json::array());
  for (std::size_t k = 0; k < e.assembly.planet_phase_rad.size(); ++k) {
    f.append("planet_phase_deg", degrees(e.assembly.planet_phase_rad[k]),
             {"phase", "deg", 9, fmt::format("planet {}", k)});
  }
  return f;
}

Fields analysis_fields(const Evaluation& e, const design::Sensitivities& s, const ModelUse* model,
                       const design::BuiltSeries* built, const design::TorqueAngleCurve* curve) {
  Fields f("train");
  f.add("tool", tool_json());
  f.add("name", e.name);
  f.add("planets", e.planets, {"planets", "", 2});
  f.add("ratio", e.ratio, {"ratio"});
  f.add("g1", e.g1, {"g1", "", 3});
  f.add("g2", e.g2, {"g2", "", 3});
  f.add("center_distance_mm", mm(e.center_distance_m), {"center_distance", "mm", 1});
  f.add("center_distance_given", e.center_distance_given);
  for (const std::size_t k : {0U, 1U}) {
    f.append("module_mm", mm(e.module_m[k]), {"module", "mm", 3, fmt::format("stage {}", k + 1)});
  }
  f.add("efficiency", efficiency_fields(e));
  f.add_list("meshes", e.meshes, mesh_fields, kMeshes);
  f.add_list("gears", e.gears, gear_fields, kGears);
  f.add("backlash", backlash_fields(e));
  f.add("inertia", nullptr);
  if (e.inertia) f.add("inertia", inertia_fields(*e.inertia));
  f.join(mass_fields(e).at_rank(kMasses));
  f.add("operating_point", nullptr);
  if (e.operation) {
    f.add("operating_point", operating_point_fields(*e.operation).at_rank(kOperation));
  }
  f.add("strength", nullptr);
  if (e.strength) f.add("strength", strength_fields(e).at_rank(kStrength));
  f.add("torque_angle", nullptr);
  if (curve != nullptr) {
    f.add("torque_angle", torque_angle_fields(*curve).at_rank(kTorqueAngle));
  }
  f.add("assembly", assembly_fields(e));
  f.add_list("checks", e.checks, check_fields, kChecks);
  if (e.tolerance_limits) {
    f.add("tolerances", tolerance_fields(*e.tolerance_limits).at_rank(kTolerances));
  }
  if (e.thermal) f.add("thermal", thermal_fields(*e.thermal).at_rank(kThermal));
  if (built != nullptr) f.add("built", built_series_fields(*built).at_rank(kBuilt));
  f.join(sensitivity_fields(s).at_rank(kInputs));
  if (model != nullptr) f.add("model", model_json(*model));
  f.add("notes", e.notes);
  return f;
}

Fields analysis_fields(const PairEvaluation& e) {
  Fields f("pair");
  f.add("tool", tool_json());
  f.add("name", e.name);
  f.add("center_distance_mm", mm(e.center_distance_m), {"center_distance", "mm"});
  f.add("center_distance_given", e.center_distance_given);
  f.append("meshes", mesh_fields(e.mesh).at_rank(kMeshes));
  f.add_list("gears", e.gears, gear_fields, kGears);
  f.add("strength", nullptr);
  if (e.strength) f.add("strength", strength_fields(e).at_rank(kStrength));
  f.add_list("checks", e.checks, check_fields, kChecks);
  if (e.tolerance_limits) {
    f.add("tolerances", tolerance_fields(*e.tolerance_limits).at_rank(kTolerances));
  }
  f.add("notes", e.notes);
  return f;
}

}  // namespace

io::Json analysis_json(const Evaluation& e, const design::Sensitivities& s, const ModelUse* model,
                       const design::BuiltSeries* built, const design::TorqueAngleCurve* curve) {
  return analysis_fields(e, s, model, built, curve).json();
}
io::Json analysis_json(const PairEvaluation& e) { return analysis_fields(e).json(); }

Fields analysis_quantities(const Evaluation& e) {
  return analysis_fields(e, {}, nullptr, nullptr, nullptr);
}

std::string analysis_csv(const Evaluation& e, const design::Sensitivities& s,
                         const design::BuiltSeries* built, const design::TorqueAngleCurve* curve) {
  return kRowsHeader + analysis_fields(e, s, nullptr, built, curve).csv_rows();
}
std::string analysis_csv(const PairEvaluation& e) {
  return kRowsHeader + analysis_fields(e).csv_rows();
}

}  // namespace gear3k::report
