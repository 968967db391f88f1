#include "report/thermal_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/report/all_numbers.hpp"

namespace gear3k::report::thermal_report_test {
namespace {

using nlohmann::json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

design::ThermalStateResult any_state(EachAnother& value) {
  design::ThermalStateResult at;
  at.state.temperature_K = value();
  at.center_distance_m = value();
  at.lost_motion_rad = value();
  for (design::ThermalMesh& m : at.meshes) {
    for (double* member : {&m.base_pitch_difference_m, &m.working_pressure_angle_rad,
                           &m.contact_ratio, &m.normal_backlash_m, &m.least_backlash_m,
                           &m.root_clearance_m[0], &m.root_clearance_m[1]}) {
      *member = value();
    }
  }
  return at;
}

Numbers numbers_of_state(const design::ThermalStateResult& at) {
  Numbers stated{{"/temperature_c", at.state.temperature_K - 273.15},
                 {"/center_distance_mm", at.center_distance_m * 1e3},
                 {"/lost_motion_arcmin", at.lost_motion_rad * 60.0 * kDegrees}};
  for (std::size_t k = 0; k < at.meshes.size(); ++k) {
    const design::ThermalMesh& m = at.meshes.at(k);
    stated.merge(at_path("/meshes/" + std::to_string(k),
                         {{"/base_pitch_difference_um", m.base_pitch_difference_m * 1e6},
                          {"/working_pressure_angle_deg", m.working_pressure_angle_rad * kDegrees},
                          {"/contact_ratio", m.contact_ratio},
                          {"/normal_backlash_um", m.normal_backlash_m * 1e6},
                          {"/least_backlash_um", m.least_backlash_m * 1e6},
                          {"/root_clearance_mm/0", m.root_clearance_m[0] * 1e3},
                          {"/root_clearance_mm/1", m.root_clearance_m[1] * 1e3}}));
  }
  return stated;
}

TEST(ThermalReport, HasEveryNumberByItsName) {
  EachAnother value;
  design::ThermalResult thermal;
  thermal.reference_K = value();
  thermal.states = {any_state(value), any_state(value)};
  for (design::JamRange& jam : thermal.jams) {
    jam.below_K = value();
    jam.above_K = value();
  }
  Numbers stated{{"/reference_c", thermal.reference_K - 273.15}};
  for (std::size_t k = 0; k < thermal.states.size(); ++k) {
    stated.merge(at_path("/states/" + std::to_string(k), numbers_of_state(thermal.states[k])));
  }
  for (std::size_t k = 0; k < thermal.jams.size(); ++k) {
    const design::JamRange& jam = thermal.jams.at(k);
    stated.merge(at_path("/jams/" + std::to_string(k), {{"/below_c", *jam.below_K - 273.15},
                                                        {"/above_c", *jam.above_K - 273.15}}));
  }
  expect_all_numbers(numbers_of(json::parse(thermal_fields(thermal).json().text())), stated);
}

}  // namespace
}  // namespace gear3k::report::thermal_report_test
