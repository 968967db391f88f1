#include "report/torque_angle_report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "io/text/csv_table.hpp"
#include "tests/report/all_numbers.hpp"

namespace gear3k::report::torque_angle_report_test {
namespace {

using nlohmann::json;

/// Arc minutes of a radian.
constexpr double kArcmins = 10800.0 / std::numbers::pi;

TEST(TorqueAngleReport, HasEveryNumberByItsName) {
  EachAnother value;
  design::TorqueAngleCurve curve;
  for (double* member : {&curve.peak_torque_Nm, &curve.lost_motion_rad, &curve.windup_rad,
                         &curve.elastic_rad, &curve.loop_J, &curve.friction_J, &curve.held_rad}) {
    *member = value();
  }
  curve.stiffness.resize(2);
  for (auto& point : curve.stiffness) {
    point.torque_Nm = value();
    point.output_Nm_rad = value();
  }
  expect_all_numbers(numbers_of(json::parse(torque_angle_fields(curve).json().text())),
                     {{"/peak_torque_nm", curve.peak_torque_Nm},
                      {"/lost_motion_arcmin", curve.lost_motion_rad * kArcmins},
                      {"/windup_arcmin", curve.windup_rad * kArcmins},
                      {"/elastic_windup_arcmin", curve.elastic_rad * kArcmins},
                      {"/stiffness/0/torque_nm", curve.stiffness[0].torque_Nm},
                      {"/stiffness/0/output_nm_per_rad", curve.stiffness[0].output_Nm_rad},
                      {"/stiffness/1/torque_nm", curve.stiffness[1].torque_Nm},
                      {"/stiffness/1/output_nm_per_rad", curve.stiffness[1].output_Nm_rad},
                      {"/loop_mj", curve.loop_J * 1e3},
                      {"/friction_mj", curve.friction_J * 1e3},
                      {"/held_arcmin", curve.held_rad * kArcmins}});
}

TEST(TorqueAngleReport, CsvHasEveryBranchInItsOrder) {
  EachAnother value;
  design::TorqueAngleCurve curve;
  for (auto& branch : curve.branch) {
    auto& point = branch.emplace_back();
    point.torque_Nm = value();
    point.angle_rad = value();
  }
  const io::CsvTable table = io::parse_csv(torque_angle_csv(curve), "torque_angle.csv");
  ASSERT_EQ(table.rows.size(), 4U);
  for (std::size_t k = 0; k < table.rows.size(); ++k) {
    const auto& point = curve.branch.at(k)[0];
    EXPECT_EQ(table.text(table.rows[k], "branch"), design::kLoopBranchNames.at(k));
    expect_all_numbers(numbers_of(table, k), {{"torque_nm", point.torque_Nm},
                                              {"angle_arcmin", point.angle_rad * kArcmins}});
  }
}

}  // namespace
}  // namespace gear3k::report::torque_angle_report_test
