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
  double braking_Nms;  ///< of the shorted motor
  double d1_Nms;
  bool locked;
};

Terminals terminals_of(const Actuator& actuator, const Chain& chain, MotorTerminals motor) {
  const double back = chain.ratio * actuator.motor.torque_constant_Nm_A;
  const double braking =
      motor == MotorTerminals::kShorted ? back * back / actuator.motor.resistance_ohm : 0.0;
  return {.braking_Nms = braking,
          .d1_Nms = chain.d1_Nms + braking,
          .locked = motor == MotorTerminals::kLocked};
}

/// The chain from the rotor to the output, all at the output.
struct LinearChain {
  double rotor_kgm2, input_kgm2, gears_kgm2, load_kgm2;
  double motor_Nms, braking_Nms, gears_Nms;
  std::optional<double> shaft_Nm_rad, gears_Nm_rad;
  bool locked;
};

LinearChain linear_chain(const Actuator& actuator, const Chain& chain, const Terminals& motor) {
  const double square = chain.ratio * chain.ratio;
  const bool designed = actuator.train != nullptr;
  LinearChain c{.rotor_kgm2 = square * actuator.motor.rotor_inertia_kgm2,
                .input_kgm2 = designed ? 0.0 : square * actuator.gearbox.input_inertia_kgm2,
                .gears_kgm2 = designed ? actuator.train->inertia_kgm2()
                                       : actuator.gearbox.output_inertia_kgm2,
                .load_kgm2 = actuator.load_inertia_kgm2,
                .motor_Nms = chain.d1_Nms,
                .braking_Nms = motor.braking_Nms,
                .gears_Nms = chain.d2_Nms,
                .shaft_Nm_rad = actuator.motor.shaft_stiffness_Nm_rad,
                .gears_Nm_rad = actuator.gearbox.stiffness_Nm_rad,
                .locked = motor.locked};
  if (c.shaft_Nm_rad) *c.shaft_Nm_rad *= square;
  return c;
}

