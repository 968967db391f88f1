#pragma once
// Conditions that are told by the session alone: what is named after sessions may be theirs.

#include <string>
#include <vector>

#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// The conditions on levels of which every session has one, and not all the same: a value for each
/// session, or a drift from one to the next, is then any law of such a condition, too.  Of three
/// rows a session and more.
std::vector<Levels> conditions_by_session(const MeasurementSet& data,
                                          const std::vector<Levels>& levels);

/// What a reader wants to know of them, and what would tell more.
std::string note_on_sessions(const Levels& condition);

}  // namespace gear3k::calibrate
