#include "report/selection_report.hpp"

#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "io/text/csv_table.hpp"
#include "report/co_design_report.hpp"
#include "tests/report/all_numbers.hpp"

namespace gear3k::report::selection_report_test {
namespace {

using nlohmann::json;

actuator::PairResult any_pair(EachAnother& value) {
  actuator::PairResult r;
  for (double* member : {&r.energy_J, &r.rms_current_A, &r.peak_current_A, &r.peak_voltage_V,
                         &r.peak_motor_speed_rad_s, &r.rms_torque_Nm, &r.peak_torque_Nm,
                         &r.inertia_kgm2, &r.excess}) {
    *member = value();
  }
  r.winding_K = value();
  r.mass_kg = value();
  r.breakaway_Nm = value();
  r.felt.emplace();
  r.felt->inertia_kgm2 = value();
  r.felt->breakaway_Nm = value();
  r.felt->transparency = value();
  r.limit = actuator::PairLimit::kVoltage;
  return r;
}

Numbers numbers_of_pair(const actuator::PairResult& r) {
  return {{"/energy_j", r.energy_J},
          {"/mass_kg", *r.mass_kg},
          {"/peak_current_a", r.peak_current_A},
          {"/rms_current_a", r.rms_current_A},
          {"/peak_voltage_v", r.peak_voltage_V},
          {"/rms_torque_nm", r.rms_torque_Nm},
          {"/peak_torque_nm", r.peak_torque_Nm},
          {"/breakaway_nm", *r.breakaway_Nm},
          {"/inertia_kgm2", r.inertia_kgm2},
          {"/winding_c", *r.winding_K - 273.15},
          {"/felt/inertia_kgm2", r.felt->inertia_kgm2},
          {"/felt/breakaway_nm", r.felt->breakaway_Nm},
          {"/felt/transparency", *r.felt->transparency}};
}

/// Two motors and three gearboxes.
actuator::SelectionTask any_task(EachAnother& value) {
  actuator::SelectionTask task;
  task.motors.resize(2);
  task.gearboxes.resize(3);
  for (std::size_t k = 0; k < task.motors.size(); ++k) task.motors[k].name = std::to_string(k);
  for (auto& gearbox : task.gearboxes) gearbox.gearbox.ratio = value();
  return task;
}

TEST(SelectionReport, PairsHaveEveryNumberByItsName) {
  EachAnother value;
  const actuator::SelectionTask task = any_task(value);
  actuator::Selection selection;
  selection.front = {any_pair(value), any_pair(value)};
  selection.front[0].pair = {.motor = 1, .gearbox = 2};
  selection.front[1].pair = {.motor = 0, .gearbox = 1};
  selection.nearest = any_pair(value);
  const json report = json::parse(selection_json(task, selection).text());
  EXPECT_EQ(report.at("front").at(0).at("motor"), "1");
  EXPECT_EQ(report.at("nearest").at("limit"), "voltage");
  const std::array<const actuator::PairResult*, 3> pairs{&selection.front[0], &selection.front[1],
                                                         &*selection.nearest};
  const std::array<std::string, 3> pointers{"/front/0", "/front/1", "/nearest"};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    Numbers stated = numbers_of_pair(*pairs[k]);
    stated["/ratio"] = task.gearboxes[pairs[k]->pair.gearbox].gearbox.ratio;
    stated["/excess"] = pairs[k]->excess;
    expect_all_numbers(numbers_of(report.at(json::json_pointer(pointers[k]))), stated);
  }
}

TEST(SelectionReport, CountsAreThoseOfTheVerdicts) {
  EachAnother value;
  const actuator::SelectionTask task = any_task(value);
  actuator::Selection selection;
  using enum actuator::PairStatus;
  constexpr std::array<std::size_t, 3> kCounts{5, 7, 11};
  for (const auto status : {kFront, kDominated, kInfeasible}) {
    actuator::PairVerdict verdict;
    verdict.status = status;
    selection.verdicts.insert(selection.verdicts.end(),
                              kCounts.at(static_cast<std::size_t>(status)), verdict);
  }
  selection.run = 13;
  Numbers stated{{"/motors", 2.0},      {"/gearboxes", 3.0}, {"/pairs", 23.0},     {"/run", 13.0},
                 {"/front_pairs", 5.0}, {"/dominated", 7.0}, {"/infeasible", 11.0}};
  constexpr std::array kLimits{"continuous_torque",
                               "intermittent_torque",
                               "nominal_current",
                               "voltage",
                               "peak_current",
                               "winding",
                               "speed",
                               "felt_inertia",
                               "breakaway",
                               "transparency"};
  for (std::size_t k = 0; k < kLimits.size(); ++k) {
    selection.rejected.at(k) = 100 + k;
    stated[std::string("/rejected/") + kLimits.at(k)] = 100.0 + static_cast<double>(k);
  }
  expect_all_numbers(numbers_of(json::parse(selection_json(task, selection).text())), stated);
}

TEST(SelectionReport, CsvOfTheFrontHasEveryNumberByItsColumn) {
  EachAnother value;
  actuator::SelectionTask task = any_task(value);
  task.motors[0].name = "motor";
  task.gearboxes[0].name = "gearbox";
  actuator::Selection selection;
  selection.front = {any_pair(value)};
  const actuator::PairResult& r = selection.front[0];
  expect_all_numbers(
      numbers_of(io::parse_csv(selection_front_csv(task, selection), "front.csv"), 0),
      {{"ratio", task.gearboxes[0].gearbox.ratio},
       {"energy_j", r.energy_J},
       {"mass_kg", *r.mass_kg},
       {"peak_current_a", r.peak_current_A},
       {"rms_current_a", r.rms_current_A},
       {"peak_voltage_v", r.peak_voltage_V},
       {"rms_torque_nm", r.rms_torque_Nm},
       {"peak_torque_nm", r.peak_torque_Nm},
       {"breakaway_nm", *r.breakaway_Nm},
       {"inertia_kgm2", r.inertia_kgm2},
       {"winding_c", *r.winding_K - 273.15},
       {"felt_inertia_kgm2", r.felt->inertia_kgm2},
       {"transparency", *r.felt->transparency}});
}

Numbers numbers_of_motor(const actuator::PairResult& r) {
  return {{"/energy_j", r.energy_J},
          {"/rms_current_a", r.rms_current_A},
          {"/peak_current_a", r.peak_current_A},
          {"/peak_voltage_v", r.peak_voltage_V},
          {"/peak_motor_speed_rad_s", r.peak_motor_speed_rad_s},
          {"/winding_c", *r.winding_K - 273.15},
          {"/felt/inertia_kgm2", r.felt->inertia_kgm2},
          {"/felt/breakaway_nm", r.felt->breakaway_Nm},
          {"/felt/transparency", *r.felt->transparency}};
}

TEST(CoDesignReport, HasEveryNumberByItsName) {
  EachAnother value;
  CoDesignReport report;
  for (const char* name : {"chosen", "next"}) {
    CoDesignMotor& motor = report.motors.emplace_back();
    motor.name = name;
    motor.result = any_pair(value);
  }
  report.run_J = value();
  report.bound_J = value();
  report.motors_considered = 101;
  report.cycles = 103;
  report.peak_torque_Nm = value();
  report.rms_torque_Nm = value();
  Numbers stated = numbers_of_motor(report.motors[0].result);
  stated.merge(at_path("/next/0", numbers_of_motor(report.motors[1].result)));
  stated.merge(Numbers{{"/run_energy_j", report.run_J},
                       {"/bound_j", *report.bound_J},
                       {"/motors", 101.0},
                       {"/cycles", 103.0},
                       {"/peak_torque_nm", report.peak_torque_Nm},
                       {"/rms_torque_nm", report.rms_torque_Nm}});
  expect_all_numbers(numbers_of(json::parse(co_design_json(report).text())), stated);
}

}  // namespace
}  // namespace gear3k::report::selection_report_test
