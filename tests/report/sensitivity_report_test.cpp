#include "report/sensitivity_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/report/all_numbers.hpp"

namespace gear3k::report::sensitivity_report_test {
namespace {

using nlohmann::json;

constexpr double kArcmins = 10800.0 / std::numbers::pi;

/// Of two checks, one of them an angle, and of two ends of a range.
design::Sensitivity any_row(EachAnother& value) {
  design::Sensitivity row;
  row.unit = units::Unit::kMillimetre;
  row.value = value();
  row.step = value();
  for (auto& slope : row.slope) slope = value();
  row.margin_slope = {value(), value()};
  row.thermal.resize(2);
  for (design::ThermalSlopes& at : row.thermal) {
    at.lost_motion = value();
    for (auto& slope : at.normal_backlash) slope = value();
    for (auto& slope : at.least_backlash) slope = value();
  }
  return row;
}

/// Slopes are per unit of the input: the numerator alone is in the unit of the field.
Numbers numbers_of_row(const design::Sensitivity& row) {
  Numbers stated{{"/value", row.value},
                 {"/step", row.step},
                 {"/d_eta_f", *row.slope[0]},
                 {"/d_eta_b", *row.slope[1]},
                 {"/d_total_eta_f", *row.slope[2]},
                 {"/d_total_eta_b", *row.slope[3]},
                 {"/d_lost_motion_arcmin", *row.slope[4] * kArcmins},
                 {"/d_margin/0", *row.margin_slope[0] * kArcmins},
                 {"/d_margin/1", *row.margin_slope[1]}};
  for (std::size_t end = 0; end < row.thermal.size(); ++end) {
    const design::ThermalSlopes& at = row.thermal[end];
    Numbers of_end{{"/d_lost_motion_arcmin", *at.lost_motion * kArcmins}};
    for (std::size_t k = 0; k < at.normal_backlash.size(); ++k) {
      of_end["/d_normal_backlash_um/" + std::to_string(k)] = *at.normal_backlash.at(k) * 1e6;
      of_end["/d_least_backlash_um/" + std::to_string(k)] = *at.least_backlash.at(k) * 1e6;
    }
    stated.merge(at_path("/thermal/" + std::to_string(end), of_end));
  }
  return stated;
}

TEST(SensitivityReport, HasEveryNumberByItsName) {
  EachAnother value;
  design::Sensitivities s;
  s.operating_point = true;
  s.inputs = {any_row(value)};
  s.inputs[0].input = {.kind = design::InputKind::kCenterDistance, .index = 0};
  s.checks.resize(2);
  s.checks[0].record = &design::check_record(design::CheckId::kOutputBacklashMax);
  s.checks[1].record = &design::check_record(design::CheckId::kContactRatioMin);
  for (design::TightCheck& check : s.checks) check.margin = value();
  s.ends.resize(2);
  for (train::ThermalState& end : s.ends) end.temperature_K = value();
  Numbers stated = at_path("/sensitivities/0", numbers_of_row(s.inputs[0]));
  stated.merge(
      Numbers{{"/sensitivities/0/thermal/0/temperature_c", s.ends[0].temperature_K - 273.15},
              {"/sensitivities/0/thermal/1/temperature_c", s.ends[1].temperature_K - 273.15},
              {"/tightest_checks/0/margin", s.checks[0].margin * kArcmins},
              {"/tightest_checks/1/margin", s.checks[1].margin}});
  expect_all_numbers(numbers_of(json::parse(sensitivity_fields(s).json().text())), stated);
}

}  // namespace
}  // namespace gear3k::report::sensitivity_report_test
