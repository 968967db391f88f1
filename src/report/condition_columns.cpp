#include "report/condition_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calibrate/response_unit.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using calibrate::Condition, calibrate::Kind, calibrate::MeasurementSet;

constexpr std::string_view kDirection = "direction";
constexpr std::string_view kRun = "run";

constexpr ConditionColumn kAngle{
    .name = "output_angle_deg",
    .title = "output angle",
    .unit = "deg",
    .value = [](const Condition& c) { return clean(degrees(c.output_angle_rad)); }};
constexpr ConditionColumn kTemperature{
    .name = "temperature_c", .title = "temperature", .unit = "C", .value = [](const Condition& c) {
      return celsius(c.temperature_K);
    }};
constexpr ConditionColumn kTime{
    .name = "time_s", .title = "time", .unit = "s", .value = [](const Condition& c) {
      return c.time_s;
    }};
constexpr ConditionColumn kCycles{
    .name = "cycles", .title = "cycles", .unit = "", .value = [](const Condition& c) {
      return c.cycles;
    }};
constexpr ConditionColumn kRunColumn{
    .name = kRun, .title = "session", .unit = "", .value = [](const Condition& c) {
      return c.run >= 0 ? static_cast<double>(c.run) : calibrate::kUnknown;
    }};

std::vector<ConditionColumn> transmission_columns() {
  return {{.name = kDirection,
           .title = "direction",
           .unit = "",
           .value =
               [](const Condition& c) {
                 return c.direction == design::Direction::kForward ? 0.0 : 1.0;
               }},
          {.name = "sun_speed_rpm",
           .title = "sun speed",
           .unit = "rpm",
           .value = [](const Condition& c) { return rpm(c.sun_speed_rad_s); }},
          {.name = "output_torque_nm",
           .title = "output torque",
           .unit = "Nm",
           .value = [](const Condition& c) { return clean(c.output_torque_Nm); }},
          {.name = "rotation",
           .title = "rotation",
           .unit = "",
           .value = [](const Condition& c) { return static_cast<double>(c.rotation); }},
          kAngle,
          kTemperature,
          kTime,
          kRunColumn};
}

std::vector<ConditionColumn> lost_motion_columns() {
  return {kAngle,
          {.name = "test_torque_nm",
           .title = "test torque",
           .unit = "Nm",
           .value = [](const Condition& c) { return clean(c.test_torque_Nm); }},
          kTemperature,
          kCycles,
          kTime,
          kRunColumn};
}

std::vector<ConditionColumn> pair_loss_columns() {
  return {{.name = "driving_teeth",
           .title = "teeth of the driver",
           .unit = "",
           .value = [](const Condition& c) { return static_cast<double>(c.driving_teeth); }},
          {.name = "driven_teeth",
           .title = "teeth of the driven gear",
           .unit = "",
           .value = [](const Condition& c) { return static_cast<double>(c.driven_teeth); }},
          {.name = "module_mm",
           .title = "module",
           .unit = "mm",
           .value =
               [](const Condition& c) {
                 return c.module_m > 0.0 ? clean(mm(c.module_m)) : calibrate::kUnknown;
               }},
          kTime,
          kRunColumn};
}

}  // namespace

const std::vector<ConditionColumn>& condition_columns(Kind kind) {
  static const std::vector<ConditionColumn> transmission = transmission_columns();
  static const std::vector<ConditionColumn> lost_motion = lost_motion_columns();
  static const std::vector<ConditionColumn> pair_loss = pair_loss_columns();
  if (kind == Kind::kTransmission) return transmission;
  return kind == Kind::kPairLoss ? pair_loss : lost_motion;
}

std::vector<ConditionColumn> stated_columns(const MeasurementSet& set) {
  std::vector<ConditionColumn> result;
  for (const ConditionColumn& column : condition_columns(set.kind)) {
    const bool stated = std::ranges::any_of(
        set.rows, [&](const auto& row) { return std::isfinite(column.value(row.condition)); });
    if (stated) result.push_back(column);
  }
  return result;
}

std::string condition_text(const ConditionColumn& column, const Condition& condition,
                           const std::vector<std::string>& runs) {
  if (column.name == kDirection) {
    return condition.direction == design::Direction::kForward ? "forward" : "backward";
  }
  if (column.name == kRun) {
    const auto run = static_cast<std::size_t>(condition.run);
    return condition.run >= 0 && run < runs.size() ? runs[run] : "";
  }
  return exact(column.value(condition));
}

std::optional<ConditionColumn> column_of(std::string_view covariate, Kind kind) {
  using Names = std::pair<std::string_view, std::string_view>;
  constexpr std::array<Names, 12> kNames{{{"load", "output_torque_nm"},
                                          {"speed", "sun_speed_rpm"},
                                          {"angle", "output_angle_deg"},
                                          {"temperature", "temperature_c"},
                                          {"time", "time_s"},
                                          {"session", kRun},
                                          {"test torque", "test_torque_nm"},
                                          {"test_torque", "test_torque_nm"},
                                          {"pinion", "driving_teeth"},
                                          {"teeth", "driving_teeth"},
                                          {"driving teeth", "driving_teeth"},
                                          {"driven teeth", "driven_teeth"}}};
  const auto& columns = condition_columns(kind);
  const auto find = [&](std::string_view name) -> std::optional<ConditionColumn> {
    const auto at = std::ranges::find(columns, name, &ConditionColumn::name);
    return at == columns.end() ? std::nullopt : std::optional(*at);
  };
  if (const auto column = find(covariate)) return column;
  for (const auto& [short_name, name] : kNames) {
    if (short_name != covariate) continue;
    if (const auto column = find(name)) return column;
  }
  // "load" of lost motion is its test torque.
  return covariate == "load" ? find("test_torque_nm") : std::nullopt;
}

ResponseText response_text(Kind kind) {
  const calibrate::ResponseUnit unit = calibrate::response_unit(kind);
  std::string_view title = "lost motion";
  if (kind == Kind::kTransmission) title = "sun torque";
  if (kind == Kind::kPairLoss) title = "loss factor";
  return {.title = title, .unit = unit.name, .si = unit.si};
}

}  // namespace gear3k::report
