#pragma once
// What happens to an actuator: its start, what is done to the motor, and the load.

#include <cstdint>
#include <optional>
#include <string>

#include "motion/signal.hpp"

namespace gear3k::motion {

/// What is prescribed at the motor.
enum class Control {
  kTorque,    ///< the motor's torque T_em
  kVoltage,   ///< at its terminals: T_em = K_t (V − K_t i w)/R
  kShorted,   ///< V = 0
  kOpen,      ///< no current
  kPosition,  ///< T_em i = k (θ_ref − θ) + d (w_ref − w), of the output
};

/// A mass on an arm that hangs: T_L = −m g l sin(θ − θ_0), inertia m l².
struct Pendulum {
  double mass_kg = 0.0, length_m = 0.0;
  double hanging_rad = 0.0;  ///< θ_0: output angle at which it hangs
  /// Standard acceleration of free fall.  Source: 3rd General Conference on Weights and Measures
  /// (1901), exact by definition.
  double gravity_m_s2 = 9.80665;
};

struct Load {
  double inertia_kgm2 = 0.0;                            ///< besides that of the actuator's own load
  Signal torque_Nm;                                     ///< of the load on the output
  double stiffness_Nm_rad = 0.0, rest_angle_rad = 0.0;  ///< T_L = −k (θ − θ_rest)
  Pendulum pendulum;
};

struct Solver {
  double relative_tolerance = 1e-11;
  double absolute_tolerance = 1e-14;  ///< rad, rad/s, J
  std::optional<double> max_step_s;   ///< empty: see max_step()
  std::int64_t max_events = 100000;
  std::int64_t max_steps = 10000000;
};

struct Scenario {
  std::string name;
  double duration_s = 1.0;
  double start_angle_rad = 0.0, start_speed_rad_s = 0.0;
  /// Where the motor's side begins within the gap: −1 and 1 at its ends.
  double start_gap_position = 0.0;
  Control control = Control::kTorque;
  Signal command;  ///< torque at the motor [N m], voltage [V] or angle of the output [rad]
  double control_stiffness_Nm_rad = 0.0, control_damping_Nms = 0.0;  ///< of kPosition
  Load load;
  Solver solver;
  std::optional<double> sample_s;  ///< distance of the rows; empty: a thousandth of the duration
};

}  // namespace gear3k::motion
