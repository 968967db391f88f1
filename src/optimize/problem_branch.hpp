#pragma once
// The smooth parts that maxima split a tooth set's programme into.

#include <vector>

#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// Which smooth part of a maximum a problem takes; the best of all branches counts.
struct ProblemBranch {
  /// 1 or 2: which of the paper's φ_2, φ_3 has to reach the lower limit of the lost motion (either
  /// suffices); of no effect where that is no row of both.
  int backlash = 1;
  /// 1 or 2: which part of the objective is the larger one; 0 where it has none.
  int objective = 0;
};

/// Every branch of a specification's problems, one at least.
std::vector<ProblemBranch> branches_of(const Specification& spec);

/// Whether the least lost motion is a row of its problems: meshes that do not interfere imply 0.
bool has_least_lost_motion(const design::Limits& limits);

}  // namespace gear3k::optimize
