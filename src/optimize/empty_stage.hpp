#pragma once
// Which limit leaves a stage without any design.

#include "optimize/shift_range.hpp"
#include "optimize/stage_relaxation.hpp"

namespace gear3k::optimize {

/// Whether a check is of the load that bounds know: flank_safety, root_safety.
bool is_load(design::CheckId check);

/// Names the check without which the proof that a stage is empty fails, and the amount that it has
/// to give way at least (by bisection, while the proof holds); where no check undoes it alone, the
/// last of those dropped together.
/// @param task   that relax_stage() proves to be empty with this effort
/// @param stage  0 or 1: of which the modules are
Infeasibility name_empty_stage(const Specification& spec, const StageTask& task, std::size_t stage,
                               const StageEffort& effort);

}  // namespace gear3k::optimize
