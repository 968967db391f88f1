#pragma once
// First derivatives of a refinement problem in all of its variables.

#include <cstdint>
#include <span>
#include <vector>

#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

/// f and g at a point with their gradients; its memory is kept from one point to the next.
struct Gradients {
  double f = 0.0;
  std::vector<double> df;  ///< ∂f/∂v_j
  std::vector<double> g;   ///< of the selected rows
  std::vector<double> dg;  ///< ∂g_k/∂v_j at [k · variables + j]
  std::vector<Jet1> pass;  ///< of one pass
};

/// Evaluates a problem in as many passes as its variables need, kMaxVariables at a time.
/// @param selection  rising indices into problem.rows
/// @returns whether the model is defined there
bool evaluate_gradients(const RefinementProblem& problem, std::span<const double> v,
                        std::span<const std::uint16_t> selection, Gradients& result);

/// All rows of a problem.
std::vector<std::uint16_t> all_rows(const RefinementProblem& problem);

}  // namespace gear3k::optimize
