#pragma once
// The best of a problem that has one free variable left.

#include <cstddef>
#include <optional>

#include "optimize/solve_outcome.hpp"

namespace gear3k::optimize {

/// The place of the one variable whose lower bound is below its upper one; empty where there is
/// none, or more than one.
std::optional<std::size_t> only_free_variable(const RefinementProblem& problem);

/// Refines along one variable, all others at their lower bounds: Newton steps to the row that is
/// missed most, else towards less of the objective up to the row that is met first, inside a
/// bracket that closes on either side.  Where two rows that are missed pull to opposite sides it
/// ends between them, at the least violation to first order, unless it has been where all rows are
/// met.  From an end at a row's limit it looks inwards once, for the objective may bend there;
/// where rows are missed that do not change it goes on from the best of 15 places of the range.
///
/// Exact as far as every row is met on one interval and the objective has one minimum on it; else
/// a local end.  Source: own derivation, docs/theory §12.
/// @param axis  of only_free_variable()
/// @returns what is there, judged by all rows
SolveOutcome solve_one_variable(const RefinementProblem& problem, std::size_t axis,
                                const Point& start);

}  // namespace gear3k::optimize
