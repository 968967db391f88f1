#pragma once
// Limits and tolerances that hold for the gearboxes built to a design, and what they cost.

#include "app/optimize.hpp"

namespace gear3k::app {

/// Sets a run's counters back for another search; its `stop` stays.
void restart(optimize::Progress& progress);

/// Tightens the task's limits until the best design holds as its specification asks, and where that
/// asks for the cheapest tolerances puts them in place of the stated ones.  Both the best design as
/// drawn and the chosen one are built again from a seed that the search did not see.
///
/// Source: optimize::robust_limits(), optimize::cheapest_tolerances(); docs/theory §35.
/// @param progress  may be watched, and ends the run by its `stop`
/// @returns without a chosen pass where nothing holds or the run was ended; the task is then as it
/// was
report::RobustRun hold_for_built(OptimizeTask& task, optimize::Progress& progress);

}  // namespace gear3k::app
