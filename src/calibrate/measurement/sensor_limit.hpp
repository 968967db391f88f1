#pragma once
// Rows at a limit of the torque sensor.

#include <optional>
#include <string>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// Leaves out rows of one transmission file at a limit of the sensor, and notes them: the greatest
/// or the least sun torque, repeated exactly in five rows or more whose loads differ by more than
/// 5 % and by more than the sensor's resolution can hide.  The resolution is the least difference
/// of two sun torques; a load hides where the middle one of the ratios of sun and output torque
/// makes less than two of it.  Loaded rows of exactly 0 that no rule leaves out, five or more, are
/// noted and stay.  Other kinds: nothing.
/// @returns what is wrong with the file where they are more than half of its rows, which then stay
std::optional<std::string> leave_out_saturated(MeasurementSet& set);

}  // namespace gear3k::calibrate
