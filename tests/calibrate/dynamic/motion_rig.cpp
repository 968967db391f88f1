#include "tests/calibrate/dynamic/motion_rig.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace gear3k::test {

namespace {

constexpr int kSamples = 2400;
constexpr double kPeriod_s = 0.005;

struct Kinematics {
  double angle = 0.0, speed = 0.0, acceleration = 0.0;
};

/// Four sines, of which the last grows and fades.
Kinematics motion_at(const MotionRig& r, double t) {
  Kinematics k;
  for (std::size_t j = 0; j < r.size.size(); ++j) {
    const double o = 2.0 * std::numbers::pi * r.frequency.at(j);
    const double beat = j == 3 ? 2.0 * std::numbers::pi / 12.0 : 0.0;
    const double a = r.size.at(j), x = o * t + r.phase.at(j), y = beat * t;
    const double e = j == 3 ? 1.0 - std::cos(y) : 1.0, e1 = beat * std::sin(y),
                 e2 = beat * beat * std::cos(y);
    k.angle += a * e * std::sin(x);
    k.speed += a * (e1 * std::sin(x) + e * o * std::cos(x));
    k.acceleration += a * (e2 * std::sin(x) + 2.0 * e1 * o * std::cos(x) - e * o * o * std::sin(x));
  }
  return k;
}

double load_at(const MotionRig& r, const Kinematics& k) {
  if (!r.has_load) return 0.0;
  return r.constant_Nm - r.weight_Nm * std::sin(k.angle + r.weight_at) -
         r.spring_Nm * std::atan(k.angle);
}

/// Constant drag with a rise towards creep, and a sense that changes within a hundredth of a radian
/// a second.
double dry(const MotionRig& r, double level, double speed) {
  const double slow = speed / 0.05;
  return level * (1.0 + r.stribeck * std::exp(-slow * slow)) * speed / std::hypot(speed, 0.01);
}

/// The motor's torque that moves it so.
double needed(const MotionRig& r, const RigDrive& d, const Kinematics& k) {
  const double through = (d.j2 + r.load_inertia) * k.acceleration + d.d2 * k.speed +
                         dry(r, d.c2, k.speed) - load_at(r, k);
  // Losses as a share of the power, rounded where it changes its sign.
  const double power = through * k.speed / std::hypot(k.speed, 0.01);
  const double rounded = std::hypot(power, 0.02);
  const double loss =
      d.loss_forward * 0.5 * (rounded + power) + d.loss_backward * 0.5 * (rounded - power);
  return d.j1 * k.acceleration + d.d1 * k.speed + dry(r, d.c1, k.speed) + through +
         loss * k.speed / std::hypot(k.speed, 0.01);
}

/// Angle of the motor's side less that of the output: play that closes within a hundredth of a
/// newton metre, and a gear out of true.
double windup(const MotionRig& r, const RigDrive& d, double t) {
  const Kinematics k = motion_at(r, t);
  const double through = (d.j2 + r.load_inertia) * k.acceleration + d.d2 * k.speed +
                         dry(r, d.c2, k.speed) - load_at(r, k);
  const double flank = through / std::hypot(through, 0.01);
  return 0.5 * d.play_rad * flank + d.compliance * through +
         r.eccentricity_rad * std::sin(40.0 * k.angle + 0.4);
}

}  // namespace

MotionRig motion_rig(std::uint64_t seed, bool has_load) {
  std::mt19937_64 random(seed * 7919 + 17);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  MotionRig r;
  r.seed = seed;
  r.has_load = has_load;
  r.drive = {.j1 = between(0.02, 0.12),
             .j2 = between(0.01, 0.05),
             .d1 = between(0.1, 0.5),
             .d2 = between(0.05, 0.3),
             .c1 = between(0.2, 0.8),
             .c2 = between(0.2, 0.8),
             .loss_forward = between(0.08, 0.35),
             .loss_backward = between(0.1, 0.4)};
  r.load_inertia = between(0.02, 0.08);
  for (std::size_t j = 0; j < 4; ++j) {
    r.frequency.at(j) = between(0.2, 0.5) * static_cast<double>(j + 1);
    r.size.at(j) = between(0.25, 0.7) / static_cast<double>(j + 1);
    r.phase.at(j) = between(0.0, 6.0);
  }
  r.weight_Nm = between(4.0, 10.0);
  r.weight_at = between(-1.5, 1.5);
  r.spring_Nm = between(0.0, 5.0);
  r.stribeck = between(0.0, 0.2);
  double square = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double torque = needed(r, r.drive, motion_at(r, k * kPeriod_s));
    square += torque * torque / kSamples;
  }
  r.torque_noise = between(0.01, 0.03) * std::sqrt(square);
  r.speed_noise = between(0.005, 0.02);
  r.load_noise = between(0.02, 0.08);
  return r;
}

