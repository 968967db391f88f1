#include "io/files/measurement_time.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace gear3k::io {

namespace {

constexpr std::size_t kStepsPerStepBack = 10;  // more steps back: rows not in order of time

struct Instant {
  double time_s = calibrate::kUnknown;
  int line = 0;  ///< 0: none yet
};
struct StepBack {
  Instant from, to;
};

struct Steps {
  std::vector<StepBack> back;  ///< the first of them
  std::size_t count = 0, count_back = 0;
};

Steps steps_of(const calibrate::MeasurementSet& set, bool must_increase) {
  Steps steps;
  std::vector<Instant> latest(set.runs.size() + 1);
  for (const calibrate::Observation& o : set.rows) {
    if (std::isnan(o.condition.time_s)) continue;
    Instant& last = latest[o.condition.run < 0 ? 0 : static_cast<std::size_t>(o.condition.run) + 1];
    const Instant now{.time_s = o.condition.time_s, .line = o.line};
    if (last.line > 0) {
      ++steps.count;
      if (must_increase ? now.time_s <= last.time_s : now.time_s < last.time_s) {
        ++steps.count_back;
        if (steps.back.size() <= Complaints::kMost) steps.back.push_back({.from = last, .to = now});
      }
    }
    last = now;
  }
  return steps;
}

}  // namespace

void check_time(calibrate::MeasurementSet& set, Complaints& complaints) {
  const bool loop = set.kind == calibrate::Kind::kTorqueAngle;
  const Steps steps = steps_of(set, loop);
  if (steps.count_back == 0) return;
  if (!loop && steps.count_back > 1 && steps.count_back * kStepsPerStepBack > steps.count) {
    const StepBack& first = steps.back[0];
    set.notes.push_back(fmt::format(
        "{}: rows are not in the order of time_s ({} after {} in lines {} and {}, the first of "
        "{}): each is taken at its time",
        set.files[0], first.to.time_s, first.from.time_s, first.from.line, first.to.line,
        steps.count_back));
    return;
  }
  for (const StepBack& step : steps.back) {
    complaints.add(
        {.line = step.to.line, .column = 1},
        fmt::format("time_s = {} after {} in line {}: allowed: {} within a run (a clock that "
                    "began anew is a new session: label it in the column run)",
                    step.to.time_s, step.from.time_s, step.from.line,
                    loop ? "above the time before" : "not below the time before"));
  }
}

}  // namespace gear3k::io
