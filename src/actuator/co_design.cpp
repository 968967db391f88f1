#include "actuator/co_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "actuator/gear_model.hpp"

namespace gear3k::actuator {

namespace {

constexpr double kWithoutBound = std::numeric_limits<double>::infinity();
/// Bounds are lowered by this share, for their rounding.
constexpr double kBoundRoom = 1e-9;

/// Polynomial of a stretch of a piece over x in [0, 1].
Quadratic stretch_of(const Quadratic& p, std::array<double, 2> range) {
  return through(value_at(p, range[0]), value_at(p, 0.5 * (range[0] + range[1])),
                 value_at(p, range[1]));
}

/// The bracket of a minimum of a convex function, halved until it is this narrow.
constexpr int kBracketHalvings = 40;
constexpr int kBracketDoublings = 200;

}  // namespace

CoDesign::CoDesign(SelectionTask task, std::vector<std::string> sources)
    : task_(std::move(task)), sources_(std::move(sources)) {
  if (task_.motors.empty() || task_.cycles.empty() || task_.weights.size() != task_.cycles.size()) {
    throw std::invalid_argument(fmt::format(
        "co-design: {} motors, {} cycles, {} weights; allowed: a motor or more, a cycle "
        "or more and a weight for each",
        task_.motors.size(), task_.cycles.size(), task_.weights.size()));
  }
  task_.gearboxes.assign(1, {});
  const Drive& drive = task_.drive;
  lossless_drive_ = drive.efficiency_motoring == 1.0 && drive.efficiency_regenerating == 1.0;
  double square = 0.0;
  for (std::size_t k = 0; k < task_.cycles.size(); ++k) {
    add(task_.cycles[k], task_.weights[k]);
    time_s_ += task_.weights[k] * (task_.cycles[k].time_s.back() - task_.cycles[k].time_s.front());
  }
  for (const Part& part : parts_) {
    add_moments(part, moments_[part.flow]);
    for (std::size_t g = 0; g < kGaussNodes.size(); ++g) {
      scale_J_ += std::abs(value_at(part.mesh_Nm, kGaussNodes[g]) *
                           value_at(part.speed_rad_s, kGaussNodes[g])) *
                  part.seconds * kGaussWeights[g];
    }
    for (const double x : {0.0, 1.0}) {
      peak_speed_rad_s_ = std::max(peak_speed_rad_s_, std::abs(value_at(part.speed_rad_s, x)));
      peak_mesh_Nm_ = std::max(peak_mesh_Nm_, std::abs(value_at(part.mesh_Nm, x)));
    }
    const auto& w = part.speed_rad_s;
    const double top = -0.5 * w[1] / w[2];
    if (w[2] != 0.0 && top > 0.0 && top < 1.0) {
      peak_speed_rad_s_ = std::max(peak_speed_rad_s_, std::abs(value_at(w, top)));
    }
  }
  for (const FlowMoments& flow : moments_) square += flow.square[0][0];
  for (const Rest& rest : rests_) {
    const double first = rest.load_Nm[0];
    const double last = value_at(rest.load_Nm, 1.0);
    square += rest.seconds * (first * first + first * last + last * last) / 3.0;
    peak_mesh_Nm_ = std::max({peak_mesh_Nm_, std::abs(first), std::abs(last)});
  }
  rms_mesh_Nm_ = std::sqrt(square / time_s_);
  if (!lossless_drive_) set_classes();
  // What is held costs, too: by any motor, so that a pure hold has a scale.
  if (!(scale_J_ > 0.0)) scale_J_ = std::max(rms_mesh_Nm_, 1.0) * time_s_;
}

void CoDesign::add_moments(const Part& part, FlowMoments& moments) {
  for (std::size_t g = 0; g < kGaussNodes.size(); ++g) {
    const double seconds = part.seconds * kGaussWeights[g];
    const Basis b = point(part, kGaussNodes[g]);
    for (std::size_t r = 0; r < b.size(); ++r) {
      for (std::size_t c = 0; c < b.size(); ++c) moments.square[r][c] += b[r] * b[c] * seconds;
    }
  }
}

void CoDesign::set_classes() {
  constexpr std::size_t kClasses = 6;  // of each flow
  for (const Flow flow : {kForwardFlow, kBackwardFlow}) {
    std::vector<const Part*> parts;
    for (const Part& part : parts_) {
      if (part.flow == flow) parts.push_back(&part);
    }
    // Whether the motor gives power depends on speed over torque.
    std::ranges::stable_sort(parts, {}, [](const Part* part) {
      return std::atan2(std::abs(value_at(part->speed_rad_s, 0.5)),
                        std::abs(value_at(part->mesh_Nm, 0.5)));
    });
    for (std::size_t n = 0; n < kClasses; ++n) {
      Class own{.flow = flow, .moments = {}};
      for (std::size_t k = n * parts.size() / kClasses; k < (n + 1) * parts.size() / kClasses;
           ++k) {
        add_moments(*parts[k], own.moments);
      }
      classes_.push_back(own);
    }
  }
}

void CoDesign::add(const Cycle& cycle, double weight) {
  std::vector<double> turns;
  for (const CyclePiece& piece : pieces_of(cycle)) {
    if (piece.rests()) {
      rests_.push_back({.seconds = weight * piece.duration_s, .load_Nm = piece.load_Nm});
      continue;
    }
    turns.assign(1, 0.0);
    append_sign_changes(piece.speed_rad_s, turns);
    turns.push_back(1.0);
    for (std::size_t k = 1; k < turns.size(); ++k) {
      const double speed = value_at(piece.speed_rad_s, 0.5 * (turns[k - 1] + turns[k]));
      add_part(piece, {turns[k - 1], turns[k]}, speed > 0.0 ? 1.0 : -1.0, weight);
    }
  }
}

void CoDesign::add_part(const CyclePiece& piece, std::array<double, 2> range, double sense,
                        double weight) {
  const Quadratic& w = piece.speed_rad_s;
  const Quadratic acceleration{w[1] / piece.duration_s, 2.0 * w[2] / piece.duration_s, 0.0};
  Quadratic mesh{};
  for (std::size_t k = 0; k < mesh.size(); ++k) {
    mesh[k] = task_.load_inertia_kgm2 * acceleration[k] - piece.load_Nm[k];
  }
  std::vector<double> edges{range[0]};
  std::vector<double> flows;
  append_sign_changes(mesh, flows);
  for (const double x : flows) {
    if (x > range[0] && x < range[1]) edges.push_back(x);
  }
  edges.push_back(range[1]);
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const std::array<double, 2> within{edges[k - 1], edges[k]};
    const double width = within[1] - within[0];
    if (!(width > 0.0)) continue;
    const bool forward = sense * value_at(mesh, 0.5 * (within[0] + within[1])) > 0.0;
    parts_.push_back({.seconds = weight * width * piece.duration_s,
                      .mesh_Nm = stretch_of(mesh, within),
                      .speed_rad_s = stretch_of(w, within),
                      .acceleration_rad_s2 = stretch_of(acceleration, within),
                      .sense = sense,
                      .flow = forward ? kForwardFlow : kBackwardFlow});
  }
}

