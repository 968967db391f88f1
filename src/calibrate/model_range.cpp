#include "calibrate/model_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gear3k::calibrate {

namespace {

constexpr double kRpm = std::numbers::pi / 30.0;
constexpr double kCelsius = 273.15;

/// Quantities of an operating point under the names and in the units of columns.
struct Quantity {
  std::string_view column, title, unit;
  double per_unit = 1.0, offset = 0.0;
  double design::OperatingPoint<double>::*member = nullptr;
};
using Point = design::OperatingPoint<double>;
constexpr std::array<Quantity, 4> kQuantities{{{.column = "sun_speed",
                                                .title = "sun speed",
                                                .unit = "rpm",
                                                .per_unit = kRpm,
                                                .member = &Point::sun_speed_rad_s},
                                               {.column = "output_torque",
                                                .title = "output torque",
                                                .unit = "Nm",
                                                .member = &Point::output_torque_Nm},
                                               {.column = "test_torque",
                                                .title = "test torque",
                                                .unit = "Nm",
                                                .member = &Point::output_torque_Nm},
                                               {.column = "temperature",
                                                .title = "temperature",
                                                .unit = "C",
                                                .offset = kCelsius,
                                                .member = &Point::temperature_K}}};

double in_unit(const Quantity& q, const Point& point) {
  return (point.*q.member - q.offset) / q.per_unit;
}

const ConditionRange* find_range(const ExtendedModel& model, std::string_view name) {
  const auto found = std::ranges::find(model.range, name, &ConditionRange::name);
  const bool stated = found != model.range.end() && found->low <= found->high;
  return stated ? &*found : nullptr;
}

/// 0 where the difference is that of roundings.
double beyond(double excess, const ConditionRange& range) {
  constexpr double kRounding = 1e-9;
  const double scale = std::max({std::abs(range.low), std::abs(range.high), 1.0});
  return excess > kRounding * scale ? excess : 0.0;
}

std::string interval_text(double low, double high, std::string_view unit) {
  if (high - low <= 1e-9 * std::max(1.0, std::abs(high)))
    return fmt::format("{:.6g} {}", low, unit);
  return fmt::format("{:.6g} to {:.6g} {}", low, high, unit);
}

}  // namespace

std::optional<Point> middle_of_range(const std::vector<ExtendedModel>& models) {
  for (const ExtendedModel& model : models) {
    if (find_range(model, "sun_speed") == nullptr ||
        find_range(model, "output_torque") == nullptr) {
      continue;
    }
    Point point;
    for (const Quantity& q : kQuantities) {
      const ConditionRange* range = find_range(model, q.column);
      if (range == nullptr) continue;
      point.*q.member = 0.5 * (range->low + range->high) * q.per_unit + q.offset;
    }
    return point;
  }
  return std::nullopt;
}

std::vector<std::string> outside_range(const std::vector<ExtendedModel>& models,
                                       const UsedRange& used) {
  std::vector<std::string> notes;
  for (const ExtendedModel& model : models) {
    for (const Quantity& q : kQuantities) {
      const ConditionRange* range = find_range(model, q.column);
      if (range == nullptr) continue;
      const double low = in_unit(q, used.low);
      const double high = in_unit(q, used.high);
      const double below = beyond(range->low - low, *range);
      const double above = beyond(high - range->high, *range);
      if (!(below > 0.0 || above > 0.0)) continue;
      std::string by;
      if (below > 0.0) by = fmt::format("by {:.6g} {} below", below, q.unit);
      if (above > 0.0) {
        by += fmt::format("{}by {:.6g} {} above", by.empty() ? "" : " and ", above, q.unit);
      }
      notes.push_back(fmt::format("{}: {} {} leaves the range of the {} model, {}, {}", used.where,
                                  q.title, interval_text(low, high, q.unit),
                                  kKindNames[static_cast<std::size_t>(model.kind)],
                                  interval_text(range->low, range->high, q.unit), by));
    }
  }
  return notes;
}

bool changes_gearbox(const AppliedCause& applied, Kind kind) {
  const Cause* cause = find_cause(applied.id);
  if (cause == nullptr || cause->remedy == Remedy::kSensor || cause->remedy == Remedy::kProcedure ||
      cause->remedy == Remedy::kAccuracy) {
    return false;
  }
  // In data of pairs the bearings are the test rig's: they add to the response.
  Modification m;
  std::vector<Scalar> p;
  p.reserve(applied.value.size());
  for (const double value : applied.value) p.push_back(constant<Scalar>(value));
  cause->apply(applied.form, p, {}, kind, m);
  return is_neutral(m.added, 0.0) && is_neutral(m.response_factor, 1.0);
}

bool needs_operating_point(const design::Extension<double>& e) {
  const bool drags = std::ranges::any_of(e.drag, [](const auto& d) {
    return d.constant_Nm != 0.0 || d.viscous_Nms != 0.0 || d.quadratic_Nms2 != 0.0;
  });
  return drags || depends_on_state(e.friction) || e.planet_bearing_arm_m != 0.0 ||
         e.output_bearing_share != 0.0 || e.drag_temperature_1_K != 0.0;
}

std::vector<std::string> black_box_causes(const std::vector<ExtendedModel>& models) {
  std::vector<std::string> ids;
  for (const ExtendedModel& model : models) {
    for (const AppliedCause& cause : model.causes) {
      const bool of_shafts =
          std::ranges::any_of(cause.form.constants, [](const FormConstant& constant) {
            return constant.unit == "Nm" || constant.unit == "rad/s";
          });
      if (of_shafts) ids.push_back(cause.id);
    }
  }
  return ids;
}

}  // namespace gear3k::calibrate
