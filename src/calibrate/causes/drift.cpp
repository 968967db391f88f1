#include <algorithm>
#include <cmath>
#include <string>

#include "calibrate/causes/reading_change.hpp"
#include "calibrate/measurement/blank_conditions.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate::drift {

namespace {

constexpr std::string_view kScale = "any_scale";
constexpr std::string_view kExponent = "any_exponent";
constexpr std::string_view kFrom = "any_start";

bool holds(const Form& form, std::string_view word) {
  return form.name.find(word) != std::string::npos;
}

std::vector<ParameterRecord> parameters(const Form& form, Kind kind) {
  const Target target = target_of(form.name);
  std::vector<ParameterRecord> result{change_parameter("change", target, kind)};
  // A time constant beyond the data is a straight line, and an exponent no more than a shape: no
  // value of theirs is one that cannot be.
  const auto shape = [&](std::string_view name, double bound) {
    result.push_back({.name = name,
                      .unit = "",
                      .lower = -bound,
                      .upper = bound,
                      .plausible_low = -HUGE_VAL,
                      .plausible_high = HUGE_VAL});
  };
  constexpr double kScales = 3.0;
  constexpr double kExponents = 1.6;
  if (holds(form, kScale)) {
    shape("log_scale_change", kScales);
    // What it tends to no row need reach: the coefficient in the rows says what can be.
    constexpr double kFarEnd = 10.0;
    if (target == Target::kFriction) result[0].lower = result[0].plausible_low = -kFarEnd;
  }
  // Nor what a gain tends to: its greatest change in the rows says what can be.
  if (target == Target::kGain) {
    result[0].plausible_low = result[0].lower;
    result[0].plausible_high = result[0].upper;
  }
  if (holds(form, kExponent)) shape("log_exponent", kExponents);
  if (holds(form, kFrom)) result.push_back(change_parameter(kStartChange, target, kind));
  return result;
}

/// From the first to the last row (of loops from the beginning of their record: by the first loop
/// something has changed): linear, levelling off (wear that runs in), or dying away (the
/// end fits the simulation).  Once it is found: with the time constant, or the exponent of a power
/// of the time, or both (wear that sets in late: 1 − exp(−(t/τ)^k)), or as the logarithm of the
/// time (creep), and with the value at the start as parameters of their own.
std::vector<Form> forms(const Occasion& o) {
  std::vector<Form> result;
  const auto add = [&](const char* variable, const char* unit, const ConditionQuantity& quantity) {
    ValueRange range = used_range(*o.data, quantity);
    if (!range.varies()) return;
    if (quantity.member == &Condition::time_s && o.data->record_start_s < range.low) {
      range.low = o.data->record_start_s;
    }
    const double span = range.high - range.low;
    for (const TargetRecord& target : targets_of(o.kind)) {
      const auto form = [&](const std::string& shape, double constant, double weight) {
        return Form{.name = targeted(shape + "_" + variable, target),
                    .constants = {{.name = "start", .unit = unit, .value = range.low},
                                  {.name = "span", .unit = unit, .value = span},
                                  {.name = "time_constant", .unit = unit, .value = constant}},
                    .weight = weight * target.weight,
                    .law = target.law};
      };
      result.push_back(form("linear", span, 0.4));
      result.push_back(form("levelling", 0.3 * span, 0.15));
      result.push_back(form("levelling", 0.1 * span, 0.1));
      result.push_back(form("dying", 0.3 * span, 0.1));
      result.push_back(form("dying", 0.1 * span, 0.05));
      result.push_back(form("centred", span, 0.2));
      result.push_back(form("levelling_any_scale", 0.3 * span, 0.0));
      result.push_back(form("levelling_any_scale_any_start", 0.3 * span, 0.0));
      result.push_back(form("logarithmic_any_scale", 0.3 * span, 0.0));
      result.push_back(form("logarithmic_any_scale_any_start", 0.3 * span, 0.0));
      result.push_back(form("power_any_exponent", span, 0.0));
      result.push_back(form("power_any_exponent_any_start", span, 0.0));
      result.push_back(form("onset_any_scale_any_exponent", 0.3 * span, 0.0));
      result.push_back(form("onset_any_scale_any_exponent_any_start", 0.3 * span, 0.0));
    }
  };
  add("time", "s", kTime);
  add("cycles", "", kCycles);
  return result;
}

/// Share of the change so long after the start, in time constants, of the parameters behind it.
/// @param next  the first of them; then the one behind the last
Scalar share_at(const Form& form, std::span<const Scalar> p, double reduced, std::size_t& next) {
  using std::exp;
  using std::log;
  const auto power = [&](const Scalar& x, const Scalar& exponent) {
    return reduced > 0.0 ? Scalar(exp(Scalar(exponent * log(x)))) : Scalar(0.0);
  };
  if (form.name.starts_with("centred")) return Scalar(reduced - 0.5);
  if (form.name.starts_with("dying")) return Scalar(std::exp(-reduced));
  if (form.name.starts_with("levelling")) {
    const Scalar scale = holds(form, kScale) ? exp(p[next++]) : Scalar(1.0);
    return 1.0 - exp(Scalar(-reduced / scale));
  }
  if (form.name.starts_with("logarithmic")) return log(Scalar(1.0 + reduced / exp(p[next++])));
  if (form.name.starts_with("power")) return power(Scalar(reduced), exp(p[next++]));
  if (form.name.starts_with("onset")) {
    const Scalar scale = exp(p[next++]);
    return 1.0 - exp(Scalar(-power(Scalar(reduced / scale), exp(p[next++]))));
  }
  return Scalar(reduced);
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  const double t = holds(form, "_cycles") ? condition.cycles : condition.time_s;
  if (!std::isfinite(t)) return;
  const double reduced = (t - form.constant("start")) / form.constant("time_constant");
  std::size_t next = 1;
  Scalar change = p[0] * share_at(form, p, reduced, next);
  if (holds(form, kFrom)) change = change + p[next];
  change_reading(target_of(form.name), change, condition, kind, m);
}

/// What changed from the first to the last row, where the end that it tends to is beyond the data:
/// the rows tell it far better than that end.
std::vector<DerivedParameter> change_over_data(const Form& form, std::span<const Scalar> p,
                                               const Simulation& simulation, const Modification&) {
  if (!holds(form, kScale)) return {};
  const double reduced = form.constant("span") / form.constant("time_constant");
  std::size_t next = 1;
  ParameterRecord record =
      change_parameter("change_over_data", target_of(form.name), simulation.kind());
  record.lower = record.plausible_low = -HUGE_VAL;
  record.upper = record.plausible_high = HUGE_VAL;
  return {{.record = record, .value = p[0] * share_at(form, p, reduced, next), .leads = true}};
}

/// A drift stays where it was at the last row.
void leave_behind(const Form& form, std::span<Scalar> /*value*/, Condition& condition) {
  condition.time_s = condition.cycles = form.constant("start") + form.constant("span");
}

/// What dies away in no time that ever passes is a constant.
Form as_constant(const Form& form, std::string_view law) {
  const std::string shape = holds(form, "_cycles") ? "dying_cycles" : "dying_time";
  Form result{.name = targeted(shape, {.target = target_of(law), .law = law, .weight = 1.0}),
              .constants = form.constants,
              .law = law};
  std::ranges::find(result.constants, "time_constant", &FormConstant::name)->value = HUGE_VAL;
  return result;
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
                  .apply = apply,
                  .derived = change_over_data,
                  .leave_behind = leave_behind,
                  .as_constant = as_constant};

}  // namespace gear3k::calibrate::drift
