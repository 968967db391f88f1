#include <cmath>

#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::calibrate::drift {

namespace {

std::vector<ParameterRecord> parameters(const Form&, Kind kind) {
  constexpr double kBound = 1e4;
  return {{.name = "change",
           .unit = response_unit(kind).name,
           .lower = -kBound,
           .upper = kBound,
           .plausible_low = -kBound,
           .plausible_high = kBound}};
}

/// From the first to the last row: linear, levelling off (wear that runs in), or dying away (the
/// end fits the simulation).
std::vector<Form> forms(const Occasion& o) {
  std::vector<Form> result;
  const auto add = [&](const char* variable, const char* unit, double Condition::*member) {
    const ValueRange range = range_of(*o.data, member);
    if (!range.varies()) return;
    const double span = range.high - range.low;
    const auto form = [&](const char* shape, double constant, double weight) {
      return Form{.name = std::string(shape) + "_" + variable,
                  .constants = {{.name = "start", .unit = unit, .value = range.low},
                                {.name = "span", .unit = unit, .value = span},
                                {.name = "time_constant", .unit = unit, .value = constant}},
                  .weight = weight};
    };
    result.push_back(form("linear", span, 0.4));
    result.push_back(form("levelling", 0.3 * span, 0.15));
    result.push_back(form("levelling", 0.1 * span, 0.1));
    result.push_back(form("dying", 0.3 * span, 0.1));
    result.push_back(form("dying", 0.1 * span, 0.05));
    result.push_back(form("centred", span, 0.2));
  };
  add("time", "s", &Condition::time_s);
  add("cycles", "", &Condition::cycles);
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  const double t = form.name.ends_with("cycles") ? condition.cycles : condition.time_s;
  if (!std::isfinite(t)) return;
  const double since = t - form.constant("start");
  const double reduced = since / form.constant("time_constant");
  double share = reduced;
  if (form.name.starts_with("centred")) share = reduced - 0.5;
  if (form.name.starts_with("levelling")) share = 1.0 - std::exp(-reduced);
  if (form.name.starts_with("dying")) share = std::exp(-reduced);
  m.added = m.added + p[0] * (share * response_unit(kind).si);
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "drift",
                  .title = "a drift in time or cycles (wear, running-in)",
                  .remedy = Remedy::kProcedure,
                  .place = Place::kMeasurement,
                  .weight = 1.8,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply};

}  // namespace gear3k::calibrate::drift