CoDesign::Fast CoDesign::fast_of(std::size_t motor, double ratio) const {
  const Motor& m = task_.motors[motor].motor;
  const double per_torque = 1.0 / (ratio * m.torque_constant_Nm_A);
  return {.j1_kgm2 = ratio * ratio * m.rotor_inertia_kgm2,
          .d1_Nms = ratio * ratio * m.viscous_Nms,
          .c1_Nm = std::abs(ratio) * m.coulomb_Nm,
          .c1_static_Nm = std::abs(ratio) * m.static_Nm,
          .per_torque = per_torque,
          .back_emf = m.torque_constant_Nm_A * ratio,
          .copper = m.resistance_ohm * per_torque * per_torque,
          .resistance_ohm = m.resistance_ohm};
}

CoDesign::Basis CoDesign::point(const Part& part, double x) {
  return {value_at(part.mesh_Nm, x), value_at(part.acceleration_rad_s2, x),
          value_at(part.speed_rad_s, x), part.sense};
}

CoDesign::InH CoDesign::square_in_h(const FlowMoments& moments, const Fast& fast) {
  const auto& m = moments.square;
  const std::array<double, 3> q{fast.j1_kgm2, fast.d1_Nms, fast.c1_Nm};
  InH sum{.c = m[0][0]};
  for (std::size_t r = 0; r < q.size(); ++r) {
    sum.b += 2.0 * q[r] * m[0][r + 1];
    for (std::size_t c = 0; c < q.size(); ++c) sum.a += q[r] * q[c] * m[r + 1][c + 1];
  }
  return sum;
}

