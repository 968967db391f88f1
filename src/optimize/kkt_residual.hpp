#pragma once

#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

/// Norm of the Lagrangian's gradient with least-squares multipliers, which are non-negative on the
/// constraints and bounds active within 1e-6 (others have none).
///
///   min_{λ ≥ 0} ‖∇f − Σ_active λ_k ∇g_k‖₂     in the scaled variables
///
/// Next to a kink (a root that becomes fully round, a factor that reaches its least value) one
/// gradient says little: there ∇f may be any mean of the gradients met within 1e-6 of the point,
/// and each active row may pull by any of its own,
///
///   min_{κ, λ ≥ 0, Σκ ≤ 1} ‖∇f + Σ_i κ_i (∇f_i − ∇f) − Σ_active Σ_i λ_ki ∇g_ki‖₂
///
/// unless the objective falls along one side of it, which is then no optimum.
/// Source: Clarke's condition with sampled gradients, docs/theory §12.
/// Accuracy: gradients met within 1e-6 differ by that times the curvature.
/// @returns the residual; NaN where the model is not defined
double kkt_residual(const RefinementProblem& problem, const Point& v);

}  // namespace gear3k::optimize
