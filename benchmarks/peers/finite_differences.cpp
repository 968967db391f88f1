// rp96 in gear3k's own model, refined by the same NLopt SLSQP from the same starts with the same
// tolerances, but with gradients by differences of evaluate<double> instead of exact ones.  `exact`
// is the control: the same loop with the exact ones.
//
//   finite_differences SPEC.toml forward|central|exact OUT

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "benchmarks/program.hpp"
#include "io/files/specification_file.hpp"
#include "numerics/parallel.hpp"
#include "optimize/refinement_problem.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/starting_points.hpp"

namespace {

using namespace gear3k;            // NOLINT(google-build-using-namespace): a program
using namespace gear3k::optimize;  // NOLINT(google-build-using-namespace)

constexpr double kUndefinedPenalty = 1e3;
/// Steps at variables of order 1: the square and the cube root of the rounding error.
constexpr double kForwardStep = 1.49e-8;
constexpr double kCentralStep = 6.06e-6;

enum class Gradient { kForward, kCentral, kExact };

/// f and g with differences at the last point asked for; NLopt asks for f and g separately.
class DifferencedProblem {
 public:
  DifferencedProblem(const RefinementProblem& problem, bool central)
      : problem_(problem),
        central_(central),
        n_(static_cast<std::size_t>(problem.variables)),
        rows_(problem.rows.size()),
        values_(1 + rows_),
        ahead_(1 + rows_),
        behind_(1 + rows_),
        slopes_((1 + rows_) * n_) {}

  double objective(const double* x, double* gradient) {
    update(x, gradient != nullptr);
    if (gradient != nullptr) std::copy_n(slopes_.begin(), n_, gradient);
    return values_[0];
  }

  void constraints(const double* x, double* result, double* gradient) {
    update(x, gradient != nullptr);
    for (std::size_t k = 0; k < rows_; ++k) result[k] = -values_[1 + k];
    if (gradient == nullptr) return;
    for (std::size_t k = 0; k < rows_ * n_; ++k) gradient[k] = -slopes_[n_ + k];
  }

 private:
  /// f and then g at a point.
  void evaluate_at(const Point& v, std::vector<double>& values) const {
    const auto f =
        evaluate<double>(problem_, used(problem_, v), std::span<double>(values).subspan(1));
    if (f) {
      values[0] = *f;
    } else {
      std::fill(values.begin(), values.end(), -kUndefinedPenalty);
      values[0] = kUndefinedPenalty;
    }
  }

  void update(const double* x, bool with_slopes) {
    const bool same = valid_ && std::equal(x, x + n_, x_.begin());
    if (!same) {
      std::copy_n(x, n_, x_.begin());
      evaluate_at(x_, values_);
      valid_ = true;
      slopes_valid_ = false;
    }
    if (!with_slopes || slopes_valid_) return;
    slopes_valid_ = true;
    for (std::size_t j = 0; j < n_; ++j) {
      const double h = central_ ? kCentralStep : kForwardStep;
      Point v = x_;
      // Never leaves the box: backward at its upper end.
      v[j] = x_[j] + h <= problem_.upper[j] ? x_[j] + h : x_[j] - h;
      const double ahead = v[j];
      evaluate_at(v, ahead_);
      double behind = x_[j];
      if (central_ && ahead > x_[j] && x_[j] - h >= problem_.lower[j]) {
        behind = v[j] = x_[j] - h;
        evaluate_at(v, behind_);
      } else {
        behind_ = values_;
      }
      for (std::size_t k = 0; k <= rows_; ++k) {
        slopes_[k * n_ + j] = (ahead_[k] - behind_[k]) / (ahead - behind);
      }
    }
  }

