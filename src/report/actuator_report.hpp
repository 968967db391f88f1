#pragma once
// What an actuator is and what a duty cycle costs: JSON, CSV, tables.

#include <optional>
#include <string>
#include <vector>

#include "actuator/drive_diagram.hpp"
#include "actuator/duty_cycle.hpp"
#include "actuator/felt.hpp"
#include "actuator/impedance.hpp"
#include "actuator/reflected.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// All that `gear3k actuator` computes.
struct ActuatorResult {
  actuator::Actuator actuator;
  actuator::Reflected reflected;
  std::optional<actuator::FeltTorque> felt;  ///< where a torque of the motor is stated
  std::vector<actuator::LimitCheck> felt_checks;
  std::optional<actuator::DutyCycle> cycle;
  std::string cycle_name;
  std::optional<std::vector<actuator::WithoutCause>> without_each;
  std::optional<actuator::ImpedanceTask> impedance_task;
  std::vector<actuator::ImpedancePoint> impedance;
  std::vector<actuator::DrivePoint> drive_diagram;  ///< where asked for
};

/// Limits as `checks` of the JSON and as lines of a table.
io::Json limit_checks_json(const std::vector<actuator::LimitCheck>& checks);
std::string limit_checks_text(const std::vector<actuator::LimitCheck>& checks);

io::Json actuator_json(const ActuatorResult& result);
std::string actuator_table(const ActuatorResult& result);
/// The motor over the cycle, a row for each end of a part of it.
std::string actuator_cycle_csv(const actuator::DutyCycle& cycle);
std::string impedance_csv(const std::vector<actuator::ImpedancePoint>& points);

}  // namespace gear3k::report
