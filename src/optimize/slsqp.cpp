#include "optimize/slsqp.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "optimize/gradients.hpp"

namespace gear3k::optimize {

namespace {

/// Returned where the model is not defined: finite, so that the line search backs off.
constexpr double kUndefinedPenalty = 1e3;
/// Interior margin that least_violation() is content with.
constexpr double kInterior = 1e-3;
/// A search for the least violation ends where so many evaluations have not lowered it by more than
/// this: at a kink of a row steps are cut short without end.
constexpr int kPatience = 15;
constexpr double kLowered = 1e-7;

/// So many runs that used up their evaluations are taken up again, where they came this near.
constexpr int kRestarts = 2;
constexpr double kNearlyFeasible = 1e-2;

/// Margin below which rows that need tooth forms take part.
constexpr double kCostlyMargin = 0.05;

/// Memory of a solve, kept by each thread from one solve to the next.
struct Workspace {
  std::vector<std::uint16_t> selection;  ///< rows that the solver sees
  std::vector<bool> elastic;             ///< of those, the ones that t relaxes; empty: no t
  Gradients gradients;
  std::vector<double> values;  ///< of all rows
  std::vector<double> x, lower, upper, tolerances;
};
Workspace& workspace() {
  thread_local Workspace space;
  return space;
}

/// f and g with derivatives at the last point asked for; NLopt asks for f and g separately.
class CachedProblem {
 public:
  CachedProblem(const RefinementProblem& problem, Workspace& space)
      : problem_(problem),
        n_(static_cast<std::size_t>(problem.variables)),
        space_(space),
        elastic_(!space.elastic.empty()) {}

  /// From here on the point of least violation is kept, and `solver` stopped where it stays.
  void watch(nlopt_opt solver) { watched_ = solver; }
  /// Violation of the point that was kept; infinite when there is none.
  [[nodiscard]] double least() const { return least_; }
  [[nodiscard]] const Point& nearest() const { return nearest_; }

  /// Variables that the solver sees: those of the problem and, when elastic, t.
  [[nodiscard]] std::size_t size() const { return n_ + (elastic_ ? 1 : 0); }

  double objective(const double* x, double* gradient) {
    if (elastic_) {
      if (gradient != nullptr) {
        std::fill(gradient, gradient + n_, 0.0);
        gradient[n_] = 1.0;
      }
      return x[n_];
    }
    update(x);
    const Gradients& at = space_.gradients;
    if (gradient != nullptr) std::copy_n(at.df.begin(), n_, gradient);
    return at.f;
  }

  void constraints(const double* x, double* result, double* gradient) {
    update(x);
    const Gradients& at = space_.gradients;
    for (std::size_t k = 0; k < at.g.size(); ++k) {
      const bool relaxed = elastic_ && space_.elastic[k];
      result[k] = -at.g[k] - (relaxed ? x[n_] : 0.0);
      if (gradient == nullptr) continue;
      double* row = gradient + k * size();
      for (std::size_t j = 0; j < n_; ++j) row[j] = -at.dg[k * n_ + j];
      if (elastic_) row[n_] = relaxed ? -1.0 : 0.0;
    }
  }

 private:
  void update(const double* x) {
    if (valid_ && std::equal(x, x + n_, x_.begin())) return;
    std::copy_n(x, n_, x_.begin());
    valid_ = true;
    Gradients& at = space_.gradients;
    if (evaluate_gradients(problem_, {x, n_}, space_.selection, at)) {
      if (watched_ != nullptr) keep_nearest();
      return;
    }
    at.f = kUndefinedPenalty;
    std::fill(at.df.begin(), at.df.end(), 0.0);
    std::fill(at.g.begin(), at.g.end(), -kUndefinedPenalty);
    std::fill(at.dg.begin(), at.dg.end(), 0.0);
  }

  void keep_nearest() {
    const double violation = worst_violation(space_.gradients.g);
    rests_ = violation < reached_ - kLowered ? 0 : rests_ + 1;
    if (rests_ == 0) reached_ = violation;
    if (violation < least_) {
      least_ = violation;
      nearest_ = x_;
    }
    if (rests_ >= kPatience) nlopt_force_stop(watched_);
  }

