#pragma once

#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

/// Norm of the Lagrangian's gradient with least-squares multipliers, which are non-negative on the
/// constraints and bounds active within 1e-6 (others have none).
///
///   min_{λ ≥ 0} ‖∇f − Σ_active λ_k ∇g_k‖₂     in the scaled variables
///
/// @returns the residual; NaN where the model is not defined
double kkt_residual(const RefinementProblem& problem, const Point& v);

}  // namespace gear3k::optimize
