#include "optimize/optimizer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "design/evaluation.hpp"
#include "efficiency/train_efficiency.hpp"
#include "geometry/interference.hpp"
#include "optimize/ipopt.hpp"
#include "optimize/parallel.hpp"
#include "optimize/refinement_problem.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/starting_points.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

/// The modules that one refinement runs with: empty = continuous.
using FixedModules = std::array<std::optional<double>, 2>;

std::vector<std::optional<double>> module_options(const ModuleChoice& choice) {
  if (choice.range_m) {
    if (choice.range_m->min < choice.range_m->max) return {std::nullopt};
    return {choice.range_m->min};
  }
  return {choice.series_m.begin(), choice.series_m.end()};
}

std::vector<FixedModules> module_combinations(const Specification& spec) {
  std::vector<FixedModules> combinations;
  for (const auto& m1 : module_options(spec.module[0])) {
    for (const auto& m2 : module_options(spec.module[1])) combinations.push_back({m1, m2});
  }
  return combinations;
}

/// The constraint that every point of the box misses most, and by how much at least, by checks that
/// are monotone in their variables.
struct Proof {
  CheckId check;
  double violation;  ///< scaled to order 1
  double miss_si;
};
std::optional<Proof> proven_infeasible(const Specification& spec, const Candidate& candidate) {
  // Undercut is least at the greatest shift, a ring smallest at the least shift and module.
  const auto most_shifted = train::make_train_gears(
      unrefined_train(spec, candidate, {.profile_shift = spec.profile_shift.max}));
  const auto smallest = train::make_train_gears(
      unrefined_train(spec, candidate, {.profile_shift = spec.profile_shift.min}));
  const auto& undercut_limit = spec.limits[CheckId::kUndercut];
  const auto& diameter_limit = spec.limits[CheckId::kRingRootDiameter];
  std::optional<Proof> worst;
  const auto offer = [&](CheckId check, double violation, double miss_si) {
    if (violation > design::kFeasibilityTolerance && (!worst || violation > worst->violation)) {
      worst = Proof{.check = check, .violation = violation, .miss_si = miss_si};
    }
  };
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    if (train::kind_of(static_cast<int>(i)) == geometry::GearKind::kExternal) {
      if (!undercut_limit) continue;
      const double miss = *undercut_limit - geometry::undercut_margin(most_shifted[i]);
      offer(CheckId::kUndercut, miss, miss);
    } else if (diameter_limit && *diameter_limit > 0.0) {
      const double miss = 2.0 * smallest[i].root_radius_m - *diameter_limit;
      offer(CheckId::kRingRootDiameter, miss / *diameter_limit, miss);
    }
  }
  return worst;
}

SolveOutcome solve(const RefinementProblem& problem, const Point& start) {
  return problem.spec->solver.refine == Refine::kIpopt ? solve_ipopt(problem, start)
                                                       : solve_slsqp(problem, start, {});
}

bool feasible(const SolveOutcome& outcome) {
  return outcome.violation <= design::kFeasibilityTolerance;
}

/// The best end of all starts, or the one that violates least.
struct BestEnd {
  std::optional<RefinementProblem> problem;
  SolveOutcome outcome;
  bool found = false;  ///< feasible

  void offer(const RefinementProblem& p, const SolveOutcome& o) {
    if (!std::isfinite(o.violation)) return;
    const bool ok = feasible(o);
    const bool better =
        !problem || (ok && !found) ||
        (ok == found && (ok ? o.objective < outcome.objective : o.violation < outcome.violation));
    if (!better) return;
    problem = p;
    outcome = o;
    found = ok;
  }
};

/// The problem with the contact ratio of a mesh kept on one side of a value.
RefinementProblem with_contact_ratio_bound(const RefinementProblem& problem, int mesh, double value,
                                           bool at_least) {
  RefinementProblem bounded = problem;
  const design::CheckRecord& record =
      design::check_record(at_least ? CheckId::kContactRatioMin : CheckId::kContactRatioMax);
  bounded.rows.push_back({.check = design::CheckInstance{.record = &record,
                                                         .subject = {.member = mesh, .which = 0},
                                                         .limit = value,
                                                         .scale = 1.0},
                          .stage = 0,
                          .bound_m = 0.0,
                          .at_least = true,
                          .name = record.name});
  return bounded;
}

