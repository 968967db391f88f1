#include "optimize/blocking.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "optimize/check_row.hpp"
#include "optimize/gradients.hpp"
#include "optimize/nonnegative_least_squares.hpp"
#include "optimize/slsqp.hpp"

namespace gear3k::optimize {

namespace {

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
Miss miss_of_name(const RefinementProblem& problem, std::string_view name, double violation) {
  return miss_of(problem, *std::ranges::find(problem.rows, name, &ConstraintRow::name), violation);
}

/// Largest violation of the rows that do not have a name.
double violation_of_others(const RefinementProblem& problem, const Point& v,
                           std::string_view name) {
  double worst = 0.0;
  for (const auto& [other, amount] : violations_by_name(problem, v)) {
    if (other != name) worst = std::max(worst, amount);
  }
  return worst;
}

/// Whether the rows that do not have a name contradict each other to first order at a point where
/// they are missed by `violation`: with multipliers λ ≥ 0 of those that are missed or met
/// exactly, and of the bounds of the box,
///
///   Σ λ_k (−g_k)/violation = 1 − r₀,   r² = r₀² + |Σ λ_k ∇g_k|² the least,
///
/// every step d after which all their linearisations hold has |d| r ≥ (1 − r) violation, which is
/// beyond the box.  Source: lemma of Farkas.
bool others_conflict(const RefinementProblem& problem, const Point& v, std::string_view name) {
  constexpr double kMet = 1e-6;
  Gradients at;
  if (!evaluate_gradients(problem, used(problem, v), all_rows(problem), at)) return false;
  double violation = 0.0;
  for (std::size_t k = 0; k < at.g.size(); ++k) {
    if (problem.rows[k].name != name) violation = std::max(violation, -at.g[k]);
  }
  if (is_feasible(violation)) return false;
  const auto n = static_cast<std::size_t>(problem.variables);
  const Eigen::Index rows = problem.variables + 1;
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(at.g.size() + 2 * n));
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < at.g.size(); ++k) {
    if (problem.rows[k].name == name || at.g[k] > kMet) continue;
    for (std::size_t j = 0; j < n; ++j) {
      columns(static_cast<Eigen::Index>(j), count) = at.dg[k * n + j];
    }
    columns(rows - 1, count++) = std::max(0.0, -at.g[k]) / violation;
  }
  double diameter2 = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    const auto axis = static_cast<Eigen::Index>(j);
    const double width = problem.upper[j] - problem.lower[j];
    diameter2 += width * width;
    if (v[j] - problem.lower[j] <= kMet) columns(axis, count++) = 1.0;
    if (problem.upper[j] - v[j] <= kMet) columns(axis, count++) = -1.0;
  }
  const Eigen::MatrixXd a = columns.leftCols(count);
  const Eigen::VectorXd b = Eigen::VectorXd::Unit(rows, rows - 1);
  const double rest = (a * nonnegative_least_squares(a, b) - b).norm();
  return (1.0 - rest) * violation > rest * std::sqrt(diameter2);
}

/// The point with the least violation found of one constraint that meets all others; empty when
/// none was found.  Sought from the given point, and from one that meets the others.
std::optional<SolveOutcome> least_violation_alone(const RefinementProblem& problem,
                                                  const Point& from, std::string_view name) {
  const auto meets_others = [&](const SolveOutcome& alone) {
    return std::isfinite(alone.violation) &&
           is_feasible(violation_of_others(problem, alone.v, name));
  };
  const SolveOutcome alone = least_violation(problem, from, {}, name);
  if (meets_others(alone)) return alone;
  if (others_conflict(problem, alone.v, name)) return std::nullopt;
  RefinementProblem without = problem;
  std::erase_if(without.rows, [&](const ConstraintRow& row) { return row.name == name; });
  const SolveOutcome others = least_violation(without, from, {});
  if (!others.feasible()) return std::nullopt;
  const SolveOutcome again = least_violation(problem, others.v, {}, name);
  if (meets_others(again)) return again;
  return std::nullopt;
}

}  // namespace

