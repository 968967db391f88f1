#pragma once
// Actuators and cycles of the reference numbers, and cycles made of digitised curves.

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "actuator/duty_cycle.hpp"

namespace gear3k::actuator_test {

/// Reference 1: i 50, eta 0.8/0.6, R 0.5, Kt 0.05, T_c 0.004, backdriving 2 N m.
inline actuator::Actuator first_reference() {
  actuator::Actuator a;
  a.motor.resistance_ohm = 0.5;
  a.motor.torque_constant_Nm_A = 0.05;
  a.motor.coulomb_Nm = 0.004;
  a.motor.static_Nm = 0.004;
  a.gearbox.ratio = 50.0;
  a.gearbox.efficiency_forward = 0.8;
  a.gearbox.efficiency_backward = 0.6;
  a.gearbox.static_Nm = 2.0;
  a.gearbox.coulomb_Nm = 1.0;
  return a;
}

/// Reference 2.
inline actuator::Actuator second_reference() {
  actuator::Actuator a = first_reference();
  a.motor.rotor_inertia_kgm2 = 4e-5;
  a.motor.coulomb_Nm = 0.0;
  a.motor.static_Nm = 0.0;
  a.gearbox.static_Nm = 0.0;
  a.gearbox.coulomb_Nm = 0.0;
  a.load_inertia_kgm2 = 0.2;
  return a;
}

/// Reference 8: maxon 397172 of the catalogue, i 100.
inline actuator::Actuator hip_reference() {
  actuator::Actuator a;
  a.motor.resistance_ohm = 0.608;
  a.motor.torque_constant_Nm_A = 0.0369;
  a.motor.rotor_inertia_kgm2 = 1.81e-5;
  a.motor.viscous_Nms = 0.0369 * 0.234 / 639.838;
  a.motor.heat.winding_housing_K_W = 4.1;
  a.motor.heat.housing_ambient_K_W = 3.56;
  a.gearbox.ratio = 100.0;
  a.gearbox.efficiency_forward = 0.85;
  a.gearbox.efficiency_backward = 0.82;
  a.gearbox.input_inertia_kgm2 = 1e-6;
  a.gearbox.static_Nm = 3.0;
  a.gearbox.coulomb_Nm = 2.0;
  a.gearbox.viscous_Nms = 0.05;
  return a;
}

/// A constant load at a constant speed.
inline actuator::Cycle steady(double speed_rad_s, double load_Nm) {
  return {.name = "steady",
          .time_s = {0.0, 1.0},
          .load_Nm = {load_Nm, load_Nm},
          .motion = {speed_rad_s, speed_rad_s}};
}

/// w = amplitude cos(2 pi t / period).
inline actuator::Cycle cosine(double amplitude_rad_s, double period_s, int intervals) {
  actuator::Cycle cycle;
  for (int k = 0; k <= intervals; ++k) {
    cycle.time_s.push_back(period_s * k / intervals);
    cycle.load_Nm.push_back(0.0);
    cycle.motion.push_back(amplitude_rad_s *
                           std::cos(2.0 * std::numbers::pi * (k % intervals) / intervals));
  }
  return cycle;
}

/// Points of one series of a digitised file: percent of the stride within [0, 100), value.
using Curve = std::map<double, double>;

/// Straight lines between the points, from the last one on to the first.
inline double value_of(const Curve& curve, double percent) {
  const auto after = curve.upper_bound(percent);
  const auto [p0, v0] = after == curve.begin() ? *curve.rbegin() : *std::prev(after);
  const auto [p1, v1] = after == curve.end() ? *curve.begin() : *after;
  const double from = after == curve.begin() ? p0 - 100.0 : p0;
  const double to = after == curve.end() ? p1 + 100.0 : p1;
  return v0 + (v1 - v0) * (percent - from) / (to - from);
}

inline Curve digitised(const std::string& file, const std::string& series) {
  std::ifstream stream(std::string(GEAR3K_SOURCE_DIR) + "/data/" + file);
  Curve curve;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line);
    std::string name;
    std::string percent;
    std::string value;
    std::getline(fields, name, ',');
    std::getline(fields, percent, ',');
    std::getline(fields, value, ',');
    if (name != series) continue;
    const double at = std::fmod(std::stod(percent), 100.0);
    curve[at < 0.0 ? at + 100.0 : at] = std::stod(value);
  }
  return curve;
}

/// What a person's joint does in a stride of 1.1 s, rows every half percent: load torque = -mass
/// times moment, speed without its mean.
inline actuator::Cycle walking(const std::string& file, const std::string& joint, double mass_kg) {
  const Curve moment = digitised(file, joint + "_moment_nm_per_kg");
  const Curve speed = digitised(file, joint + "_angular_velocity_deg_s");
  constexpr int kRows = 200;
  double mean = 0.0;
  for (int k = 0; k < kRows; ++k) mean += value_of(speed, 0.5 * k) / kRows;
  actuator::Cycle cycle;
  cycle.name = joint;
  for (int k = 0; k <= kRows; ++k) {
    const double percent = 0.5 * (k % kRows);
    cycle.time_s.push_back(1.1 * k / kRows);
    cycle.load_Nm.push_back(-mass_kg * value_of(moment, percent));
    cycle.motion.push_back((value_of(speed, percent) - mean) * std::numbers::pi / 180.0);
  }
  return cycle;
}

inline double loss_of(const actuator::DutyCycle& d, const std::string& cause) {
  for (const auto& [name, energy] : d.losses) {
    if (name == cause) return energy;
  }
  return std::nan("");
}

}  // namespace gear3k::actuator_test