/// All loss models but `ohlendorf` have kinks where the contact ratio of a mesh passes an integer,
/// which split the problem into basins: from a good end, the basin on the other side is tried too.
void cross_contact_ratio_kinks(BestEnd& best) {
  const RefinementProblem problem = *best.problem;
  if (problem.spec->friction.model == efficiency::LossModel::kOhlendorf) return;
  constexpr double kReachDown = 0.5;  // from above the kink
  constexpr double kReachUp = 0.15;   // from below it
  constexpr double kBeyond = 1e-3;
  const Point from = best.outcome.v;
  const auto train = train::make_train_geometry(parameters_at(problem, used(problem, from)));
  for (int mesh = 0; mesh < train::kMeshCount; ++mesh) {
    const double epsilon = train->meshes[static_cast<std::size_t>(mesh)].contact_ratio;
    for (const double kink : {2.0, 3.0}) {
      const bool above = epsilon >= kink && epsilon < kink + kReachDown;
      const bool below = epsilon < kink && epsilon > kink - kReachUp;
      if (!above && !below) continue;
      const RefinementProblem beyond =
          with_contact_ratio_bound(problem, mesh, above ? kink - kBeyond : kink + kBeyond, below);
      const SolveOutcome crossed = solve_slsqp(beyond, from, {});
      if (feasible(crossed)) best.offer(problem, solve(problem, crossed.v));
    }
  }
}

void polish(BestEnd& best) {
  const SolveOutcome polished = solve_ipopt(*best.problem, best.outcome.v);
  if (!feasible(polished)) return;
  const double gain = best.outcome.objective - polished.objective;
  const auto residual = [&](const SolveOutcome& o) { return kkt_residual(*best.problem, o.v); };
  constexpr double kSameObjective = 1e-9;
  if (gain > kSameObjective ||
      (gain > -kSameObjective && residual(polished) < residual(best.outcome))) {
    best.outcome = polished;
  }
}

/// Efficiencies with the calibrated model at the operating point.
void judge_by_model(const Specification& spec, const train::TrainGeometry<double>& train,
                    RefinedSet& set) {
  const design::Design design = design::extended(design_of(spec, set), *spec.model);
  const auto lossy = design::lossy_train(design, train);
  const auto efficiency = [&](design::Direction direction) -> std::optional<double> {
    const auto result = design::operate(lossy, *spec.operating_point, direction);
    return result.operation ? result.operation->efficiency : std::nullopt;
  };
  set.eta_b_model = efficiency(design::Direction::kBackward);
  set.eta_f_model = efficiency(design::Direction::kForward);
}

void fill_optimum(const Specification& spec, const BestEnd& best, RefinedSet& set) {
  set.train = parameters_at(*best.problem, used(*best.problem, best.outcome.v));
  set.kkt_residual = kkt_residual(*best.problem, best.outcome.v);
  set.status = set.kkt_residual <= kStationary ? Status::kOptimal : Status::kFailed;
  const auto train = train::make_train_geometry(set.train);
  const auto j_bn = backlash::normal_backlashes(*train);
  set.lost_motion_rad = backlash::output_lost_motion(*train, j_bn, spec.limits.model);
  const auto& teeth = set.candidate.teeth;
  const auto efficiencies = [&](bool forward) {
    return efficiency::mesh_efficiencies(
        *train, efficiency::constant_friction<double>(spec.friction, forward), spec.friction.model,
        forward);
  };
  set.eta_b = efficiency::backward_efficiency(teeth, efficiencies(false));
  set.eta_f = efficiency::forward_efficiency(teeth, efficiencies(true));
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    set.contact_ratio[k] = train->meshes[k].contact_ratio;
  }
  set.ring_root_diameter_m = 2.0 * std::max(train->gears[train::kR1].root_radius_m,
                                            train->gears[train::kR2].root_radius_m);
  if (judged_by_model(spec)) judge_by_model(spec, *train, set);
}

/// Violations of a problem's rows at a point, by name: the largest of each, in the order of rows.
std::vector<std::pair<std::string_view, double>> violations_by_name(
    const RefinementProblem& problem, const Point& v) {
  std::vector<double> g(problem.rows.size());
  std::vector<std::pair<std::string_view, double>> result;
  if (!evaluate<double>(problem, used(problem, v), g)) return result;
  for (std::size_t k = 0; k < g.size(); ++k) {
    const std::string_view name = problem.rows[k].name;
    if (result.empty() || result.back().first != name) result.emplace_back(name, 0.0);
    result.back().second = std::max(result.back().second, -g[k]);
  }
  return result;
}

