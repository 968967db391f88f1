#pragma once
// Rows at a limit of the torque sensor.

#include "calibrate/measurement/measurement.hpp"
#include "io/text/complaints.hpp"

namespace gear3k::io {

/// Leaves out rows of one transmission file at a limit of the sensor, and notes them: the greatest
/// or the least sun torque, repeated exactly in five rows or more whose loads differ by more than
/// 5 % and by more than the sensor's resolution can hide.  The resolution is the least difference
/// of two sun torques; a load hides where the middle one of the ratios of sun and output torque
/// makes less than two of it.  Complains when they are more than half of the rows.  Other kinds:
/// nothing.
void leave_out_saturated(calibrate::MeasurementSet& set, Complaints& complaints);

}  // namespace gear3k::io
