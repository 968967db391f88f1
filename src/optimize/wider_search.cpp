#include "optimize/wider_search.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"

namespace gear3k::optimize {

namespace {

constexpr int kMoreTeeth = 2;
constexpr double kMoreTolerance = 1.1;

/// A task with one bound given way.
struct WiderTask {
  Specification spec;
  double value = 0.0;       ///< of the key then
  bool beyond_only = true;  ///< it has only what lies beyond
};

std::optional<WiderTask> wider_range(const Specification& spec, const std::string& key,
                                     IntegerRange ToothRanges::*range, std::string_view gear) {
  WiderTask task{.spec = spec};
  const IntegerRange& stated = spec.teeth.*range;
  if (key == fmt::format("teeth.{}[1]", gear)) {
    task.spec.teeth.*range = {.min = stated.max + 1, .max = stated.max + kMoreTeeth};
    task.value = stated.max + kMoreTeeth;
    return task;
  }
  if (key != fmt::format("teeth.{}[0]", gear) || stated.min <= kMoreTeeth + 1) return std::nullopt;
  task.spec.teeth.*range = {.min = stated.min - kMoreTeeth, .max = stated.min - 1};
  task.value = stated.min - kMoreTeeth;
  return task;
}

std::optional<WiderTask> wider_task(const Specification& spec, const std::string& key) {
  for (const auto& [gear, range] :
       {std::pair{"S", &ToothRanges::S}, std::pair{"P1", &ToothRanges::P1},
        std::pair{"P2", &ToothRanges::P2}}) {
    if (auto task = wider_range(spec, key, range, gear)) return task;
  }
  WiderTask task{.spec = spec, .value = 0.0, .beyond_only = false};
  ToothRanges& teeth = task.spec.teeth;
  if (key == "teeth.R1_max") {
    task.value = teeth.R1_max += kMoreTeeth;
  } else if (key == "teeth.R2_max") {
    task.value = teeth.R2_max += kMoreTeeth;
  } else if (key == "teeth.max_coaxial_offset") {
    task.value = ++teeth.max_coaxial_offset;
  } else if (key == "teeth.min_internal_difference" && teeth.min_internal_difference > 1) {
    task.value = --teeth.min_internal_difference;
  } else if (key == "ratio.tolerance") {
    task.value = task.spec.ratio.tolerance *= kMoreTolerance;
  } else {
    return std::nullopt;
  }
  return task;
}

}  // namespace

void search_beyond(const Specification& spec, const RefinedSet& best, std::size_t sets,
                   HeldBack& held, Progress& progress) {
  const Objective first = first_objective(spec);
  if (!is_efficiency(first) || !has_bounds(spec) || judged_by_model(spec)) return;
  progress.stage = Progress::Stage::kBeyond;
  progress.stage_done = 0;
  progress.searches = 0;
  progress.stage_total = held.at.size();
  for (SearchBound& bound : held.at) {
    auto task = wider_task(spec, bound.key);
    if (task && (task->beyond_only || sets <= kMostSearchedAgain)) {
      task->spec.objectives = {first};
      ++progress.searches;
      const OptimizeResult result =
          optimize(task->spec, progress, {.best_only = true, .certify = false});
      if (result.interrupted) break;
      WiderSearch wider{.value = task->value, .better = std::nullopt};
      const auto cost = [&](const RefinedSet& set) {
        return cost_in_steps(first, objective_of(spec, set, first));
      };
      if (result.best && cost(*result.best) < cost(best)) wider.better = result.best;
      bound.wider = wider;
    }
    ++progress.stage_done;
  }
  progress.stage = Progress::Stage::kOne;
}

}  // namespace gear3k::optimize
