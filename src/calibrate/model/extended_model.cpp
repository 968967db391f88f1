#include "calibrate/model/extended_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibrate/model/hypothesis.hpp"
#include "design/scalar_as.hpp"

namespace gear3k::calibrate {

namespace {

const Cause& cause_of(const AppliedCause& applied) {
  const Cause* cause = find_cause(applied.id);
  if (cause == nullptr) {
    throw std::invalid_argument(fmt::format("extended model: there is no cause {}", applied.id));
  }
  return *cause;
}

/// The measurement and how it went; what belongs to the gearbox is everything else.
bool of_measurement(Remedy remedy) {
  return remedy == Remedy::kSensor || remedy == Remedy::kProcedure;
}

/// Loops of torque and angle become rows of lost motion, read by other sensors.
bool same_response(Kind a, Kind b) {
  const auto is_lost_motion = [](Kind kind) {
    return kind == Kind::kLostMotion || kind == Kind::kTorqueAngle;
  };
  return is_lost_motion(a) && is_lost_motion(b);
}

bool is_left_behind(const AppliedCause& applied) {
  return cause_of(applied).leave_behind != nullptr;
}

void apply_cause(const AppliedCause& applied, const Condition& condition, Kind kind,
                 Modification& m) {
  const Cause& cause = cause_of(applied);
  const std::size_t count = cause.parameters(applied.form, kind).size();
  if (applied.value.size() != count) {
    throw std::invalid_argument(fmt::format("extended model: {} has {} parameters, allowed: {}",
                                            applied.id, applied.value.size(), count));
  }
  std::vector<Scalar> value = constants_of(applied.value);
  Condition at = condition;
  if (cause.leave_behind != nullptr) cause.leave_behind(applied.form, value, at);
  if (cause.as_constant != nullptr && std::isfinite(applied.left_behind)) {
    const Scalar change(applied.left_behind);
    const Form form = cause.as_constant(applied.form, applied.left_behind_on);
    cause.apply(form, {&change, 1}, at, kind, m);
    return;
  }
  cause.apply(applied.form, value, at, kind, m);
}

}  // namespace

std::size_t parameter_count(const ExtendedModel& model) {
  std::size_t count = 0;
  for (const AppliedCause& cause : model.causes) count += cause.value.size();
  for (const AppliedLaw& law : model.laws) count += law.value.size();
  return count;
}

void apply_model(const ExtendedModel& model, const Condition& condition, Kind kind,
                 Modification& m) {
  for (const AppliedCause& applied : model.causes) {
    if (kind == model.kind || (same_response(kind, model.kind) && is_left_behind(applied))) {
      apply_cause(applied, condition, kind, m);
      continue;
    }
    // Responses and sensors of another kind are other ones; the gearbox is the same.
    Modification other;
    other.gearbox = m.gearbox;
    apply_cause(applied, condition, model.kind, other);
    m.gearbox = other.gearbox;
  }
  if (kind != model.kind) return;
  for (const AppliedLaw& law : model.laws) {
    if (!is_of_campaign(law.law)) {
      apply_law(law, condition, kind, m);
    } else if (const auto left = as_left_behind(law)) {
      apply_law(*left, condition, kind, m);
    }
  }
}

bool has_whole_windup(const std::vector<ExtendedModel>& models) {
  return std::ranges::any_of(models, [](const ExtendedModel& model) {
    return !model.beyond_springs &&
           std::ranges::find(model.causes, "compliance", &AppliedCause::id) != model.causes.end();
  });
}

design::Extension<double> extension_of(const std::vector<ExtendedModel>& models) {
  Modification m;
  for (const ExtendedModel& model : models) {
    if (model.beyond_springs) m.gearbox.lost_motion.beyond_springs = true;
    for (const AppliedCause& applied : model.causes) {
      if (of_measurement(cause_of(applied).remedy)) continue;
      apply_cause(applied, {}, model.kind, m);
    }
  }
  return design::extension_as<double>(m.gearbox);
}

}  // namespace gear3k::calibrate
