#pragma once

#include <optional>
#include <string>

#include "actuator/cycle.hpp"
#include "report/actuator_report.hpp"

namespace gear3k::app {

struct ActuatorRequest {
  actuator::Actuator actuator;
  std::string source;  ///< of the actuator, for messages
  std::optional<actuator::Cycle> cycle;
  std::optional<actuator::ImpedanceTask> impedance;
  bool without_each = false;
  bool keep_instants = false;  ///< of the cycle, for CSV and figures
  bool drive_diagram = false;
};

/// What an actuator is at its output, what a cycle asks of it, and how it feels from outside.
/// @throws io::InvalidInput where a designed train does not turn as the cycle asks
report::ActuatorResult analyze_actuator(const ActuatorRequest& request);

}  // namespace gear3k::app
