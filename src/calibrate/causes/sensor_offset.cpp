#include <cmath>

#include "calibrate/causes/reading_change.hpp"
#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::sensor_offset {

namespace {

/// Zero of a sensor that goes with its temperature: in proportion to T − T_0, with the zero at T_0
/// given (0) or, once it is found, as a parameter.
constexpr const char* kWarming = "by_temperature";
constexpr const char* kWarmingAnyZero = "by_temperature_any_zero";
/// The other sensor's: what the output carries is not what was read.  In that sensor's own sign, or
/// the same whichever way anything turns or drives (kOutputMagnitude: a load cell pulled one way
/// only, the hanger of a weight).
constexpr const char* kOutput = "output";
/// The greatest zero error [Nm], an assumption; of the output's fit/row_gain.hpp tells.
constexpr double kMostZero = 1.0;

bool follows_temperature(const Form& form) {
  return form.name == kWarming || form.name == kWarmingAnyZero;
}

bool is_of_output(const Form& form) {
  return form.name == kOutput || form.name == kOutputMagnitude;
}

std::vector<ParameterRecord> parameters(const Form& form, Kind) {
  constexpr double kFar = 1e6;
  if (is_of_output(form)) {
    return {{.name = "offset",
             .unit = "Nm",
             .lower = -kFar,
             .upper = kFar,
             .plausible_low = -kFar,
             .plausible_high = kFar}};
  }
  std::vector<ParameterRecord> result;
  if (follows_temperature(form)) {
    constexpr double kOverKelvin = 20.0;
    result.push_back({.name = "zero_drift",
                      .unit = "Nm/K",
                      .lower = -100.0,
                      .upper = 100.0,
                      .plausible_low = -kMostZero / kOverKelvin,
                      .plausible_high = kMostZero / kOverKelvin});
  }
  if (form.name != kWarming) {
    result.push_back({.name = "offset",
                      .unit = "Nm",
                      .lower = -100.0,
                      .upper = 100.0,
                      .plausible_low = -kMostZero,
                      .plausible_high = kMostZero});
  }
  return result;
}

std::vector<Form> forms(const Occasion& o) {
  if (o.kind != Kind::kTransmission) return {};
  std::vector<Form> result{{.name = "offset"},
                           {.name = kOutput, .weight = 0.4},
                           {.name = std::string(kOutputMagnitude), .weight = 0.4}};
  if (!tells_of_temperature(o)) return result;
  const auto [coldest_K, warmest_K] = o.temperature_K;
  const double middle_K = 0.5 * (coldest_K + warmest_K);
  const auto add = [&](const char* name, double reference_K, double weight) {
    result.push_back({.name = name,
                      .constants = {{.name = "reference_temperature",
                                     .unit = "c",
                                     .value = kTemperature.stated(reference_K)}},
                      .weight = weight});
  };
  add(kWarming, middle_K, 0.2);
  add(kWarming, coldest_K, 0.08);
  add(kWarming, warmest_K, 0.08);
  add(kWarmingAnyZero, middle_K, 0.0);
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind,
           Modification& m) {
  if (form.name == kOutput) {
    m.output_sensor.own_sign = m.output_sensor.own_sign + p[0];
    return;
  }
  if (form.name == kOutputMagnitude) {
    m.output_sensor.magnitude = m.output_sensor.magnitude + p[0];
    return;
  }
  if (condition.reference_sensor) return;
  if (form.name != kWarming) m.sensor_offset = m.sensor_offset + p.back();
  if (!follows_temperature(form) || !std::isfinite(condition.temperature_K)) return;
  const double reference_K = kTemperature.si(form.constant("reference_temperature"));
  m.sensor_offset = m.sensor_offset + p[0] * (condition.temperature_K - reference_K);
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "sensor_offset",
                  .title = "zero error of a torque sensor",
                  .remedy = Remedy::kSensor,
                  .place = Place::kMeasurement,
                  .weight = 0.7,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply,
                  .acts_in_gearbox = is_of_output};

}  // namespace gear3k::calibrate::sensor_offset