  const RefinementProblem& problem_;
  std::size_t n_;
  Workspace& space_;
  bool elastic_;
  bool valid_ = false;
  Point x_{};
  nlopt_opt watched_ = nullptr;
  Point nearest_{};
  double least_ = std::numeric_limits<double>::infinity();
  double reached_ = std::numeric_limits<double>::infinity();
  int rests_ = 0;
};

double objective_callback(unsigned /*n*/, const double* x, double* gradient, void* data) {
  return static_cast<CachedProblem*>(data)->objective(x, gradient);
}

void constraint_callback(unsigned /*m*/, double* result, unsigned /*n*/, const double* x,
                         double* gradient, void* data) {
  static_cast<CachedProblem*>(data)->constraints(x, result, gradient);
}

/// Runs NLopt from space.x, which becomes the point where it stops; the caller judges it, whatever
/// the reason to stop was.
/// @param watch  for the least violation of all rows: space.x becomes the point where it is least
/// @returns whether it stopped because options.max_evaluations were used up
bool run(CachedProblem& functions, Workspace& space, const SlsqpOptions& options,
         bool watch = false) {
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> solver(
      nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(space.x.size())), &nlopt_destroy);
  nlopt_set_lower_bounds(solver.get(), space.lower.data());
  nlopt_set_upper_bounds(solver.get(), space.upper.data());
  nlopt_set_min_objective(solver.get(), objective_callback, &functions);
  space.tolerances.assign(space.selection.size(), 1e-10);
  if (!space.selection.empty()) {
    nlopt_add_inequality_mconstraint(solver.get(), static_cast<unsigned>(space.selection.size()),
                                     constraint_callback, &functions, space.tolerances.data());
  }
  nlopt_set_maxeval(solver.get(), options.max_evaluations);
  nlopt_set_xtol_rel(solver.get(), options.x_tolerance);
  nlopt_set_ftol_rel(solver.get(), options.f_tolerance);
  for (std::size_t k = 0; k < space.x.size(); ++k) {
    space.x[k] = std::clamp(space.x[k], space.lower[k], space.upper[k]);
  }
  if (watch) functions.watch(solver.get());
  double f = 0.0;
  const nlopt_result result = nlopt_optimize(solver.get(), space.x.data(), &f);
  if (std::isfinite(functions.least())) {
    std::copy_n(functions.nearest().begin(), space.x.size() - 1, space.x.begin());
  }
  return result == NLOPT_MAXEVAL_REACHED;
}

void take_box(const RefinementProblem& p, const Point& start, Workspace& space) {
  const auto n = static_cast<std::ptrdiff_t>(p.variables);
  space.lower.assign(p.lower.begin(), p.lower.begin() + n);
  space.upper.assign(p.upper.begin(), p.upper.begin() + n);
  space.x.assign(start.begin(), start.begin() + n);
}

Point point_of(const RefinementProblem& p, const std::vector<double>& x) {
  Point v{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(p.variables); ++k) {
    v[k] = std::clamp(x[k], p.lower[k], p.upper[k]);
  }
  return v;
}

/// Values of all rows at v into space.values.
SolveOutcome judge(const RefinementProblem& problem, const Point& v, Workspace& space) {
  space.values.resize(problem.rows.size());
  return outcome_at(problem, v, space.values);
}

/// Adds the rows below a margin to the selection; those that need tooth forms are costly and wait
/// for a smaller one.
/// @returns whether there was any
bool select_below(const RefinementProblem& problem, double margin, Workspace& space) {
  const std::size_t before = space.selection.size();
  for (std::size_t k = 0; k < space.values.size(); ++k) {
    const auto row = static_cast<std::uint16_t>(k);
    const auto& check = problem.rows[k].check;
    // Nothing else holds a torque that may rise.
    const bool holds_torque = problem.torque > 0 && check && check->record->rating;
    const bool costly = check && (check->record->tooth_form || check->record->rating);
    const double least = costly ? std::min(margin, kCostlyMargin) : margin;
    if ((holds_torque || space.values[k] < least) &&
        !std::binary_search(space.selection.begin(),
                            space.selection.begin() + static_cast<std::ptrdiff_t>(before), row)) {
      space.selection.push_back(row);
    }
  }
  std::sort(space.selection.begin(), space.selection.end());
  return space.selection.size() > before;
}

void select_all(const RefinementProblem& problem, Workspace& space) {
  space.selection.resize(problem.rows.size());
  for (std::size_t k = 0; k < space.selection.size(); ++k) {
    space.selection[k] = static_cast<std::uint16_t>(k);
  }
}

/// Whether a row that the solver saw is missed.
bool misses_selected(const Workspace& space) {
  return std::ranges::any_of(space.selection, [&](std::uint16_t k) {
    return !(space.values[k] >= -design::kFeasibilityTolerance);
  });
}

}  // namespace

