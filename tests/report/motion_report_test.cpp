#include "report/motion_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "io/text/csv_table.hpp"
#include "tests/report/all_numbers.hpp"

namespace gear3k::report::motion_report_test {
namespace {

using nlohmann::json;

motion::MotionRow any_row(EachAnother& value) {
  motion::MotionRow r;
  for (double* member :
       {&r.time_s, &r.sides.fast_rad, &r.sides.fast_rad_s, &r.sides.output_rad,
        &r.sides.output_rad_s, &r.acceleration_rad_s2, &r.outside.motor_Nm, &r.outside.reflected_Nm,
        &r.outside.load_Nm, &r.outside.prescribed_Nm, &r.outside.current_A, &r.outside.voltage_V,
        &r.outside.electrical_W, &r.outside.copper_W}) {
    *member = value();
  }
  r.mesh_Nm = value();
  r.mode.phase = motion::Phase::kSlide;
  r.mode.sense = -1;
  r.mode.flow = 1;
  return r;
}

motion::Ledger any_ledger(EachAnother& value) {
  motion::Ledger l;
  for (double* member : {&l.drawn_J, &l.regenerated_J, &l.positive_J, &l.negative_J, &l.kinetic_J,
                         &l.spring_J, &l.gravity_J, &l.balance_error}) {
    *member = value();
  }
  l.losses = {{.cause = "copper", .energy_J = value()}, {.cause = "mesh", .energy_J = value()}};
  return l;
}

TEST(MotionReport, HasEveryNumberByItsName) {
  EachAnother value;
  MotionResult result;
  result.scenario.duration_s = value();
  result.actuator.gearbox.backlash_rad = value();
  motion::Motion& m = result.motion;
  m.end = any_row(value);
  m.ledger = any_ledger(value);
  m.shares = {{.name = "stick", .time_s = value(), .entries = 7},
              {.name = "gap", .time_s = value(), .entries = 11}};
  m.events.resize(3);
  for (auto& event : m.events) event.what = "contact";
  m.events.resize(8);
  for (std::size_t k = 3; k < m.events.size(); ++k) m.events[k].what = "jams";
  m.peak_current_A = value();
  m.peak_voltage_V = value();
  m.peak_motor_speed_rad_s = value();
  m.checks.resize(1);
  m.checks[0].value = value();
  m.checks[0].limit = value();
  m.checks[0].margin = value();
  m.steps = 1234;
  const motion::Ledger& l = m.ledger;
  expect_all_numbers(
      numbers_of(json::parse(motion_json(result).text())),
      {{"/duration_s", result.scenario.duration_s},
       {"/end/time_s", m.end.time_s},
       {"/end/output_angle_rad", m.end.sides.output_rad},
       {"/end/output_speed_rad_s", m.end.sides.output_rad_s},
       {"/backlash_arcmin", *result.actuator.gearbox.backlash_rad * 10800.0 / std::numbers::pi},
       {"/ledger/electrical_energy_j/drawn", l.drawn_J},
       {"/ledger/electrical_energy_j/regenerated", l.regenerated_J},
       {"/ledger/load_energy_j/positive", l.positive_J},
       {"/ledger/load_energy_j/negative", l.negative_J},
       {"/ledger/loss_j/copper", l.losses[0].energy_J},
       {"/ledger/loss_j/mesh", l.losses[1].energy_J},
       {"/ledger/stored_j/kinetic", l.kinetic_J},
       {"/ledger/stored_j/spring", l.spring_J},
       {"/ledger/stored_j/gravity", l.gravity_J},
       {"/ledger/balance_error", l.balance_error},
       {"/modes/stick/time_s", m.shares[0].time_s},
       {"/modes/stick/entries", 7.0},
       {"/modes/gap/time_s", m.shares[1].time_s},
       {"/modes/gap/entries", 11.0},
       {"/events/contact", 3.0},
       {"/events/jams", 5.0},
       {"/peak_current_a", m.peak_current_A},
       {"/peak_voltage_v", m.peak_voltage_V},
       {"/peak_motor_speed_rad_s", m.peak_motor_speed_rad_s},
       {"/checks/0/value", *m.checks[0].value},
       {"/checks/0/limit", m.checks[0].limit},
       {"/checks/0/margin", *m.checks[0].margin},
       {"/steps", 1234.0}});
}

TEST(MotionReport, CsvHasEveryNumberByItsColumn) {
  EachAnother value;
  MotionResult result;
  result.motion.rows = {any_row(value)};
  const motion::MotionRow& r = result.motion.rows[0];
  const io::CsvTable table = io::parse_csv(motion_csv(result), "motion.csv");
  EXPECT_EQ(table.text(table.rows[0], "mode"), "slide");
  EXPECT_EQ(table.text(table.rows[0], "flow"), "forward");
  expect_all_numbers(numbers_of(table, 0), {{"time_s", r.time_s},
                                            {"output_angle_rad", r.sides.output_rad},
                                            {"output_speed_rad_s", r.sides.output_rad_s},
                                            {"output_acceleration_rad_s2", r.acceleration_rad_s2},
                                            {"motor_side_angle_rad", r.sides.fast_rad},
                                            {"motor_side_speed_rad_s", r.sides.fast_rad_s},
                                            {"sense", -1.0},
                                            {"motor_torque_nm", r.outside.motor_Nm},
                                            {"load_nm", r.outside.load_Nm},
                                            {"mesh_nm", *r.mesh_Nm},
                                            {"current_a", r.outside.current_A},
                                            {"voltage_v", r.outside.voltage_V}});
}

TEST(MotionReport, CsvOfEventsHasEveryNumberByItsColumn) {
  EachAnother value;
  MotionResult result;
  motion::MotionEvent& e = result.motion.events.emplace_back();
  for (double* member : {&e.time_s, &e.angle_rad, &e.speed_rad_s, &e.loss_J}) *member = value();
  e.what = "contact";
  e.before.phase = motion::Phase::kGap;
  e.after.phase = motion::Phase::kSlide;
  e.after.flow = -1;
  const io::CsvTable table = io::parse_csv(motion_events_csv(result), "events.csv");
  EXPECT_EQ(table.rows[0].fields[1], "contact");
  EXPECT_EQ(table.text(table.rows[0], "mode_before"), "gap");
  EXPECT_EQ(table.text(table.rows[0], "flow_before"), "none");
  EXPECT_EQ(table.text(table.rows[0], "mode_after"), "slide");
  EXPECT_EQ(table.text(table.rows[0], "flow_after"), "backward");
  expect_all_numbers(numbers_of(table, 0), {{"time_s", e.time_s},
                                            {"output_angle_rad", e.angle_rad},
                                            {"output_speed_rad_s", e.speed_rad_s},
                                            {"loss_j", e.loss_J}});
}

}  // namespace
}  // namespace gear3k::report::motion_report_test
