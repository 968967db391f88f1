#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "io/text/csv_table.hpp"
#include "report/map_report.hpp"
#include "tests/report/all_numbers.hpp"

namespace gear3k::report::map_numbers_test {
namespace {

using nlohmann::json;

constexpr double kRpms = 30.0 / std::numbers::pi;

design::Operation<double> any_operation(EachAnother& value) {
  design::Operation<double> o{};
  for (double* member :
       {&o.sun_torque_Nm, &o.output_torque_Nm, &o.bearing_loss_W, &o.input_power_W, &o.loss_W}) {
    *member = value();
  }
  o.efficiency = value();
  for (auto& m : o.mesh) {
    for (double* member :
         {&m.friction, &m.normal_force_N, &m.sliding_speed_m_s, &m.efficiency, &m.loss_W}) {
      *member = value();
    }
  }
  for (double& drag : o.drag_loss_W) drag = value();
  return o;
}

design::MapPair any_pair(EachAnother& value) {
  design::MapPair pair;
  pair.point.sun_speed_rad_s = value();
  pair.point.output_torque_Nm = value();
  for (design::MapPoint* point : {&pair.forward, &pair.backward}) {
    point->status = design::MapStatus::kRuns;
    point->operation = any_operation(value);
    point->backdriving_margin = value();
    point->drives_sun = true;
  }
  return pair;
}

design::UnloadedTorques any_torques(EachAnother& value) {
  design::UnloadedTorques torques;
  torques.sun.torque_Nm = value();
  torques.output.torque_Nm = value();
  return torques;
}

/// The margin is that of the backward direction; the torque is the point's.
Numbers numbers_of_point(const design::MapPair& pair, design::Direction direction) {
  const bool forward = direction == design::Direction::kForward;
  const design::MapPoint& point = forward ? pair.forward : pair.backward;
  const design::Operation<double>& o = *point.operation;
  Numbers stated{{"/sun_speed_rpm", pair.point.sun_speed_rad_s * kRpms},
                 {"/output_torque_nm", pair.point.output_torque_Nm},
                 {"/sun_torque_nm", o.sun_torque_Nm},
                 {"/efficiency", *o.efficiency},
                 {"/input_power_w", o.input_power_W},
                 {"/loss_w", o.loss_W},
                 {"/bearing_loss_w", o.bearing_loss_W},
                 {"/drag_loss_w/S", o.drag_loss_W[0]},
                 {"/drag_loss_w/planet", o.drag_loss_W[1]},
                 {"/drag_loss_w/carrier", o.drag_loss_W[2]},
                 {"/drag_loss_w/R2", o.drag_loss_W[3]}};
  for (std::size_t k = 0; k < o.mesh.size(); ++k) {
    const auto& m = o.mesh.at(k);
    stated.merge(
        at_path("/meshes/" + std::to_string(k), {{"/friction", m.friction},
                                                 {"/normal_force_n", m.normal_force_N},
                                                 {"/sliding_speed_m_s", m.sliding_speed_m_s},
                                                 {"/efficiency", m.efficiency},
                                                 {"/heat_w", m.loss_W}}));
  }
  if (!forward) stated["/backdriving_margin"] = *point.backdriving_margin;
  return stated;
}

/// A map of one point, and another as its reference.
design::OperatingMap any_map(EachAnother& value) {
  design::OperatingMap map;
  map.planets = 5;
  map.ratio = value();
  map.temperature_K = value();
  map.points = {any_pair(value)};
  map.sun_speed_rad_s = {map.points[0].point.sun_speed_rad_s};
  map.output_torque_Nm = {map.points[0].point.output_torque_Nm};
  map.running = {any_torques(value)};
  map.breakaway = any_torques(value);
  map.reference = any_pair(value);
  return map;
}

TEST(MapNumbers, PointsHaveEveryNumberByItsName) {
  EachAnother value;
  const design::OperatingMap map = any_map(value);
  const json report = json::parse(map_json(map, nullptr).text());
  using enum design::Direction;
  ASSERT_EQ(report.at("points").size(), 2U);
  expect_all_numbers(numbers_of(report.at("points").at(0)),
                     numbers_of_point(map.points[0], kForward));
  expect_all_numbers(numbers_of(report.at("points").at(1)),
                     numbers_of_point(map.points[0], kBackward));
  expect_all_numbers(numbers_of(report.at("reference").at("forward")),
                     numbers_of_point(map.reference, kForward));
  expect_all_numbers(numbers_of(report.at("reference").at("backward")),
                     numbers_of_point(map.reference, kBackward));
}

TEST(MapNumbers, WhatIsOfTheWholeMapHasEveryNumberByItsName) {
  EachAnother value;
  const design::OperatingMap map = any_map(value);
  json report = json::parse(map_json(map, nullptr).text());
  // The only point of the grid: of its axes, of each speed, of the least margin.
  const double speed_rpm = map.sun_speed_rad_s[0] * kRpms;
  for (const char* pointer :
       {"/sun_speed_rpm/0", "/running/0/sun_speed_rpm", "/backdriving_margin/sun_speed_rpm"}) {
    EXPECT_NEAR(report.at(json::json_pointer(pointer)).get<double>(), speed_rpm,
                kTwelfthDigit * speed_rpm)
        << pointer;
  }
  for (const char* pointer : {"/output_torque_nm/0", "/backdriving_margin/output_torque_nm"}) {
    EXPECT_NEAR(report.at(json::json_pointer(pointer)).get<double>(), map.output_torque_Nm[0],
                kTwelfthDigit * map.output_torque_Nm[0])
        << pointer;
  }
  for (const char* key : {"points", "reference", "sun_speed_rpm", "output_torque_nm"}) {
    report.erase(key);
  }
  report.at("running").at(0).erase("sun_speed_rpm");
  report.at("backdriving_margin").erase("sun_speed_rpm");
  report.at("backdriving_margin").erase("output_torque_nm");
  expect_all_numbers(numbers_of(report),
                     {{"/planets", 5.0},
                      {"/ratio", map.ratio},
                      {"/temperature_c", map.temperature_K - 273.15},
                      {"/running/0/sun/torque_nm", *map.running[0].sun.torque_Nm},
                      {"/running/0/output/torque_nm", *map.running[0].output.torque_Nm},
                      {"/breakaway/sun/torque_nm", *map.breakaway.sun.torque_Nm},
                      {"/breakaway/output/torque_nm", *map.breakaway.output.torque_Nm},
                      {"/backdriving_margin/least", *map.points[0].backward.backdriving_margin}});
}

TEST(MapNumbers, CsvHasEveryNumberByItsColumn) {
  EachAnother value;
  const design::OperatingMap map = any_map(value);
  const io::CsvTable table = io::parse_csv(map_csv(map), "map.csv");
  ASSERT_EQ(table.rows.size(), 2U);
  const design::MapPair& pair = map.points[0];
  const std::array<const design::MapPoint*, 2> points{&pair.forward, &pair.backward};
  for (std::size_t k = 0; k < points.size(); ++k) {
    const design::Operation<double>& o = *points.at(k)->operation;
    EXPECT_EQ(table.text(table.rows[k], "direction"), k == 0 ? "forward" : "backward");
    expect_all_numbers(numbers_of(table, k),
                       {{"sun_speed_rpm", pair.point.sun_speed_rad_s * kRpms},
                        {"output_torque_nm", pair.point.output_torque_Nm},
                        {"sun_torque_nm", o.sun_torque_Nm},
                        {"efficiency", *o.efficiency},
                        {"input_power_w", o.input_power_W},
                        {"loss_w", o.loss_W},
                        {"heat_s_p1_w", o.mesh[0].loss_W},
                        {"heat_p1_r1_w", o.mesh[1].loss_W},
                        {"heat_p2_r2_w", o.mesh[2].loss_W},
                        {"friction_s_p1", o.mesh[0].friction},
                        {"friction_p1_r1", o.mesh[1].friction},
                        {"friction_p2_r2", o.mesh[2].friction},
                        {"mesh_efficiency_s_p1", o.mesh[0].efficiency},
                        {"mesh_efficiency_p1_r1", o.mesh[1].efficiency},
                        {"mesh_efficiency_p2_r2", o.mesh[2].efficiency},
                        {"drag_loss_sun_w", o.drag_loss_W[0]},
                        {"drag_loss_planet_w", o.drag_loss_W[1]},
                        {"drag_loss_carrier_w", o.drag_loss_W[2]},
                        {"drag_loss_r2_w", o.drag_loss_W[3]},
                        {"bearing_loss_w", o.bearing_loss_W},
                        {"temperature_c", map.temperature_K - 273.15},
                        {"backdriving_margin", *points.at(k)->backdriving_margin}});
  }
}

}  // namespace
}  // namespace gear3k::report::map_numbers_test
