#include "report/actuator_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "io/text/gnuplot.hpp"
#include "report/actuator_plot.hpp"
#include "tests/report/all_numbers.hpp"

namespace gear3k::report::actuator_report_test {
namespace {

using nlohmann::json;

json json_of(const ActuatorResult& result) { return json::parse(actuator_json(result).text()); }

actuator::Reflected any_reflected(EachAnother& value) {
  actuator::Reflected r;
  r.motor_kgm2 = value();
  r.gearbox_kgm2 = value();
  r.load_kgm2 = value();
  r.total_kgm2 = value();
  r.speeding_up_kgm2 = value();
  r.slowing_down_kgm2 = value();
  r.motor_Nms = value();
  r.gearbox_Nms = value();
  r.total_Nms = value();
  r.backdriven_Nms = value();
  r.coulomb_Nm = value();
  r.backdriven_coulomb_Nm = value();
  r.breakaway_Nm = value();
  r.breakaway_motor_Nm = value();
  r.motor_Nm_rad = value();
  r.gearbox_Nm_rad = value();
  r.total_Nm_rad = value();
  return r;
}

Numbers numbers_of_reflected(const actuator::Reflected& r) {
  return {{"/inertia_kgm2/motor", r.motor_kgm2},
          {"/inertia_kgm2/gearbox", r.gearbox_kgm2},
          {"/inertia_kgm2/load", r.load_kgm2},
          {"/inertia_kgm2/total", r.total_kgm2},
          {"/inertia_kgm2/speeding_up", *r.speeding_up_kgm2},
          {"/inertia_kgm2/slowing_down", *r.slowing_down_kgm2},
          {"/damping_nms_per_rad/motor", r.motor_Nms},
          {"/damping_nms_per_rad/gearbox", r.gearbox_Nms},
          {"/damping_nms_per_rad/total", r.total_Nms},
          {"/damping_nms_per_rad/backdriven", *r.backdriven_Nms},
          {"/coulomb_nm", r.coulomb_Nm},
          {"/coulomb_backdriven_nm", *r.backdriven_coulomb_Nm},
          {"/breakaway_nm", *r.breakaway_Nm},
          {"/breakaway_motor_nm", *r.breakaway_motor_Nm},
          {"/stiffness_nm_per_rad/motor", *r.motor_Nm_rad},
          {"/stiffness_nm_per_rad/gearbox", *r.gearbox_Nm_rad},
          {"/stiffness_nm_per_rad/total", *r.total_Nm_rad}};
}

actuator::LimitCheck any_check(EachAnother& value, const std::string& unit) {
  actuator::LimitCheck check;
  check.name = "any";
  check.unit = unit;
  check.value = value();
  check.limit = value();
  check.margin = value();
  return check;
}

actuator::DutyCycle any_cycle(EachAnother& value) {
  actuator::DutyCycle d;
  d.period_s = value();
  d.positive_J = value();
  d.negative_J = value();
  d.drawn_J = value();
  d.regenerated_J = value();
  d.losses = {{.cause = "copper", .energy_J = value()}, {.cause = "mesh", .energy_J = value()}};
  d.kinetic_J = value();
  d.balance_error = value();
  d.peak_current_A = value();
  d.rms_current_A = value();
  d.peak_voltage_V = value();
  d.peak_motor_speed_rad_s = value();
  d.peak_motor_torque_Nm = value();
  d.rms_motor_torque_Nm = value();
  d.shares.emplace();
  d.shares->backdriven = value();
  d.shares->motor_braking = value();
  d.shares->regenerating = value();
  d.winding.emplace();
  d.winding->winding_K = value();
  d.winding->housing_K = value();
  d.winding->winding_J_K = value();
  d.winding->housing_J_K = value();
  d.checks = {any_check(value, "A"), any_check(value, "K")};
  return d;
}

/// The winding's temperature stands there twice: it is not among them.
Numbers numbers_of_cycle(const actuator::DutyCycle& d) {
  return {{"/period_s", d.period_s},
          {"/mechanical_energy_j/positive", d.positive_J},
          {"/mechanical_energy_j/negative", d.negative_J},
          {"/electrical_energy_j/drawn", d.drawn_J},
          {"/electrical_energy_j/regenerated", d.regenerated_J},
          {"/loss_j/copper", d.losses[0].energy_J},
          {"/loss_j/mesh", d.losses[1].energy_J},
          {"/kinetic_j", d.kinetic_J},
          {"/balance_error", d.balance_error},
          {"/peak_current_a", d.peak_current_A},
          {"/rms_current_a", d.rms_current_A},
          {"/peak_voltage_v", d.peak_voltage_V},
          {"/peak_motor_speed_rad_s", d.peak_motor_speed_rad_s},
          {"/peak_motor_torque_nm", d.peak_motor_torque_Nm},
          {"/rms_motor_torque_nm", d.rms_motor_torque_Nm},
          {"/backdrivable_fraction_of_negative_power", d.shares->backdriven},
          {"/motor_braking_fraction", d.shares->motor_braking},
          {"/regenerating_fraction", d.shares->regenerating},
          {"/thermal/housing_c", *d.winding->housing_K - 273.15},
          {"/thermal/winding_j_per_k", *d.winding->winding_J_K},
          {"/thermal/housing_j_per_k", *d.winding->housing_J_K},
          {"/checks/0/value", *d.checks[0].value},
          {"/checks/0/limit", d.checks[0].limit},
          {"/checks/0/margin", *d.checks[0].margin},
          {"/checks/1/value", *d.checks[1].value - 273.15},
          {"/checks/1/limit", d.checks[1].limit - 273.15},
          {"/checks/1/margin", *d.checks[1].margin}};
}

TEST(ActuatorReport, ReflectedHasEveryNumberByItsName) {
  EachAnother value;
  ActuatorResult result;
  result.actuator.gearbox.ratio = value();
  result.reflected = any_reflected(value);
  Numbers stated = at_path("/reflected", numbers_of_reflected(result.reflected));
  stated["/ratio"] = result.actuator.gearbox.ratio;
  expect_all_numbers(numbers_of(json_of(result)), stated);
  result.reflected.gearbox_inertia_known = false;
  EXPECT_TRUE(json_of(result).at("/reflected/inertia_kgm2/gearbox"_json_pointer).is_null());
}

TEST(ActuatorReport, FeltTorqueHasEveryNumberByItsName) {
  EachAnother value;
  ActuatorResult result;
  result.felt.emplace();
  result.felt->motor_Nm = value();
  result.felt->moving_with_Nm = value();
  result.felt->pushed_back_Nm = value();
  result.felt->transparency = value();
  result.felt_checks = {any_check(value, "kg m2")};
  const json report = json_of(result);
  expect_all_numbers(numbers_of(report.at("felt")),
                     {{"/motor_torque_nm", result.felt->motor_Nm},
                      {"/moving_with_nm", *result.felt->moving_with_Nm},
                      {"/pushed_back_nm", *result.felt->pushed_back_Nm},
                      {"/transparency", *result.felt->transparency}});
  expect_all_numbers(numbers_of(report.at("checks")),
                     {{"/0/value", *result.felt_checks[0].value},
                      {"/0/limit", result.felt_checks[0].limit},
                      {"/0/margin", *result.felt_checks[0].margin}});
}

TEST(ActuatorReport, CycleHasEveryNumberByItsName) {
  EachAnother value;
  ActuatorResult result;
  result.cycle = any_cycle(value);
  json cycle = json_of(result).at("cycle");
  const double winding_C = *result.cycle->winding->winding_K - 273.15;
  EXPECT_NEAR(cycle.at("winding_c").get<double>(), winding_C, 1e-10);
  EXPECT_NEAR(cycle.at("thermal").at("winding_c").get<double>(), winding_C, 1e-10);
  cycle.erase("winding_c");
  cycle.at("thermal").erase("winding_c");
  expect_all_numbers(numbers_of(cycle), numbers_of_cycle(*result.cycle));
  EXPECT_EQ(cycle.at("checks").at(0).at("unit"), "A");
  EXPECT_EQ(cycle.at("checks").at(1).at("unit"), "C");
}

/// Height on the page of a text of a figure [px].
double height_of(const std::string& svg, const std::string& words) {
  const std::size_t text = svg.find(words + "</text>");
  if (text == std::string::npos) throw std::invalid_argument("no text " + words);
  const std::size_t place = svg.rfind("translate(", text);
  return std::stod(svg.substr(svg.find(',', place) + 1));
}

TEST(ActuatorFigures, NoKeyStandsOverTheTitleOfAnAxis) {
  EachAnother value;
  ActuatorResult result;
  result.cycle = any_cycle(value);
  actuator::MotorInstant instant{};
  result.cycle->instants = {instant};
  instant.time_s = 1.0;
  instant.electrical_W = 2.0;
  result.cycle->instants.push_back(instant);
  const std::vector<ActuatorFigure> figures = actuator_figures(result);
  ASSERT_EQ(figures.at(0).plot.name, "power");
  const std::string svg = io::run_gnuplot(figures[0].plot.script);
  constexpr double kLetter_px = 14.0;
  for (const char* entry : {"mechanical, to the load", "electrical, into the motor"}) {
    EXPECT_GT(std::abs(height_of(svg, entry) - height_of(svg, "time (s)")), 1.5 * kLetter_px)
        << entry;
  }
}

TEST(ActuatorReport, WithoutEachCauseHasEveryNumberByItsName) {
  EachAnother value;
  ActuatorResult result;
  result.cycle.emplace();
  result.without_each.emplace();
  for (const char* cause : {"copper", "inertia"}) {
    actuator::WithoutCause& without = result.without_each->emplace_back();
    without.cause = cause;
    without.drawn_J = value();
    without.regenerated_J = value();
    without.saved_J = value();
  }
  const actuator::WithoutCause& copper = result.without_each->at(0);
  const actuator::WithoutCause& inertia = result.without_each->at(1);
  expect_all_numbers(numbers_of(json_of(result).at("cycle").at("without_each")),
                     {{"/copper/drawn_j", copper.drawn_J},
                      {"/copper/regenerated_j", copper.regenerated_J},
                      {"/copper/saved_j", copper.saved_J},
                      {"/inertia/drawn_j", inertia.drawn_J},
                      {"/inertia/regenerated_j", inertia.regenerated_J},
                      {"/inertia/saved_j", inertia.saved_J}});
}

actuator::ImpedancePoint any_impedance(EachAnother& value) {
  const auto complex = [&] {
    const double real = value();
    return std::complex<double>(real, value());
  };
  actuator::ImpedancePoint p;
  p.frequency_Hz = value();
  p.stiffness_Nm_rad = complex();
  p.impedance_Nms = complex();
  p.first_harmonic_Nms = complex();
  p.causes = {{.name = "load", .impedance_Nms = complex()}};
  p.harmonic_causes = {{.name = "mesh", .impedance_Nms = complex()}};
  p.flow_change_rad = value();
  return p;
}

TEST(ActuatorReport, ImpedanceHasEveryNumberByItsName) {
  EachAnother value;
  ActuatorResult result;
  result.impedance_task.emplace();
  result.impedance_task->amplitude_rad = value();
  result.impedance = {any_impedance(value)};
  const actuator::ImpedancePoint& p = result.impedance[0];
  expect_all_numbers(
      numbers_of(json_of(result).at("impedance")),
      {{"/amplitude_rad", result.impedance_task->amplitude_rad},
       {"/points/0/frequency_hz", p.frequency_Hz},
       {"/points/0/dynamic_stiffness_nm_per_rad/real", p.stiffness_Nm_rad->real()},
       {"/points/0/dynamic_stiffness_nm_per_rad/imaginary", p.stiffness_Nm_rad->imag()},
       {"/points/0/impedance_nms_per_rad/real", p.impedance_Nms->real()},
       {"/points/0/impedance_nms_per_rad/imaginary", p.impedance_Nms->imag()},
       {"/points/0/first_harmonic_nms_per_rad/real", p.first_harmonic_Nms->real()},
       {"/points/0/first_harmonic_nms_per_rad/imaginary", p.first_harmonic_Nms->imag()},
       {"/points/0/flow_change_deg", *p.flow_change_rad * 180.0 / std::numbers::pi},
       {"/points/0/causes_nms_per_rad/load/real", p.causes[0].impedance_Nms.real()},
       {"/points/0/causes_nms_per_rad/load/imaginary", p.causes[0].impedance_Nms.imag()},
       {"/points/0/first_harmonic_causes_nms_per_rad/mesh/real",
        p.harmonic_causes[0].impedance_Nms.real()},
       {"/points/0/first_harmonic_causes_nms_per_rad/mesh/imaginary",
        p.harmonic_causes[0].impedance_Nms.imag()}});
  expect_all_numbers(
      numbers_of(io::parse_csv(impedance_csv(result.impedance), "impedance.csv"), 0),
      {{"frequency_hz", p.frequency_Hz},
       {"impedance_real_nms_per_rad", p.impedance_Nms->real()},
       {"impedance_imaginary_nms_per_rad", p.impedance_Nms->imag()},
       {"first_harmonic_real_nms_per_rad", p.first_harmonic_Nms->real()},
       {"first_harmonic_imaginary_nms_per_rad", p.first_harmonic_Nms->imag()},
       {"impedance_load_real_nms_per_rad", p.causes[0].impedance_Nms.real()},
       {"impedance_load_imaginary_nms_per_rad", p.causes[0].impedance_Nms.imag()},
       {"first_harmonic_mesh_real_nms_per_rad", p.harmonic_causes[0].impedance_Nms.real()},
       {"first_harmonic_mesh_imaginary_nms_per_rad", p.harmonic_causes[0].impedance_Nms.imag()}});
}

TEST(ActuatorReport, CsvOfACycleHasEveryNumberByItsColumn) {
  EachAnother value;
  actuator::MotorInstant p{};
  for (double* member : {&p.time_s, &p.speed_rad_s, &p.load_Nm, &p.mesh_Nm, &p.motor_Nm,
                         &p.current_A, &p.voltage_V, &p.electrical_W}) {
    *member = value();
  }
  actuator::DutyCycle cycle;
  cycle.instants = {p};
  // The load takes power where its torque is against the speed.
  expect_all_numbers(numbers_of(io::parse_csv(actuator_cycle_csv(cycle), "cycle.csv"), 0),
                     {{"time_s", p.time_s},
                      {"speed_rad_s", p.speed_rad_s},
                      {"load_nm", p.load_Nm},
                      {"mesh_nm", p.mesh_Nm},
                      {"motor_torque_nm", p.motor_Nm},
                      {"current_a", p.current_A},
                      {"voltage_v", p.voltage_V},
                      {"mechanical_power_w", -p.load_Nm * p.speed_rad_s},
                      {"electrical_power_w", p.electrical_W}});
}

}  // namespace
}  // namespace gear3k::report::actuator_report_test
