#include "app/optimize.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "app/evaluate.hpp"
#include "app/model_change.hpp"
#include "app/robust_run.hpp"
#include "calibrate/model/model_range.hpp"
#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"
#include "optimize/refine.hpp"

namespace gear3k::app {

namespace {

/// What cannot be had together.
void refuse_without_bounds(const OptimizeTask& task) {
  const bool front = task.spec.objectives.size() > 1;
  if (task.certify && optimize::judged_by_model(task.spec)) {
    throw io::InvalidInput(
        "--certify: bounds are those of the simulation without the model's losses at an operating "
        "point, by which --model judges the sets; allowed: one of --certify and --model");
  }
  if ((task.certify || front) && !optimize::has_bounds(task.spec)) {
    throw io::InvalidInput(fmt::format(
        "{}: {} needs bounds, and with free.pressure_angle_deg there are none; allowed: one of "
        "them",
        task.source, task.certify ? "--certify" : "a list of objectives"));
  }
  if (front && optimize::judged_by_model(task.spec)) {
    throw io::InvalidInput(
        "--model: a list of objectives asks for a Pareto front, which has none of the model's "
        "losses at an operating point; allowed: one objective, or no --model");
  }
}

/// With the task's model where it judges the sets.
design::Design with_judging_model(const OptimizeTask& task, const design::Design& stated) {
  if (!task.model ||
      (!task.spec.operating_point && calibrate::needs_operating_point(task.model->extension))) {
    return stated;
  }
  design::Design design = design::extended(stated, task.model->extension);
  design.operating_point = task.spec.operating_point;
  return design;
}

Optimization::Best best_of(const OptimizeTask& task, const optimize::RefinedSet& set) {
  design::Design found = optimize::design_of(task.spec, set);
  found.limits = task.stated_limits;
  // What is shown is what best.toml describes, to the last bit.
  design::Design stated = io::as_written(found);
  design::Design design = with_judging_model(task, stated);
  design::Evaluation evaluation = evaluate(design, task.source);
  evaluation.notes.insert(evaluation.notes.end(), task.model_notes.begin(), task.model_notes.end());
  std::optional<design::TorqueAngleCurve> curve = torque_angle(design, evaluation);
  return {.stated = std::move(stated),
          .design = std::move(design),
          .evaluation = std::move(evaluation),
          .torque_angle = std::move(curve)};
}

}  // namespace

OptimizeTask optimize_task(const OptimizeRequest& request) {
  OptimizeTask task{.spec = request.spec,
                    .without_model = std::nullopt,
                    .stated_limits = {},
                    .model = request.model,
                    .model_notes = {},
                    .unreachable = {},
                    .source = request.source,
                    .certify = request.certify};
  if (task.model) {
    task.without_model = request.spec;
    task.spec = with_model(request.spec, *task.model, task.model_notes);
    task.unreachable = unreachable_lost_motion(request.spec, *task.model);
  }
  refuse_without_bounds(task);
  task.stated_limits = task.spec.limits;
  return task;
}

Optimization optimize(OptimizeTask& task, const OptimizeHooks& hooks,
                      optimize::Progress& progress) {
  if (!task.unreachable.empty()) throw std::invalid_argument(task.unreachable);
  Optimization outcome;
  if (task.spec.robust.hold != optimize::Hold::kNominal) {
    outcome.robust = hold_for_built(task, progress);
    outcome.interrupted = progress.stop;
    if (!outcome.searched()) return outcome;
    restart(progress);
  }
  outcome.result = optimize::optimize(
      task.spec, progress,
      {.best_only = task.certify,
       .known = hooks.known ? hooks.known() : std::vector<optimize::RefinedSet>(),
       .on_wave = hooks.on_wave});
  if (task.spec.objectives.size() > 1 && !outcome.result.interrupted) {
    outcome.front = optimize::search_pareto_front(task.spec, progress, outcome.result.refined);
  }
  outcome.interrupted = outcome.result.interrupted || (outcome.front && outcome.front->interrupted);
  if (outcome.result.best) outcome.best = best_of(task, *outcome.result.best);
  if (task.model) {
    outcome.comparison = compare_with_model(task, outcome, progress);
    outcome.interrupted = outcome.interrupted || outcome.comparison->interrupted;
  }
  return outcome;
}

std::optional<CarriedTorque> carried_torque(const optimize::Specification& spec,
                                            const report::ResultTally& tally) {
  if (!tally.nearest_under_load || !strength::judges_any(*spec.rating)) return std::nullopt;
  const optimize::Candidate& candidate = tally.nearest_under_load->candidate;
  const auto torque_Nm = optimize::greatest_torque(spec, candidate);
  if (!torque_Nm || *torque_Nm >= spec.rating->torque_Nm) return std::nullopt;
  return CarriedTorque{.teeth = candidate.teeth, .torque_Nm = *torque_Nm};
}

}  // namespace gear3k::app