CoDesign::InH CoDesign::energy_in_h(const FlowMoments& moments, const Fast& fast) {
  const auto& m = moments.square;
  InH e = square_in_h(moments, fast);
  e.a = fast.copper * e.a + fast.j1_kgm2 * m[1][2] + fast.d1_Nms * m[2][2] + fast.c1_Nm * m[3][2];
  e.b = fast.copper * e.b + m[0][2];
  e.c *= fast.copper;
  return e;
}

void CoDesign::add_moving(const Part& part, const Fast& fast, double h, Sum& sum) const {
  Quadratic torque{};
  Quadratic volts{};  // times i K_t
  for (std::size_t k = 0; k < torque.size(); ++k) {
    torque[k] = h * part.mesh_Nm[k] + fast.j1_kgm2 * part.acceleration_rad_s2[k] +
                fast.d1_Nms * part.speed_rad_s[k];
  }
  torque[0] += fast.c1_Nm * part.sense;
  for (std::size_t k = 0; k < torque.size(); ++k) {
    volts[k] = fast.copper * torque[k] + part.speed_rad_s[k];
  }
  thread_local std::vector<double> edges;
  edges.assign(1, 0.0);
  append_sign_changes(torque, edges);
  append_sign_changes(volts, edges);
  edges.push_back(1.0);
  std::ranges::sort(edges);
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const double width = edges[k] - edges[k - 1];
    for (std::size_t g = 0; g < kGaussNodes.size(); ++g) {
      const double x = edges[k - 1] + width * kGaussNodes[g];
      const double seconds = part.seconds * width * kGaussWeights[g];
      const double tau = value_at(torque, x);
      const double m = value_at(part.mesh_Nm, x);
      const double w = value_at(part.speed_rad_s, x);
      const double power = tau * (fast.copper * tau + w);
      const double share = (power > 0.0 ? 1.0 / task_.drive.efficiency_motoring
                                        : task_.drive.efficiency_regenerating) *
                           seconds;
      sum.energy += share * power;
      sum.slope += share * (2.0 * fast.copper * tau + w) * m;
      sum.curvature += share * 2.0 * fast.copper * m * m;
    }
  }
}

void CoDesign::add_resting(const Rest& rest, const Fast& fast, double h, Sum& sum) const {
  if (!(h > 0.0)) return;
  thread_local std::vector<double> edges;
  edges.assign(1, 0.0);
  for (const double held : {-fast.c1_static_Nm / h, 0.0, fast.c1_static_Nm / h}) {
    append_sign_changes(Quadratic{rest.load_Nm[0] - held, rest.load_Nm[1], 0.0}, edges);
  }
  edges.push_back(1.0);
  std::ranges::sort(edges);
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const double width = edges[k] - edges[k - 1];
    for (std::size_t g = 0; g < kGaussNodes.size(); ++g) {
      const double load = std::abs(value_at(rest.load_Nm, edges[k - 1] + width * kGaussNodes[g]));
      const double tau = h * load - fast.c1_static_Nm;
      if (!(tau > 0.0)) continue;
      const double share =
          fast.copper * rest.seconds * width * kGaussWeights[g] / task_.drive.efficiency_motoring;
      sum.energy += share * tau * tau;
      sum.slope += share * 2.0 * tau * load;
      sum.curvature += share * 2.0 * load * load;
    }
  }
}

