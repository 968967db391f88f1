#include "papers/knee_example.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "papers/backdrivability.hpp"

namespace gear3k::papers {

namespace {

using actuator::Actuator, actuator::Cycle;

constexpr int kStrideRows = 200;
/// The curves come without a stride time; at this one the angles span those of walking (data/).
constexpr double kStride_s = 1.1;
constexpr double kFullStride = 100.0;

/// A curve's value by straight lines, periodic.
double stride_value(const MotionCurves::Curve& curve, double percent) {
  const auto after =
      std::ranges::lower_bound(curve, percent, {}, &std::pair<double, double>::first);
  auto [p1, v1] = after == curve.end() ? curve.front() : *after;
  auto [p0, v0] = after == curve.begin() ? curve.back() : *(after - 1);
  if (after == curve.end()) p1 += kFullStride;
  if (after == curve.begin()) p0 -= kFullStride;
  return v0 + (v1 - v0) * (percent - p0) / (p1 - p0);
}

/// One row interval on which neither torque nor speed changes its sign.
struct Part {
  double from_s, to_s, torque_from, torque_to, speed_from, speed_to;
};

std::vector<Part> parts_of(const Cycle& cycle) {
  std::vector<Part> parts;
  for (std::size_t k = 0; k + 1 < cycle.time_s.size(); ++k) {
    const double t0 = cycle.time_s[k];
    const double dt = cycle.time_s[k + 1] - t0;
    const double m0 = cycle.load_Nm[k];
    const double dm = cycle.load_Nm[k + 1] - m0;
    const double w0 = cycle.motion[k];
    const double dw = cycle.motion[k + 1] - w0;
    std::vector<double> cuts{0.0, 1.0};
    for (const auto& [start, change] : {std::pair{m0, dm}, std::pair{w0, dw}}) {
      const double root = change == 0.0 ? -1.0 : -start / change;
      if (root > 0.0 && root < 1.0) cuts.push_back(root);
    }
    std::ranges::sort(cuts);
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
      const double a = cuts[c];
      const double b = cuts[c + 1];
      parts.push_back({.from_s = t0 + a * dt,
                       .to_s = t0 + b * dt,
                       .torque_from = m0 + a * dm,
                       .torque_to = m0 + b * dm,
                       .speed_from = w0 + a * dw,
                       .speed_to = w0 + b * dw});
    }
  }
  return parts;
}

/// Energy that the load gives on a part: the integral of the product of two straight lines.
double given_energy(const Part& p) {
  return (p.to_s - p.from_s) / 6.0 *
         (p.torque_from * p.speed_from + p.torque_to * p.speed_to +
          (p.torque_from + p.torque_to) * (p.speed_from + p.speed_to));
}

KneeRun knee_run(std::string name, Actuator actuator, const Cycle& cycle) {
  actuator.name = name;
  KneeRun run{.name = std::move(name),
              .actuator = actuator,
              .duty = actuator::run_cycle(actuator, cycle, true)};
  for (const actuator::MotorInstant& p : run.duty.instants) {
    run.peak_electrical_W = std::max(run.peak_electrical_W, p.electrical_W);
    run.least_electrical_W = std::min(run.least_electrical_W, p.electrical_W);
  }
  return run;
}

/// A stride of 1.1 s in 201 rows by straight lines between the digitised points, periodic: the
/// load's torque is −mass times the moment, the speed is without its mean.
Cycle walking_cycle(const MotionCurves& curves, double mass_kg) {
  const auto percent_of = [](int row) { return kFullStride * (row % kStrideRows) / kStrideRows; };
  double mean = 0.0;
  for (int k = 0; k < kStrideRows; ++k) {
    mean += stride_value(curves.speed_deg_s, percent_of(k)) / kStrideRows;
  }
  Cycle cycle;
  cycle.name = "knee";
  for (int k = 0; k <= kStrideRows; ++k) {
    cycle.time_s.push_back(kStride_s * k / kStrideRows);
    cycle.load_Nm.push_back(-mass_kg * stride_value(curves.moment_Nm_kg, percent_of(k)));
    cycle.motion.push_back((stride_value(curves.speed_deg_s, percent_of(k)) - mean) *
                           std::numbers::pi / 180.0);
  }
  return cycle;
}

/// The stretches of a cycle of speeds, each between changes of sign of torque or speed.
std::vector<NegativeStretch> negative_stretches(const Cycle& cycle) {
  std::vector<NegativeStretch> stretches;
  bool open = false;
  const auto at_zero_torque = [](double torque, double speed) {
    return std::abs(torque) < std::abs(speed);  // one of the two is a rounding error
  };
  for (const Part& p : parts_of(cycle)) {
    const double energy = given_energy(p);
    if (energy <= 0.0) {
      open = false;
      continue;
    }
    if (!open) {
      stretches.push_back({.from_s = p.from_s,
                           .to_s = p.to_s,
                           .begins_at_zero_torque = at_zero_torque(p.torque_from, p.speed_from),
                           .ends_at_zero_torque = false,
                           .peak_torque_Nm = 0.0,
                           .energy_J = 0.0});
      open = true;
    }
    NegativeStretch& s = stretches.back();
    s.to_s = p.to_s;
    s.ends_at_zero_torque = at_zero_torque(p.torque_to, p.speed_to);
    s.peak_torque_Nm = std::max({s.peak_torque_Nm, std::abs(p.torque_from), std::abs(p.torque_to)});
    s.energy_J += energy;
  }
  return stretches;
}

}  // namespace

