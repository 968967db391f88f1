#pragma once
// One task of a sweep, worked on.

#include <string>

#include "optimize/progress.hpp"
#include "sweep/task.hpp"

namespace gear3k::app {

/// Searches for the best design of a SPEC, certified where it has bounds, with the default number
/// of OpenMP threads.  What is wrong with the SPEC, or with the run, is a result as well.
sweep::TaskResult solve_task(const std::string& spec_text, optimize::Progress& progress);

}  // namespace gear3k::app