CoDesign::Sum CoDesign::energy_over(Flow flow, const Fast& fast, double h) const {
  Sum sum;
  if (lossless_drive_) {
    const InH e = energy_in_h(moments_[flow], fast);
    sum = {
        .energy = e.a + h * (e.b + h * e.c), .slope = e.b + 2.0 * h * e.c, .curvature = 2.0 * e.c};
  } else {
    for (const Part& part : parts_) {
      if (part.flow == flow) add_moving(part, fast, h, sum);
    }
  }
  if (flow == kBackwardFlow) {
    for (const Rest& rest : rests_) add_resting(rest, fast, h, sum);
  }
  return sum;
}

double CoDesign::least_over(Flow flow, const Fast& fast, double end) const {
  const double inwards = flow == kForwardFlow ? 1.0 : -1.0;
  const Sum at_end = energy_over(flow, fast, end);
  if (at_end.slope * inwards >= 0.0) return at_end.energy;
  // It falls into the box: between `falling` and `rising` lies its least.
  double falling = end;
  double rising = 0.0;
  if (flow == kForwardFlow) {
    rising = 2.0 * end;
    for (int k = 0; k < kBracketDoublings && energy_over(flow, fast, rising).slope < 0.0; ++k) {
      falling = rising;
      rising *= 2.0;
    }
  } else if (const Sum at_zero = energy_over(flow, fast, 0.0); at_zero.slope >= 0.0) {
    return at_zero.energy;
  }
  for (int k = 0; k < kBracketHalvings; ++k) {
    const double middle = 0.5 * (falling + rising);
    (energy_over(flow, fast, middle).slope * inwards < 0.0 ? falling : rising) = middle;
  }
  // The tangents of a convex function lie below it.
  const Sum a = energy_over(flow, fast, falling);
  const Sum b = energy_over(flow, fast, rising);
  return std::max(a.energy + a.slope * (rising - falling), b.energy + b.slope * (falling - rising));
}

