#include "optimize/refine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "design/evaluation.hpp"
#include "efficiency/train_efficiency.hpp"
#include "optimize/best_end.hpp"
#include "optimize/blocking.hpp"
#include "optimize/cutter_choice.hpp"
#include "optimize/energy_box.hpp"
#include "optimize/lattice.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/rated_set.hpp"
#include "optimize/shift_grid.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/starting_points.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

/// For the start where the bound lies: rows far from their limits there seldom bind at the end.
constexpr SlsqpOptions kNearTheEnd{.working_margin = 0.3};
/// No more starts are taken where the best end is no farther below the set's bound than the first
/// share of its loss; or than the second one, and two starts have ended alike.
constexpr double kNearBound = 0.05, kLikelyNearBound = 0.25;
constexpr double kAlike = 1e-8;  ///< of two ends' objectives

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
                          .objective = std::nullopt,
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
      if (crossed.feasible()) best.offer(problem, solve(problem, crossed.v));
    }
  }
}

/// What a bound leaves to win in units of a problem's objective; infinite where it says nothing.
double most_of(const Specification& spec, const Candidate& candidate, const SetBound& bound) {
  const Objective objective = first_objective(spec);
  if (!follows_efficiency(objective) || !bound.known) {
    return std::numeric_limits<double>::infinity();
  }
  if (objective == Objective::kCycleEnergy) {
    return -spec.cycle_energy->least(
               energy_box(spec, candidate.teeth, candidate.planets, bound.eta_f, bound.eta_b)) /
           spec.cycle_energy->scale_j();
  }
  return objective == Objective::kForwardEfficiency ? bound.eta_f : bound.eta_b;
}

/// Whether the best end is as good as proven, or (two starts ended alike) likely so.
bool near_bound(const RefinementProblem& problem, const SolveOutcome& end, const SetBound& bound,
                bool alike) {
  const Specification& spec = *problem.spec;
  // The KHK rule has a kink, at which a start may stay.
  const bool kinked = spec.khk_tip[train::kS] || spec.khk_tip[train::kP1];
  if (!follows_efficiency(first_objective(spec)) || !bound.known || kinked) return false;
  SetBound without_losses;
  without_losses.known = true;
  const double lossless = most_of(spec, problem.candidate, without_losses);
  return most_of(spec, problem.candidate, bound) + end.objective <=
         (alike ? kLikelyNearBound : kNearBound) * (lossless + end.objective);
}

