#pragma once
// Torque-angle records among measurements that were read.

#include "io/files/measurement_file.hpp"

namespace gear3k::io {

/// Turns torque-angle records into rows of lost motion (calibrate::loop_observations()): of the set
/// of lost_motion where there is one, the set of torque_angle then goes, else of the set of
/// torque_angle.  The records themselves are used up.  Without such records nothing happens.
/// @param ratio  of the gearbox
/// @throws InvalidInput when no loop could be measured
void read_loops(Measurements& data, double ratio);

}  // namespace gear3k::io