double CoDesign::quick_bound(const Fast& fast, const Box& box) const {
  double least = task_.drive.standby_W * time_s_;
  double magnitude = least;
  const auto add = [&](Flow flow, const FlowMoments& moments, double most, double more) {
    const InH e = energy_in_h(moments, fast);
    double h = flow == kForwardFlow ? box.forward : box.backward;
    if (!box.exact && e.c > 0.0) {
      const double lowest = -0.5 * e.b / e.c;
      h = flow == kForwardFlow ? std::max(h, lowest) : std::max(0.0, std::min(h, lowest));
    } else if (!box.exact && flow == kBackwardFlow && e.b > 0.0) {
      h = 0.0;
    }
    const double energy = e.a + h * (e.b + h * e.c);
    least += energy > 0.0 ? energy * more : energy * most;
    magnitude += (std::abs(e.a) + std::abs(h * e.b) + h * h * e.c) * more;
  };
  if (lossless_drive_) {
    for (const Flow flow : {kForwardFlow, kBackwardFlow}) add(flow, moments_[flow], 1.0, 1.0);
  } else {
    for (const Class& part : classes_) {
      add(part.flow, part.moments, task_.drive.efficiency_regenerating,
          1.0 / task_.drive.efficiency_motoring);
    }
  }
  return least - kBoundRoom * magnitude;
}

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
      amperes = std::max(amperes, least_magnitude(q * fast.per_torque, m * fast.per_torque, forward,
                                                  end, box.exact));
      const double ohms = fast.resistance_ohm * fast.per_torque;
      volts = std::max(
          volts, least_magnitude(q * ohms + fast.back_emf * w, m * ohms, forward, end, box.exact));
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
  Felt felt{.inertia_kgm2 = task_.load_inertia_kgm2 + fast.j1_kgm2 / box.backward,
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

optimize::EnergyAt CoDesign::at(double ratio, double forward, double backward) const {
  const Box box{.forward = 1.0 / forward, .backward = backward, .exact = true};
  thread_local std::vector<double> bounds;
  bounds.resize(task_.motors.size());
  for (std::size_t k = 0; k < bounds.size(); ++k) bounds[k] = quick_bound(fast_of(k, ratio), box);
  optimize::EnergyAt best{.energy_J = kWithoutBound, .within_limits = false};
  double least_excess = kWithoutBound;
  std::size_t nearest = 0;
  for (std::size_t seen = 0; seen < bounds.size(); ++seen) {
    const auto next = std::ranges::min_element(bounds);
    if (*next >= best.energy_J) break;
    const auto k = static_cast<std::size_t>(next - bounds.begin());
    *next = kWithoutBound;
    const Fast fast = fast_of(k, ratio);
    const double over = excess(k, ratio, fast, box);
    if (over > 0.0) {
      if (over < least_excess) nearest = k;
      least_excess = std::min(least_excess, over);
      continue;
    }
    const Sum f = energy_over(kForwardFlow, fast, box.forward);
    const Sum b = energy_over(kBackwardFlow, fast, box.backward);
    const double energy = f.energy + b.energy + task_.drive.standby_W * time_s_;
    if (!(energy < best.energy_J)) continue;
    best = {.energy_J = energy,
            .slope = {f.slope, b.slope},
            .curvature = {f.curvature, b.curvature},
            .motor = k};
  }
  if (best.within_limits) return best;
  const Fast fast = fast_of(nearest, ratio);
  const Sum f = energy_over(kForwardFlow, fast, box.forward);
  const Sum b = energy_over(kBackwardFlow, fast, box.backward);
  return {.energy_J = f.energy + b.energy + task_.drive.standby_W * time_s_,
          .slope = {f.slope, b.slope},
          .curvature = {f.curvature, b.curvature},
          .motor = nearest,
          .within_limits = false};
}

double CoDesign::least(double ratio, double most_forward, double most_backward) const {
  if (!(most_forward > 0.0 && most_backward > 0.0)) return kWithoutBound;
  const Box box{.forward = 1.0 / most_forward, .backward = most_backward, .exact = false};
  thread_local std::vector<double> bounds;
  bounds.resize(task_.motors.size());
  for (std::size_t k = 0; k < bounds.size(); ++k) bounds[k] = quick_bound(fast_of(k, ratio), box);
  double best = kWithoutBound;
  for (std::size_t seen = 0; seen < bounds.size(); ++seen) {
    const auto next = std::ranges::min_element(bounds);
    if (*next >= best) break;
    const auto k = static_cast<std::size_t>(next - bounds.begin());
    const double quick = *next;
    *next = kWithoutBound;
    const Fast fast = fast_of(k, ratio);
    if (excess(k, ratio, fast, box) > 0.0) continue;
    double energy = quick;
    if (!lossless_drive_ || !rests_.empty()) {
      const double moving = least_over(kForwardFlow, fast, box.forward) +
                            least_over(kBackwardFlow, fast, box.backward);
      energy = std::max(energy, moving + task_.drive.standby_W * time_s_ -
                                    kBoundRoom * (std::abs(moving) + scale_J_));
    }
    best = std::min(best, energy);
  }
  return best;
}

PairResult CoDesign::run(std::size_t motor, double ratio, double forward, double backward) const {
  SelectionTask task = task_;
  task.gearboxes.front().gearbox.ratio = ratio;
  task.gearboxes.front().gearbox.efficiency_forward = forward;
  task.gearboxes.front().gearbox.efficiency_backward = backward;
  return run_pair(task, {.motor = motor, .gearbox = 0});
}

const CoDesign* co_design_of(const optimize::CycleEnergy* energy) {
  return dynamic_cast<const CoDesign*>(energy);
}

}  // namespace gear3k::actuator