/// The point of least violation where it is the same from an end and from a start, and misses a
/// limit: the set is then given up.
std::optional<SolveOutcome> nearest_of_two(const RefinementProblem& problem, const Point& end,
                                           const Point& start) {
  const SolveOutcome one = least_violation(problem, end, {});
  if (!std::isfinite(one.violation) || one.feasible()) return std::nullopt;
  const SolveOutcome two = least_violation(problem, start, {});
  constexpr double kSameViolation = 0.01;  // of it
  if (!(std::abs(two.violation - one.violation) <= kSameViolation * one.violation)) {
    return std::nullopt;
  }
  return one.violation <= two.violation ? one : two;
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

/// Capacity and stiffness under the stated load.
void rate_optimum(const Specification& spec, const train::TrainGeometry<double>& train,
                  const LoadAt<double>& load, RefinedSet& set) {
  std::array<geometry::ToothForm<double>, train::kGearCount> forms;
  std::ranges::transform(train.gears, forms.begin(), geometry::make_tooth_form<double>);
  const strength::RatedTrain<double> loaded = strength::with_sections(
      rated_train<double>(spec, train, forms, load.face_width_m), *spec.rating);
  using strength::Drive;
  const auto least =
      strength::least_capacity(strength::train_capacity(loaded, *spec.rating, Drive::kForward),
                               strength::train_capacity(loaded, *spec.rating, Drive::kBackward));
  if (least) set.torque_capacity_Nm = least->capacity.torque_Nm;
  const auto rating = strength::rate_train(loaded, *spec.rating, strength::Drive::kForward,
                                           spec.rating->torque_Nm, strength::StiffnessPart::kPath);
  if (rating.stiffness) set.torsional_stiffness_Nm_rad = rating.stiffness->output_Nm_rad;
}

/// @param residual  of the best end
void fill_optimum(const Specification& spec, const BestEnd& best, double residual,
                  RefinedSet& set) {
  const auto parameters = parameters_at(*best.problem, used(*best.problem, best.outcome.v));
  const auto load = load_at(*best.problem, used(*best.problem, best.outcome.v));
  set.train = {.profile_shift = parameters.profile_shift,
               .module_m = parameters.module_m,
               .center_distance_m = parameters.center_distance_m,
               .tip_shortening = parameters.tip_shortening,
               .pressure_angle_rad = parameters.pressure_angle_rad,
               .face_width_m = load.face_width_m,
               .cutter_teeth = best.problem->cutter_teeth};
  set.kkt_residual = residual;
  set.status = set.kkt_residual <= kStationary ? Status::kOptimal : Status::kNotStationary;
  const auto train = train::make_train_geometry(parameters);
  const auto j_bn = backlash::normal_backlashes(*train);
  set.lost_motion_rad = backlash::output_lost_motion(*train, j_bn, spec.limits.model);
  const auto& teeth = set.candidate.teeth;
  const auto efficiencies = [&](bool forward) {
    return efficiency::mesh_efficiencies(
        *train, efficiency::constant_friction<double>(spec.friction, train->teeth, forward),
        spec.friction.model, forward);
  };
  set.eta_b = efficiency::backward_efficiency(teeth, efficiencies(false));
  set.eta_f = efficiency::forward_efficiency(teeth, efficiencies(true));
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    set.contact_ratio[k] = train->meshes[k].contact_ratio;
  }
  set.ring_root_diameter_m = 2.0 * std::max(train->gears[train::kR1].root_radius_m,
                                            train->gears[train::kR2].root_radius_m);
  if (knows_masses(spec)) {
    const ObjectiveInput<double> at{.spec = spec,
                                    .train = *train,
                                    .normal_backlash_m = j_bn,
                                    .face_width_m = load.face_width_m,
                                    .torque_Nm = load.torque_Nm,
                                    .rating = nullptr};
    set.mass_kg = objective_value(Objective::kMass, at);
    set.inertia_kgm2 = objective_value(Objective::kInertia, at);
  }
  if (spec.rating) rate_optimum(spec, *train, load, set);
  if (first_objective(spec) == Objective::kCycleEnergy && knows_inertia(spec) && set.eta_b > 0.0) {
    const EnergyAt run = spec.cycle_energy->of(design_of(spec, set));
    set.cycle_energy_J = run.within_limits ? run.energy_J : std::numeric_limits<double>::infinity();
    set.motor = run.motor;
  }
  if (judged_by_model(spec)) judge_by_model(spec, *train, set);
}

/// Whether a problem hardly misses a gap of tip corners: that has kinks, at which a search stays
/// though there is a way on.
bool stays_at_kink(const BestEnd& best) {
  constexpr double kHardly = 0.01;
  if (best.found || !best.problem || !(best.outcome.violation <= kHardly)) return false;
  const RefinementProblem& problem = *best.problem;
  std::vector<double> g(problem.rows.size());
  if (!evaluate<double>(problem, used(problem, best.outcome.v), g)) return false;
  for (std::size_t k = 0; k < g.size(); ++k) {
    const auto& check = problem.rows[k].check;
    if (check && check->record->id == CheckId::kTipFouling && g[k] < -design::kFeasibilityTolerance)
      return true;
  }
  return false;
}

/// Goes on from further starts, until a feasible point is found.
void take_more_starts(const RefinementProblem& problem, const StopFlag& stop, BestEnd& best) {
  constexpr int kMore = 8;
  const Solver& solver = problem.spec->solver;
  const std::vector<Point> starts = starting_points(problem, solver.starts + kMore, solver.seed);
  for (std::size_t k = static_cast<std::size_t>(solver.starts); k < starts.size(); ++k) {
    if (stop.load(std::memory_order_relaxed) || best.found) return;
    const SolveOutcome nearest = least_violation(problem, solve(problem, starts[k]).v, {});
    if (!nearest.feasible()) continue;
    best.offer(problem, nearest);
    best.offer(problem, solve(problem, nearest.v));
  }
}

