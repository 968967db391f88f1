#include "report/condition_columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using calibrate::Condition, calibrate::ConditionQuantity, calibrate::Kind,
    calibrate::MeasurementSet;

constexpr std::string_view kDirection = "direction";
constexpr std::string_view kRun = "run";

constexpr ConditionColumn column_for(const ConditionQuantity& quantity,
                                     double (*value)(const Condition&)) {
  return {.name = quantity.column,
          .title = quantity.title,
          .unit = quantity.shown_unit,
          .value = value};
}

/// A column whose numbers went through SI units when they were read.
template <const ConditionQuantity& quantity>
constexpr ConditionColumn converted() {
  return column_for(quantity,
                    [](const Condition& c) { return clean(quantity.written(c.*quantity.member)); });
}
/// A column whose numbers are those of the file.
template <const ConditionQuantity& quantity>
constexpr ConditionColumn as_written() {
  return column_for(quantity, [](const Condition& c) { return c.*quantity.member; });
}

constexpr ConditionColumn kAngle = converted<calibrate::kOutputAngle>();
constexpr ConditionColumn kTemperature = converted<calibrate::kTemperature>();
constexpr ConditionColumn kCycles = as_written<calibrate::kCycles>();
constexpr ConditionColumn kTime = as_written<calibrate::kTime>();
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
          converted<calibrate::kSunSpeed>(),
          converted<calibrate::kOutputTorque>(),
          {.name = "rotation",
           .title = "rotation",
           .unit = "",
           .value = [](const Condition& c) { return static_cast<double>(c.rotation); }},
          kAngle,
          kTemperature,
          kCycles,
          kTime,
          kRunColumn};
}

std::vector<ConditionColumn> lost_motion_columns() {
  return {kAngle, converted<calibrate::kTestTorque>(), kTemperature, kCycles, kTime, kRunColumn};
}

std::vector<ConditionColumn> pair_loss_columns() {
  return {column_for(calibrate::kDrivingTeeth,
                     [](const Condition& c) { return static_cast<double>(c.driving_teeth); }),
          column_for(calibrate::kDrivenTeeth,
                     [](const Condition& c) { return static_cast<double>(c.driven_teeth); }),
          column_for(calibrate::kModule,
                     [](const Condition& c) {
                       return c.module_m > 0.0 ? clean(calibrate::kModule.written(c.module_m))
                                               : calibrate::kUnknown;
                     }),
          kTemperature,
          kCycles,
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
