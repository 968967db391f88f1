#pragma once
// What keeps a tooth set from having a feasible design.

#include <optional>
#include <span>
#include <vector>

#include "optimize/refined_set.hpp"
#include "optimize/set_bounds.hpp"
#include "optimize/solve_outcome.hpp"

namespace gear3k::optimize {

/// Says what blocks a problem, from the point of least violation.  That point balances the
/// constraints in conflict, which are missed alike there; relaxing each of them alone tells whether
/// it suffices, and by how much it has to give way.
/// @returns a feasible point, should the search come across one; nothing blocks then
std::optional<SolveOutcome> name_blocking_constraints(const RefinementProblem& problem,
                                                      const SolveOutcome& nearest, RefinedSet& set);

/// A scaled violation of a row, in the unit of its limit.
Miss miss_of(const RefinementProblem& problem, const ConstraintRow& row, double violation);

/// The limits that rows of these values miss beyond the tolerance, each once, largest (scaled)
/// first.
std::vector<Miss> misses_of(const RefinementProblem& problem, std::span<const double> g);

/// The set that a proof rules out.
RefinedSet proven_infeasible(const Candidate& candidate, const Infeasibility& proof);

}  // namespace gear3k::optimize
