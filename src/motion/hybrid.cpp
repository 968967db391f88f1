#include "motion/hybrid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace gear3k::motion {

namespace {

/// What rounding may make of torques that cancel, as a share of them.
constexpr double kTorqueRounding = 1e-12;
/// Of powers that cancel.
constexpr double kPowerRounding = 1e-9;
/// Of the half gap.
constexpr double kGapRounding = 1e-12;
/// Keeps what is nothing at all above zero.
constexpr double kNothing = 1e-300;

}  // namespace

Sides sides_of(const State& x) {
  return {.fast_rad = x[kFastAngle],
          .fast_rad_s = x[kFastSpeed],
          .output_rad = x[kOutputAngle],
          .output_rad_s = x[kOutputSpeed]};
}

Hybrid::Hybrid(const actuator::Actuator& actuator, const Scenario& scenario)
    : chain_(chain_of(actuator)),
      drive_(actuator.drive),
      scenario_(scenario),
      half_gap_rad_(0.5 * actuator.gearbox.backlash_rad.value_or(0.0)),
      surroundings_(actuator, scenario),
      gear_(motion_gear(actuator, surroundings_.load_inertia_kgm2())) {
  const auto [fast, output] = gear_->inertias_kgm2();
  if (!(fast + output > 0.0)) {
    throw std::invalid_argument(
        "motor, gearbox and load have no inertia: allowed: motor.rotor_inertia_kgm2 or a load's "
        "above 0");
  }
  if (half_gap_rad_ > 0.0 && !(fast > 0.0 && output > 0.0)) {
    throw std::invalid_argument(
        "within the backlash each side moves by itself: allowed: inertia of the motor and of the "
        "load above 0, or backlash.output_arcmin = 0");
  }
  if (half_gap_rad_ > 0.0) mode_.phase = Phase::kGap;
}

State Hybrid::start() const {
  State x{};
  x[kOutputAngle] = scenario_.start_angle_rad;
  x[kFastAngle] = x[kOutputAngle] + half_gap_rad_ * scenario_.start_gap_position;
  x[kFastSpeed] = x[kOutputSpeed] = scenario_.start_speed_rad_s;
  return x;
}

double Hybrid::kinetic_j(const State& x) const {
  const auto [fast, output] = gear_->inertias_kgm2();
  return 0.5 * (fast * x[kFastSpeed] * x[kFastSpeed] + output * x[kOutputSpeed] * x[kOutputSpeed]);
}

double Hybrid::max_step_s() const {
  constexpr double kSteps = 50.0;
  constexpr double kPerPeriod = 40.0;
  if (scenario_.solver.max_step_s) return *scenario_.solver.max_step_s;
  double period = kPerPeriod / kSteps * scenario_.duration_s;
  const auto [fast, output] = gear_->inertias_kgm2();
  const double inertia = half_gap_rad_ > 0.0 ? std::min(fast, output) : fast + output;
  if (const double stiffness = surroundings_.stiffness_nm_rad(); stiffness > 0.0) {
    period = std::min(period, 2.0 * std::numbers::pi * std::sqrt(inertia / stiffness));
  }
  for (const Signal* signal : {&scenario_.command, &scenario_.load.torque_Nm}) {
    if (signal->amplitude != 0.0 && signal->frequency_Hz > 0.0) {
      period = std::min(period, 1.0 / signal->frequency_Hz);
    }
  }
  return period / kPerPeriod;
}

JointInput Hybrid::joint_input(const Outside& o, double speed_rad_s, int sense,
                               bool starting) const {
  const double friction = starting ? chain_.c1_static_Nm : chain_.c1_Nm;
  const double viscous = chain_.d1_Nms * speed_rad_s;
  return {.fast_Nm = o.reflected_Nm - viscous - sense * friction,
          .fast_scale_Nm = std::abs(o.reflected_Nm) + std::abs(viscous) + friction,
          .load_Nm = o.load_Nm,
          .speed_rad_s = speed_rad_s,
          .sense = sense,
          .starting = starting};
}

double Hybrid::bus_w(double electrical_W) const {
  return (signs_.electrical > 0 ? electrical_W / drive_.efficiency_motoring
                                : electrical_W * drive_.efficiency_regenerating) +
         drive_.standby_W;
}

void Hybrid::set_slide(const JointInput& in, int flow, Instant& now) const {
  JointInput held = in;
  held.flow = flow;
  const Joint joint = gear_->joined(held);
  now.fast_rad_s2 = now.output_rad_s2 = joint.acceleration_rad_s2;
  now.mesh_Nm = joint.mesh_Nm;
  now.lead = joint.lead;
  now.lead_rounding = joint.lead_rounding;
  now.jammed = joint.jammed;
  now.loss_W = joint.loss_W;
}

