#pragma once

#include "optimize/solve_outcome.hpp"

namespace gear3k::optimize {

/// Refines from a start by Ipopt with exact gradients and Hessian of the Lagrangian.
///
/// Calls are serialised by a mutex: Debian's Ipopt with MUMPS is not thread-safe.
SolveOutcome solve_ipopt(const RefinementProblem& problem, const Point& start);

}  // namespace gear3k::optimize
