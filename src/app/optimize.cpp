#include "app/optimize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "actuator/design_gear.hpp"
#include "app/evaluate.hpp"
#include "app/mesh_load_search.hpp"
#include "app/model_change.hpp"
#include "app/robust_run.hpp"
#include "calibrate/model/model_range.hpp"
#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"
#include "optimize/module_pairs.hpp"
#include "optimize/wider_search.hpp"
#include "report/result_tally.hpp"
#include "units/units.hpp"

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
  if (task.model && task.spec.cycle_energy) {
    throw io::InvalidInput(
        "--model: the objective cycle_energy takes the friction of the simulation; allowed: one of "
        "them");
  }
  if (task.model && task.spec.felt) {
    throw io::InvalidInput(
        "--model: limits of what is felt (actuator.limits) take the friction of the simulation; "
        "allowed: one of them");
  }
  if ((task.certify || front) && !optimize::has_bounds(task.spec)) {
    throw io::InvalidInput(fmt::format(
        "{}: {} needs bounds, and with {} there are none; allowed: one of them", task.source,
        task.certify ? "--certify" : "a list of objectives",
        task.spec.free.pressure_angle_rad ? "free.pressure_angle_deg"
                                          : "backlash.NAME.A_sn_um at a module that is searched"));
  }
  if (front && optimize::judged_by_model(task.spec)) {
    throw io::InvalidInput(
        "--model: a list of objectives asks for a Pareto front, which has none of the model's "
        "losses at an operating point; allowed: one objective, or no --model");
  }
}

