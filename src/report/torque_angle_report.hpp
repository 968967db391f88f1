#pragma once
// The torque-angle curve of an output, as printed and written.

#include <string>

#include "design/torque_angle_curve.hpp"
#include "report/fields.hpp"

namespace gear3k::report {

/// What the curve says in numbers; JSON alone.
Fields torque_angle_fields(const design::TorqueAngleCurve& curve);

/// One line: wind-up, stiffness, what friction takes.
std::string torque_angle_summary(const design::TorqueAngleCurve& curve);

/// One row per point, branch after branch.
std::string torque_angle_csv(const design::TorqueAngleCurve& curve);

}  // namespace gear3k::report
