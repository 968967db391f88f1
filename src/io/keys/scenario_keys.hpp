#pragma once
// Keys of SCENARIO files, and what they set.

#include <optional>
#include <string>

#include "io/keys/key_registry.hpp"
#include "motion/scenario.hpp"

namespace gear3k::io {

struct ScenarioInput {
  motion::Scenario scenario;
  /// The command by its kind; the one of the control's mode becomes that of the scenario.
  double torque_Nm = 0.0, torque_amplitude_Nm = 0.0;
  double voltage_V = 0.0, voltage_amplitude_V = 0.0;
  double angle_rad = 0.0, angle_amplitude_rad = 0.0;
  std::string control_table, load_table;  ///< paths of CSV files; "" = none
};

const Schema<ScenarioInput>& scenario_schema();

/// What the keys say together.
void check_scenario(const ScenarioInput& input, FileReading& reading);

}  // namespace gear3k::io
