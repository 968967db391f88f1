#include "optimize/slsqp.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace gear3k::optimize {

namespace {

/// Returned where the model is not defined: finite, so that the line search backs off.
constexpr double kUndefinedPenalty = 1e3;
/// Interior margin that least_violation() is content with.
constexpr double kInterior = 1e-3;

/// f and g with derivatives at the last point asked for; NLopt asks for f and g separately.
class CachedProblem {
 public:
  /// @param elastic_rows  rows that t relaxes; empty = there is no t
  CachedProblem(const RefinementProblem& problem, std::vector<bool> elastic_rows)
      : problem_(problem),
        n_(static_cast<std::size_t>(problem.variables)),
        elastic_rows_(std::move(elastic_rows)),
        elastic_(!elastic_rows_.empty()),
        g_(problem.rows.size()) {}

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
    if (gradient != nullptr) std::copy_n(f_.v.data(), n_, gradient);
    return f_.a;
  }

  void constraints(const double* x, double* result, double* gradient) {
    update(x);
    for (std::size_t k = 0; k < g_.size(); ++k) {
      const bool relaxed = elastic_ && elastic_rows_[k];
      result[k] = -g_[k].a - (relaxed ? x[n_] : 0.0);
      if (gradient == nullptr) continue;
      double* row = gradient + k * size();
      for (std::size_t j = 0; j < n_; ++j) row[j] = -g_[k].v[static_cast<Eigen::Index>(j)];
      if (elastic_) row[n_] = relaxed ? -1.0 : 0.0;
    }
  }

 private:
  void update(const double* x) {
    if (valid_ && std::equal(x, x + n_, x_.begin())) return;
    std::copy_n(x, n_, x_.begin());
    valid_ = true;
    for (std::size_t k = 0; k < n_; ++k) jets_[k] = Jet1(x[k], static_cast<int>(k));
    if (const auto f = evaluate<Jet1>(problem_, used(problem_, jets_), g_)) {
      f_ = *f;
    } else {
      f_ = Jet1(kUndefinedPenalty);
      std::fill(g_.begin(), g_.end(), Jet1(-kUndefinedPenalty));
    }
  }

  const RefinementProblem& problem_;
  std::size_t n_;
  std::vector<bool> elastic_rows_;
  bool elastic_;
  bool valid_ = false;
  Point x_{};
  std::array<Jet1, kMaxVariables> jets_;
  Jet1 f_;
  std::vector<Jet1> g_;
};

double objective_callback(unsigned /*n*/, const double* x, double* gradient, void* data) {
  return static_cast<CachedProblem*>(data)->objective(x, gradient);
}

void constraint_callback(unsigned /*m*/, double* result, unsigned /*n*/, const double* x,
                         double* gradient, void* data) {
  static_cast<CachedProblem*>(data)->constraints(x, result, gradient);
}

struct Bounds {
  std::vector<double> lower, upper;
};

/// The point where NLopt stops; the caller judges it, whatever the reason to stop was.
std::vector<double> run(CachedProblem& functions, const Bounds& bounds, std::vector<double> x,
                        std::size_t rows, const SlsqpOptions& options) {
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> solver(
      nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(x.size())), &nlopt_destroy);
  nlopt_set_lower_bounds(solver.get(), bounds.lower.data());
  nlopt_set_upper_bounds(solver.get(), bounds.upper.data());
  nlopt_set_min_objective(solver.get(), objective_callback, &functions);
  const std::vector<double> tolerances(rows, 1e-10);
  nlopt_add_inequality_mconstraint(solver.get(), static_cast<unsigned>(rows), constraint_callback,
                                   &functions, tolerances.data());
  nlopt_set_maxeval(solver.get(), options.max_evaluations);
  nlopt_set_xtol_rel(solver.get(), options.x_tolerance);
  nlopt_set_ftol_rel(solver.get(), options.f_tolerance);
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = std::clamp(x[k], bounds.lower[k], bounds.upper[k]);
  }
  double f = 0.0;
  nlopt_optimize(solver.get(), x.data(), &f);
  return x;
}

Bounds box_of(const RefinementProblem& p) {
  const auto n = static_cast<std::size_t>(p.variables);
  return {.lower = {p.lower.begin(), p.lower.begin() + static_cast<std::ptrdiff_t>(n)},
          .upper = {p.upper.begin(), p.upper.begin() + static_cast<std::ptrdiff_t>(n)}};
}

Point point_of(const RefinementProblem& p, const std::vector<double>& x) {
  Point v{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(p.variables); ++k) {
    v[k] = std::clamp(x[k], p.lower[k], p.upper[k]);
  }
  return v;
}

}  // namespace

SolveOutcome solve_slsqp(const RefinementProblem& problem, const Point& start,
                         const SlsqpOptions& options) {
  CachedProblem functions(problem, {});
  const std::vector<double> end =
      run(functions, box_of(problem),
          {start.begin(), start.begin() + static_cast<std::ptrdiff_t>(problem.variables)},
          problem.rows.size(), options);
  return outcome_at(problem, point_of(problem, end));
}

SolveOutcome least_violation(const RefinementProblem& problem, const Point& start,
                             const SlsqpOptions& options, std::string_view elastic_name) {
  std::vector<bool> elastic_rows;
  for (const ConstraintRow& row : problem.rows) {
    elastic_rows.push_back(elastic_name.empty() || row.name == elastic_name);
  }
  CachedProblem functions(problem, std::move(elastic_rows));
  Bounds bounds = box_of(problem);
  bounds.lower.push_back(-kInterior);
  bounds.upper.push_back(2.0 * kUndefinedPenalty);
  std::vector<double> x(start.begin(),
                        start.begin() + static_cast<std::ptrdiff_t>(problem.variables));
  x.push_back(std::min(outcome_at(problem, start).violation, kUndefinedPenalty));
  const std::vector<double> end =
      run(functions, bounds, std::move(x), problem.rows.size(), options);
  return outcome_at(problem, point_of(problem, end));
}

}  // namespace gear3k::optimize