void Hybrid::set_gap(const State& x, const Mode& mode, Instant& now) const {
  const Outside& o = now.outside;
  if (mode.fast_sense != 0) {
    const double speed = x[kFastSpeed];
    const FreeSide fast = gear_->fast_alone(
        {.torque_Nm = o.reflected_Nm - chain_.d1_Nms * speed - mode.fast_sense * chain_.c1_Nm,
         .speed_rad_s = speed,
         .sense = mode.fast_sense});
    now.fast_rad_s2 = fast.acceleration_rad_s2;
    now.loss_W = fast.loss_W;
  }
  if (mode.output_sense != 0) {
    const FreeSide output = gear_->output_alone(
        {.torque_Nm = o.load_Nm, .speed_rad_s = x[kOutputSpeed], .sense = mode.output_sense});
    now.output_rad_s2 = output.acceleration_rad_s2;
    for (std::size_t k = 0; k < now.loss_W.size(); ++k) now.loss_W[k] += output.loss_W[k];
  }
}

Instant Hybrid::at(const State& x, double time_s) const {
  Instant now;
  now.outside = surroundings_.at(time_s, sides_of(x));
  now.bus_W = bus_w(now.outside.electrical_W);
  const double speed = x[kFastSpeed];
  int sense = 0;
  if (mode_.phase == Phase::kSlide) {
    sense = mode_.sense;
    set_slide(joint_input(now.outside, speed, sense, false), mode_.flow, now);
  } else if (mode_.phase == Phase::kGap) {
    sense = mode_.fast_sense;
    set_gap(x, mode_, now);
  }
  now.motor_coulomb_W = sense * chain_.c1_Nm * speed;
  now.motor_viscous_W = chain_.d1_Nms * speed * speed;
  return now;
}

void Hybrid::slopes(const State& x, State& dxdt, double time_s) const {
  const Instant now = at(x, time_s);
  const double given = -now.outside.prescribed_Nm * x[kOutputSpeed];
  dxdt[kFastAngle] = x[kFastSpeed];
  dxdt[kFastSpeed] = now.fast_rad_s2;
  dxdt[kOutputAngle] = x[kOutputSpeed];
  dxdt[kOutputSpeed] = now.output_rad_s2;
  dxdt[kDrawn] = signs_.bus > 0 ? now.bus_W : 0.0;
  dxdt[kRegenerated] = signs_.bus > 0 ? 0.0 : -now.bus_W;
  dxdt[kPositive] = signs_.load > 0 ? given : 0.0;
  dxdt[kNegative] = signs_.load > 0 ? 0.0 : -given;
  dxdt[kCopper] = now.outside.copper_W;
  dxdt[kMotorCoulomb] = now.motor_coulomb_W;
  dxdt[kMotorViscous] = now.motor_viscous_W;
  dxdt[kDrive] = now.bus_W - now.outside.electrical_W;
  std::ranges::copy(now.loss_W, dxdt.begin() + kGearLosses);
}

double Hybrid::hidden_torque_nm(const Outside& o) const {
  return kTorqueRounding *
         (std::abs(o.reflected_Nm) + std::abs(o.load_Nm) + chain_.c1_static_Nm + kNothing);
}

std::array<double, 2> Hybrid::rest_margins(const Outside& o) const {
  const double hidden = hidden_torque_nm(o) + kNothing;
  return {hidden - signs_.rest[0] * breakaway_excess_nm(o, 1),
          hidden - signs_.rest[1] * breakaway_excess_nm(o, -1)};
}

double Hybrid::breakaway_excess_nm(const Outside& o, int sense) const {
  return std::min(gear_->breakaway_excess_nm(joint_input(o, 0.0, sense, true)),
                  gear_->breakaway_excess_nm(joint_input(o, 0.0, sense, false))) -
         hidden_torque_nm(o);
}

double Hybrid::start_excess(const Outside& o, int sense) const {
  const double excess = breakaway_excess_nm(o, sense);
  if (!(excess >= 0.0)) return excess;
  const Joint rest = gear_->joined(joint_input(o, 0.0, sense, true));
  const bool pulled = mode_.contact != 0 && mode_.contact * rest.lead < 0.0;
  const bool held =
      pulled || rest.jammed || gear_->joined(joint_input(o, 0.0, sense, false)).jammed;
  return held ? -(std::abs(o.reflected_Nm) + std::abs(o.load_Nm) + kNothing) : excess;
}

double Hybrid::fast_start_excess(const Outside& o, int sense) const {
  const FreeSide side = gear_->fast_alone(
      {.torque_Nm = o.reflected_Nm - sense * chain_.c1_static_Nm, .sense = sense});
  return sense * side.acceleration_rad_s2 -
         kTorqueRounding * (std::abs(o.reflected_Nm) + chain_.c1_static_Nm + kNothing) /
             gear_->inertias_kgm2()[0];
}

double Hybrid::output_start_excess(const Outside& o, int sense) const {
  const FreeSide side =
      gear_->output_alone({.torque_Nm = o.load_Nm, .sense = sense, .starting = true});
  return sense * side.acceleration_rad_s2 -
         kTorqueRounding * (std::abs(o.load_Nm) + kNothing) / gear_->inertias_kgm2()[1];
}

