#pragma once
// Whether the sun's torque was set, so that what was read, and scatters, is the output's.

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// Whether the sun's torque was set and the output's was read: it takes a third as many values,
/// most of them several times, at loads that lie together.  Readings of a sensor so coarse that it
/// shows few values may pass for it, but not where it is at its limit.
bool is_commanded(const MeasurementSet& data);

}  // namespace gear3k::calibrate