SolveOutcome solve_slsqp(const RefinementProblem& problem, const Point& start,
                         const SlsqpOptions& options) {
  Workspace& space = workspace();
  space.elastic.clear();
  space.selection.clear();
  SolveOutcome outcome = judge(problem, start, space);
  if (std::isfinite(outcome.violation)) {
    select_below(problem, options.working_margin, space);
  } else {
    select_all(problem, space);
  }
  Point from = start;
  std::optional<SolveOutcome> cut_off;  // the better end of runs that were
  std::optional<SolveOutcome> defined;  // the latest point where the model is
  if (std::isfinite(outcome.violation)) defined = outcome;
  const auto ended = [&](const SolveOutcome& end) {
    if (cut_off && is_better(*cut_off, end)) return *cut_off;
    return std::isfinite(end.violation) ? end : defined.value_or(end);
  };
  int restarts = 0;
  for (int round = 0;;) {
    CachedProblem functions(problem, space);
    take_box(problem, from, space);
    const bool used_up = run(functions, space, options);
    from = point_of(problem, space.x);
    outcome = judge(problem, from, space);
    // Slow steps come of a poor picture of the curvature: it begins anew.
    if (used_up && restarts < kRestarts && outcome.violation < kNearlyFeasible) {
      ++restarts;
      cut_off = ended(outcome);
      continue;
    }
    if (outcome.feasible() || space.selection.size() == problem.rows.size() ||
        (options.give_up && misses_selected(space))) {
      return ended(outcome);
    }
    if (std::isfinite(outcome.violation)) {
      defined = outcome;
    } else if (defined) {
      // Beyond the model nothing leads back: with all rows the line search stays within it.
      from = defined->v;
    }
    constexpr int kRounds = 4;
    if (round++ == kRounds || !std::isfinite(outcome.violation)) {
      select_all(problem, space);
    } else if (!select_below(problem, -design::kFeasibilityTolerance, space)) {
      return ended(outcome);  // infeasible with the rows it saw
    }
  }
}

SolveOutcome least_violation(const RefinementProblem& problem, const Point& start,
                             const SlsqpOptions& options, std::string_view elastic_name) {
  Workspace& space = workspace();
  SolveOutcome outcome = judge(problem, start, space);
  // Rows that need a rating are costly: those far from their limits wait until they are missed.
  const bool rated = std::ranges::any_of(problem.rows, [](const ConstraintRow& row) {
    return row.check && row.check->record->rating;
  });
  space.selection.clear();
  if ((rated || options.give_up) && std::isfinite(outcome.violation)) {
    select_below(problem, options.working_margin, space);
  }
  if (space.selection.empty()) select_all(problem, space);
  Point from = start;
  std::optional<SolveOutcome> defined;  // the latest point where the model is
  for (int round = 0;; ++round) {
    if (std::isfinite(outcome.violation)) defined = outcome;
    space.elastic.clear();
    for (const std::uint16_t k : space.selection) {
      space.elastic.push_back(elastic_name.empty() || problem.rows[k].name == elastic_name);
    }
    take_box(problem, from, space);
    // No limit is easier to keep at more torque.
    if (problem.torque > 0) space.upper[problem.torque] = space.lower[problem.torque];
    space.lower.push_back(-kInterior);
    space.upper.push_back(2.0 * kUndefinedPenalty);
    space.x.push_back(std::min(outcome.violation, kUndefinedPenalty));
    CachedProblem functions(problem, space);
    run(functions, space, options, elastic_name.empty());
    from = point_of(problem, space.x);
    outcome = judge(problem, from, space);
    if (!std::isfinite(outcome.violation) && defined) {
      from = defined->v;
      if (space.selection.size() == problem.rows.size()) return *defined;
    }
    if (space.selection.size() == problem.rows.size() ||
        (options.give_up && misses_selected(space))) {
      return outcome;
    }
    constexpr int kRounds = 3;
    if (round == kRounds || !std::isfinite(outcome.violation)) {
      select_all(problem, space);
    } else if (!select_below(problem, -design::kFeasibilityTolerance, space)) {
      return outcome;
    }
  }
}

}  // namespace gear3k::optimize
