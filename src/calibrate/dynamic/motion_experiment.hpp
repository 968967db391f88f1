#pragma once
// The motion that tells causes apart which a log leaves open.

#include <optional>

#include "calibrate/dynamic/motion_diagnosis.hpp"
#include "calibrate/dynamic/window_fit.hpp"

namespace gear3k::calibrate {

/// Of a gravity load, a second inertia and a chirp, as long as the log and at its greatest speed,
/// that which is expected to tell the effects from their alternatives best.
///
/// The log that a proposal would give is its terms in motion w = A sin Ωt under the changes found,
/// with the noise of the log; the χ² is that of the alternatives fitted to both.
/// @returns empty where none gives a χ² of at least 4
/// Source: docs/theory §70.
std::optional<MotionProposal> next_motion(const MotionDiagnosis& diagnosis, const WindowSums& sums,
                                          const DriveParameters& stated,
                                          const DriveChanges& changes);

}  // namespace gear3k::calibrate
