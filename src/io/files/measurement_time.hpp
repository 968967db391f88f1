#pragma once
// The order of rows in time.

#include "calibrate/measurement/measurement.hpp"
#include "io/text/complaints.hpp"

namespace gear3k::io {

/// Complains where time goes back within a run of one file (torque_angle: does not go on).  Where
/// rows are plainly not in the order of time (more than one step in ten goes back) that is noted
/// instead; a torque-angle record must be in order.
void check_time(calibrate::MeasurementSet& set, Complaints& complaints);

}  // namespace gear3k::io