double Hybrid::cohesion(const Outside& o) const {
  const Mode free{
      .phase = Phase::kGap, .fast_sense = started(o, true), .output_sense = started(o, false)};
  if (free.fast_sense == 0 && free.output_sense == 0) return 1.0;
  // A self-locking mesh holds the motor's side by the load that presses on it.
  const bool pressed = free.fast_sense == free.output_sense && free.fast_sense * mode_.contact < 0;
  if (pressed && !(breakaway_excess_nm(o, free.fast_sense) >= 0.0)) return 1.0;
  Instant now;
  now.outside = o;
  set_gap({}, free, now);
  const double apart = mode_.contact * (now.output_rad_s2 - now.fast_rad_s2);
  constexpr double kHidden = 1e-10;  // accelerations that are alike keep the sides together
  const double hidden = kHidden * (std::abs(now.output_rad_s2) + std::abs(now.fast_rad_s2));
  return apart > hidden ? -apart : 1.0;
}

double Hybrid::hidden_room(const State& x) const {
  constexpr double kUnits = 16.0;
  return kGapRounding * half_gap_rad_ + kUnits * std::numeric_limits<double>::epsilon() *
                                            (std::abs(x[kFastAngle]) + std::abs(x[kOutputAngle]));
}

std::array<double, 3> Hybrid::power_margins(const Instant& now, const State& x) const {
  const Outside& o = now.outside;
  const double mechanical = std::abs(o.reflected_Nm * x[kFastSpeed]);
  const double noise = kPowerRounding * (o.copper_W + mechanical) + kNothing;
  const double load = -o.prescribed_Nm * x[kOutputSpeed];
  return {signs_.electrical * o.electrical_W + noise,
          signs_.bus * now.bus_W + noise + kPowerRounding * drive_.standby_W,
          signs_.load * load + 2.0 * kSpeedFloor_rad_s * std::abs(o.prescribed_Nm) + kNothing};
}

Outside Hybrid::watch(const State& x, double time_s, std::vector<double>& values) const {
  const Instant now = at(x, time_s);
  const std::array<double, 3> powers = power_margins(now, x);
  values.assign(powers.begin(), powers.end());
  const Outside& o = now.outside;
  const auto add = [&](double value) { values.push_back(value); };
  switch (mode_.phase) {
    case Phase::kStick:
      add(-start_excess(o, 1));
      add(-start_excess(o, -1));
      if (mode_.contact == 0) break;
      for (const double margin : rest_margins(o)) add(margin);
      add(cohesion(o));
      break;
    case Phase::kSlide:
      add(mode_.sense * x[kOutputSpeed] + kSpeedFloor_rad_s);
      add(mode_.flow * mode_.sense * now.lead + now.lead_rounding);
      break;
    case Phase::kGap: {
      const double ahead = x[kFastAngle] - x[kOutputAngle];
      const double room = half_gap_rad_ + hidden_room(x);
      add(room - ahead);
      add(room + ahead);
      if (mode_.fast_sense != 0) {
        add(mode_.fast_sense * x[kFastSpeed] + kSpeedFloor_rad_s);
      } else {
        add(-std::max(fast_start_excess(o, 1), fast_start_excess(o, -1)));
      }
      if (mode_.output_sense != 0) {
        add(mode_.output_sense * x[kOutputSpeed] + kSpeedFloor_rad_s);
      } else {
        add(-std::max(output_start_excess(o, 1), output_start_excess(o, -1)));
      }
      break;
    }
  }
  return o;
}

void Hybrid::take(const std::vector<double>& values, State& x) {
  constexpr std::size_t kPowers = 3;
  const auto ended = [&](std::size_t k) { return !(values[kPowers + k] > 0.0); };
  if (mode_.phase == Phase::kSlide && ended(0)) {
    x[kFastSpeed] = x[kOutputSpeed] = 0.0;
    mode_ = {.phase = Phase::kStick, .contact = mode_.contact};
  } else if (mode_.phase == Phase::kGap) {
    if (ended(0)) x[kFastAngle] = x[kOutputAngle] + half_gap_rad_;
    if (ended(1)) x[kFastAngle] = x[kOutputAngle] - half_gap_rad_;
    if (mode_.fast_sense != 0 && ended(2)) {
      x[kFastSpeed] = 0.0;
      mode_.fast_sense = 0;
    }
    if (mode_.output_sense != 0 && ended(3)) {
      x[kOutputSpeed] = 0.0;
      mode_.output_sense = 0;
    }
  }
}

const char* phase_name(Phase phase) {
  switch (phase) {
    case Phase::kStick:
      return "stick";
    case Phase::kSlide:
      return "slide";
    case Phase::kGap:
      break;
  }
  return "gap";
}

}  // namespace gear3k::motion
