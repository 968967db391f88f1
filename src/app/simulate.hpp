#pragma once

#include <string>

#include "report/motion_report.hpp"

namespace gear3k::app {

struct SimulateRequest {
  actuator::Actuator actuator;
  std::string source;  ///< of the actuator, for messages
  motion::Scenario scenario;
};

/// The motion of an actuator in a scenario.
/// @throws io::InvalidInput where a side lacks inertia that it needs; std::runtime_error where the
/// integration finds no way on
report::MotionResult simulate(const SimulateRequest& request,
                              const motion::MotionProgress& progress = {});

}  // namespace gear3k::app
