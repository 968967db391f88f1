#include "tests/calibrate/dynamic/drive_bench.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace gear3k::test {

namespace {

using Pair = std::array<double, 2>;  // angle, speed

struct Torques {
  double motor = 0.0, load = 0.0;
};

Pair reference(const DriveBench& b, double t) {
  const double o = 2.0 * std::numbers::pi * b.frequency_hz;
  const double part = 0.35 * b.amplitude_rad;
  return {b.amplitude_rad * std::sin(o * t) + part * std::sin(2.7 * o * t + 1.0) + b.turn_rad_s * t,
          b.amplitude_rad * o * std::cos(o * t) + part * 2.7 * o * std::cos(2.7 * o * t + 1.0) +
              b.turn_rad_s};
}

Torques torques_at(const DriveBench& b, const Pair& x, double t) {
  const Pair want = reference(b, t);
  constexpr double kStiffness = 60.0, kDamping = 9.0;
  return {.motor = kStiffness * (want[0] - x[0]) + kDamping * (want[1] - x[1]),
          .load = -b.gravity_Nm * std::sin(x[0] + 0.4)};
}

double acceleration(const DriveBench& b, const Pair& x, double t) {
  constexpr double kSmooth = 0.004;
  const Torques at = torques_at(b, x, t);
  const double sense = std::tanh(x[1] / kSmooth);
  const double fast = at.motor - b.d1 * x[1] - b.c1 * sense;
  const double slow = at.load - b.d2 * x[1] - b.c2 * sense;
  const double body = b.j2 + b.load_inertia;
  // Torque through teeth without loss first: its power says which side drives.
  const double through = (body * fast - b.j1 * slow) / (b.j1 + body);
  const double ratio = through * x[1] > 0.0 ? 1.0 / b.eta_f : b.eta_b;
  return (fast + ratio * slow) / (b.j1 + ratio * body);
}

Pair moved(const DriveBench& b, const Pair& x, double t, double h) {
  const auto slope = [&](const Pair& y, double time) {
    return Pair{y[1], acceleration(b, y, time)};
  };
  const auto ahead = [&](const Pair& k, double step) {
    return Pair{x[0] + step * k[0], x[1] + step * k[1]};
  };
  const Pair k1 = slope(x, t), k2 = slope(ahead(k1, h / 2), t + h / 2);
  const Pair k3 = slope(ahead(k2, h / 2), t + h / 2), k4 = slope(ahead(k3, h), t + h);
  return {x[0] + h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0]),
          x[1] + h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])};
}

}  // namespace

calibrate::MotionRecord log_of(const DriveBench& b, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  calibrate::MotionStretch s;
  s.load_kgm2 = b.load_inertia;
  constexpr int kSteps = 25;
  const double h = 1.0 / (b.rate_hz * kSteps);
  Pair x = reference(b, 0.0);
  double t = 0.0, memory = 0.0;
  const auto samples = static_cast<int>(b.seconds * b.rate_hz);
  const double fresh = std::sqrt(1.0 - b.torque_memory * b.torque_memory);
  for (int k = 0; k < samples; ++k) {
    const Torques at = torques_at(b, x, t);
    memory = b.torque_memory * memory + fresh * normal(random);
    s.time_s.push_back(t);
    s.motor_Nm.push_back(at.motor / b.gain + b.torque_bias + b.torque_noise * memory);
    if (b.logs_angle) {
      const double step = 2.0 * std::numbers::pi / b.encoder_lines;
      s.angle_rad.push_back(step * std::floor(x[0] / step));
    } else {
      s.speed_rad_s.push_back(x[1] + b.speed_noise * normal(random));
    }
    if (b.logs_load) s.load_Nm.push_back(at.load + b.load_noise * normal(random));
    for (int j = 0; j < kSteps; ++j, t += h) x = moved(b, x, t, h);
  }
  return {.files = {"bench"}, .stretches = {s}, .notes = {}};
}

calibrate::DriveParameters stated_of(const DriveBench& b) {
  return {.motor_inertia_kgm2 = b.j1,
          .motor_viscous_Nms = b.d1,
          .motor_coulomb_Nm = b.c1,
          .output_inertia_kgm2 = b.j2,
          .output_viscous_Nms = b.d2,
          .output_coulomb_Nm = b.c2,
          .efficiency_forward = b.eta_f,
          .efficiency_backward = b.eta_b};
}

}  // namespace gear3k::test