/// A scaled violation of the rows of a name, with its unit.
Miss miss_of(const RefinementProblem& problem, std::string_view name, double violation) {
  const auto row = std::ranges::find(problem.rows, name, &ConstraintRow::name);
  const design::Unit unit = row->check ? row->check->record->unit : design::Unit::kMillimetre;
  const double scale = row->check ? row->check->scale : problem.length_scale_m;
  return {.name = name,
          .violation = violation,
          .amount = design::in_unit(violation * scale, unit),
          .unit = design::unit_name(unit)};
}

/// The point with the least violation found of one constraint that meets all others; empty when
/// none was found.  Sought from the given point and from points that meet the others.
std::optional<SolveOutcome> least_violation_alone(const RefinementProblem& problem,
                                                  const Point& from, std::string_view name) {
  RefinementProblem without = problem;
  std::erase_if(without.rows, [&](const ConstraintRow& row) { return row.name == name; });
  std::optional<SolveOutcome> least;
  for (const Point& start : {from, solve_slsqp(without, from, {}).v,
                             solve_slsqp(without, starting_points(problem, 1, 0).front(), {}).v}) {
    const SolveOutcome alone = least_violation(problem, start, {}, name);
    if (!std::isfinite(alone.violation)) continue;
    double others = 0.0;
    for (const auto& [other, amount] : violations_by_name(problem, alone.v)) {
      if (other != name) others = std::max(others, amount);
    }
    if (others > design::kFeasibilityTolerance) continue;
    if (!least || alone.violation < least->violation) least = alone;
  }
  return least;
}

/// Says what blocks a problem, from the point of least violation.  That point balances the
/// constraints in conflict, which are missed alike there; relaxing each of them alone tells whether
/// it suffices, and by how much it has to give way.
/// @returns a feasible point, should the search come across one; nothing blocks then
std::optional<SolveOutcome> name_blocking_constraints(const RefinementProblem& problem,
                                                      const SolveOutcome& nearest,
                                                      RefinedSet& set) {
  constexpr double kAlike = 0.01;
  std::vector<Miss> alike;
  for (const auto& [name, amount] : violations_by_name(problem, nearest.v)) {
    if (amount >= (1.0 - kAlike) * nearest.violation) {
      alike.push_back(miss_of(problem, name, amount));
    }
  }
  for (const Miss& miss : alike) {
    const auto alone = least_violation_alone(problem, nearest.v, miss.name);
    if (!alone) continue;
    if (feasible(*alone)) {
      set.blocked_by.clear();
      return alone;
    }
    set.blocked_by.push_back(miss_of(problem, miss.name, alone->violation));
  }
  set.blocked_together = set.blocked_by.empty();
  if (set.blocked_together) set.blocked_by = alike;
  std::ranges::stable_sort(set.blocked_by, {}, &Miss::violation);
  return std::nullopt;
}

}  // namespace

double objective_of(const RefinedSet& set, Objective objective) {
  return objective == Objective::kForwardEfficiency ? set.eta_f : set.eta_b;
}

bool judged_by_model(const Specification& spec) {
  return spec.model.has_value() && spec.operating_point.has_value();
}

double judged_objective(const Specification& spec, const RefinedSet& set) {
  if (!judged_by_model(spec)) return objective_of(set, spec.objective);
  const auto& eta =
      spec.objective == Objective::kForwardEfficiency ? set.eta_f_model : set.eta_b_model;
  return eta.value_or(-std::numeric_limits<double>::infinity());
}

RefinedSet refine(const Specification& spec, const Candidate& candidate) {
  const std::atomic<bool> never{false};
  return *refine(spec, candidate, never);
}

