#pragma once
// Which of the pinion cutters at hand shape R1 and R2.

#include <array>
#include <vector>

#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

/// Every choice of Specification::cutter_teeth, by rising teeth of R1's, then of R2's; {0, 0} alone
/// where nothing is chosen.
std::vector<std::array<int, 2>> cutter_choices(const Specification& spec);

/// The problem without what a ring's cutter has a say in, so that it bounds the problems of all
/// cutters: the rows of ring_cutter, of form_circle and tip_fouling of meshes with a ring, and of
/// the load.  The objective must not be of the load.
RefinementProblem without_cutter_rows(const RefinementProblem& problem);

}  // namespace gear3k::optimize
