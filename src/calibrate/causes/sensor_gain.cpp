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

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission && o.kind != Kind::kPairLoss) return {};
  return {{.name = "gain"}};
}

void apply(const Form&, std::span<const Scalar> p, const Condition& condition, Kind,
           Modification& m) {
  if (!condition.reference_sensor) m.sensor_gain = m.sensor_gain * (1.0 + p[0]);
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
