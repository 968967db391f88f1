#include "actuator/impedance.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "actuator/design_gear.hpp"

namespace gear3k::actuator {

namespace {

using Complex = std::complex<double>;
constexpr double kHalfTurn = std::numbers::pi / 2.0;

/// A spring behind which a body of dynamic stiffness S moves; a rigid one passes S on.
Complex in_series(const Complex& s, const std::optional<double>& spring) {
  if (!spring) return s;
  return s * *spring / (s + *spring);
}

struct Terminals {
  double d1_Nms;
  bool locked;
};

Terminals terminals_of(const Actuator& actuator, const Chain& chain, MotorTerminals motor) {
  const double back = chain.ratio * actuator.motor.torque_constant_Nm_A;
  const double braking =
      motor == MotorTerminals::kShorted ? back * back / actuator.motor.resistance_ohm : 0.0;
  return {.d1_Nms = chain.d1_Nms + braking, .locked = motor == MotorTerminals::kLocked};
}

std::optional<Complex> dynamic_stiffness(const Actuator& actuator, const Chain& chain,
                                         const Terminals& motor, double omega) {
  const double square = chain.ratio * chain.ratio;
  const Complex j(0.0, 1.0);
  std::optional<double> shaft = actuator.motor.shaft_stiffness_Nm_rad;
  if (shaft) *shaft *= square;
  const bool designed = actuator.train != nullptr;
  const double input_kgm2 = designed ? 0.0 : square * actuator.gearbox.input_inertia_kgm2;
  const double output_kgm2 =
      designed ? actuator.train->inertia_kgm2() + actuator.load_inertia_kgm2 : chain.j2_kgm2;
  std::optional<Complex> s;
  if (!motor.locked) {
    const double rotor = square * actuator.motor.rotor_inertia_kgm2;
    s = in_series(-omega * omega * rotor + j * omega * motor.d1_Nms, shaft);
  } else if (shaft) {
    s = *shaft;
  }
  if (s) {
    s = in_series(*s - omega * omega * input_kgm2, actuator.gearbox.stiffness_Nm_rad);
  } else if (actuator.gearbox.stiffness_Nm_rad) {
    s = *actuator.gearbox.stiffness_Nm_rad;
  }
  if (!s) return std::nullopt;
  return *s - omega * omega * output_kgm2 + j * omega * chain.d2_Nms;
}

/// ∫ (p sin x − q cos x − c) cos x dx and the same times sin x.
struct Harmonics {
  double cosine = 0.0, sine = 0.0;
};
struct FastSide {
  double p, q, c;  ///< u = p sin x − q cos x − c
};

Harmonics integral(const FastSide& u, double from, double to) {
  const auto at = [&](double x) {
    const double s = std::sin(x);
    const double c = std::cos(x);
    const double cos2 = 0.5 * (x + s * c);
    const double sin2 = 0.5 * (x - s * c);
    return Harmonics{.cosine = 0.5 * u.p * s * s - u.q * cos2 - u.c * s,
                     .sine = u.p * sin2 - 0.5 * u.q * s * s + u.c * c};
  };
  const Harmonics low = at(from);
  const Harmonics high = at(to);
  return {.cosine = high.cosine - low.cosine, .sine = high.sine - low.sine};
}

/// x* where u passes from backward to forward; π/2 where it never does.
double flow_change(const FastSide& u) {
  const double r = std::hypot(u.p, u.q);
  if (u.c >= r) return kHalfTurn;
  return std::min(std::asin(u.c / r) + std::atan2(u.q, u.p), kHalfTurn);
}

Complex as_impedance(const Harmonics& torque, double speed) {
  return {2.0 / std::numbers::pi * torque.cosine / speed,
          -2.0 / std::numbers::pi * torque.sine / speed};
}

void set_catalogue_harmonic(const Chain& chain, const Terminals& motor, double omega,
                            double amplitude, ImpedancePoint& point) {
  const double speed = amplitude * omega;
  const FastSide u{.p = chain.j1_kgm2 * omega * speed, .q = motor.d1_Nms * speed, .c = chain.c1_Nm};
  const double change = flow_change(u);
  const bool idle = u.p == 0.0 && u.q == 0.0 && u.c == 0.0;
  if (!idle && change > -kHalfTurn && !(chain.efficiency_backward > 0.0)) return;
  Harmonics torque =
      integral({.p = -chain.j2_kgm2 * omega * speed, .q = -chain.d2_Nms * speed, .c = -chain.c2_Nm},
               -kHalfTurn, kHalfTurn);
  if (!idle) {
    const Harmonics backward = integral(u, -kHalfTurn, change);
    const Harmonics forward = integral(u, change, kHalfTurn);
    torque.cosine -=
        backward.cosine / chain.efficiency_backward + forward.cosine * chain.efficiency_forward;
    torque.sine -=
        backward.sine / chain.efficiency_backward + forward.sine * chain.efficiency_forward;
    point.flow_change_rad = change;
  }
  point.first_harmonic_Nms = as_impedance(torque, speed);
}

/// The same by quadrature, for a train whose losses follow from its power flow.
void set_train_harmonic(const Actuator& actuator, const Chain& chain, const Terminals& motor,
                        double omega, double amplitude, ImpedancePoint& point) {
  constexpr int kParts = 720;
  const double speed = amplitude * omega;
  Harmonics torque;
  for (int k = 0; k < kParts; ++k) {
    // Midpoints: of a function of the whole period the rule converges fast between its kinks.
    const double x = -kHalfTurn + 2.0 * kHalfTurn * (k + 0.5) / kParts;
    const OutputMotion o{.speed_rad_s = speed * std::cos(x),
                         .acceleration_rad_s2 = -omega * speed * std::sin(x),
                         .sense = 1.0};
    const double u =
        -chain.j1_kgm2 * o.acceleration_rad_s2 - motor.d1_Nms * o.speed_rad_s - chain.c1_Nm;
    const auto mesh = output_torque(*actuator.train, o, u);
    if (!mesh) return;
    const double t = actuator.load_inertia_kgm2 * o.acceleration_rad_s2 - *mesh;
    torque.cosine += t * std::cos(x) * 2.0 * kHalfTurn / kParts;
    torque.sine += t * std::sin(x) * 2.0 * kHalfTurn / kParts;
  }
  point.first_harmonic_Nms = as_impedance(torque, speed);
}

void require_task(const ImpedanceTask& task) {
  if (task.low_Hz > 0.0 && task.high_Hz >= task.low_Hz && std::isfinite(task.high_Hz) &&
      task.points >= 1 && task.amplitude_rad >= 0.0 && std::isfinite(task.amplitude_rad)) {
    return;
  }
  throw std::invalid_argument(fmt::format(
      "impedance: {} to {} Hz in {} points at {} rad, allowed: 0 < low <= high, 1 point or more, 0 "
      "rad or more",
      task.low_Hz, task.high_Hz, task.points, task.amplitude_rad));
}

}  // namespace

std::vector<ImpedancePoint> impedance(const Actuator& actuator, const ImpedanceTask& task) {
  require_task(task);
  const Chain chain = chain_of(actuator);
  const Terminals motor = terminals_of(actuator, chain, task.motor);
  std::vector<ImpedancePoint> points;
  points.reserve(static_cast<std::size_t>(task.points));
  for (int k = 0; k < task.points; ++k) {
    const double share = task.points > 1 ? static_cast<double>(k) / (task.points - 1) : 0.0;
    ImpedancePoint point{.frequency_Hz = task.low_Hz * std::pow(task.high_Hz / task.low_Hz, share)};
    const double omega = 2.0 * std::numbers::pi * point.frequency_Hz;
    point.stiffness_Nm_rad = dynamic_stiffness(actuator, chain, motor, omega);
    if (point.stiffness_Nm_rad) {
      point.impedance_Nms = *point.stiffness_Nm_rad / Complex(0.0, omega);
    }
    if (task.amplitude_rad > 0.0 && !motor.locked) {
      if (actuator.train != nullptr) {
        set_train_harmonic(actuator, chain, motor, omega, task.amplitude_rad, point);
      } else {
        set_catalogue_harmonic(chain, motor, omega, task.amplitude_rad, point);
      }
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace gear3k::actuator
