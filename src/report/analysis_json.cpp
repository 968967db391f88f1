#include <algorithm>

#include "io/text/json.hpp"
#include "report/analysis_report.hpp"
#include "report/display.hpp"
#include "report/mass_report.hpp"
#include "report/operation_report.hpp"
#include "report/sensitivity_report.hpp"
#include "report/tolerance_report.hpp"
#include "report/yield_report.hpp"

namespace gear3k::report {

namespace {

using design::CheckResult, design::Evaluation, design::GearResult, design::MeshResult,
    design::PairEvaluation, design::Unit;

io::Json mesh_json(const MeshResult& m) {
  return {{"name", m.name},
          {"working_pressure_angle_deg", degrees(m.working_pressure_angle_rad)},
          {"zero_backlash_center_distance_mm", if_any(m.zero_backlash_center_distance_m, mm)},
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
          {"active_root_diameter_mm",
           list_json(m.active_root_diameter_m, [](const auto& d) { return if_any(d, mm); })},
          {"root_clearance_mm", list_json(m.root_clearance_m, mm)},
          {"specific_sliding_tip",
           list_json(m.tip_sliding, [](const auto& t) { return t.specific_at_tip; })},
          {"specific_sliding_root",
           {m.tip_sliding[1].specific_at_root, m.tip_sliding[0].specific_at_root}},
          {"sliding_factor_tip",
           list_json(m.tip_sliding, [](const auto& t) { return t.sliding_factor; })}};
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

io::Json tooth_json(const design::ToothResult& t) {
  io::Json json{{"root", root_name(t.tool)},
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

io::Json gear_json(const GearResult& g) {
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

io::Json check_json(const CheckResult& c) {
  io::Json json{{"name", c.record->name}, {"group", c.record->group}};
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

}  // namespace

std::string analysis_json(const Evaluation& e, const design::Sensitivities& s,
                          const ModelUse* model, const design::BuiltSeries* built) {
  io::Json json{{"tool", tool_json()},
                {"name", e.name},
                {"planets", e.planets},
                {"ratio", e.ratio},
                {"g1", e.g1},
                {"g2", e.g2},
                {"center_distance_mm", mm(e.center_distance_m)},
                {"center_distance_given", e.center_distance_given},
                {"module_mm", {mm(e.module_m[0]), mm(e.module_m[1])}},
                {"efficiency",
                 {{"forward", e.efficiency.forward},
                  {"backward", e.efficiency.backward},
                  {"backdrivable", e.efficiency.backdrivable},
                  {"backdriving_margin", e.efficiency.backdriving_margin}}},
                {"meshes", list_json(e.meshes, mesh_json)},
                {"gears", list_json(e.gears, gear_json)},
                {"backlash",
                 {{"paper_arcmin", arcmin(e.backlash.paper_rad)},
                  {"kinematic_arcmin", arcmin(e.backlash.kinematic_rad)},
                  {"input_kinematic_arcmin", arcmin(e.backlash.input_kinematic_rad)}}}};
  if (e.backlash.measured_rad) {
    json["backlash"]["measured_arcmin"] = arcmin(*e.backlash.measured_rad);
  }
  if (e.inertia) {
    json["inertia"] = {{"backward_kgm2", e.inertia->backward_kgm2},
                       {"forward_kgm2", e.inertia->forward_kgm2},
                       {"lossless_kgm2", e.inertia->lossless_kgm2},
                       {"paper_kgm2", e.inertia->paper_kgm2}};
  } else {
    json["inertia"] = nullptr;
  }
  add_masses(json, e);
  add_operation(json, e);
  json["assembly"] = {{"equal_spacing", e.assembly.equal_spacing},
                      {"identical_planets", e.assembly.identical_planets},
                      {"planet_phase_deg", list_json(e.assembly.planet_phase_rad, degrees)}};
  json["checks"] = list_json(e.checks, check_json);
  add_tolerances(json, e.tolerance_limits);
  if (built != nullptr) json["built"] = yield_json(*built);
  add_sensitivities(json, s);
  if (model != nullptr) add_model(json, *model);
  json["notes"] = e.notes;
  return json.text();
}

std::string analysis_json(const PairEvaluation& e) {
  io::Json json{{"tool", tool_json()},
                {"name", e.name},
                {"center_distance_mm", mm(e.center_distance_m)},
                {"center_distance_given", e.center_distance_given},
                {"meshes", list_json(std::vector<MeshResult>{e.mesh}, mesh_json)},
                {"gears", list_json(e.gears, gear_json)},
                {"checks", list_json(e.checks, check_json)}};
  add_tolerances(json, e.tolerance_limits);
  json["notes"] = e.notes;
  return json.text();
}

}  // namespace gear3k::report
