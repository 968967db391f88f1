#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::sensor_gain {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return {{.name = "gain_error",
           .unit = "",
           .lower = -0.9,
           .upper = 9.0,
           .plausible_low = -0.1,
           .plausible_high = 0.1}};
}

/// Of pairs either that of a sensor on one of the two shafts, whose torques are compared, or that
/// of the sensor which reads the loss itself, as on a rig in which the power goes round.
constexpr const char* kLoss = "loss";

std::vector<Form> forms(const Occasion& o) {
  if (o.kind == Kind::kTransmission) return {{.name = "gain"}};
  if (o.kind != Kind::kPairLoss) return {};
  return {{.name = "gain"}, {.name = kLoss, .weight = 0.3}};
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind,
           Modification& m) {
  if (condition.reference_sensor) return;
  Scalar& factor = form.name == kLoss ? m.response_factor : m.sensor_gain;
  factor = factor * (1.0 + p[0]);
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "sensor_gain",
                  .title = "gain error of the torque sensor",
                  .remedy = Remedy::kSensor,
                  .place = Place::kMeasurement,
                  .weight = 0.9,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::sensor_gain
