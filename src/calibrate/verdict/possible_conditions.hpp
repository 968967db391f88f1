#pragma once
// What could be measured next.

#include <vector>

#include "calibrate/verdict/experiment.hpp"

namespace gear3k::calibrate {

/// A grid of conditions within the limits of the options, without any within what the data and the
/// gearbox have; at twelve angles each where waves are in question, and by a reference sensor too
/// where the sensor is.  Those at which every explanation stays within physics, where there are
/// any.
std::vector<Condition> possible_conditions(const Problem& problem,
                                           const std::vector<Explanation>& explanations,
                                           const DiagnoseOptions& options);

/// Rows to simulate, of a session after those of the data.
MeasurementSet rows_at(const std::vector<Condition>& conditions, const MeasurementSet& data);

/// An explanation in new rows: of a further session, with what drifts as the data left it.
Hypothesis later(Hypothesis h);

}  // namespace gear3k::calibrate
