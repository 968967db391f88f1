#pragma once

#include <functional>
#include <span>

#include "optimize/gradients.hpp"

namespace gear3k::optimize {

/// f and all g with their gradients at a point.
/// @returns whether the model is defined there
using GradientFunction = std::function<bool(std::span<const double> v, Gradients& result)>;

/// Norm of the Lagrangian's gradient with least-squares multipliers, which are non-negative on the
/// constraints and bounds active within 1e-6 (others have none).
///
///   min_{λ ≥ 0} ‖∇f − Σ_active λ_k ∇g_k‖₂     in the scaled variables
///
/// Next to a kink (a root that becomes fully round, a factor that reaches its least value) one
/// gradient says little.  Where it leaves more than kStationary, the gradients met 1e-6 to either
/// side along every variable join in (i = 0: the point itself),
///
///   min_{κ, λ ≥ 0, Σκ = 1} ‖Σ_i κ_i ∇f_i − Σ_active Σ_i λ_ki ∇g_ki‖₂
///
/// unless the objective falls along one side of the kink, which is then no optimum.
/// Source: Clarke's condition with sampled gradients, docs/theory §12.
/// Accuracy: gradients met within 1e-6 differ by that times the curvature.
/// @returns the residual; NaN where the model is not defined
double kkt_residual(const GradientFunction& function, std::span<const double> v,
                    std::span<const double> lower, std::span<const double> upper);
/// The same of a refinement problem.
double kkt_residual(const RefinementProblem& problem, const Point& v);

}  // namespace gear3k::optimize
