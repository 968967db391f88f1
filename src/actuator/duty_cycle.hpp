#pragma once
// What a duty cycle asks of motor and drive, and where its energy goes.

#include <optional>
#include <string>
#include <vector>

#include "actuator/actuator.hpp"
#include "actuator/cycle.hpp"
#include "actuator/winding.hpp"

namespace gear3k::actuator {

struct LossEnergy {
  std::string cause;
  double energy_J;
};

/// A limit of the actuator, held against a cycle.
struct LimitCheck {
  std::string name;  ///< current, voltage, speed, winding; felt_inertia, breakaway, transparency
  std::string unit;
  std::optional<double> value;  ///< empty: without bound (thermal runaway)
  double limit = 0.0;
  std::optional<double> margin{};  ///< limit − value
  bool ok = false;
};
/// A value against its limit; one without bound keeps none.
LimitCheck limit_check(std::string name, std::string unit, std::optional<double> value,
                       double limit);

/// Shares of the energy that the load gives while ...
struct NegativeShares {
  double backdriven = 0.0;     ///< it passes the mesh backward, m w < 0
  double motor_braking = 0.0;  ///< the motor's torque brakes, τ w < 0
  double regenerating = 0.0;   ///< the motor gives electrical power, P_el < 0
};

/// The motor at one instant.
struct MotorInstant {
  double time_s, speed_rad_s, load_Nm, mesh_Nm;  ///< of the output
  double motor_Nm, current_A, voltage_V, electrical_W;
};

struct DutyCycle {
  double period_s = 0.0;
  bool periodic = false;
  double positive_J = 0.0, negative_J = 0.0;  ///< that the load receives, that it gives
  double drawn_J = 0.0, regenerated_J = 0.0;  ///< from the bus, to the bus
  std::vector<LossEnergy> losses{};
  double kinetic_J = 0.0;
  double balance_error = 0.0;
  double peak_current_A = 0.0, rms_current_A = 0.0, peak_voltage_V = 0.0;
  double peak_motor_speed_rad_s = 0.0, peak_motor_torque_Nm = 0.0, rms_motor_torque_Nm = 0.0;
  std::optional<NegativeShares> shares{};  ///< empty where the load gives nothing
  std::optional<WindingState> winding{};   ///< empty without heat paths
  std::vector<LimitCheck> checks{};
  bool feasible = true;
  std::vector<std::string> notes{};
  std::vector<MotorInstant> instants{};  ///< ends of the parts of every piece, where asked for
};

/// What a motion asks of motor and drive at most.
struct DrivePeaks {
  double current_A = 0.0, voltage_V = 0.0, motor_speed_rad_s = 0.0;
};
/// Peaks against those limits of motor and drive that are stated.
std::vector<LimitCheck> drive_checks(const Actuator& actuator, const DrivePeaks& peaks);

/// Runs a cycle backwards from the output: torque, current and power of the motor follow from the
/// motion at every instant.
///
///   τ = J1 a + D1 w + c1 s + u,    I = τ/(i K_t),   V = R I + K_t i w,   P_el = V I = R I² + τ w
///   P_bus = P_el/η_mot where P_el > 0,  η_reg P_el where P_el < 0;  and the standby power
///   drawn − regenerated = positive − negative + losses + kinetic
///
/// A piece is split where w, m, T_L, T_em, P_el or P_bus change sign and integrated by three Gauss
/// points, two where speed and torque are straight: exact for constant efficiencies.  A piece that
/// rests (w = 0) takes the torque of least magnitude that holds it.  Peaks are one-sided limits at
/// the ends of the parts and, where the speed is no straight line, the extremes between them.
/// Source: own derivation, docs/theory §60.  Accuracy: balance_error ≤ 1e-12 of the sum of all
/// magnitudes with constant efficiencies.
/// Does not account for: inductance, cogging, the winding's temperature in R.
/// @throws std::invalid_argument as pieces_of(); std::runtime_error where a train does not turn
DutyCycle run_cycle(const Actuator& actuator, const Cycle& cycle, bool keep_instants = false);

/// What a cycle costs without one cause of loss or inertia.
struct WithoutCause {
  std::string cause;
  double drawn_J = 0.0, regenerated_J = 0.0;
  double saved_J = 0.0;  ///< net energy from the bus with the cause, less that without
};

/// The cycle once more without each cause: resistance, friction, mesh losses, inertia of motor and
/// gearbox, losses of the drive.  Copper that is spent against friction shows only here.
std::vector<WithoutCause> without_each(const Actuator& actuator, const Cycle& cycle,
                                       const DutyCycle& whole);

}  // namespace gear3k::actuator
