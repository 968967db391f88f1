#include "app/sweep.hpp"

#include <algorithm>
#include <exception>
#include <numeric>
#include <utility>
#include <vector>

#include "app/optimize.hpp"
#include "design/checks.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/stage_relaxer.hpp"
#include "report/robust_report.hpp"
#include "report/search_report.hpp"

namespace gear3k::app {

namespace {

using sweep::TaskResult, sweep::TaskStatus;

/// What stands for the SPEC in messages.
constexpr const char* kTaskName = "task";

TaskResult without_design(TaskStatus status, std::string reason) {
  while (!reason.empty() && reason.back() == '\n') reason.pop_back();
  TaskResult result;
  result.status = status;
  result.reason = std::move(reason);
  return result;
}

/// The best of the sets with a design, first.
std::vector<const optimize::RefinedSet*> best_sets(const optimize::Specification& spec,
                                                   const optimize::OptimizeResult& result) {
  std::vector<const optimize::RefinedSet*> sets;
  for (const optimize::RefinedSet& set : result.refined) {
    if (optimize::has_design(set.status)) sets.push_back(&set);
  }
  std::ranges::stable_sort(sets, std::ranges::greater(), [&](const optimize::RefinedSet* set) {
    // The one that the search calls best comes first, whatever ties there are.
    return std::pair(set->index == result.best->index, optimize::merit_of(spec, *set));
  });
  sets.resize(std::min(sets.size(), sweep::kKeptDesigns));
  return sets;
}

void add_refusals(TaskResult& result, const optimize::OptimizeResult& found,
                  const report::ResultTally& tally) {
  for (std::size_t status = 0; status < optimize::kStatusCount; ++status) {
    const std::string name(optimize::kStatusNames[status]);
    std::size_t with_reason = 0;
    for (const auto& [reason, sets] : tally.reasons[status]) {
      result.refusals.push_back({.status = name, .reason = reason, .sets = sets});
      with_reason += sets;
    }
    if (tally.status[status] > with_reason) {
      result.refusals.push_back(
          {.status = name, .reason = "", .sets = tally.status[status] - with_reason});
    }
  }
  for (std::size_t k = 0; k < optimize::kToothRejectionCount; ++k) {
    if (found.search.rejected[k] == 0) continue;
    result.refusals.push_back({.status = "rejected",
                               .reason = std::string(optimize::kToothRejectionNames[k]),
                               .sets = found.search.rejected[k]});
  }
}

TaskResult solve(const optimize::Specification& spec, optimize::Progress& progress) {
  if (spec.objectives.size() > 1) {
    return without_design(TaskStatus::kInvalid,
                          "objective: a list asks for a Pareto front, of which a sweep keeps none: "
                          "allowed: one objective");
  }
  OptimizeTask task = optimize_task({.spec = spec,
                                     .model = std::nullopt,
                                     .source = kTaskName,
                                     .certify = optimize::has_bounds(spec),
                                     .round = false,
                                     .explain = false});
  const Optimization found = optimize(task, {}, progress);
  TaskResult result;
  if (found.interrupted) {
    result.interrupted = true;
    return result;
  }
  if (!found.searched()) {
    return without_design(TaskStatus::kNoFeasibleDesign,
                          report::robust_blocking_text(task.spec, found.robust->search));
  }
  const report::ResultTally tally = report::tally_of(found.result);
  if (!found.best) {
    result = without_design(
        report::only_failed(tally) ? TaskStatus::kFailed : TaskStatus::kNoFeasibleDesign,
        report::blocking_text(task.spec, found.result, tally));
  } else {
    const bool sound = design::all_ok(found.best->evaluation.checks);
    result.status = sound ? TaskStatus::kOptimal : TaskStatus::kFailed;
    if (!sound) result.reason = "the best design fails a check";
    result.best = io::design_text(found.best->stated);
    result.merit = optimize::merit_of(task.spec, *found.result.best);
    const report::RefinedColumns columns = report::refined_columns(task.spec);
    for (const optimize::RefinedSet* set : best_sets(task.spec, found.result)) {
      result.designs.push_back(report::refined_values(found.result, *set, columns));
    }
  }
  result.sets = found.result.search.candidate_count();
  const auto& certificate = found.result.certificate;
  if (certificate && certificate->objective_bounded) result.bound = certificate->global_bound;
  add_refusals(result, found.result, tally);
  return result;
}

}  // namespace

TaskResult solve_task(const std::string& spec_text, optimize::Progress& progress) {
  try {
    return solve(io::parse_specification(spec_text, kTaskName, optimize::kMostRefinedSets),
                 progress);
  } catch (const io::InvalidInput& error) {
    return without_design(TaskStatus::kInvalid, error.what());
  } catch (const std::exception& error) {
    return without_design(TaskStatus::kFailed, error.what());
  }
}

}  // namespace gear3k::app
