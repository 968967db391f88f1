#include "calibrate/model/extended_model.hpp"

#include <fmt/format.h>

#include <stdexcept>

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

void apply_cause(const AppliedCause& applied, const Condition& condition, Kind kind,
                 Modification& m) {
  const Cause& cause = cause_of(applied);
  const std::size_t count = cause.parameters(applied.form, kind).size();
  if (applied.value.size() != count) {
    throw std::invalid_argument(fmt::format("extended model: {} has {} parameters, allowed: {}",
                                            applied.id, applied.value.size(), count));
  }
  std::vector<Scalar> p;
  p.reserve(count);
  for (const double value : applied.value) p.push_back(constant<Scalar>(value));
  cause.apply(applied.form, p, condition, kind, m);
}

}  // namespace

void apply_model(const ExtendedModel& model, const Condition& condition, Kind kind,
                 Modification& m) {
  for (const AppliedCause& applied : model.causes) {
    if (cause_of(applied).remedy == Remedy::kProcedure) continue;
    if (kind == model.kind) {
      apply_cause(applied, condition, kind, m);
      continue;
    }
    // Responses and sensors of another kind are other ones; the gearbox is the same.
    Modification other{.gearbox = m.gearbox};
    apply_cause(applied, condition, model.kind, other);
    m.gearbox = other.gearbox;
  }
}

design::Extension<double> extension_of(const std::vector<ExtendedModel>& models) {
  Modification m;
  for (const ExtendedModel& model : models) {
    for (const AppliedCause& applied : model.causes) {
      if (of_measurement(cause_of(applied).remedy)) continue;
      apply_cause(applied, {}, model.kind, m);
    }
  }
  return design::extension_as<double>(m.gearbox);
}

}  // namespace gear3k::calibrate
