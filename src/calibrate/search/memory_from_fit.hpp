#pragma once
// What the residuals of a fit say of how the noise remembers.

#include <Eigen/Core>

#include "calibrate/fit/fit.hpp"

namespace gear3k::calibrate {

/// Restricted likelihood of what a hypothesis leaves in weighted rows (far ones as kWinsor
/// deviations), with a level of each session of its own, so that sessions that differ are no
/// memory.
/// Source: docs/theory §30 (noise that remembers).  Valid: at least kFewestRememberingRows rows
/// whose order is known; else p_value 1.
/// @param chance  no memory where independent readings look like this more often by luck
MemoryEstimate memory_of(const Problem& problem, const Hypothesis& hypothesis, double chance);
inline constexpr int kFewestRememberingRows = 20;

}  // namespace gear3k::calibrate
