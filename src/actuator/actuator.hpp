#pragma once
// A motor with drive, gearbox and load: what a user describes.  SI units inside.

#include <memory>
#include <optional>
#include <string>

namespace gear3k::actuator {

/// Source: slope of copper's resistance over temperature, per kelvin at 25 °C, as in the thermal
/// model of docs/theory §61.
inline constexpr double kCopperSlope_1_K = 0.00393;
/// Temperature at which a winding's resistance is stated, 25 °C.
inline constexpr double kResistanceTemperature_K = 25.0 + 273.15;

/// Heat paths of a motor; empty where they are not stated.
struct MotorHeat {
  std::optional<double> winding_housing_K_W, housing_ambient_K_W;  ///< both or none
  std::optional<double> winding_ambient_K_W{};                     ///< in place of both, as one
  std::optional<double> winding_time_constant_s, housing_time_constant_s;
  std::optional<double> max_winding_K;
  double ambient_K = kResistanceTemperature_K;
};

/// Current with loss R I²: of a direct-current motor, or terminal values.
struct Motor {
  double resistance_ohm = 0.0;        ///< at 25 °C
  double torque_constant_Nm_A = 0.0;  ///< T = K_t I
  double rotor_inertia_kgm2 = 0.0;    ///< J_m
  double coulomb_Nm = 0.0;            ///< T_c while it turns
  double static_Nm = 0.0;             ///< at rest, ≥ coulomb_Nm
  double viscous_Nms = 0.0;           ///< D_m
  std::optional<double> shaft_stiffness_Nm_rad;
  std::optional<double> max_current_A, max_speed_rad_s;
  std::optional<double> mass_kg;
  MotorHeat heat;
};

/// Gearbox by values of a catalogue: load-proportional losses and, apart from them, drag.
struct Gearbox {
  double ratio = 1.0;                ///< i = w_motor/w_output, signed
  double efficiency_forward = 1.0;   ///< η_f: the motor's side drives the mesh
  double efficiency_backward = 1.0;  ///< η_b: the output drives; ≤ 0: self-locking
  double input_inertia_kgm2 = 0.0, output_inertia_kgm2 = 0.0;
  std::optional<double> stiffness_Nm_rad;  ///< at the output
  double coulomb_Nm = 0.0;                 ///< c2 while it turns, at the output
  double static_Nm = 0.0;                  ///< c2s at rest, ≥ coulomb_Nm
  double viscous_Nms = 0.0;                ///< D2, at the output
  std::optional<double> backlash_rad{};    ///< lost motion of the output with the motor locked
  std::optional<double> mass_kg;
};

struct Drive {
  std::optional<double> bus_voltage_V;
  double efficiency_motoring = 1.0;
  double efficiency_regenerating = 1.0;  ///< 0: a chopper burns what comes back
  double standby_W = 0.0;
};

/// Limits of what is felt at the output: see felt.hpp.
struct FeltLimits {
  std::optional<double> max_inertia_kgm2, max_breakaway_Nm, max_transparency;
  std::optional<double> transparency_torque_Nm;  ///< of the motor, at the output
};

class DesignTrain;

struct Actuator {
  std::string name;
  Motor motor;
  Gearbox gearbox;  ///< with a train: its ratio, stiffness and mass alone
  Drive drive;
  double load_inertia_kgm2 = 0.0;
  FeltLimits felt{};
  std::shared_ptr<const DesignTrain> train;  ///< a designed gearbox in place of catalogue values
};

}  // namespace gear3k::actuator
