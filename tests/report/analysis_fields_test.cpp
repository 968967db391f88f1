#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "io/text/csv_table.hpp"
#include "report/analysis_report.hpp"
#include "report/fields.hpp"
#include "tests/report/all_numbers.hpp"

namespace gear3k::report::analysis_fields_test {
namespace {

using nlohmann::json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kArcmins = 60.0 * kDegrees;

design::MeshResult any_mesh(EachAnother& value) {
  design::MeshResult m{};
  m.name = "S-P1";
  for (double* member : {&m.working_pressure_angle_rad, &m.contact_ratio, &m.approach_contact_ratio,
                         &m.recess_contact_ratio, &m.normal_backlash_m, &m.friction_forward,
                         &m.friction_backward, &m.efficiency_forward, &m.efficiency_backward}) {
    *member = value();
  }
  m.zero_backlash_center_distance_m = value();
  m.hunting_period_teeth = 12345;
  m.common_factor = 17;
  for (const std::size_t k : {0U, 1U}) {
    m.active_root_diameter_m[k] = value();
    m.root_clearance_m[k] = value();
    geometry::TipSliding& tip = m.tip_sliding[k];
    for (double* member : {&tip.specific_at_tip, &tip.specific_at_root, &tip.sliding_factor}) {
      *member = value();
    }
  }
  m.planet_phase = {value(), value()};
  return m;
}

/// Where the tip of one gear touches, the other slides at its root.
Numbers numbers_of_mesh(const design::MeshResult& m) {
  return {{"/working_pressure_angle_deg", m.working_pressure_angle_rad * kDegrees},
          {"/zero_backlash_center_distance_mm", *m.zero_backlash_center_distance_m * 1e3},
          {"/contact_ratio", m.contact_ratio},
          {"/approach_contact_ratio", m.approach_contact_ratio},
          {"/recess_contact_ratio", m.recess_contact_ratio},
          {"/normal_backlash_um", m.normal_backlash_m * 1e6},
          {"/friction_forward", m.friction_forward},
          {"/friction_backward", m.friction_backward},
          {"/efficiency_forward", m.efficiency_forward},
          {"/efficiency_backward", m.efficiency_backward},
          {"/hunting_period_teeth", 12345.0},
          {"/common_factor", 17.0},
          {"/planet_phase/0", m.planet_phase[0]},
          {"/planet_phase/1", m.planet_phase[1]},
          {"/active_root_diameter_mm/0", *m.active_root_diameter_m[0] * 1e3},
          {"/active_root_diameter_mm/1", *m.active_root_diameter_m[1] * 1e3},
          {"/root_clearance_mm/0", m.root_clearance_m[0] * 1e3},
          {"/root_clearance_mm/1", m.root_clearance_m[1] * 1e3},
          {"/specific_sliding_tip/0", m.tip_sliding[0].specific_at_tip},
          {"/specific_sliding_tip/1", m.tip_sliding[1].specific_at_tip},
          {"/specific_sliding_root/0", m.tip_sliding[1].specific_at_root},
          {"/specific_sliding_root/1", m.tip_sliding[0].specific_at_root},
          {"/sliding_factor_tip/0", m.tip_sliding[0].sliding_factor},
          {"/sliding_factor_tip/1", m.tip_sliding[1].sliding_factor}};
}

design::ToothResult any_tooth(EachAnother& value) {
  design::ToothResult t{};
  for (double* member :
       {&t.form_diameter_m, &t.fillet_radius_m, &t.form_thickness_m, &t.chordal.chord_m,
        &t.chordal.height_m, &t.infeed.profile_shift, &t.infeed.root_radius_m,
        &t.cutter_tip_diameter_m, &t.cutter_center_distance_m}) {
    *member = value();
  }
  t.root_space_m = value();
  t.span = {.count = 3, .length_m = value(), .contact_radius_m = value()};
  t.pins = {.pin_diameter_m = value(), .over_pins_m = value(), .contact_radius_m = value()};
  t.fitting_pins = {.least_m = value(), .greatest_m = value()};
  t.cutter_teeth = 29;
  t.undercut = true;
  return t;
}

Numbers numbers_of_tooth(const design::ToothResult& t) {
  return {{"/form_diameter_mm", t.form_diameter_m * 1e3},
          {"/fillet_radius_mm", t.fillet_radius_m * 1e3},
          {"/form_circle_thickness_mm", t.form_thickness_m * 1e3},
          {"/root_space_width_mm", *t.root_space_m * 1e3},
          {"/span/count", 3.0},
          {"/span/length_mm", t.span->length_m * 1e3},
          {"/span/contact_diameter_mm", 2.0 * t.span->contact_radius_m * 1e3},
          {"/pins/pin_diameter_mm", t.pins->pin_diameter_m * 1e3},
          {"/pins/over_pins_mm", t.pins->over_pins_m * 1e3},
          {"/pins/contact_diameter_mm", 2.0 * t.pins->contact_radius_m * 1e3},
          {"/fitting_pins/least_mm", t.fitting_pins->least_m * 1e3},
          {"/fitting_pins/greatest_mm", t.fitting_pins->greatest_m * 1e3},
          {"/chordal_thickness_mm", t.chordal.chord_m * 1e3},
          {"/chordal_height_mm", t.chordal.height_m * 1e3},
          {"/infeed/profile_shift", t.infeed.profile_shift},
          {"/infeed/root_diameter_mm", 2.0 * t.infeed.root_radius_m * 1e3},
          {"/cutter/teeth", 29.0},
          {"/cutter/tip_diameter_mm", t.cutter_tip_diameter_m * 1e3},
          {"/cutter/center_distance_mm", t.cutter_center_distance_m * 1e3}};
}

design::GearResult any_gear(EachAnother& value) {
  design::GearResult g{};
  g.name = "P1";
  g.teeth = 37;
  for (double* member :
       {&g.profile_shift, &g.tip_shortening, &g.pitch_diameter_m, &g.base_diameter_m,
        &g.tip_diameter_m, &g.root_diameter_m, &g.tip_thickness_m}) {
    *member = value();
  }
  g.tooth = any_tooth(value);
  return g;
}

Numbers numbers_of_gear(const design::GearResult& g) {
  Numbers stated = at_path("/tooth", numbers_of_tooth(g.tooth));
  stated.merge(Numbers{{"/teeth", 37.0},
                       {"/profile_shift", g.profile_shift},
                       {"/tip_shortening", g.tip_shortening},
                       {"/pitch_diameter_mm", g.pitch_diameter_m * 1e3},
                       {"/base_diameter_mm", g.base_diameter_m * 1e3},
                       {"/tip_diameter_mm", g.tip_diameter_m * 1e3},
                       {"/root_diameter_mm", g.root_diameter_m * 1e3},
                       {"/tip_thickness_mm", g.tip_thickness_m * 1e3}});
  return stated;
}

design::Evaluation any_train(EachAnother& value) {
  design::Evaluation e{};
  e.planets = 5;
  for (double* member : {&e.ratio, &e.g1, &e.g2, &e.center_distance_m, &e.module_m[0],
                         &e.module_m[1], &e.efficiency.backdriving_margin, &e.lost_motion.paper_rad,
                         &e.lost_motion.kinematic_rad, &e.lost_motion.input_kinematic_rad}) {
    *member = value();
  }
  e.efficiency.forward = value();
  e.efficiency.backward = value();
  e.lost_motion.measured_rad = value();
  e.inertia = design::InertiaResult{.lossless_kgm2 = value(),
                                    .backward_kgm2 = value(),
                                    .forward_kgm2 = value(),
                                    .paper_kgm2 = value()};
  design::PartMass& part = e.parts.emplace_back();
  part.name = "P1";
  part.count = 7;
  part.mass_kg = value();
  part.inertia_kgm2 = value();
  e.total_mass_kg = value();
  e.assembly.planet_phase_rad = {value(), value()};
  return e;
}

Numbers numbers_of_train(const design::Evaluation& e) {
  return {{"/planets", 5.0},
          {"/ratio", e.ratio},
          {"/g1", e.g1},
          {"/g2", e.g2},
          {"/center_distance_mm", e.center_distance_m * 1e3},
          {"/module_mm/0", e.module_m[0] * 1e3},
          {"/module_mm/1", e.module_m[1] * 1e3},
          {"/efficiency/forward", *e.efficiency.forward},
          {"/efficiency/backward", *e.efficiency.backward},
          {"/efficiency/backdriving_margin", e.efficiency.backdriving_margin},
          {"/backlash/paper_arcmin", e.lost_motion.paper_rad * kArcmins},
          {"/backlash/kinematic_arcmin", e.lost_motion.kinematic_rad * kArcmins},
          {"/backlash/input_kinematic_arcmin", e.lost_motion.input_kinematic_rad * kArcmins},
          {"/backlash/measured_arcmin", *e.lost_motion.measured_rad * kArcmins},
          {"/inertia/lossless_kgm2", e.inertia->lossless_kgm2},
          {"/inertia/backward_kgm2", *e.inertia->backward_kgm2},
          {"/inertia/forward_kgm2", *e.inertia->forward_kgm2},
          {"/inertia/paper_kgm2", *e.inertia->paper_kgm2},
          {"/masses/0/count", 7.0},
          {"/masses/0/mass_kg", *e.parts[0].mass_kg},
          {"/masses/0/inertia_kgm2", *e.parts[0].inertia_kgm2},
          {"/total_mass_kg", *e.total_mass_kg},
          {"/assembly/planet_phase_deg/0", e.assembly.planet_phase_rad[0] * kDegrees},
          {"/assembly/planet_phase_deg/1", e.assembly.planet_phase_rad[1] * kDegrees}};
}

/// Value, limit and margin of a check; the margin of a temperature is a difference.
design::CheckResult any_check(EachAnother& value, design::CheckId id) {
  design::CheckResult c{};
  c.record = &design::check_record(id);
  c.value = value();
  c.limit = value();
  c.margin = value();
  return c;
}

Numbers numbers_of_check(const design::CheckResult& c, double factor) {
  return {
      {"/value", c.value * factor}, {"/limit", c.limit * factor}, {"/margin", c.margin * factor}};
}

json json_of(const design::Evaluation& e) { return json::parse(analysis_json(e, {}).text()); }

TEST(AnalysisFields, TrainHasEveryNumberByItsName) {
  EachAnother value;
  const design::Evaluation e = any_train(value);
  expect_all_numbers(numbers_of(json_of(e)), numbers_of_train(e));
}

TEST(AnalysisFields, MeshesHaveEveryNumberByItsName) {
  EachAnother value;
  design::Evaluation e{};
  e.meshes = {any_mesh(value), any_mesh(value)};
  const json meshes = json_of(e).at("meshes");
  for (const std::size_t k : {0U, 1U}) {
    expect_all_numbers(numbers_of(meshes.at(k)), numbers_of_mesh(e.meshes[k]));
  }
}

TEST(AnalysisFields, GearsHaveEveryMeasureByItsName) {
  EachAnother value;
  design::Evaluation e{};
  e.gears = {any_gear(value), any_gear(value)};
  const json gears = json_of(e).at("gears");
  for (const std::size_t k : {0U, 1U}) {
    expect_all_numbers(numbers_of(gears.at(k)), numbers_of_gear(e.gears[k]));
  }
}

TEST(AnalysisFields, ChecksAreInTheirUnits) {
  EachAnother value;
  design::Evaluation e{};
  e.checks = {any_check(value, design::CheckId::kOutputBacklashMax),
              any_check(value, design::CheckId::kContactRatioMin)};
  const json checks = json_of(e).at("checks");
  expect_all_numbers(numbers_of(checks.at(0)), numbers_of_check(e.checks[0], kArcmins));
  expect_all_numbers(numbers_of(checks.at(1)), numbers_of_check(e.checks[1], 1.0));
}

/// Rows of an item by their quantities.
Numbers rows_of(const io::CsvTable& table, const std::string& item) {
  Numbers numbers;
  for (const auto& row : table.rows) {
    if (table.text(row, "item") != item) continue;
    const auto value = io::csv_number(table.text(row, "value").value_or(""));
    if (value) numbers[*table.text(row, "quantity")] = *value;
  }
  return numbers;
}

TEST(AnalysisFields, CsvHasTheMeasuresOfAGearByTheirQuantities) {
  EachAnother value;
  design::Evaluation e{};
  e.gears = {any_gear(value)};
  const design::GearResult& g = e.gears[0];
  const design::ToothResult& t = g.tooth;
  expect_all_numbers(rows_of(io::parse_csv(analysis_csv(e, {}), "analysis.csv"), "P1"),
                     {{"teeth", 37.0},
                      {"undercut", 1.0},
                      {"full_round", 0.0},
                      {"profile_shift", g.profile_shift},
                      {"tip_shortening", g.tip_shortening},
                      {"pitch_diameter", g.pitch_diameter_m * 1e3},
                      {"base_diameter", g.base_diameter_m * 1e3},
                      {"tip_diameter", g.tip_diameter_m * 1e3},
                      {"root_diameter", g.root_diameter_m * 1e3},
                      {"tip_thickness", g.tip_thickness_m * 1e3},
                      {"form_diameter", t.form_diameter_m * 1e3},
                      {"fillet_radius", t.fillet_radius_m * 1e3},
                      {"form_circle_thickness", t.form_thickness_m * 1e3},
                      {"root_space_width", *t.root_space_m * 1e3},
                      {"span_count", 3.0},
                      {"span", t.span->length_m * 1e3},
                      {"span_contact_diameter", 2.0 * t.span->contact_radius_m * 1e3},
                      {"pin_diameter", t.pins->pin_diameter_m * 1e3},
                      {"over_pins", t.pins->over_pins_m * 1e3},
                      {"pin_contact_diameter", 2.0 * t.pins->contact_radius_m * 1e3},
                      {"least_pin_diameter", t.fitting_pins->least_m * 1e3},
                      {"greatest_pin_diameter", t.fitting_pins->greatest_m * 1e3},
                      {"chordal_thickness", t.chordal.chord_m * 1e3},
                      {"chordal_height", t.chordal.height_m * 1e3},
                      {"infeed_profile_shift", t.infeed.profile_shift},
                      {"infeed_root_diameter", 2.0 * t.infeed.root_radius_m * 1e3},
                      {"cutter_teeth", 29.0},
                      {"cutter_tip_diameter", t.cutter_tip_diameter_m * 1e3},
                      {"cutter_center_distance", t.cutter_center_distance_m * 1e3}});
}

TEST(AnalysisFields, CsvHasTheNumbersOfTheTrainByTheirQuantities) {
  EachAnother value;
  const design::Evaluation e = any_train(value);
  const io::CsvTable table = io::parse_csv(analysis_csv(e, {}), "analysis.csv");
  expect_all_numbers(rows_of(table, "train"),
                     {{"planets", 5.0},
                      {"ratio", e.ratio},
                      {"g1", e.g1},
                      {"g2", e.g2},
                      {"center_distance", e.center_distance_m * 1e3},
                      {"efficiency_forward", *e.efficiency.forward},
                      {"efficiency_backward", *e.efficiency.backward},
                      {"backdriving_margin", e.efficiency.backdriving_margin},
                      {"lost_motion_paper", e.lost_motion.paper_rad * kArcmins},
                      {"lost_motion_kinematic", e.lost_motion.kinematic_rad * kArcmins},
                      {"lost_motion_input_kinematic", e.lost_motion.input_kinematic_rad * kArcmins},
                      {"lost_motion_measured", *e.lost_motion.measured_rad * kArcmins},
                      {"inertia_lossless", e.inertia->lossless_kgm2},
                      {"inertia_backward", *e.inertia->backward_kgm2},
                      {"inertia_forward", *e.inertia->forward_kgm2},
                      {"inertia_paper", *e.inertia->paper_kgm2},
                      {"mass", *e.total_mass_kg}});
  expect_all_numbers(rows_of(table, "stage 1"), {{"module", e.module_m[0] * 1e3}});
  expect_all_numbers(rows_of(table, "stage 2"), {{"module", e.module_m[1] * 1e3}});
  expect_all_numbers(rows_of(table, "planet 0"),
                     {{"phase", e.assembly.planet_phase_rad[0] * kDegrees}});
  expect_all_numbers(rows_of(table, "planet 1"),
                     {{"phase", e.assembly.planet_phase_rad[1] * kDegrees}});
  expect_all_numbers(
      rows_of(table, "P1"),
      {{"count", 7.0}, {"mass", *e.parts[0].mass_kg}, {"inertia", *e.parts[0].inertia_kgm2}});
}

TEST(AnalysisFields, CsvHasTheNumbersOfAMeshByTheirQuantities) {
  EachAnother value;
  design::Evaluation e{};
  e.meshes = {any_mesh(value)};
  const design::MeshResult& m = e.meshes[0];
  expect_all_numbers(rows_of(io::parse_csv(analysis_csv(e, {}), "analysis.csv"), "S-P1"),
                     {{"working_pressure_angle", m.working_pressure_angle_rad * kDegrees},
                      {"zero_backlash_center_distance", *m.zero_backlash_center_distance_m * 1e3},
                      {"contact_ratio", m.contact_ratio},
                      {"approach_contact_ratio", m.approach_contact_ratio},
                      {"recess_contact_ratio", m.recess_contact_ratio},
                      {"normal_backlash", m.normal_backlash_m * 1e6},
                      {"friction_forward", m.friction_forward},
                      {"friction_backward", m.friction_backward},
                      {"efficiency_forward", m.efficiency_forward},
                      {"efficiency_backward", m.efficiency_backward},
                      {"loss_model_in_range", 0.0},
                      {"hunting_period", 12345.0},
                      {"common_factor", 17.0},
                      {"phase_planet0", m.planet_phase[0]},
                      {"phase_planet1", m.planet_phase[1]},
                      {"active_root_diameter_gear1", *m.active_root_diameter_m[0] * 1e3},
                      {"active_root_diameter_gear2", *m.active_root_diameter_m[1] * 1e3},
                      {"root_clearance_gear1", m.root_clearance_m[0] * 1e3},
                      {"root_clearance_gear2", m.root_clearance_m[1] * 1e3},
                      {"specific_sliding_tip_gear1", m.tip_sliding[0].specific_at_tip},
                      {"specific_sliding_tip_gear2", m.tip_sliding[1].specific_at_tip},
                      {"specific_sliding_root_gear1", m.tip_sliding[1].specific_at_root},
                      {"specific_sliding_root_gear2", m.tip_sliding[0].specific_at_root},
                      {"sliding_factor_tip_gear1", m.tip_sliding[0].sliding_factor},
                      {"sliding_factor_tip_gear2", m.tip_sliding[1].sliding_factor}});
}

}  // namespace
}  // namespace gear3k::report::analysis_fields_test
