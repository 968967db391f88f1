#pragma once
// The loops of torque and angle that a diagnosis read.

#include <string>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::report {

/// Lost motion [arcmin] and flank stiffness [N m/rad] of each loop, friction included, referred to
/// the output, ± one standard deviation, and what each record was; "" without loops.
std::string loop_table(const calibrate::MeasurementSet& set);

}  // namespace gear3k::report