Actuator knee_actuator(const BackdrivabilityStatements& s, KneeNumbers numbers) {
  const bool printed = numbers == KneeNumbers::kPrinted;
  const double squared_ratio = s.ratio * s.ratio;
  Actuator a;
  a.motor.resistance_ohm = s.resistance_ohm;
  a.motor.torque_constant_Nm_A = s.torque_constant_Nm_A;
  a.motor.rotor_inertia_kgm2 = printed ? s.eq42_inertia_kgm2 / squared_ratio : s.rotor_inertia_kgm2;
  a.motor.viscous_Nms = printed ? s.eq38_viscous_Nms / squared_ratio : viscous_by_eq24(s);
  a.gearbox.ratio = s.ratio;
  a.gearbox.input_inertia_kgm2 =
      printed ? s.eq41_inertia_kgm2 / squared_ratio : s.gear_inertia_kgm2;
  a.gearbox.coulomb_Nm = s.eq39_coulomb_Nm;
  a.gearbox.static_Nm = s.max_backdriving_Nm;
  a.gearbox.viscous_Nms = s.gear_viscous_Nms;
  a.gearbox.efficiency_forward = s.efficiency;
  a.gearbox.efficiency_backward = printed ? s.eq45_torque_factor : s.efficiency;
  if (numbers == KneeNumbers::kCorrected) {
    a.gearbox.efficiency_forward = mesh_efficiency(s);
    a.gearbox.efficiency_backward = backward_mesh_efficiency(s);
  }
  return a;
}

KneeExample knee_example(const BackdrivabilityStatements& s, const MotionCurves& curves) {
  KneeExample example;
  example.cycle = walking_cycle(curves, s.body_mass_kg);
  const Cycle& cycle = example.cycle;
  for (std::size_t k = 0; k < cycle.time_s.size(); ++k) {
    const double power = -cycle.load_Nm[k] * cycle.motion[k];
    example.peak_torque_Nm = std::max(example.peak_torque_Nm, std::abs(cycle.load_Nm[k]));
    example.peak_speed_rad_s = std::max(example.peak_speed_rad_s, std::abs(cycle.motion[k]));
    example.peak_power_W = std::max(example.peak_power_W, power);
    example.least_power_W = std::min(example.least_power_W, power);
  }
  example.negative = negative_stretches(cycle);
  const auto add = [&](const char* name, KneeNumbers numbers) {
    example.runs.push_back(knee_run(name, knee_actuator(s, numbers), cycle));
  };
  add("as printed", KneeNumbers::kPrinted);
  add("its own equations", KneeNumbers::kEquations);
  add("corrected", KneeNumbers::kCorrected);
  Cycle raised = cycle;
  for (double& torque : raised.load_Nm) torque *= s.knee_torque_Nm / example.peak_torque_Nm;
  example.raised =
      knee_run("corrected, torque raised", knee_actuator(s, KneeNumbers::kCorrected), raised);
  const KneeRun& corrected = example.runs.back();
  example.without_each = actuator::without_each(corrected.actuator, cycle, corrected.duty);
  return example;
}

}  // namespace gear3k::papers
