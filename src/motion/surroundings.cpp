#include "motion/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gear3k::motion {

Surroundings::Surroundings(const actuator::Actuator& actuator, const Scenario& scenario)
    : motor_(actuator.motor), ratio_(actuator.gearbox.ratio), scenario_(scenario) {}

void Surroundings::enter(double time_s) {
  command_piece_ = piece_from(scenario_.command, time_s);
  load_piece_ = piece_from(scenario_.load.torque_Nm, time_s);
}

double Surroundings::next_row_s(double time_s) const {
  double next = std::numeric_limits<double>::infinity();
  for (const Signal* signal : {&scenario_.command, &scenario_.load.torque_Nm}) {
    const auto row = std::ranges::upper_bound(signal->time_s, time_s);
    if (row != signal->time_s.end()) next = std::min(next, *row);
  }
  return next;
}

double Surroundings::motor_torque(double time_s, const Sides& sides) const {
  const Signal& command = scenario_.command;
  const double per_volt = motor_.torque_constant_Nm_A / motor_.resistance_ohm;
  const double induced = motor_.torque_constant_Nm_A * ratio_ * sides.fast_rad_s;
  switch (scenario_.control) {
    case Control::kTorque:
      return value_at(command, time_s, command_piece_);
    case Control::kVoltage:
      return per_volt * (value_at(command, time_s, command_piece_) - induced);
    case Control::kShorted:
      return -per_volt * induced;
    case Control::kOpen:
      return 0.0;
    case Control::kPosition:
      break;
  }
  const double angle = value_at(command, time_s, command_piece_) - sides.output_rad;
  const double speed = slope_at(command, time_s, command_piece_) - sides.output_rad_s;
  return (scenario_.control_stiffness_Nm_rad * angle + scenario_.control_damping_Nms * speed) /
         ratio_;
}

Outside Surroundings::at(double time_s, const Sides& sides) const {
  const Load& load = scenario_.load;
  const Pendulum& pendulum = load.pendulum;
  Outside o;
  o.motor_Nm = motor_torque(time_s, sides);
  o.reflected_Nm = ratio_ * o.motor_Nm;
  o.current_A = o.motor_Nm / motor_.torque_constant_Nm_A;
  const bool closed = scenario_.control == Control::kShorted;
  o.voltage_V = closed ? 0.0
                       : motor_.resistance_ohm * o.current_A +
                             motor_.torque_constant_Nm_A * ratio_ * sides.fast_rad_s;
  o.electrical_W = o.voltage_V * o.current_A;
  o.copper_W = motor_.resistance_ohm * o.current_A * o.current_A;
  o.prescribed_Nm = value_at(load.torque_Nm, time_s, load_piece_);
  o.load_Nm = o.prescribed_Nm;
  if (load.stiffness_Nm_rad != 0.0) {
    o.load_Nm -= load.stiffness_Nm_rad * (sides.output_rad - load.rest_angle_rad);
  }
  if (pendulum.mass_kg != 0.0) {
    o.load_Nm -= pendulum.mass_kg * pendulum.gravity_m_s2 * pendulum.length_m *
                 std::sin(sides.output_rad - pendulum.hanging_rad);
  }
  return o;
}

double Surroundings::load_inertia_kgm2() const {
  const Pendulum& pendulum = scenario_.load.pendulum;
  return scenario_.load.inertia_kgm2 + pendulum.mass_kg * pendulum.length_m * pendulum.length_m;
}

double Surroundings::spring_j(double output_rad) const {
  const double angle = output_rad - scenario_.load.rest_angle_rad;
  return 0.5 * scenario_.load.stiffness_Nm_rad * angle * angle;
}

double Surroundings::gravity_j(double output_rad) const {
  const Pendulum& pendulum = scenario_.load.pendulum;
  const double half = std::sin(0.5 * (output_rad - pendulum.hanging_rad));
  return 2.0 * pendulum.mass_kg * pendulum.gravity_m_s2 * pendulum.length_m * half * half;
}

double Surroundings::stiffness_nm_rad() const {
  const Pendulum& pendulum = scenario_.load.pendulum;
  return scenario_.load.stiffness_Nm_rad +
         pendulum.mass_kg * pendulum.gravity_m_s2 * pendulum.length_m +
         (scenario_.control == Control::kPosition ? scenario_.control_stiffness_Nm_rad : 0.0);
}

}  // namespace gear3k::motion
