#pragma once
// Keys of ACTUATOR files, and what they set.

#include <optional>
#include <string>
#include <vector>

#include "actuator/actuator.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

struct MotorInput {
  actuator::Motor motor;
  std::optional<double> no_load_current_A, no_load_speed_rad_s;
  std::optional<double> static_Nm;
  std::optional<double> thermal_resistance_K_W;  ///< from winding to the surroundings, as one
};

struct GearboxInput {
  actuator::Gearbox gearbox;
  std::optional<double> least_friction_speed_rad_s;
  std::string design;  ///< path of a DESIGN file; "" = catalogue values
  std::optional<double> coulomb_Nm, backdriving_Nm;
  std::optional<double> efficiency_includes_drag_at_Nm;
};

struct ActuatorInput {
  std::string name;
  MotorInput motor;
  GearboxInput gearbox;
  actuator::Drive drive;
  double load_inertia_kgm2 = 0.0;
  actuator::FeltLimits felt;
  std::optional<double> backlash_rad;
};

const Schema<ActuatorInput>& actuator_schema();

/// Limits of what is felt, which a SPEC has, too.
std::vector<Key<actuator::FeltLimits>> felt_keys();
/// @param table  before their paths: "", or one with its dot
void check_felt(const actuator::FeltLimits& felt, const std::string& table, FileReading& reading);

/// What the keys say together.
void check_actuator(const ActuatorInput& input, FileReading& reading);

}  // namespace gear3k::io
