#include "actuator/reflected.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "actuator/chain.hpp"
#include "actuator/design_gear.hpp"

namespace gear3k::actuator {

namespace {

constexpr double kNothing = 1e-9;
constexpr int kTries = 200;

/// Torque of the load at which a band's end passes zero: what starts the output from outside.
std::optional<double> starting_load(const GearModel& gear, double motor_static_Nm) {
  // The output starts backward, s = 1 with T_L driving, where the fast side has to hold it back:
  // high end of the band below zero.
  const auto starts = [&](double load_Nm) {
    return gear.band(load_Nm).high_Nm + motor_static_Nm < 0.0;
  };
  double low = 0.0;
  double high = kNothing;
  constexpr double kMost = 1e9;
  while (!starts(high)) {
    low = high;
    high *= 2.0;
    if (high > kMost) return std::nullopt;
  }
  for (int k = 0; k < kTries; ++k) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) break;
    (starts(middle) ? high : low) = middle;
  }
  return high <= kNothing ? 0.0 : high;
}

/// Torque on the output body that turns a train from outside against a torque of the fast side.
std::optional<double> driving_torque(const DesignTrain& train, const OutputMotion& motion,
                                     double input_Nm) {
  const auto torque = output_torque(train, motion, input_Nm);
  if (!torque) return std::nullopt;
  return -*torque;
}

void set_design_parts(const Actuator& actuator, const Chain& chain, Reflected& r) {
  const DesignTrain& train = *actuator.train;
  const auto gear = design_gear(actuator);
  r.gearbox_kgm2 = train.inertia_kgm2();
  r.gearbox_inertia_known = train.inertia_missing().empty();
  const auto lossy = std::make_shared<DesignTrain>(train);
  lossy->shafts.drag = {};
  const OutputMotion up{.acceleration_rad_s2 = 1.0};
  if (const auto torque = driving_torque(*lossy, up, -chain.j1_kgm2)) {
    r.speeding_up_kgm2 = *torque + actuator.load_inertia_kgm2;
  }
  const OutputMotion down{.acceleration_rad_s2 = -1.0};
  if (const auto torque = driving_torque(*lossy, down, chain.j1_kgm2)) {
    r.slowing_down_kgm2 = actuator.load_inertia_kgm2 - *torque;
  }
  r.breakaway_Nm = starting_load(*gear, chain.c1_static_Nm);
  try {
    r.breakaway_motor_Nm = (chain.c1_static_Nm + gear->band(0.0).high_Nm) / std::abs(chain.ratio);
  } catch (const std::runtime_error&) {
    r.notes.emplace_back("the motor cannot start the train: it locks");
  }
  std::ranges::move(notes_of(train), std::back_inserter(r.notes));
}

void set_catalogue_parts(const Actuator& actuator, const Chain& chain, Reflected& r) {
  const Gearbox& gearbox = actuator.gearbox;
  const double forward = chain.efficiency_forward;
  const double backward = chain.efficiency_backward;
  r.gearbox_kgm2 =
      chain.ratio * chain.ratio * gearbox.input_inertia_kgm2 + gearbox.output_inertia_kgm2;
  r.gearbox_Nms = chain.d2_Nms;
  r.slowing_down_kgm2 = chain.j2_kgm2 + forward * chain.j1_kgm2;
  r.breakaway_motor_Nm =
      (chain.c1_static_Nm + chain.c2_static_Nm / forward) / std::abs(chain.ratio);
  if (!(backward > 0.0)) {
    r.notes.emplace_back(
        "self-locking: efficiency_backward is not positive, no torque at the output turns the "
        "motor");
    return;
  }
  r.speeding_up_kgm2 = chain.j2_kgm2 + chain.j1_kgm2 / backward;
  r.backdriven_Nms = chain.d2_Nms + chain.d1_Nms / backward;
  r.backdriven_coulomb_Nm = chain.c2_Nm + chain.c1_Nm / backward;
  r.breakaway_Nm = chain.c2_static_Nm + chain.c1_static_Nm / backward;
}

}  // namespace

Reflected reflected(const Actuator& actuator) {
  const Chain chain = chain_of(actuator);
  const double square = chain.ratio * chain.ratio;
  Reflected r;
  r.motor_kgm2 = square * actuator.motor.rotor_inertia_kgm2;
  r.load_kgm2 = actuator.load_inertia_kgm2;
  r.motor_Nms = chain.d1_Nms;
  if (actuator.train != nullptr) {
    set_design_parts(actuator, chain, r);
  } else {
    set_catalogue_parts(actuator, chain, r);
  }
  r.total_kgm2 = r.motor_kgm2 + r.gearbox_kgm2 + r.load_kgm2;
  r.total_Nms = r.motor_Nms + r.gearbox_Nms;
  r.coulomb_Nm = chain.c1_Nm + chain.c2_Nm;
  if (actuator.motor.shaft_stiffness_Nm_rad) {
    r.motor_Nm_rad = square * *actuator.motor.shaft_stiffness_Nm_rad;
  }
  r.gearbox_Nm_rad = actuator.gearbox.stiffness_Nm_rad;
  if (r.motor_Nm_rad && r.gearbox_Nm_rad) {
    r.total_Nm_rad = 1.0 / (1.0 / *r.motor_Nm_rad + 1.0 / *r.gearbox_Nm_rad);
  } else {
    r.total_Nm_rad = r.motor_Nm_rad ? r.motor_Nm_rad : r.gearbox_Nm_rad;
  }
  return r;
}

}  // namespace gear3k::actuator
