#include <cmath>

#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::run_step {

namespace {

constexpr const char* kFirstRun = "first_run";
constexpr const char* kInstant = "instant";

std::vector<ParameterRecord> parameters(const Form&, Kind kind) {
  constexpr double kBound = 1e4;
  const bool share = kind == Kind::kPairLoss;
  return {{.name = "step",
           .unit = response_unit(kind).name,
           .lower = -kBound,
           .upper = kBound,
           .plausible_low = share ? -0.1 : -kBound,
           .plausible_high = share ? 0.1 : kBound}};
}

/// Ends of equal parts of the time, where no runs are told apart.
std::vector<double> instants(const MeasurementSet& data) {
  constexpr int kParts = 10;
  const ValueRange time = range_of(data, &Condition::time_s);
  std::vector<double> result;
  if (!time.varies()) return result;
  result.reserve(kParts - 1);
  for (int k = 1; k < kParts; ++k) {
    result.push_back(time.low + (time.high - time.low) * k / kParts);
  }
  return result;
}

/// From one run (or instant) on; or up to there, when the later runs are those that fit; or in one
/// run alone, between others; added to the magnitude, or in the sensor's own sign.
std::vector<Form> forms(const Occasion& o) {
  std::vector<FormConstant> places;
  const auto runs = static_cast<int>(o.data->runs.size());
  for (int run = 1; run < runs; ++run) {
    places.push_back({.name = kFirstRun, .unit = "", .value = static_cast<double>(run)});
  }
  if (runs == 0) {
    for (const double t : instants(*o.data)) {
      places.push_back({.name = kInstant, .unit = "s", .value = t});
    }
  }
  std::vector<Form> result;
  for (const FormConstant& place : places) {
    const double share = 1.0 / std::sqrt(static_cast<double>(places.size()));
    result.push_back({.name = "from", .constants = {place}, .weight = 0.5 * share});
    result.push_back({.name = "until", .constants = {place}, .weight = 0.25 * share});
    if (o.kind == Kind::kTransmission) {
      result.push_back({.name = "sensor_from", .constants = {place}, .weight = 0.3 * share});
      result.push_back({.name = "sensor_until", .constants = {place}, .weight = 0.15 * share});
    }
    if (place.name != kFirstRun || place.value + 1 >= runs) continue;
    result.push_back({.name = "only", .constants = {place}, .weight = 0.25 * share});
    if (o.kind == Kind::kTransmission) {
      result.push_back({.name = "sensor_only", .constants = {place}, .weight = 0.15 * share});
    }
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  const FormConstant& place = form.constants.front();
  const bool by_run = place.name == kFirstRun;
  const double at = by_run ? condition.run : condition.time_s;
  if (by_run ? condition.run < 0 : !std::isfinite(at)) return;
  if (form.name.ends_with("only")) {
    if (at != place.value) return;
  } else {
    const bool later = at >= place.value;
    const bool until = form.name.ends_with("until");
    if (later == until) return;
  }
  Scalar& changed = form.name.starts_with("sensor") ? m.sensor_offset : m.added;
  changed = changed + p[0] * response_unit(kind).si;
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "run_step",
                  .title = "a step between measuring sessions",
                  .remedy = Remedy::kProcedure,
                  .place = Place::kMeasurement,
                  .weight = 1.5,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::run_step
