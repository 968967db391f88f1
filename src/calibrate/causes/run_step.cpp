#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string_view>

#include "calibrate/causes/reading_change.hpp"
#include "calibrate/measurement/blank_conditions.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/model/cause.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate::run_step {

namespace {

constexpr const char* kFirstRun = "first_run";
constexpr const char* kInstant = "instant";

/// Sessions that a form with a value for each can tell apart.
constexpr std::array<std::string_view, kMostSessions> kSessionNames{
    "session_1",  "session_2",  "session_3",  "session_4",  "session_5",  "session_6",
    "session_7",  "session_8",  "session_9",  "session_10", "session_11", "session_12",
    "session_13", "session_14", "session_15", "session_16"};

/// How many values a form of all sessions has.
std::size_t sessions_of(const Form& form) {
  const auto at = std::ranges::find(form.constants, kSessions, &FormConstant::name);
  constexpr auto kMost = static_cast<double>(kSessionNames.size());
  return at == form.constants.end()
             ? 0
             : static_cast<std::size_t>(std::clamp(std::floor(at->value), 0.0, kMost));
}

std::vector<ParameterRecord> parameters(const Form& form, Kind kind) {
  const Target target = form.name.starts_with("sensor") ? Target::kOffset : target_of(form.name);
  if (!gives_each_session_a_value(form)) return {change_parameter("step", target, kind)};
  std::vector<ParameterRecord> result;
  for (std::size_t k = 0; k < sessions_of(form); ++k) {
    result.push_back(change_parameter(kSessionNames[k], target, kind));
  }
  return result;
}

/// Of two sessions a step knows that there are no more of them.
constexpr int kTwo = 2;
bool is_between_two(const Form& form) {
  return !gives_each_session_a_value(form) && sessions_of(form) == kTwo;
}

/// Ends of equal parts of the time, where no runs are told apart, or one is all.
std::vector<double> instants(const MeasurementSet& data) {
  constexpr int kParts = 10;
  const ValueRange time = used_range(data, kTime);
  std::vector<double> result;
  if (!time.varies()) return result;
  result.reserve(kParts - 1);
  for (int k = 1; k < kParts; ++k) {
    result.push_back(time.low + (time.high - time.low) * k / kParts);
  }
  return result;
}

/// One row that is off is no step, whatever session it says it is of, nor are two.
constexpr std::ptrdiff_t kFewestRows = 3;

std::ptrdiff_t rows_of(const MeasurementSet& data, int run) {
  return std::ranges::count_if(data.rows,
                               [&](const Observation& row) { return row.condition.run == run; });
}

/// Whether so many rows lie on either side of a place.
bool has_rows(const MeasurementSet& data, const FormConstant& place) {
  const bool by_run = place.name == kFirstRun;
  std::ptrdiff_t before = 0, after = 0;
  for (const Observation& row : data.rows) {
    const double at = by_run ? row.condition.run : row.condition.time_s;
    if (!std::isfinite(at) || (by_run && row.condition.run < 0)) continue;
    ++(at >= place.value ? after : before);
  }
  return std::min(before, after) >= kFewestRows;
}

/// Whether every session has more than one row: a value of its own would only leave that one out.
bool have_rows_each(const MeasurementSet& data) {
  std::vector<int> rows(data.runs.size(), 0);
  for (const Observation& row : data.rows) {
    if (row.condition.run >= 0) ++rows[static_cast<std::size_t>(row.condition.run)];
  }
  return std::ranges::all_of(rows, [](int count) { return count >= 2; });
}

/// From one run (or instant) on, of more sessions than have a value each from one of 31; or up to
/// there, when the later runs are those that fit; or in one run alone, between others; or every
/// session with a value of its own.  Each may act on the reading or on what makes it; of the
/// sensor's own sign it is named for the sensor.
std::vector<Form> forms(const Occasion& o) {
  std::vector<FormConstant> places;
  const auto runs = static_cast<int>(o.data->runs.size());
  const bool few = runs <= static_cast<int>(kSessionNames.size());
  // Of many sessions every so many-th: what lies between is as good as met by its neighbour.
  constexpr int kMostPlaces = 31;
  const int count = std::min(runs - 1, few ? runs - 1 : kMostPlaces);
  for (int k = 1; k <= count; ++k) {
    const int run =
        few ? k : static_cast<int>(std::lround(static_cast<double>(k) * runs / (count + 1)));
    places.push_back({.name = kFirstRun, .unit = "", .value = static_cast<double>(run)});
  }
  constexpr int kFewestToStep = 2;  // one session has no steps between sessions
  if (runs < kFewestToStep) {
    for (const double t : instants(*o.data)) {
      places.push_back({.name = kInstant, .unit = "s", .value = t});
    }
  }
  std::erase_if(places, [&](const FormConstant& place) { return !has_rows(*o.data, place); });
  const bool each = have_rows_each(*o.data);
  std::vector<Form> result;
  for (const TargetRecord& target : targets_of(o.kind)) {
    const bool offset = target.target == Target::kOffset;
    const auto name = [&](const std::string& shape) {
      return offset ? "sensor_" + shape : targeted(shape, target);
    };
    const auto add = [&](const std::string& shape, const FormConstant& place, double weight) {
      constexpr double kOfAdded = 0.4;
      std::vector<FormConstant> constants{place};
      if (runs == kTwo) constants.push_back({.name = kSessions, .unit = "", .value = kTwo});
      result.push_back({.name = name(shape),
                        .constants = std::move(constants),
                        .weight = weight * target.weight / kOfAdded,
                        .law = target.law});
    };
    for (const FormConstant& place : places) {
      const double share = 1.0 / std::sqrt(static_cast<double>(places.size()));
      add("from", place, 0.5 * share);
      add("until", place, 0.25 * share);
      if (few && place.name == kFirstRun && place.value + 1 < runs &&
          rows_of(*o.data, static_cast<int>(place.value)) >= kFewestRows) {
        add("only", place, 0.25 * share);
      }
    }
    constexpr int kFewest = 3;
    if (runs >= kFewest && few && each) {
      add(kSessions, {.name = kSessions, .unit = "", .value = static_cast<double>(runs)}, 0.5);
    }
  }
  return result;
}

void apply(const Form& form, std::span<const Scalar> p, const Condition& condition, Kind kind,
           Modification& m) {
  const Target target = form.name.starts_with("sensor") ? Target::kOffset : target_of(form.name);
  if (gives_each_session_a_value(form)) {
    if (condition.run < 0 || condition.run >= static_cast<int>(p.size())) return;
    change_reading(target, p[static_cast<std::size_t>(condition.run)], condition, kind, m);
    return;
  }
  const FormConstant& place = form.constants.front();
  const bool by_run = place.name == kFirstRun;
  const double at = by_run ? condition.run : condition.time_s;
  if (by_run ? condition.run < 0 : !std::isfinite(at)) return;
  if (form.name.find("only") != std::string::npos) {
    if (at != place.value) return;
  } else {
    const bool later = at >= place.value;
    const bool until = form.name.find("until") != std::string::npos;
    if (later == until) return;
  }
  change_reading(target, p[0], condition, kind, m);
}

/// How much the sessions scatter about their mean: √(Σ (x − x̄)²/(k − 1)).
std::vector<DerivedParameter> session_deviation(const Form& form, std::span<const Scalar> p,
                                                const Simulation& simulation, const Modification&) {
  using std::sqrt;
  if (!gives_each_session_a_value(form) || p.size() < 2) return {};
  Scalar mean(0.0);
  for (const Scalar& x : p) mean = mean + x / static_cast<double>(p.size());
  Scalar squares(0.0);
  for (const Scalar& x : p) squares = squares + (x - mean) * (x - mean);
  if (!(squares.a > 0.0)) return {};
  ParameterRecord record = parameters(form, simulation.kind()).front();
  record.name = "session_deviation";
  return {{.record = record,
           .value = sqrt(Scalar(squares / static_cast<double>(p.size() - 1))),
           .leads = true}};
}

/// Steps stay as in the last session; of sessions with a value each the next one is expected at
/// their mean.  So it is of two with a step between them, which do not tell a change that stays
/// (the last would be right, the mean half the step off, as one refitted value is) from values
/// drawn anew in each session (of deviation τ: the last is √2 τ off, the mean and a refit √1.5 τ).
void leave_behind(const Form& form, std::span<Scalar> value, Condition& condition) {
  if (gives_each_session_a_value(form)) {
    const Scalar sum = std::accumulate(value.begin(), value.end(), Scalar(0.0));
    std::ranges::fill(value, Scalar(sum / static_cast<double>(value.size())));
    condition.run = 0;
    return;
  }
  if (is_between_two(form)) {
    for (Scalar& x : value) x = 0.5 * x;
    const bool until = form.name.find("until") != std::string::npos;
    condition.run = until ? 0 : std::numeric_limits<int>::max();
    return;
  }
  condition.run = std::numeric_limits<int>::max();
  condition.time_s = std::numeric_limits<double>::max();
}

/// From the first session, or before all time, on.
Form as_constant(const Form& form, std::string_view law) {
  const bool by_time = form.constants.front().name == kInstant;
  FormConstant place{.name = kFirstRun, .unit = "", .value = 0.0};
  if (by_time) place = {.name = kInstant, .unit = "s", .value = -HUGE_VAL};
  const TargetRecord target{.target = target_of(law), .law = law, .weight = 1.0};
  return {.name = target.target == Target::kOffset ? "sensor_from" : targeted("from", target),
          .constants = {place},
          .law = law};
}

}  // namespace

extern const Cause cause;
const Cause cause{.id = "run_step",
                  .title = "a step between measuring sessions or in time",
                  .remedy = Remedy::kProcedure,
                  .place = Place::kMeasurement,
                  .weight = 1.5,
                  .parameters = parameters,
                  .forms = forms,
                  .apply = apply,
                  .derived = session_deviation,
                  .leave_behind = leave_behind,
                  .as_constant = as_constant};

}  // namespace gear3k::calibrate::run_step
