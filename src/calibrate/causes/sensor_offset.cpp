#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::sensor_offset {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind) {
  return {{.name = "offset",
           .unit = "Nm",
           .lower = -100.0,
           .upper = 100.0,
           .plausible_low = -1.0,
           .plausible_high = 1.0}};
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission) return {};
  return {{.name = "offset"}};
}

void apply(const Form&, std::span<const Scalar> p, const Condition& condition, Kind,
           Modification& m) {
  if (!condition.reference_sensor) m.sensor_offset = m.sensor_offset + p[0];
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "sensor_offset",
                  .title = "zero error of the torque sensor",
                  .remedy = Remedy::kSensor,
                  .place = Place::kMeasurement,
                  .weight = 0.7,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::sensor_offset