/// The best end of one problem from several starts, that of its bound first, a known design last.
/// @returns empty when `stop` became true
std::optional<BestEnd> best_of_starts(const RefinementProblem& problem, const SetBound& bound,
                                      const StopFlag& stop, const KnownTrain* known = nullptr) {
  const Specification& spec = *problem.spec;
  BestEnd local;
  std::vector<Point> ends;
  std::vector<Point> starts = starting_points(problem, spec.solver.starts, spec.solver.seed,
                                              bound.known ? &bound : nullptr);
  for (const Point& start : starts) {
    if (stop.load(std::memory_order_relaxed)) return std::nullopt;
    if (ends.size() == 1 && !local.found && known == nullptr) {
      if (const auto nearest = nearest_of_two(problem, ends.front(), start)) {
        local.offer(problem, *nearest);
        ends.clear();
        break;
      }
    }
    const bool near = bound.known && ends.empty();
    const SolveOutcome end = solve(problem, start, near ? kNearTheEnd : SlsqpOptions{});
    const bool alike = local.found && end.feasible() &&
                       std::abs(end.objective - local.outcome.objective) <= kAlike;
    ends.push_back(end.v);
    local.offer(problem, end);
    if (local.found && near_bound(problem, local.outcome, bound, alike)) break;
  }
  if (known != nullptr && !stop.load(std::memory_order_relaxed)) {
    const SolveOutcome end = solve(problem, point_of(problem, known->train, known->load));
    ends.push_back(end.v);
    local.offer(problem, end);
    if (!end.feasible()) {
      local.offer(problem, outcome_at(problem, point_of(problem, known->train, known->load)));
    }
  }
  for (std::size_t k = 0; k < ends.size() && !local.found; ++k) {
    if (stop.load(std::memory_order_relaxed)) return std::nullopt;
    const SolveOutcome nearest = least_violation(problem, ends[k], {});
    local.offer(problem, nearest);
    if (nearest.feasible()) local.offer(problem, solve(problem, nearest.v));
  }
  if (stays_at_kink(local)) take_more_starts(problem, stop, local);
  if (local.found) cross_contact_ratio_kinks(local);
  return local;
}

/// The search for the best design of one set over its problems.
class SetSearch {
 public:
  /// @param to_beat  scaled objective
  /// @param known  see KnownOfSet::design
  SetSearch(const Specification& spec, double to_beat, const StopFlag& stop,
            const KnownTrain* known)
      : spec_(spec),
        choices_(cutter_choices(spec)),
        to_beat_(to_beat),
        stop_(stop),
        known_(known) {}

  [[nodiscard]] BestEnd& best() { return best_; }
  /// Whether the grid was given up for what is to be beaten.
  [[nodiscard]] bool bounded() const { return bounded_; }
  /// Whether the search of a grid was cut short.
  [[nodiscard]] bool cut() const { return cut_; }
  /// The nearest point of the grid where none is feasible though free shifts are.
  [[nodiscard]] const std::optional<GridEnd>& nearest() const { return nearest_; }
  /// See RefinedSet.
  [[nodiscard]] std::uint32_t refinements() const { return refinements_; }
  [[nodiscard]] std::uint32_t relaxations() const { return relaxations_; }

  /// @returns false when the search was stopped
  [[nodiscard]] bool search(const RefinementProblem& problem, const SetBound& bound) {
    const bool done = search_all(problem, bound);
    // A grid in it may have ended early.
    return done && !stop_.load(std::memory_order_relaxed);
  }

 private:
  bool search_all(const RefinementProblem& problem, const SetBound& bound) {
    if (choices_.size() > 1) {
      BestEnd best;
      return is_of_load(problem.objective) ? try_every_cutter(problem, bound, best)
                                           : choose_cutters(problem, bound);
    }
    const std::optional<BestEnd> local = from_starts(problem, bound);
    if (local) take(*local);
    return local.has_value();
  }

  std::optional<BestEnd> from_starts(const RefinementProblem& problem, const SetBound& bound) {
    ++refinements_;
    return best_of_starts(problem, bound, stop_, known_);
  }

  void take(const BestEnd& local) {
    if (!local.problem) return;
    if (!spec_.shift_step || !local.found) {
      best_.offer(*local.problem, local.outcome);
      return;
    }
    const double least = best_.found ? std::min(to_beat_, best_.outcome.objective) : to_beat_;
    if (!(local.outcome.objective < least)) {
      bounded_ = true;
      return;
    }
    GridEnd end = best_on_grid(*local.problem, local.outcome, least, stop_);
    cut_ = cut_ || end.cut;
    relaxations_ += static_cast<std::uint32_t>(end.relaxations);
    if (end.found) {
      best_.offer(*end.held, end.outcome);
    } else if (std::isfinite(least) && !end.cut) {
      bounded_ = true;
    } else if (end.held && (!nearest_ || end.outcome.violation < nearest_->outcome.violation)) {
      nearest_ = std::move(end);
    }
  }