/// What the limits hold, by the actuator of the motor and the design.
std::vector<actuator::LimitCheck> felt_at_best(const optimize::FeltTask& task,
                                               const design::Design& design) {
  auto train = std::make_shared<actuator::DesignTrain>(design);
  actuator::Actuator a;
  a.gearbox.ratio = train->ratio();
  a.load_inertia_kgm2 = task.load_inertia_kgm2;
  a.train = train;
  a.motor.rotor_inertia_kgm2 = task.rotor_inertia_kgm2;
  a.motor.coulomb_Nm = task.coulomb_Nm;
  a.motor.static_Nm = task.static_Nm;
  a.motor.torque_constant_Nm_A = 1.0;  // any: no current is asked for
  std::optional<actuator::FeltTorque> torque;
  for (const optimize::FeltLimit& limit : task.limits) {
    switch (limit.quantity) {
      case optimize::FeltQuantity::kInertia:
        a.felt.max_inertia_kgm2 = limit.value;
        break;
      case optimize::FeltQuantity::kBreakaway:
        a.felt.max_breakaway_Nm = limit.value;
        break;
      case optimize::FeltQuantity::kTransparency:
        a.felt.max_transparency = limit.value;
        torque = actuator::felt_torque(a, task.transparency_torque_Nm);
        break;
    }
  }
  return actuator::felt_checks(a, actuator::reflected(a), torque);
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

/// Whether an objective changes with the width of a face.
bool depends_on_width(optimize::Objective objective) {
  using optimize::Objective;
  switch (objective) {
    case Objective::kCycleEnergy:
    case Objective::kInertia:
    case Objective::kMass:
    case Objective::kTorqueCapacity:
    case Objective::kTorqueDensity:
    case Objective::kTorsionalStiffness:
      return true;
    default:
      return false;
  }
}

/// What a reader of the best design would take for something else.
void note_objectives(const OptimizeTask& task, const optimize::RefinedSet& set, Notes& notes) {
  using optimize::Objective;
  const optimize::Specification& spec = task.spec;
  const auto& widths = spec.free.face_width_m;
  const bool free_width = widths[0] || widths[1];
  if (spec.rating && free_width && std::ranges::none_of(spec.objectives, depends_on_width)) {
    notes.emplace_back(
        "the objective does not depend on the face widths: they carry the load and "
        "may be wider than it needs; a list of objectives with \"mass\" or \"torque_density\" "
        "weighs them");
  }
  if (std::ranges::find(spec.objectives, Objective::kTorqueDensity) != spec.objectives.end() &&
      set.torque_capacity_Nm) {
    notes.push_back(fmt::format(
        "torque density: {:.5g} N m/kg over the mass of the gears alone, {:.4g} kg with rims of "
        "{:g} mm on the rings (size.ring_rim_mm)",
        *set.torque_capacity_Nm / set.mass_kg, set.mass_kg,
        units::from_si(spec.bodies.ring_rim_m, units::Unit::kMillimetre)));
  }
}

/// Of an operating point that the search does not read.
void note_operating_point(const OptimizeTask& task, Notes& notes) {
  if (!task.spec.operating_point || task.model || task.spec.rating) return;
  notes.emplace_back(
      "[operating_point] is read by a search with --model or [strength] only: designs are ranked "
      "by "
      "the efficiencies of the meshes alone");
}

void note_not_stationary(const optimize::RefinedSet& set, Notes& notes) {
  if (set.status != optimize::Status::kNotStationary) return;
  notes.push_back(fmt::format(
      "the best design meets every limit, but is no optimum (KKT residual {:.2g}, above {:g}): the "
      "solver ended beside one, and a better design may be near (solver.starts, solver.seed and "
      "solver.refine lead it other ways)",
      set.kkt_residual, optimize::kStationary));
}

/// The design of a set as its file describes it, to the last bit.
design::Design stated_of(const OptimizeTask& task, const optimize::Specification& spec,
                         const optimize::RefinedSet& set) {
  design::Design found = optimize::design_of(spec, set);
  found.limits = task.stated_limits;
  // As SPEC states it: where it does not, the middle of a model's range judges, and is no input.
  found.operating_point = (task.without_model ? *task.without_model : spec).operating_point;
  return io::as_written(found);
}

Optimization::Best best_of(const OptimizeTask& task, const optimize::Specification& spec,
                           const optimize::RefinedSet& set) {
  design::Design stated = stated_of(task, spec, set);
  design::Design design = with_judging_model(task, stated);
  design::Evaluation evaluation = evaluate(design, task.source);
  evaluation.notes.insert(evaluation.notes.end(), task.model_notes.begin(), task.model_notes.end());
  evaluation.notes.insert(evaluation.notes.end(), task.spec.notes.begin(), task.spec.notes.end());
  note_objectives(task, set, evaluation.notes);
  std::optional<design::TorqueAngleCurve> curve = torque_angle(design, evaluation);
  return {.stated = std::move(stated),
          .design = std::move(design),
          .evaluation = std::move(evaluation),
          .torque_angle = std::move(curve)};
}

/// The torque that the best design carries by its own distribution of the load on the planets, in
/// place of that by the one which the search held.
void take_own_capacity(Optimization& outcome) {
  const auto& strength = outcome.best->evaluation.strength;
  const auto least = strength ? strength->least_capacity() : std::nullopt;
  optimize::RefinedSet& best = *outcome.result.best;
  best.torque_capacity_Nm = least ? std::optional(least->capacity.torque_Nm) : std::nullopt;
  const auto row =
      std::ranges::find(outcome.result.refined, best.index, &optimize::RefinedSet::index);
  if (row != outcome.result.refined.end()) row->torque_capacity_Nm = best.torque_capacity_Nm;
}

report::HeldBackReport held_back_by(const OptimizeTask& task,
                                    const optimize::OptimizeResult& result,
                                    optimize::Progress& progress) {
  const auto held = [&](const optimize::RefinedSet& set) {
    report::HeldSet own{.set = set,
                        .held = optimize::held_back(task.spec, set, task.stated_limits)};
    if (!result.interrupted) optimize::refine_gains(task.spec, set, own.held, progress);
    return own;
  };
  const std::vector<optimize::RefinedSet> by_planets =
      optimize::best_per_planets(task.spec, result.refined);
  progress.stage_done = 0;
  progress.searches = 1;
  progress.stage_total = std::max<std::size_t>(1, by_planets.size());
  progress.stage = optimize::Progress::Stage::kHeldBack;
  report::HeldBackReport report{.best = held(*result.best),
                                .by_planets = {},
                                .proofs = result.by_planets,
                                .all_refined = !task.certify && !result.interrupted,
                                .interrupted = result.interrupted};
  bool interrupted = result.interrupted;
  for (const optimize::RefinedSet& set : by_planets) {
    const bool is_best = set.index == result.best->index;
    if (!is_best) {
      ++progress.stage_done;
      ++progress.searches;
    }
    report.by_planets.push_back(is_best ? report.best : held(set));
    interrupted = interrupted || report.by_planets.back().held.interrupted;
  }
  progress.stage = optimize::Progress::Stage::kOne;
  optimize::HeldBack& best = report.best.held;
  if (!result.interrupted) {
    const std::size_t sets = result.search.candidates.size();
    optimize::search_beyond(task.spec, *result.best, sets, best, progress);
    optimize::search_relaxed(task.spec, *result.best, sets, best, progress);
  }
  best.interrupted = best.interrupted || interrupted;
  return report;
}

/// Whether no set has a design.
bool sought_in_vain(const optimize::OptimizeResult& result) {
  return !result.best && !result.interrupted && !result.search.candidates.empty();
}

/// Why it is not asked which limits would have to give way; "": it is.
std::string why_not_relaxed(const OptimizeTask& task, const optimize::OptimizeResult& result) {
  if (!optimize::has_bounds(task.spec)) {
    return "this needs bounds, and there are none with a free pressure angle, or with thickness "
           "allowances in um where modules are searched";
  }
  const bool any = std::ranges::any_of(result.refined, [](const optimize::RefinedSet& set) {
    return optimize::has_design(set.status);
  });
  if (any) return "there are designs, but no motor drives one within its limits";
  const report::ResultTally tally = report::tally_of(result);
  if (tally.cut_without_design > 0) {
    return fmt::format(
        "the grids of shifts of {} of the tooth sets were not searched to the end "
        "(solver.grid_relaxations = {}), so it may be that none has to",
        tally.cut_without_design, task.spec.solver.grid_relaxations);
  }
  if (report::only_failed(tally)) {
    return fmt::format("the solver failed on {} of the tooth sets, which may have designs as it is",
                       tally.status[static_cast<std::size_t>(optimize::Status::kFailed)]);
  }
  const std::size_t by_load = tally.blocked_by_load;
  if (by_load > 0) {
    return fmt::format(
        "limits of the load block {} of the tooth sets, and the torque that can be carried is told "
        "instead",
        by_load);
  }
  if (has_own_mesh_load(task.spec)) {
    return "the distribution of the load on the planets (k_gamma of tolerances) is each design's "
           "own";
  }
  return "";
}

/// What is asked without some of its limits: feasibility does not depend on the losses that a model
/// adds at an operating point, and limits that it changes are the task's.
optimize::Specification to_be_relaxed(const OptimizeTask& task) {
  optimize::Specification spec = task.spec;
  spec.model.reset();
  return spec;
}

/// To a thousandth of its unit, never stricter.
double looser_thousandth(const design::CheckRecord& record, double limit_si) {
  constexpr double kSteps = 1e3;
  constexpr double kRounding = 1e-6;  // what is a whole number but for rounding stays
  const double steps = kSteps * units::from_si(limit_si, record.unit);
  const double whole =
      record.at_least ? std::floor(steps + kRounding) : std::ceil(steps - kRounding);
  return units::to_si(whole / kSteps, record.unit);
}

/// Limits of lost motion as SPEC states them: with what the model took off for its own share.
void tell_with_model(const OptimizeTask& task, optimize::RelaxedLimits& relaxed) {
  if (!task.model) return;
  const double shift_rad = task.model->use.lost_motion_shift_rad;
  if (shift_rad == 0.0) return;
  using design::CheckId;
  for (optimize::Freed& freed : relaxed.freed) {
    for (optimize::RelaxedLimit& limit : freed.limits) {
      const CheckId id = *limit.of.check;
      if (id != CheckId::kOutputBacklashMin && id != CheckId::kOutputBacklashMax) continue;
      const auto& stated = task.without_model->limits[id];
      const bool as_stated = stated && task.spec.limits[id] == task.stated_limits[id];
      limit.stated_si = as_stated ? *stated : limit.stated_si + shift_rad;
      if (limit.relaxed_si) {
        limit.relaxed_si =
            looser_thousandth(design::check_record(id), *limit.relaxed_si + shift_rad);
      }
    }
  }
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
                    .certify = request.certify,
                    .round = request.round,
                    .explain = request.explain};
  if (task.model) {
    task.without_model = request.spec;
    task.spec = with_model(request.spec, *task.model, task.model_notes);
    task.unreachable = unreachable_lost_motion(request.spec, *task.model);
  }
  refuse_without_bounds(task);
  refuse_with_own_mesh_load(task);
  task.stated_limits = task.spec.limits;
  return task;
}

