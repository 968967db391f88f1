#include "calibrate/model/model_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

namespace {

/// A quantity of a row's condition, and what it is of the operating point where a model is used.
struct Quantity {
  const ConditionQuantity* condition;
  double design::OperatingPoint<double>::*member;
};
using Point = design::OperatingPoint<double>;
constexpr std::array<Quantity, 4> kQuantities{
    {{.condition = &kSunSpeed, .member = &Point::sun_speed_rad_s},
     {.condition = &kOutputTorque, .member = &Point::output_torque_Nm},
     {.condition = &kTestTorque, .member = &Point::output_torque_Nm},
     {.condition = &kTemperature, .member = &Point::temperature_K}}};

/// Whether responses of a kind are measured under a quantity.
bool measured_under(const ConditionQuantity* q, Kind kind) {
  if (q == &kTemperature) return true;
  if (q == &kTestTorque) return kind == Kind::kLostMotion || kind == Kind::kTorqueAngle;
  return kind == Kind::kTransmission;
}

double in_unit(const Quantity& q, const Point& point) {
  return q.condition->written(point.*q.member);
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

/// What a cause of a model does by itself.
Modification modification_by(const Cause& cause, const AppliedCause& applied, Kind kind) {
  std::vector<Scalar> p;
  p.reserve(applied.value.size());
  for (const double value : applied.value) p.push_back(constant<Scalar>(value));
  Modification m;
  cause.apply(applied.form, p, {}, kind, m);
  return m;
}

}  // namespace

std::vector<ConditionRange> ranges_of(const MeasurementSet& data) {
  std::vector<ConditionRange> result;
  for (const Quantity& q : kQuantities) {
    const ConditionQuantity& condition = *q.condition;
    const ValueRange range = range_of(data, condition.member);
    if (!measured_under(q.condition, data.kind) || !range.known()) continue;
    result.push_back({.name = std::string(condition.name),
                      .unit = std::string(condition.unit),
                      .low = condition.stated(range.low),
                      .high = condition.stated(range.high)});
  }
  return result;
}

std::optional<Point> middle_of_range(const std::vector<ExtendedModel>& models) {
  for (const ExtendedModel& model : models) {
    if (find_range(model, "sun_speed") == nullptr ||
        find_range(model, "output_torque") == nullptr) {
      continue;
    }
    Point point;
    for (const Quantity& q : kQuantities) {
      const ConditionRange* range = find_range(model, q.condition->name);
      if (range == nullptr) continue;
      point.*q.member = q.condition->si(0.5 * range->low + 0.5 * range->high);
    }
    return point;
  }
  return std::nullopt;
}

namespace {

/// How a quantity leaves a model's range; empty where it does not.  @param low, high  in its unit
std::string leaving(const std::string& where, const Quantity& q, double low, double high,
                    const ConditionRange& range, Kind kind) {
  const double below = beyond(range.low - low, range);
  const double above = beyond(high - range.high, range);
  if (!(below > 0.0 || above > 0.0)) return {};
  const std::string_view unit = q.condition->shown_unit;
  std::string by;
  if (below > 0.0) by = fmt::format("by {:.6g} {} below", below, unit);
  if (above > 0.0)
    by += fmt::format("{}by {:.6g} {} above", by.empty() ? "" : " and ", above, unit);
  return fmt::format("{}: {} {} leaves the range of the {} model, {}, {}", where,
                     q.condition->title, interval_text(low, high, q.condition->shown_unit),
                     kKindNames[static_cast<std::size_t>(kind)],
                     interval_text(range.low, range.high, q.condition->shown_unit), by);
}

}  // namespace

std::vector<std::string> outside_range(const std::vector<ExtendedModel>& models,
                                       const UsedRange& used) {
  std::vector<std::string> notes;
  for (const ExtendedModel& model : models) {
    for (const Quantity& q : kQuantities) {
      const ConditionRange* range = find_range(model, q.condition->name);
      if (range == nullptr) continue;
      std::string note =
          leaving(used.where, q, in_unit(q, used.low), in_unit(q, used.high), *range, model.kind);
      if (!note.empty()) notes.push_back(std::move(note));
    }
  }
  return notes;
}

std::vector<std::string> outside_range(const std::vector<ExtendedModel>& models,
                                       const MeasurementSet& data) {
  const std::vector<ConditionRange> measured = ranges_of(data);
  std::vector<std::string> notes;
  for (const ExtendedModel& model : models) {
    if (model.kind != data.kind) continue;
    for (const Quantity& q : kQuantities) {
      const ConditionRange* range = find_range(model, q.condition->name);
      const auto own = std::ranges::find(measured, q.condition->name, &ConditionRange::name);
      if (range == nullptr || own == measured.end()) continue;
      std::string note = leaving("these data", q, own->low, own->high, *range, model.kind);
      if (!note.empty()) notes.push_back(std::move(note));
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
  const Modification m = modification_by(*cause, applied, kind);
  return is_neutral(m.added, 0.0) && is_neutral(m.response_factor, 1.0);
}

bool needs_operating_point(const design::Extension<double>& e) {
  const bool drags = std::ranges::any_of(e.drag, [](const auto& d) {
    return d.constant_Nm != 0.0 || d.viscous_Nms != 0.0 || d.quadratic_Nms2 != 0.0;
  });
  return drags || depends_on_state(e.friction) || e.planet_bearing_arm_m != 0.0 ||
         e.output_bearing_share != 0.0 || e.output_bearing_growth.share != 0.0 ||
         e.drag_temperature_1_K != 0.0;
}

std::vector<std::string> black_box_causes(const std::vector<ExtendedModel>& models) {
  std::vector<std::string> ids;
  for (const ExtendedModel& model : models) {
    for (const AppliedCause& cause : model.causes) {
      const bool of_shafts =
          std::ranges::any_of(cause.form.constants, [](const FormConstant& constant) {
            // A test torque, a drag's speed and a bearing's torque are a shaft's, whatever stands
            // between the shafts.
            return (constant.unit == "Nm" && constant.name != "hardening_torque" &&
                    !constant.name.starts_with("soft_torque") &&
                    constant.name != "preload_torque" && constant.name != "top_torque" &&
                    constant.name != "reference_torque") ||
                   (constant.unit == "rad/s" && constant.name != "top_speed");
          });
      if (of_shafts) ids.push_back(cause.id);
    }
  }
  return ids;
}

std::vector<std::string> inner_causes(const std::vector<ExtendedModel>& models) {
  const auto by_teeth = [](const auto& friction) {
    return depends_on_mesh(friction) || !is_neutral(friction.approach, 1.0) ||
           !is_neutral(friction.recess, 1.0);
  };
  const auto drags = [](const auto& drag) {
    return !is_neutral(drag.constant_Nm, 0.0) || !is_neutral(drag.viscous_Nms, 0.0) ||
           !is_neutral(drag.quadratic_Nms2, 0.0);
  };
  std::vector<std::string> ids;
  for (const ExtendedModel& model : models) {
    for (const AppliedCause& applied : model.causes) {
      const Cause* cause = find_cause(applied.id);
      if (cause == nullptr) continue;
      const auto& gearbox = modification_by(*cause, applied, model.kind).gearbox;
      const bool by_constants =
          std::ranges::any_of(applied.form.constants, [](const FormConstant& constant) {
            return constant.unit == "N" || constant.unit == "m/s";
          });
      if (by_constants || by_teeth(gearbox.friction) ||
          !is_neutral(gearbox.planet_bearing_arm_m, 0.0) ||
          !is_neutral(gearbox.drag_temperature_1_K, 0.0) ||
          !is_neutral(gearbox.lost_motion.expansion_1_K, 0.0) ||
          drags(gearbox.drag[design::kPlanetShaft]) || drags(gearbox.drag[design::kCarrierShaft])) {
        ids.push_back(applied.id);
      }
    }
  }
  return ids;
}

}  // namespace gear3k::calibrate
