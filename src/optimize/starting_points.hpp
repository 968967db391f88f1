#pragma once

#include <vector>

#include "optimize/refinement_problem.hpp"
#include "optimize/set_bounds.hpp"

namespace gear3k::optimize {

/// Starting points for the refinement of one tooth set, in closed form.
///
/// Each takes a pair of shifts for S, P1 and for P2, R2 (the first ones from a fixed table of
/// fractions of the shift range, the rest drawn from `seed` and the tooth numbers), and closes the
/// meshes one after the other: the angle at which S-P1 has no backlash, the x_R1 with which
/// P1-R1 has none at that distance, the angle (or x_R2) at which P2-R2 has none.  Values are
/// clipped to the box, so a start need not be feasible.  With a bound there is one more, the first:
/// where the bound's stages have their least losses.
/// Source: own derivation, docs/theory §12, §32.
std::vector<Point> starting_points(const RefinementProblem& problem, int count,
                                   unsigned long long seed, const SetBound* bound = nullptr);

}  // namespace gear3k::optimize