std::optional<RefinedSet> refine(const Specification& spec, const Candidate& candidate,
                                 const std::atomic<bool>& stop) {
  RefinedSet set;
  set.candidate = candidate;
  if (const auto proof = proven_infeasible(spec, candidate)) {
    set.status = Status::kInfeasible;
    const design::CheckRecord& record = design::check_record(proof->check);
    set.blocked_by = {{.name = record.name,
                       .violation = proof->violation,
                       .amount = design::in_unit(proof->miss_si, record.unit),
                       .unit = design::unit_name(record.unit)}};
    return set;
  }
  BestEnd best;
  for (const FixedModules& modules : module_combinations(spec)) {
    // Either branch of the paper's max() may carry the lower limit.
    int branches = 1;
    for (int branch = 1; branch <= branches; ++branch) {
      const RefinementProblem problem = make_refinement_problem(spec, candidate, modules, branch);
      if (problem.has_branches) branches = 2;
      BestEnd local;
      std::vector<Point> ends;
      for (const Point& start : starting_points(problem, spec.solver.starts, spec.solver.seed)) {
        if (stop.load(std::memory_order_relaxed)) return std::nullopt;
        const SolveOutcome end = solve(problem, start);
        ends.push_back(end.v);
        local.offer(problem, end);
      }
      for (std::size_t k = 0; k < ends.size() && !local.found; ++k) {
        if (stop.load(std::memory_order_relaxed)) return std::nullopt;
        const SolveOutcome nearest = least_violation(problem, ends[k], {});
        local.offer(problem, nearest);
        if (feasible(nearest)) local.offer(problem, solve(problem, nearest.v));
      }
      if (local.found) cross_contact_ratio_kinks(local);
      if (local.problem) best.offer(*local.problem, local.outcome);
    }
  }
  if (!best.problem) {
    set.status = Status::kFailed;
    return set;
  }
  if (!best.found) {
    const RefinementProblem problem = *best.problem;
    const auto found = name_blocking_constraints(problem, best.outcome, set);
    if (!found) {
      set.status = Status::kNoFeasibleFound;
      return set;
    }
    best.offer(problem, *found);
    best.offer(problem, solve(problem, found->v));
  }
  if (spec.solver.refine == Refine::kBoth ||
      !(kkt_residual(*best.problem, best.outcome.v) <= kStationary)) {
    polish(best);
  }
  fill_optimum(spec, best, set);
  return set;
}

OptimizeResult optimize(const Specification& spec, Progress& progress) {
  OptimizeResult result;
  result.search = search_teeth(spec, progress);
  if (result.search.interrupted) {
    result.interrupted = true;
    return result;
  }
  const std::vector<Candidate>& candidates = result.search.candidates;
  progress.total = 0;  // while done and phase change, nothing is known
  progress.done = 0;
  progress.phase = Progress::Phase::kRefinement;
  progress.total = candidates.size();
  std::vector<std::optional<RefinedSet>> refined(candidates.size());
  parallel_for(candidates.size(), [&](std::size_t k) {
    refined[k] = refine(spec, candidates[k], progress.stop);
    if (!refined[k]) return;
    if (refined[k]->status == Status::kOptimal) {
      const double value = judged_objective(spec, *refined[k]);
      double seen = progress.best_objective.load();
      while (value > seen && !progress.best_objective.compare_exchange_weak(seen, value)) {
      }
      ++progress.feasible;
    }
    ++progress.done;
  });
  for (auto& set : refined) {
    if (set) result.sets.push_back(*set);
  }
  result.interrupted = progress.stop.load() || result.search.interrupted;
  for (std::size_t k = 0; k < result.sets.size(); ++k) {
    if (result.sets[k].status != Status::kOptimal) continue;
    if (!result.best || judged_objective(spec, result.sets[k]) >
                            judged_objective(spec, result.sets[*result.best])) {
      result.best = k;
    }
  }
  result.pareto = pareto_front(result.sets, judged_by_model(spec));
  return result;
}

std::vector<std::size_t> pareto_front(const std::vector<RefinedSet>& sets, bool by_model) {
  const auto as_costs = [&](const RefinedSet& s) {
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    const double eta_b = by_model ? s.eta_b_model.value_or(kNone) : s.eta_b;
    const double eta_f = by_model ? s.eta_f_model.value_or(kNone) : s.eta_f;
    return std::array<double, 4>{-eta_b, -eta_f, s.lost_motion_rad, s.ring_root_diameter_m};
  };
  std::vector<std::size_t> front;
  for (std::size_t k = 0; k < sets.size(); ++k) {
    if (sets[k].status != Status::kOptimal) continue;
    const auto mine = as_costs(sets[k]);
    bool dominated = false;
    for (std::size_t j = 0; j < sets.size() && !dominated; ++j) {
      if (j == k || sets[j].status != Status::kOptimal) continue;
      const auto other = as_costs(sets[j]);
      const bool no_worse = std::ranges::equal(other, mine, std::less_equal<>());
      dominated = no_worse && (other != mine || j < k);
    }
    if (!dominated) front.push_back(k);
  }
  return front;
}

design::Design design_of(const Specification& spec, const RefinedSet& set) {
  const auto& z = set.candidate.teeth;
  design::Design design;
  design.name = fmt::format("{}{}/{}/{}/{}/{}", spec.name.empty() ? "" : spec.name + " ", z.S, z.P1,
                            z.R1, z.P2, z.R2);
  design.train = set.train;
  design.center_distance_given = true;
  design.friction = spec.friction;
  design.friction.extension = {};
  design.axial = spec.axial;
  design.limits = spec.limits;
  return design;
}

}  // namespace gear3k::optimize