  /// The best end of any cutter, offered to the grid by itself.
  void take(const BestEnd& end, BestEnd& best) {
    if (end.problem) best.offer(*end.problem, end.outcome);
    take(end);
  }

  bool try_every_cutter(const RefinementProblem& problem, const SetBound& bound, BestEnd& best) {
    RefinementProblem own = problem;
    for (const auto& choice : choices_) {
      own.cutter_teeth = choice;
      const std::optional<BestEnd> local = from_starts(own, bound);
      if (!local) return false;
      take(*local, best);
    }
    return true;
  }

  /// Cutters by how little the best design of any cutter misses with them.
  bool choose_cutters(const RefinementProblem& problem, const SetBound& bound) {
    const std::optional<BestEnd> any = from_starts(without_cutter_rows(problem), bound);
    if (!any) return false;
    if (!any->found) {
      take(*any);
      return true;
    }
    struct Chosen {
      RefinementProblem problem;
      double violation = 0.0;
    };
    std::vector<Chosen> chosen;
    for (const auto& choice : choices_) {
      chosen.push_back({.problem = problem});
      chosen.back().problem.cutter_teeth = choice;
      chosen.back().violation = outcome_at(chosen.back().problem, any->outcome.v).violation;
    }
    std::ranges::stable_sort(chosen, {}, &Chosen::violation);
    BestEnd best;
    const bool proven = is_feasible(chosen.front().violation);
    for (const Chosen& own : chosen) {
      if (stop_.load(std::memory_order_relaxed)) return false;
      if (best_.found && !(any->outcome.objective < best_.outcome.objective)) break;
      const bool as_it_is = is_feasible(own.violation);
      BestEnd end;
      end.offer(own.problem, as_it_is ? outcome_at(own.problem, any->outcome.v)
                                      : best_within(own.problem, any->outcome.v));
      take(end, best);
    }
    if (!best.problem) return true;  // other modules have a better design
    if (proven) {
      // What no cutter has a say in is a local optimum: it bounds them all as far as the starts of
      // one of them do not lead farther.
      const std::optional<BestEnd> own = from_starts(chosen.front().problem, bound);
      if (!own) return false;
      take(*own, best);
      if (!(best.outcome.objective < any->outcome.objective - kAlike)) return true;
    }
    // What goes on from the end of any cutter may stay in a worse basin.
    return try_every_cutter(problem, bound, best);
  }

  const Specification& spec_;
  std::vector<std::array<int, 2>> choices_;
  double to_beat_;
  const StopFlag& stop_;
  const KnownTrain* known_;
  BestEnd best_;
  bool bounded_ = false, cut_ = false;
  std::uint32_t refinements_ = 0, relaxations_ = 0;
  std::optional<GridEnd> nearest_;
};

/// Says what the nearest point of the grid misses.
void name_missed_on_grid(const GridEnd& nearest, RefinedSet& set) {
  std::vector<double> g(nearest.held->rows.size());
  const RefinementProblem& problem = *nearest.held;
  if (evaluate<double>(problem, used(problem, nearest.outcome.v), g)) {
    set.blocked_by = misses_of(problem, g);
  }
  set.blocked_together = set.blocked_by.size() > 1;
  set.status = Status::kNoFeasibleFound;
}

}  // namespace

Refiner::Refiner(const Specification& spec) : spec_(&spec) {
  const std::vector<FixedModules> combinations = module_combinations(spec);
  for (const int planets : spec.planets) {
    for (std::size_t modules = 0; modules < combinations.size(); ++modules) {
      for (const ProblemBranch& branch : branches_of(spec)) {
        prototypes_.push_back(
            {.modules = modules,
             .problem = make_problem_rows(spec, planets, combinations[modules], branch)});
      }
    }
  }
}