void set_linear(const LinearChain& c, double omega, ImpedancePoint& point) {
  const double square = omega * omega;
  const Complex j(0.0, 1.0);
  const Complex rotor = -square * c.rotor_kgm2 + j * omega * (c.motor_Nms + c.braking_Nms);
  std::optional<Complex> behind;  // the gearbox's input
  if (!c.locked) {
    behind = in_series(rotor, c.shaft_Nm_rad);
  } else if (c.shaft_Nm_rad) {
    behind = *c.shaft_Nm_rad;
  }
  std::optional<Complex> s;
  if (behind) {
    s = in_series(*behind - square * c.input_kgm2, c.gears_Nm_rad);
  } else if (c.gears_Nm_rad) {
    s = *c.gears_Nm_rad;
  }
  if (!s) return;
  point.stiffness_Nm_rad = *s - square * (c.gears_kgm2 + c.load_kgm2) + j * omega * c.gears_Nms;
  point.impedance_Nms = *point.stiffness_Nm_rad / (j * omega);
  // How far the input and the rotor move while the output moves by 1.
  Complex input = behind ? Complex(1.0) : Complex(0.0);
  if (behind && c.gears_Nm_rad) {
    input = *c.gears_Nm_rad / (*behind - square * c.input_kgm2 + *c.gears_Nm_rad);
  }
  Complex turned = c.locked ? Complex(0.0) : input;
  if (!c.locked && c.shaft_Nm_rad) turned = input * *c.shaft_Nm_rad / (rotor + *c.shaft_Nm_rad);
  const auto inertia = [&](double kgm2, const Complex& moved) {
    return j * omega * kgm2 * std::norm(moved);
  };
  const auto spring = [&](const std::optional<double>& stiffness, const Complex& twist) {
    return stiffness ? *stiffness * std::norm(twist) / (j * omega) : Complex(0.0);
  };
  point.causes = {
      {.name = "motor_inertia", .impedance_Nms = inertia(c.rotor_kgm2, turned)},
      {.name = "gear_inertia",
       .impedance_Nms = inertia(c.input_kgm2, input) + inertia(c.gears_kgm2, 1.0)},
      {.name = "load_inertia", .impedance_Nms = inertia(c.load_kgm2, 1.0)},
      {.name = "motor_viscous", .impedance_Nms = c.motor_Nms * std::norm(turned)},
      {.name = "short_circuit", .impedance_Nms = c.braking_Nms * std::norm(turned)},
      {.name = "gear_viscous", .impedance_Nms = c.gears_Nms},
      {.name = "motor_stiffness", .impedance_Nms = spring(c.shaft_Nm_rad, input - turned)},
      {.name = "gear_stiffness", .impedance_Nms = spring(c.gears_Nm_rad, 1.0 - input)}};
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

/// Causes of the rigid chain that its gearbox does not know.
std::vector<ImpedanceCause> rigid_causes(const LinearChain& c, double coulomb_Nm, double omega,
                                         double speed) {
  const auto inertia = [&](double kgm2) { return Complex(0.0, omega * kgm2); };
  return {
      {.name = "motor_inertia", .impedance_Nms = inertia(c.rotor_kgm2)},
      {.name = "gear_inertia", .impedance_Nms = inertia(c.input_kgm2 + c.gears_kgm2)},
      {.name = "load_inertia", .impedance_Nms = inertia(c.load_kgm2)},
      {.name = "motor_viscous", .impedance_Nms = c.motor_Nms},
      {.name = "short_circuit", .impedance_Nms = c.braking_Nms},
      {.name = "motor_coulomb", .impedance_Nms = 4.0 * coulomb_Nm / (std::numbers::pi * speed)}};
}

void set_catalogue_harmonic(const Chain& chain, const LinearChain& linear, const Terminals& motor,
                            double omega, double amplitude, ImpedancePoint& point) {
  const double speed = amplitude * omega;
  const FastSide u{.p = chain.j1_kgm2 * omega * speed, .q = motor.d1_Nms * speed, .c = chain.c1_Nm};
  const double change = flow_change(u);
  const bool idle = u.p == 0.0 && u.q == 0.0 && u.c == 0.0;
  if (!idle && change > -kHalfTurn && !(chain.efficiency_backward > 0.0)) return;
  Harmonics torque =
      integral({.p = -chain.j2_kgm2 * omega * speed, .q = -chain.d2_Nms * speed, .c = -chain.c2_Nm},
               -kHalfTurn, kHalfTurn);
  Harmonics mesh;
  if (!idle) {
    const Harmonics backward = integral(u, -kHalfTurn, change);
    const Harmonics forward = integral(u, change, kHalfTurn);
    const double b = 1.0 / chain.efficiency_backward - 1.0;
    const double f = chain.efficiency_forward - 1.0;
    mesh = {.cosine = -backward.cosine * b - forward.cosine * f,
            .sine = -backward.sine * b - forward.sine * f};
    torque.cosine -=
        backward.cosine / chain.efficiency_backward + forward.cosine * chain.efficiency_forward;
    torque.sine -=
        backward.sine / chain.efficiency_backward + forward.sine * chain.efficiency_forward;
    point.flow_change_rad = change;
  }
  point.first_harmonic_Nms = as_impedance(torque, speed);
  point.harmonic_causes = rigid_causes(linear, chain.c1_Nm, omega, speed);
  point.harmonic_causes.push_back({.name = "gear_viscous", .impedance_Nms = chain.d2_Nms});
  point.harmonic_causes.push_back(
      {.name = "gear_coulomb", .impedance_Nms = 4.0 * chain.c2_Nm / (std::numbers::pi * speed)});
  point.harmonic_causes.push_back({.name = "mesh", .impedance_Nms = as_impedance(mesh, speed)});
}

/// The same by quadrature, for a train whose losses follow from its power flow.
void set_train_harmonic(const Actuator& actuator, const Chain& chain, const LinearChain& linear,
                        const Terminals& motor, double omega, double amplitude,
                        ImpedancePoint& point) {
  constexpr int kParts = 720;
  const double speed = amplitude * omega;
  const design::PreparedTrain train = prepared(*actuator.train);
  Harmonics torque;
  std::array<Harmonics, kMostGearLosses> losses{};
  for (int k = 0; k < kParts; ++k) {
    // Midpoints: of a function of the whole period the rule converges fast between its kinks.
    const double x = -kHalfTurn + 2.0 * kHalfTurn * (k + 0.5) / kParts;
    const OutputMotion o{.speed_rad_s = speed * std::cos(x),
                         .acceleration_rad_s2 = -omega * speed * std::sin(x),
                         .sense = 1.0};
    const double u =
        -chain.j1_kgm2 * o.acceleration_rad_s2 - motor.d1_Nms * o.speed_rad_s - chain.c1_Nm;
    const auto moved = moved_from_output(train, *actuator.train, o, u);
    if (!moved) return;
    const auto add = [&](double t, Harmonics& sum) {
      sum.cosine += t * std::cos(x) * 2.0 * kHalfTurn / kParts;
      sum.sine += t * std::sin(x) * 2.0 * kHalfTurn / kParts;
    };
    add(actuator.load_inertia_kgm2 * o.acceleration_rad_s2 - moved->mesh_Nm, torque);
    for (std::size_t n = 0; n < losses.size(); ++n) {
      add(moved->loss_W[n] / o.speed_rad_s, losses[n]);
    }
  }
  point.first_harmonic_Nms = as_impedance(torque, speed);
  point.harmonic_causes = rigid_causes(linear, chain.c1_Nm, omega, speed);
  for (std::size_t n = 0; n < losses.size(); ++n) {
    point.harmonic_causes.push_back(
        {.name = design_gear_causes()[n], .impedance_Nms = as_impedance(losses[n], speed)});
  }
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
  const LinearChain linear = linear_chain(actuator, chain, motor);
  std::vector<ImpedancePoint> points;
  points.reserve(static_cast<std::size_t>(task.points));
  for (int k = 0; k < task.points; ++k) {
    const double share = task.points > 1 ? static_cast<double>(k) / (task.points - 1) : 0.0;
    ImpedancePoint point{.frequency_Hz = task.low_Hz * std::pow(task.high_Hz / task.low_Hz, share)};
    const double omega = 2.0 * std::numbers::pi * point.frequency_Hz;
    set_linear(linear, omega, point);
    if (task.amplitude_rad > 0.0 && !motor.locked) {
      if (actuator.train != nullptr) {
        set_train_harmonic(actuator, chain, linear, motor, omega, task.amplitude_rad, point);
      } else {
        set_catalogue_harmonic(chain, linear, motor, omega, task.amplitude_rad, point);
      }
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace gear3k::actuator
