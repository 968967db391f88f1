#pragma once
// Figure of the torque-angle curve, as a script for gnuplot.

#include <string>

#include "design/torque_angle_curve.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

/// The loop with its lost motion at T = 0, and the line without friction.
/// @param name  of the design
Plot torque_angle_plot(const std::string& name, const design::TorqueAngleCurve& curve);

}  // namespace gear3k::report
