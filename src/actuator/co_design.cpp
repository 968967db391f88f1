#include "actuator/co_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "actuator/gear_model.hpp"
#include "actuator/screening.hpp"

namespace gear3k::actuator {

namespace {

/// Polynomial of a stretch of a piece over x in [0, 1].
Quadratic stretch_of(const Quadratic& p, std::array<double, 2> range) {
  return through(value_at(p, range[0]), value_at(p, 0.5 * (range[0] + range[1])),
                 value_at(p, range[1]));
}

/// The bracket of a minimum of a convex function, halved until it is this narrow.
constexpr int kBracketHalvings = 40;
constexpr int kBracketDoublings = 200;

Actuator with_train(const SelectionTask& task, std::size_t motor,
                    const std::shared_ptr<const DesignTrain>& train) {
  Actuator a = actuator_of(task, {.motor = motor, .gearbox = 0});
  a.gearbox = {};
  a.gearbox.ratio = train->ratio();
  a.train = train;
  return a;
}

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
    FlowMoments own;
    add_moments(part, own);
    acceleration_work_ += std::sqrt(own.square[1][1] * own.square[2][2]);
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

double CoDesign::square_acceleration() const {
  return moments_[kForwardFlow].square[1][1] + moments_[kBackwardFlow].square[1][1];
}

CoDesign::Fast CoDesign::fast_of(std::size_t motor, double ratio, double inertia_kgm2) const {
  const Motor& m = task_.motors[motor].motor;
  const double per_torque = 1.0 / (ratio * m.torque_constant_Nm_A);
  const double rotor = ratio * ratio * m.rotor_inertia_kgm2;
  return {.rotor_kgm2 = rotor,
          .j1_kgm2 = rotor + inertia_kgm2,
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
      const double a = value_at(part.acceleration_rad_s2, x);
      const double rise = share * (2.0 * fast.copper * tau + w);
      const double bend = share * 2.0 * fast.copper;
      sum.slope += rise * m;
      sum.curvature += bend * m * m;
      sum.inertia_slope += rise * a;
      sum.inertia_curvature += bend * a * a;
      sum.mixed += bend * a * m;
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
    const auto& m = moments_[flow].square;
    const double bend = 2.0 * fast.copper;
    sum = {.energy = e.a + h * (e.b + h * e.c),
           .slope = e.b + 2.0 * h * e.c,
           .curvature = 2.0 * e.c,
           .inertia_slope = bend * (fast.j1_kgm2 * m[1][1] + fast.d1_Nms * m[1][2] +
                                    fast.c1_Nm * m[1][3] + h * m[0][1]) +
                            m[1][2],
           .inertia_curvature = bend * m[1][1],
           .mixed = bend * m[0][1]};
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

CoDesign::Least CoDesign::least_over(Flow flow, const Fast& fast, double end) const {
  const double inwards = flow == kForwardFlow ? 1.0 : -1.0;
  const Sum at_end = energy_over(flow, fast, end);
  if (at_end.slope * inwards >= 0.0) return {.h = end, .bound = at_end.energy, .sum = at_end};
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
    return {.h = 0.0, .bound = at_zero.energy, .sum = at_zero};
  }
  for (int k = 0; k < kBracketHalvings; ++k) {
    const double middle = 0.5 * (falling + rising);
    (energy_over(flow, fast, middle).slope * inwards < 0.0 ? falling : rising) = middle;
  }
  // The tangents of a convex function lie below it.
  const Sum a = energy_over(flow, fast, falling);
  const Sum b = energy_over(flow, fast, rising);
  return {.h = rising,
          .bound = std::max(a.energy + a.slope * (rising - falling),
                            b.energy + b.slope * (falling - rising)),
          .sum = b};
}

/// E ≥ its tangent at the least inertia J, in h, in J and in what γ differs from J at any time:
///   E(J) + ∂E/∂J (J' − J) − c J' ∫ |∂P/∂τ| |a| dt,   c = the greater of 1 − γ/J and γ/J − 1
double CoDesign::sharp_bound(const Fast& fast, const Box& box,
                             const optimize::EnergyBox& gearboxes) const {
  const double least_J = gearboxes.least_inertia_kgm2;
  double energy = task_.drive.standby_W * time_s_;
  double magnitude = energy;
  double slope = 0.0;
  double torque = 0.0;  // ∫ |τ a|
  for (const Flow flow : {kForwardFlow, kBackwardFlow}) {
    const double end = flow == kForwardFlow ? box.forward : box.backward;
    const Least least = least_over(flow, fast, end);
    // A place within rounding of the least one: its tangent over the range of h.
    const double range = flow == kForwardFlow ? std::max(0.0, least.h - end) : end;
    const double tilt = flow == kForwardFlow ? std::max(0.0, least.sum.slope) * range
                                             : std::abs(least.sum.slope) * range;
    const bool at_end = least.h == end || least.h == 0.0;
    energy +=
        least_J > 0.0 && !at_end ? std::min(least.bound, least.sum.energy - tilt) : least.bound;
    magnitude += std::abs(least.bound);
    slope += least.sum.inertia_slope;
    const InH s = square_in_h(moments_[flow], fast);
    torque += std::sqrt(std::max(0.0, s.a + least.h * (s.b + least.h * s.c)) *
                        moments_[flow].square[1][1]);
  }
  if (gearboxes.most_inertia_kgm2 > 0.0) {
    const double more =
        (2.0 * fast.copper * torque + acceleration_work_) / task_.drive.efficiency_motoring;
    const double factor =
        std::max(1.0 - gearboxes.inertia_factor[0], gearboxes.inertia_factor[1] - 1.0);
    energy += std::min(0.0, slope - factor * more) * (gearboxes.most_inertia_kgm2 - least_J) -
              factor * least_J * more;
    magnitude += (std::abs(slope) + more) * gearboxes.most_inertia_kgm2;
  }
  return energy - kBoundRoom * (magnitude + scale_J_);
}

/// Where γ may differ by D from the inertia of J1, |∂P/∂τ| D |a| ≤ (2 ρ |τ| + |w|) D |a|/η_mot, of
/// which 2 ρ |τ| D |a| ≤ θ ρ τ² + ρ D² a²/θ: the bound with a share θ of the copper loss left out,
/// less the rest.
double CoDesign::quick_bound(const Fast& fast, const Box& box) const {
  const Drive& drive = task_.drive;
  const double more = 1.0 / drive.efficiency_motoring;
  const double both = drive.efficiency_motoring * drive.efficiency_regenerating;
  double least = drive.standby_W * time_s_;
  double share = 0.0;  // θ
  if (box.spread_kgm2 > 0.0) {
    double square = 0.0;
    for (const Flow flow : {kForwardFlow, kBackwardFlow}) {
      const InH s = square_in_h(moments_[flow], fast);
      const double h = flow == kForwardFlow ? box.forward : box.backward;
      square += std::max(0.0, s.a + h * (s.b + h * s.c));
    }
    constexpr double kMostShare = 0.5;
    const double inertia = box.spread_kgm2 * box.spread_kgm2 * square_acceleration();
    share = kMostShare * std::max(both, kMostShare);
    if (square > 0.0) share = std::min(share, std::sqrt(inertia / square));
    if (share > 0.0) least -= more * fast.copper * inertia / share;
    least -= more * box.spread_kgm2 * acceleration_work_;
  }
  double magnitude = std::abs(least);
  Fast spared = fast;
  spared.copper *= 1.0 - share;
  Fast spared_back = fast;
  if (both > 0.0) spared_back.copper *= std::max(0.0, 1.0 - share / both);
  const auto minimum = [&](Flow flow, const FlowMoments& moments, const Fast& by) {
    const InH e = energy_in_h(moments, by);
    double h = flow == kForwardFlow ? box.forward : box.backward;
    if (!box.exact && e.c > 0.0) {
      const double lowest = -0.5 * e.b / e.c;
      h = flow == kForwardFlow ? std::max(h, lowest) : std::max(0.0, std::min(h, lowest));
    } else if (!box.exact && flow == kBackwardFlow && e.b > 0.0) {
      h = 0.0;
    }
    magnitude += (std::abs(e.a) + std::abs(h * e.b) + h * h * e.c) * more;
    return e.a + h * (e.b + h * e.c);
  };
  if (lossless_drive_) {
    for (const Flow flow : {kForwardFlow, kBackwardFlow}) {
      least += minimum(flow, moments_[flow], spared);
    }
  } else {
    for (const Class& part : classes_) {
      const double energy = minimum(part.flow, part.moments, spared);
      if (share == 0.0) {
        least += energy > 0.0 ? energy * more : energy * drive.efficiency_regenerating;
      } else {
        double best = energy * more;
        if (share < both) {
          best = std::max(
              best, drive.efficiency_regenerating * minimum(part.flow, part.moments, spared_back));
        }
        least += best;
      }
    }
  }
  return least - kBoundRoom * magnitude;
}

optimize::EnergyAt CoDesign::at(const optimize::EnergyGearbox& g) const {
  const Box box{.forward = 1.0 / g.forward,
                .backward = g.backward,
                .exact = true,
                .inertia_kgm2 = g.inertia_kgm2};
  const auto fast_at = [&](std::size_t k) { return fast_of(k, g.ratio, g.inertia_kgm2); };
  const auto energy_with = [&](std::size_t k, bool within) {
    const Fast fast = fast_at(k);
    const Sum f = energy_over(kForwardFlow, fast, box.forward);
    const Sum b = energy_over(kBackwardFlow, fast, box.backward);
    return optimize::EnergyAt{.energy_J = f.energy + b.energy + task_.drive.standby_W * time_s_,
                              .slope = {f.slope, b.slope},
                              .curvature = {f.curvature, b.curvature},
                              .inertia_slope = f.inertia_slope + b.inertia_slope,
                              .inertia_curvature = f.inertia_curvature + b.inertia_curvature,
                              .mixed = {f.mixed, b.mixed},
                              .motor = k,
                              .within_limits = within};
  };
  thread_local std::vector<double> bounds;
  bounds.resize(task_.motors.size());
  for (std::size_t k = 0; k < bounds.size(); ++k) bounds[k] = quick_bound(fast_at(k), box);
  optimize::EnergyAt best{.energy_J = kWithoutBound, .within_limits = false};
  double least_excess = kWithoutBound;
  std::size_t nearest = 0;
  for (std::size_t seen = 0; seen < bounds.size(); ++seen) {
    const auto next = std::ranges::min_element(bounds);
    if (*next >= best.energy_J) break;
    const auto k = static_cast<std::size_t>(next - bounds.begin());
    *next = kWithoutBound;
    const double over = excess(k, g.ratio, fast_at(k), box);
    if (over > 0.0) {
      if (over < least_excess) nearest = k;
      least_excess = std::min(least_excess, over);
      continue;
    }
    const optimize::EnergyAt own = energy_with(k, true);
    if (own.energy_J < best.energy_J) best = own;
  }
  return best.within_limits ? best : energy_with(nearest, false);
}

optimize::EnergyAt CoDesign::of(const design::Design& design) const {
  const auto train = std::make_shared<const DesignTrain>(design);
  Screening screening(task_);
  std::vector<PairResult> bounds = screening.bounds(with_train(task_, 0, train));
  std::ranges::stable_sort(
      bounds, {}, [](const PairResult& r) { return std::pair(r.excess > 0.0, r.energy_J); });
  optimize::EnergyAt best{.energy_J = kWithoutBound, .within_limits = false};
  for (const PairResult& bound : bounds) {
    if (bound.excess > 0.0 || bound.energy_J >= best.energy_J) break;
    const PairResult r = run(bound.pair.motor, train);
    // Of equals the one that stands first, as at() has it.
    if (r.excess > 0.0 || r.energy_J > best.energy_J) continue;
    if (r.energy_J == best.energy_J && r.pair.motor > best.motor) continue;
    best = {.energy_J = r.energy_J, .motor = r.pair.motor};
  }
  return best;
}

double CoDesign::least(const optimize::EnergyBox& g) const {
  if (!(g.most_forward > 0.0 && g.most_backward > 0.0)) return kWithoutBound;
  if (!g.known) return -kWithoutBound;
  const double low = g.inertia_factor[0];
  const Box box{.forward = 1.0 / g.most_forward,
                .backward = g.most_backward,
                .exact = false,
                .inertia_kgm2 = g.least_inertia_kgm2,
                .spread_kgm2 =
                    std::max({0.0, g.inertia_factor[1] * g.most_inertia_kgm2 - g.least_inertia_kgm2,
                              g.least_inertia_kgm2 - std::min(low * g.least_inertia_kgm2,
                                                              low * g.most_inertia_kgm2)})};
  const auto fast_at = [&](std::size_t k) { return fast_of(k, g.ratio, box.inertia_kgm2); };
  thread_local std::vector<double> bounds;
  bounds.resize(task_.motors.size());
  for (std::size_t k = 0; k < bounds.size(); ++k) bounds[k] = quick_bound(fast_at(k), box);
  double best = kWithoutBound;
  for (std::size_t seen = 0; seen < bounds.size(); ++seen) {
    const auto next = std::ranges::min_element(bounds);
    if (*next >= best) break;
    const auto k = static_cast<std::size_t>(next - bounds.begin());
    const double quick = *next;
    *next = kWithoutBound;
    const Fast fast = fast_at(k);
    if (excess(k, g.ratio, fast, box) > 0.0) continue;
    double energy = quick;
    if (!lossless_drive_ || !rests_.empty() || box.spread_kgm2 > 0.0) {
      energy = std::max(energy, sharp_bound(fast, box, g));
    }
    best = std::min(best, energy);
  }
  return best;
}

PairResult CoDesign::run(std::size_t motor, const optimize::EnergyGearbox& g) const {
  SelectionTask task = task_;
  Gearbox& gearbox = task.gearboxes.front().gearbox;
  gearbox.ratio = g.ratio;
  gearbox.efficiency_forward = g.forward;
  gearbox.efficiency_backward = g.backward;
  gearbox.input_inertia_kgm2 = g.inertia_kgm2 / (g.ratio * g.ratio);
  return run_pair(task, {.motor = motor, .gearbox = 0});
}

PairResult CoDesign::run(std::size_t motor, const std::shared_ptr<const DesignTrain>& train) const {
  return run_actuator(task_, {.motor = motor, .gearbox = 0}, with_train(task_, motor, train));
}

const CoDesign* co_design_of(const optimize::CycleEnergy* energy) {
  return dynamic_cast<const CoDesign*>(energy);
}

}  // namespace gear3k::actuator