std::optional<RefinedSet> Refiner::refine(const Candidate& candidate, const ShiftRanges& shifts,
                                          std::span<const ModuleBound> bounds, const StopFlag& stop,
                                          const KnownOfSet& known) const {
  const Specification& spec = *spec_;
  RefinedSet set;
  set.candidate = candidate;
  const double scale = objective_scale(first_objective(spec), spec);
  // Equals are told apart by who comes first, not here.
  SetSearch search(spec, 2.0 * kBetterOnLattice - known.to_beat / scale, stop, known.design);
  BestEnd& best = search.best();
  thread_local RefinementProblem problem;
  for (const auto& [pair, bound] : bounds) {
    if (best.found && most_of(spec, candidate, bound) <= -best.outcome.objective) continue;
    for (const Prototype& prototype : prototypes_) {
      if (prototype.problem.candidate.planets != candidate.planets) continue;
      if (pair && prototype.modules != *pair) continue;
      problem = prototype.problem;  // keeps the memory of its rows
      set_teeth(problem, candidate, shifts);
      if (!search.search(problem, bound)) return std::nullopt;
    }
  }
  set.grid_cut = search.cut();
  set.refinements = search.refinements();
  set.relaxations = search.relaxations();
  if (!best.found && search.bounded() && !search.cut()) {
    set.status = Status::kBounded;
    return set;
  }
  if (!best.found && search.cut()) {
    // What the nearest point misses says nothing of those that were not looked at.
    set.status = Status::kNoFeasibleFound;
    return set;
  }
  if (!best.found && search.nearest()) {
    name_missed_on_grid(*search.nearest(), set);
    return set;
  }
  if (!best.problem) {
    set.status = Status::kFailed;
    return set;
  }
  if (!best.found) {
    // The shifts' own checks may be what blocks: all rows take part.
    const RefinementProblem all = with_all_rows(*best.problem);
    const auto found = name_blocking_constraints(all, best.outcome, set);
    if (!found || spec.shift_step) {
      set.status = Status::kNoFeasibleFound;
      return set;
    }
    best.offer(all, *found);
    best.offer(all, solve(all, found->v));
  }
  const double residual = polish(best);
  fill_optimum(spec, best, residual, set);
  return set;
}

std::optional<BestOfSet> Refiner::best_end(const Candidate& candidate, const ShiftRanges& shifts,
                                           const StopFlag& stop) const {
  constexpr double kEndsAlike = 1e-6;
  const Specification& spec = *spec_;
  BestEnd best;
  thread_local RefinementProblem problem;
  for (const Prototype& prototype : prototypes_) {
    if (prototype.problem.candidate.planets != candidate.planets) continue;
    problem = prototype.problem;
    set_teeth(problem, candidate, shifts);
    std::vector<Point> starts = starting_points(problem, spec.solver.starts, spec.solver.seed);
    std::ranges::reverse(starts);
    BestEnd own;
    for (const Point& start : starts) {
      if (stop.load(std::memory_order_relaxed)) return std::nullopt;
      const SolveOutcome end = solve(problem, start);
      const bool alike = own.found && end.feasible() &&
                         std::abs(end.objective - own.outcome.objective) <= kEndsAlike;
      own.offer(problem, end);
      if (alike) break;
    }
    if (!own.problem) continue;
    // The picture of the curvature starts afresh there.
    const SolveOutcome nearest =
        own.found ? own.outcome : least_violation(problem, own.outcome.v, {});
    if (nearest.feasible()) own.offer(problem, solve(problem, nearest.v));
    best.offer(*own.problem, own.outcome);
  }
  if (!best.found) return BestOfSet{};
  const auto at = used(*best.problem, best.outcome.v);
  return BestOfSet{
      .merit = -best.outcome.objective * objective_scale(first_objective(spec), spec),
      .at = {.train = parameters_at(*best.problem, at), .load = load_at(*best.problem, at)}};
}

std::optional<RefinedSet> refine(const Specification& spec, const Candidate& candidate,
                                 const StopFlag& stop, const KnownOfSet& known) {
  Progress progress;
  const std::array one{candidate};
  SetBounds bounds(spec, one, progress);
  bounds.tie(std::array{std::uint32_t{0}}, progress);
  const SetBound bound = bounds.of(0);
  if (bound.infeasible) return proven_infeasible(candidate, *bound.infeasible);
  Specification own = spec;
  own.planets = {candidate.planets};
  return Refiner(own).refine(candidate, bounds.shifts().of(candidate.teeth), bounds.by_modules(0),
                             stop, known);
}

RefinedSet refine(const Specification& spec, const Candidate& candidate) {
  const StopFlag never;
  return *refine(spec, candidate, never);
}

}  // namespace gear3k::optimize