calibrate::MotionRecord rig_log(const MotionRig& r, const RigDrive& drive) {
  std::mt19937_64 random(r.seed * 104729 + 5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  calibrate::MotionStretch s;
  s.load_kgm2 = r.load_inertia;
  // Of the torque's noise a part is a ripple that turns with the motor, a part has thick tails.
  double last_difference = 0.0, last_turn = 0.0, last_angle = 0.0, last_s = 0.0;
  const double phase = even(random) * std::numbers::pi, bias = 0.5 * r.torque_noise * even(random);
  for (int k = 0; k < kSamples; ++k) {
    const double jitter = 0.1 * even(random);
    const double t = (k + (r.logs_motor_speed ? 0.0 : jitter)) * kPeriod_s;
    const Kinematics at = motion_at(r, t);
    const double white = normal(random), thick = white * std::exp(0.4 * normal(random) - 0.32);
    const double ripple = 0.6 * std::sqrt(2.0) * std::sin(60.0 * at.angle + phase);
    s.time_s.push_back(t);
    s.motor_Nm.push_back(needed(r, drive, at) / drive.gain + bias +
                         r.torque_noise * (ripple + 0.8 * thick));
    const double step = 0.5 * r.speed_noise;
    s.speed_rad_s.push_back(step * std::round((at.speed + r.speed_noise * normal(random)) / step));
    if (r.has_load) s.load_Nm.push_back(load_at(r, at) + r.load_noise * normal(random));
    s.motor_Nm.back() += r.motor_ripple_Nm * std::sin(80.0 * at.angle + 1.1);
    if (r.logs_motor_angle) {
      // Both angles by encoders of their own, the output's in 2 pi/65536.
      const double line = 2.0 * std::numbers::pi / 65536.0;
      const double late = t - r.delay_s;
      const double motor = motion_at(r, late).angle + windup(r, drive, late);
      s.angle_rad.push_back(line * std::floor(at.angle / line) + r.angle_noise * normal(random));
      s.windup_rad.push_back(0.3 + motor + r.angle_noise * normal(random) - s.angle_rad.back());
    } else if (r.logs_motor_speed) {
      // Both speeds are differences of counts, of the step before the row.
      const double turn = at.angle + windup(r, drive, t), dt = k == 0 ? kPeriod_s : t - last_s;
      const double output = k == 0 ? at.speed : (at.angle - last_angle) / dt;
      const double motor = k == 0 ? at.speed : (turn - last_turn) / dt;
      s.speed_rad_s.back() = output + r.speed_noise * normal(random);
      const double more = motor + r.speed_noise * normal(random) - s.speed_rad_s.back();
      s.windup_drifts = true;
      s.windup_rad.push_back(k == 0 ? 0.0
                                    : s.windup_rad.back() + 0.5 * (more + last_difference) * dt);
      last_difference = more;
      last_turn = turn;
      last_angle = at.angle;
      last_s = t;
    }
  }
  if (r.logs_motor_angle) s.speed_rad_s.clear();
  return {.files = {"rig"}, .stretches = {s}, .notes = {}};
}

double rig_windup_effect(const MotionRig& r, const RigDrive& before, const RigDrive& after) {
  double square = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double t = k * kPeriod_s, change = windup(r, after, t) - windup(r, before, t);
    square += change * change / kSamples;
  }
  return std::sqrt(square);
}

double rig_effect(const MotionRig& r, const RigDrive& before, const RigDrive& after) {
  double square = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const Kinematics at = motion_at(r, k * kPeriod_s);
    const double change = needed(r, after, at) / after.gain - needed(r, before, at) / before.gain;
    square += change * change / kSamples;
  }
  return std::sqrt(square);
}

calibrate::DriveParameters rig_stated(const MotionRig& r) {
  return {.motor_inertia_kgm2 = r.drive.j1,
          .motor_viscous_Nms = r.drive.d1,
          .motor_coulomb_Nm = r.drive.c1,
          .output_inertia_kgm2 = r.drive.j2,
          .output_viscous_Nms = r.drive.d2,
          .output_coulomb_Nm = r.drive.c2,
          .efficiency_forward = 1.0 / (1.0 + r.drive.loss_forward),
          .efficiency_backward = 1.0 - r.drive.loss_backward};
}

}  // namespace gear3k::test