  const RefinementProblem& problem_;
  bool central_;
  std::size_t n_, rows_;
  bool valid_ = false, slopes_valid_ = false;
  Point x_{};
  std::vector<double> values_, ahead_, behind_, slopes_;
};

/// The end of one start, judged by the problem itself; options as in solve_slsqp().
SolveOutcome refine_by_differences(const RefinementProblem& p, const Point& start, bool central) {
  DifferencedProblem functions(p, central);
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> solver(
      nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(p.variables)), &nlopt_destroy);
  nlopt_set_lower_bounds(solver.get(), p.lower.data());
  nlopt_set_upper_bounds(solver.get(), p.upper.data());
  nlopt_set_min_objective(
      solver.get(),
      [](unsigned, const double* x, double* gradient, void* data) {
        return static_cast<DifferencedProblem*>(data)->objective(x, gradient);
      },
      &functions);
  const std::vector<double> tolerances(p.rows.size(), 1e-10);
  nlopt_add_inequality_mconstraint(
      solver.get(), static_cast<unsigned>(p.rows.size()),
      [](unsigned, double* result, unsigned, const double* x, double* gradient, void* data) {
        static_cast<DifferencedProblem*>(data)->constraints(x, result, gradient);
      },
      &functions, tolerances.data());
  const SlsqpOptions options;
  nlopt_set_maxeval(solver.get(), options.max_evaluations);
  nlopt_set_xtol_rel(solver.get(), options.x_tolerance);
  nlopt_set_ftol_rel(solver.get(), options.f_tolerance);
  Point x = start;
  for (std::size_t k = 0; k < static_cast<std::size_t>(p.variables); ++k) {
    x[k] = std::clamp(x[k], p.lower[k], p.upper[k]);
  }
  double f = 0.0;
  nlopt_optimize(solver.get(), x.data(), &f);
  return outcome_at(p, x);
}

/// The best feasible end of all starts, or the one that violates least, as a row of results.csv.
std::string refined_row(const Specification& spec, const Candidate& candidate, Gradient gradient) {
  const RefinementProblem problem =
      make_refinement_problem(spec, candidate, {least_module(spec.module[0]), std::nullopt});
  SolveOutcome best{.violation = std::numeric_limits<double>::infinity()};
  constexpr double kFeasible = 1e-6;
  for (const Point& start : starting_points(problem, spec.solver.starts, spec.solver.seed)) {
    const SolveOutcome end =
        gradient == Gradient::kExact
            ? solve_slsqp(problem, start, {})
            : refine_by_differences(problem, start, gradient == Gradient::kCentral);
    const bool ok = end.violation <= kFeasible;
    const bool best_ok = best.violation <= kFeasible;
    if (ok == best_ok ? (ok ? end.objective < best.objective : end.violation < best.violation)
                      : ok) {
      best = end;
    }
  }
  const auto train = parameters_at(problem, used(problem, best.v));
  const train::ToothSet& z = candidate.teeth;
  std::string row = fmt::format("{},{},{},{},{}", z.S, z.P1, z.R1, z.P2, z.R2);
  for (std::size_t k = 0; k < train::kGearCount; ++k) row += fmt::format(",{}", best.v[k]);
  const double m1 = train.module_m[0];
  return row + fmt::format(",{},{}\n", train.module_m[1] / m1, train.center_distance_m / m1);
}

int run(const std::string& file, const std::filesystem::path& out, Gradient gradient) {
  const Specification spec = io::read_specification(file);
  const auto begin = std::chrono::steady_clock::now();
  Progress progress;
  const auto candidates = search_teeth(spec, progress).candidates;
  std::vector<std::string> rows(candidates.size());
  numerics::parallel_for(
      rows.size(), [&](std::size_t k) { rows[k] = refined_row(spec, candidates[k], gradient); });
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  std::filesystem::create_directories(out);
  std::ofstream csv(out / "results.csv");
  csv << "zS,zP1,zR1,zP2,zR2,xS,xP1,xR1,xP2,xR2,m2,d\n";
  for (const std::string& row : rows) csv << row;
  std::ofstream(out / "facts.json")
      << fmt::format("{{\"wall_time_s\": {}, \"starts\": {}}}\n", wall.count(), spec.solver.starts);
  return 0;
}

}  // namespace

PROGRAM(finite_differences)(int argc, char** argv) {
  const std::string_view name = argc == 4 ? argv[2] : "";
  if (name != "forward" && name != "central" && name != "exact") {
    fmt::print(stderr, "usage: finite_differences SPEC.toml forward|central|exact OUT\n");
    return 1;
  }
  try {
    return run(argv[1], argv[3],
               name == "forward"   ? Gradient::kForward
               : name == "central" ? Gradient::kCentral
                                   : Gradient::kExact);
  } catch (const std::exception& error) {
    fmt::print(stderr, "finite_differences: {}\n", error.what());
    return 1;
  }
}
