#pragma once
// A design evaluated, or why it cannot be: the one place where that becomes an exception.

#include <optional>
#include <string>

#include "design/evaluation.hpp"
#include "design/operating_map.hpp"
#include "design/torque_angle_curve.hpp"

namespace gear3k::app {

/// design::evaluate() of a design that must be defined.
/// @param source  stands for the design in messages, such as the name of its file
/// @throws io::InvalidInput "SOURCE: why the geometry is not defined", also for values outside the
/// ranges of the geometry functions
design::Evaluation evaluate(const design::Design& design, const std::string& source);
design::PairEvaluation evaluate(const design::PairDesign& pair, const std::string& source);
/// Torque and angle of the output of a design with [strength]; why not is a note.
std::optional<design::TorqueAngleCurve> torque_angle(const design::Design& design,
                                                     design::Evaluation& evaluation);
/// The same of its operating map.
design::OperatingMap operating_map(const design::Design& design, const std::string& source);

}  // namespace gear3k::app
