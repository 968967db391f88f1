#include "optimize/blocking.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "optimize/check_row.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/starting_points.hpp"

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
Miss miss_of(const RefinementProblem& problem, std::string_view name, double violation) {
  const auto row = std::ranges::find(problem.rows, name, &ConstraintRow::name);
  if (row->objective) {
    const ObjectiveRecord& record = objective_record(row->objective->objective);
    return {.name = name,
            .violation = violation,
            .amount = violation * row->objective->scale / record.per_unit,
            .unit = record.unit};
  }
  const units::Unit unit = row->check ? row->check->record->unit : units::Unit::kMillimetre;
  const double miss_si = row->check ? miss_of_constraint(*row->check, violation)
                                    : violation * problem.length_scale_m;
  return {.name = name,
          .violation = violation,
          .amount = units::from_si(miss_si, unit),
          .unit = units::unit_name(unit)};
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

}  // namespace

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
    if (alone->violation <= design::kFeasibilityTolerance) {
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

RefinedSet proven_infeasible(const Candidate& candidate, const Infeasibility& proof) {
  RefinedSet set;
  set.candidate = candidate;
  set.status = Status::kInfeasible;
  set.blocked_together = !proof.alone;
  const design::CheckRecord& record = design::check_record(proof.check);
  set.blocked_by = {{.name = record.name,
                     .violation = proof.violation,
                     .amount = units::from_si(proof.miss_si, record.unit),
                     .unit = units::unit_name(record.unit)}};
  return set;
}

}  // namespace gear3k::optimize
