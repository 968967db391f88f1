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

/// Noise of unknown memory, taken as a whole.
struct MemoryEvidence {
  /// 2 ln of the likelihood, its mean over all memories; up to a constant of the data.
  double twice_log_likelihood = 0.0;
  MemoryEstimate likeliest;  ///< none where independent readings look like this by luck
};

/// Likelihood of what a hypothesis misses, its parameters free, averaged over what the noise may
/// remember: nothing with the weight 1/2, else φ from 0.2 to 0.95 and ρ up to 1, of long memory
/// (φ > 0.7) up to 1/2.  Sessions have no levels of their own here: memory makes them differ.
/// Source: docs/theory §30 (noise that remembers).  Valid: an order that is known.
/// @param noise   with the weights and the scatter of sessions; its memory does not count
/// @param missed  measured − simulated, far rows moved in [SI]
/// @param own     derivatives by the hypothesis' parameters [SI]
/// @param chance  no likeliest memory where independent readings look like this more often by luck
MemoryEvidence memory_evidence(const NoiseModel& noise, const Eigen::VectorXd& missed,
                               const Eigen::MatrixXd& own, double chance);

}  // namespace gear3k::calibrate