Optimization optimize(OptimizeTask& task, const OptimizeHooks& hooks,
                      optimize::Progress& progress) {
  if (!task.unreachable.empty()) throw std::invalid_argument(task.unreachable);
  Optimization outcome;
  progress.front_objectives = task.spec.objectives.size() > 1 ? task.spec.objectives.size() : 0;
  progress.front_lost_motion =
      std::ranges::find(task.spec.objectives, optimize::Objective::kLostMotion) !=
      task.spec.objectives.end();
  progress.front_designs = static_cast<std::size_t>(task.spec.pareto_points);
  progress.rounding = task.round;
  progress.best_only = task.certify;
  const bool per_planets = task.certify && task.explain && task.spec.planets.size() > 1;
  progress.planets = per_planets && !has_own_mesh_load(task.spec) ? task.spec.planets.size() : 0;
  const std::set<int> numbers(task.spec.planets.begin(), task.spec.planets.end());
  progress.told = task.explain ? numbers.size() : 0;
  progress.ties = optimize::ModulePairs::ties(task.spec);
  progress.explains = task.explain && optimize::has_bounds(task.spec);
  progress.passes_most = optimize::most_robust_passes(task.spec.robust.hold);
  // Yields are bisected to the end; in the worst case a few passes are enough as a rule.
  constexpr std::size_t kFew = 5;
  const bool bisects = task.spec.robust.hold == optimize::Hold::kYield;
  progress.passes_least = bisects ? progress.passes_most.load() : 2;
  if (!bisects) progress.passes_most = std::min(kFew, progress.passes_most.load());
  if (task.spec.robust.hold != optimize::Hold::kNominal) {
    outcome.robust = hold_for_built(task, progress);
    outcome.interrupted = progress.stop;
    if (!outcome.searched()) return outcome;
    restart(progress);
  }
  std::string mesh_load;
  if (has_own_mesh_load(task.spec)) {
    // Its sets are of searches that differ: none of an earlier run counts.
    mesh_load = mesh_load_note(hold_mesh_load(task, outcome.result, progress));
  } else {
    outcome.result = optimize::optimize(
        task.spec, progress,
        {.best_only = task.certify,
         .per_planets = per_planets,
         .known = hooks.known ? hooks.known() : std::vector<optimize::RefinedSet>(),
         .on_wave = hooks.on_wave});
  }
  if (task.spec.objectives.size() > 1 && !outcome.result.interrupted) {
    const auto steps = hooks.front_steps ? hooks.front_steps() : std::vector<optimize::FrontStep>();
    outcome.front = optimize::search_pareto_front(
        task.spec, progress,
        {.steps = steps, .on_step = hooks.on_front_step, .searched = &outcome.result});
    for (const optimize::ParetoPoint& point : outcome.front->points) {
      outcome.front_designs.push_back(stated_of(task, task.spec, point.set));
    }
  }
  outcome.interrupted = outcome.result.interrupted || (outcome.front && outcome.front->interrupted);
  if (outcome.result.best) {
    outcome.best = best_of(task, task.spec, *outcome.result.best);
    note_not_stationary(*outcome.result.best, outcome.best->evaluation.notes);
    note_operating_point(task, outcome.best->evaluation.notes);
    if (has_own_mesh_load(task.spec)) take_own_capacity(outcome);
    if (std::string cut =
            report::grid_cut_text(task.spec, report::tally_of(outcome.result).grid_cut);
        !cut.empty()) {
      outcome.best->evaluation.notes.push_back(std::move(cut));
    }
    if (!mesh_load.empty()) outcome.best->evaluation.notes.push_back(std::move(mesh_load));
    if (std::string unread = report::unread_steps_text(task.spec); !task.round && !unread.empty()) {
      outcome.best->evaluation.notes.push_back(std::move(unread));
    }
    if (task.spec.cycle_energy) {
      outcome.co_design = co_designed(task.spec, outcome.result, outcome.best->stated);
    }
    if (task.spec.felt) {
      outcome.felt = felt_at_best(*task.spec.felt, outcome.best->stated);
    }
    if (task.explain) {
      outcome.held = held_back_by(task, outcome.result, progress);
      outcome.interrupted = outcome.interrupted || outcome.held->best.held.interrupted;
    }
  }
  if (task.explain && sought_in_vain(outcome.result)) {
    outcome.not_relaxed = why_not_relaxed(task, outcome.result);
    if (outcome.not_relaxed.empty()) {
      outcome.relaxed = optimize::relax_limits(to_be_relaxed(task), outcome.result, progress);
      outcome.interrupted = outcome.interrupted || outcome.relaxed->interrupted;
      tell_with_model(task, *outcome.relaxed);
    } else if (!nearest_motor(task.spec, outcome.result) &&
               report::tally_of(outcome.result).blocked_by_load > 0) {
      outcome.carried = carried_torque(task.spec, progress);
      outcome.interrupted = outcome.interrupted || progress.stop;
    }
  }
  if (task.model) {
    outcome.comparison = compare_with_model(task, outcome, progress);
    outcome.interrupted = outcome.interrupted || outcome.comparison->interrupted;
  }
  if (task.round && outcome.result.best && !outcome.interrupted) {
    outcome.rounding = optimize::round_design(task.spec, *outcome.result.best, progress.stop);
    outcome.interrupted = progress.stop;
    if (outcome.rounding->best) {
      const optimize::RoundedDesign& rounded = *outcome.rounding->best;
      outcome.rounded = best_of(task, rounded.spec, rounded.set);
    }
  }
  return outcome;
}

std::optional<CarriedTorque> carried_torque(const optimize::Specification& spec,
                                            optimize::Progress& progress) {
  if (!spec.rating || !strength::judges_any(*spec.rating)) return std::nullopt;
  optimize::Specification own = spec;
  own.objectives = {optimize::Objective::kTorqueCapacity};
  own.model.reset();
  // The torque is sought from the least one upwards: not from farther below than need be.
  for (const double reach : {30.0, 1000.0}) {
    own.rating->torque_Nm = spec.rating->torque_Nm / reach;
    restart(progress);
    const optimize::OptimizeResult result = optimize::optimize(own, progress);
    if (result.interrupted) return std::nullopt;
    if (!result.best) continue;
    const double torque_Nm = result.best->torque_capacity_Nm.value_or(0.0);
    if (torque_Nm >= spec.rating->torque_Nm) return std::nullopt;
    return CarriedTorque{.teeth = result.best->candidate.teeth, .torque_Nm = torque_Nm};
  }
  return std::nullopt;
}

}  // namespace gear3k::app
