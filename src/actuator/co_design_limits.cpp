// What a set of gears and a motor exceed of the limits of a selection: at a point, and at least in
// a box.
#include <algorithm>
#include <cmath>

#include "actuator/co_design.hpp"
#include "actuator/screening.hpp"

namespace gear3k::actuator {

namespace {

/// Least |q + h m| over the box of a flow; with one h alone its value.
double least_magnitude(double q, double m, bool forward, double end, bool exact) {
  const double at_end = q + end * m;
  if (exact) return std::abs(at_end);
  // Forward h grows without end, which moves the value along m; backward it falls to 0.
  const double other = forward ? m : q;
  if (at_end * other < 0.0) return 0.0;
  return forward ? std::abs(at_end) : std::min(std::abs(at_end), std::abs(q));
}

}  // namespace

void CoDesign::bound_peaks(const Fast& fast, const Box& box, double& amperes, double& volts) const {
  for (const Part& part : parts_) {
    const bool forward = part.flow == kForwardFlow;
    const double end = forward ? box.forward : box.backward;
    for (const double x : {0.0, 1.0}) {
      const auto [m, a, w, s] = point(part, x);
      const double q = fast.j1_kgm2 * a + fast.d1_Nms * w + fast.c1_Nm * s;
      const double other = box.spread_kgm2 * std::abs(a);
      amperes = std::max(amperes, least_magnitude(q * fast.per_torque, m * fast.per_torque, forward,
                                                  end, box.exact) -
                                      other * std::abs(fast.per_torque));
      const double ohms = fast.resistance_ohm * fast.per_torque;
      volts = std::max(
          volts, least_magnitude(q * ohms + fast.back_emf * w, m * ohms, forward, end, box.exact) -
                     other * std::abs(ohms));
    }
  }
}

void CoDesign::note_peaks(const Fast& fast, const Box& box, double& amperes, double& volts) const {
  bound_peaks(fast, box, amperes, volts);
  const double ohms = fast.resistance_ohm * fast.per_torque;
  for (const Part& part : parts_) {
    if (part.speed_rad_s[2] == 0.0) continue;
    // Extremes between the ends, where the speed is no straight line.
    const double h = part.flow == kForwardFlow ? box.forward : box.backward;
    Quadratic current{};
    Quadratic voltage{};
    for (std::size_t k = 0; k < current.size(); ++k) {
      const double torque = h * part.mesh_Nm[k] + fast.j1_kgm2 * part.acceleration_rad_s2[k] +
                            fast.d1_Nms * part.speed_rad_s[k] +
                            (k == 0 ? fast.c1_Nm * part.sense : 0.0);
      current[k] = torque * fast.per_torque;
      voltage[k] = torque * ohms + fast.back_emf * part.speed_rad_s[k];
    }
    const auto note = [](const Quadratic& p, double& most) {
      const double top = -0.5 * p[1] / p[2];
      if (p[2] != 0.0 && top > 0.0 && top < 1.0) most = std::max(most, std::abs(value_at(p, top)));
    };
    note(current, amperes);
    note(voltage, volts);
  }
  for (const Rest& rest : rests_) {
    for (const double x : {0.0, 1.0}) {
      const double tau = box.backward * std::abs(value_at(rest.load_Nm, x)) - fast.c1_static_Nm;
      if (!(tau > 0.0)) continue;
      amperes = std::max(amperes, std::abs(tau * fast.per_torque));
      volts = std::max(volts, std::abs(tau * ohms));
    }
  }
}

Felt CoDesign::felt_of(const Fast& fast, const Box& box) const {
  if (!(box.backward > 0.0)) return {kWithoutBound, kWithoutBound, kWithoutBound};
  // Of a box without that of the gears, which only adds to it.
  const double inertia = box.exact ? fast.j1_kgm2 : fast.rotor_kgm2;
  Felt felt{.inertia_kgm2 = task_.load_inertia_kgm2 + inertia / box.backward,
            .breakaway_Nm = fast.c1_static_Nm / box.backward};
  if (const auto& motor_Nm = task_.felt.transparency_torque_Nm) {
    const double with = (*motor_Nm - fast.c1_Nm) / box.forward;
    const double against = (*motor_Nm + fast.c1_Nm) / box.backward;
    felt.transparency = with > 0.0 ? 2.0 * (against - with) / (against + with) : kWithoutBound;
  }
  return felt;
}

double CoDesign::excess(std::size_t motor, double ratio, const Fast& fast, const Box& box) const {
  double square = 0.0;
  double friction = 0.0;
  for (const Flow flow : {kForwardFlow, kBackwardFlow}) {
    const InH s = square_in_h(moments_[flow], fast);
    double h = flow == kForwardFlow ? box.forward : box.backward;
    if (!box.exact && s.c > 0.0) {
      const double lowest = -0.5 * s.b / s.c;
      h = flow == kForwardFlow ? std::max(h, lowest) : std::max(0.0, std::min(h, lowest));
    }
    square += std::max(0.0, s.a + h * (s.b + h * s.c));
    const auto& m = moments_[flow].square;
    friction += fast.d1_Nms * m[2][2] + fast.c1_Nm * m[3][2];
  }
  Sum held;
  if (box.exact) {
    for (const Rest& rest : rests_) add_resting(rest, fast, box.backward, held);
    square += held.energy * task_.drive.efficiency_motoring / fast.copper;
  }
  const double room = box.exact ? 1.0 : 1.0 - kBoundRoom;
  PairResult values{.pair = {.motor = motor, .gearbox = 0}};
  if (box.spread_kgm2 > 0.0) {
    const double left =
        std::max(0.0, std::sqrt(square) - box.spread_kgm2 * std::sqrt(square_acceleration()));
    square = left * left;
  }
  values.rms_current_A = std::sqrt(square / time_s_) * std::abs(fast.per_torque) * room;
  values.peak_motor_speed_rad_s = std::abs(ratio) * peak_speed_rad_s_ * room;
  if (box.exact) {
    note_peaks(fast, box, values.peak_current_A, values.peak_voltage_V);
  } else {
    bound_peaks(fast, box, values.peak_current_A, values.peak_voltage_V);
    values.peak_current_A *= room;
    values.peak_voltage_V *= room;
  }
  Felt felt = felt_of(fast, box);
  if (!box.exact) {
    felt = {.inertia_kgm2 = felt.inertia_kgm2 * room,
            .breakaway_Nm = felt.breakaway_Nm * room,
            .transparency = felt.transparency};
    // A difference: its rounding is of the size of what it is one of.
    if (felt.transparency) *felt.transparency -= kBoundRoom;
  }
  values.felt = felt;
  judge(task_, values, friction / time_s_ * room, values);
  return values.excess;
}

}  // namespace gear3k::actuator