Miss miss_of(const RefinementProblem& problem, const ConstraintRow& row, double violation) {
  if (row.objective) {
    const ObjectiveRecord& record = objective_record(row.objective->objective);
    return {.name = row.name,
            .violation = violation,
            .amount = violation * row.objective->scale / record.per_unit,
            .unit = record.unit};
  }
  if (row.felt) {
    const units::Unit unit = felt_record(row.felt->quantity).unit;
    return {.name = row.name,
            .violation = violation,
            .amount = felt_miss(*problem.spec->felt, *row.felt, violation),
            .unit = units::unit_name(unit)};
  }
  const units::Unit unit = row.check ? row.check->record->unit : units::Unit::kMillimetre;
  const double miss_si =
      row.check ? miss_of_constraint(*row.check, violation) : violation * problem.length_scale_m;
  return {.name = row.name,
          .violation = violation,
          .amount = units::difference_from_si(miss_si, unit),
          .unit = units::unit_name(unit)};
}

std::optional<SolveOutcome> name_blocking_constraints(const RefinementProblem& problem,
                                                      const SolveOutcome& nearest,
                                                      RefinedSet& set) {
  constexpr double kAlike = 0.01;
  std::vector<Miss> alike;
  for (const auto& [name, amount] : violations_by_name(problem, nearest.v)) {
    if (amount >= (1.0 - kAlike) * nearest.violation) {
      alike.push_back(miss_of_name(problem, name, amount));
    }
  }
  for (const Miss& miss : alike) {
    if (others_conflict(problem, nearest.v, miss.name)) continue;
    const auto alone = least_violation_alone(problem, nearest.v, miss.name);
    if (!alone) continue;
    if (alone->feasible()) {
      set.blocked_by.clear();
      return alone;
    }
    set.blocked_by.push_back(miss_of_name(problem, miss.name, alone->violation));
  }
  set.blocked_together = set.blocked_by.empty();
  if (set.blocked_together) set.blocked_by = alike;
  // What is missed alike to rounding stays in the order of the rows.
  constexpr double kSame = 1e-6;
  std::ranges::stable_sort(set.blocked_by, {},
                           [](const Miss& miss) { return std::round(miss.violation / kSame); });
  return std::nullopt;
}

std::vector<Miss> misses_of(const RefinementProblem& problem, std::span<const double> g) {
  std::vector<Miss> missed;
  for (std::size_t k = 0; k < g.size(); ++k) {
    if (!(g[k] < -design::kFeasibilityTolerance)) continue;
    const auto same = std::ranges::find(missed, problem.rows[k].name, &Miss::name);
    if (same != missed.end() && same->violation >= -g[k]) continue;
    const Miss miss = miss_of(problem, problem.rows[k], -g[k]);
    if (same != missed.end()) {
      *same = miss;
    } else {
      missed.push_back(miss);
    }
  }
  std::ranges::stable_sort(missed, std::ranges::greater(), &Miss::violation);
  return missed;
}

RefinedSet proven_infeasible(const Candidate& candidate, const Infeasibility& proof) {
  RefinedSet set;
  set.candidate = candidate;
  set.status = Status::kInfeasible;
  set.blocked_together = !proof.alone;
  if (proof.of_modules) {
    set.blocked_by = {{.name = "stage2_module",
                       .violation = proof.violation,
                       .amount = units::difference_from_si(proof.miss_si, units::Unit::kMillimetre),
                       .unit = units::unit_name(units::Unit::kMillimetre)}};
    return set;
  }
  if (proof.felt) {
    const FeltRecord& record = felt_record(*proof.felt);
    set.blocked_by = {{.name = record.name,
                       .violation = proof.violation,
                       .amount = proof.miss_si,
                       .unit = units::unit_name(record.unit)}};
    return set;
  }
  const design::CheckRecord& record = design::check_record(proof.check);
  set.blocked_by = {{.name = record.name,
                     .violation = proof.violation,
                     .amount = units::difference_from_si(proof.miss_si, record.unit),
                     .unit = units::unit_name(record.unit)}};
  return set;
}

}  // namespace gear3k::optimize
