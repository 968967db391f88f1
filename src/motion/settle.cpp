// Which mode holds from an instant on; docs/theory §67.

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "motion/hybrid.hpp"

namespace gear3k::motion {

namespace {

int sign_of_speed(double speed) { return speed > 0.0 ? 1 : speed < 0.0 ? -1 : 0; }

}  // namespace

int Hybrid::started(const Outside& o, bool fast) const {
  for (const int sense : {1, -1}) {
    if ((fast ? fast_start_excess(o, sense) : output_start_excess(o, sense)) >= 0.0) return sense;
  }
  return 0;
}

void Hybrid::leave(State& x, const Mode& gap) {
  // Both angles were integrated: what rounding has made of their distance is put right.
  x[kFastAngle] = x[kOutputAngle] + mode_.contact * half_gap_rad_;
  mode_ = gap;
}

void Hybrid::settle_stick(State& x, double time_s) {
  if (x[kOutputSpeed] != 0.0) {
    // A start in motion.
    mode_ = {
        .phase = Phase::kSlide, .sense = sign_of_speed(x[kOutputSpeed]), .contact = mode_.contact};
    return;
  }
  const Outside o = surroundings_.at(time_s, sides_of(x));
  for (const int sense : {1, -1}) {
    if (start_excess(o, sense) >= 0.0) {
      mode_ = {.phase = Phase::kSlide, .sense = sense, .contact = mode_.contact};
      return;
    }
  }
  if (mode_.contact != 0 && !(cohesion(o) > 0.0)) leave(x, {.phase = Phase::kGap});
}

void Hybrid::settle_slide(State& x, double time_s, std::vector<Occurrence>& happened) {
  const Outside o = surroundings_.at(time_s, sides_of(x));
  const int sense = mode_.sense;
  const JointInput in = joint_input(o, x[kOutputSpeed], sense, false);
  Instant now;
  set_slide(in, mode_.flow, now);
  if (mode_.contact != 0) {
    mode_.flow = sense * mode_.contact;
    if (!(mode_.contact * now.lead + now.lead_rounding > 0.0)) {
      leave(x, {.phase = Phase::kGap, .fast_sense = sense, .output_sense = sense});
      return;
    }
  } else if (mode_.flow == 0) {
    mode_.flow = sense * now.lead >= 0.0 ? 1 : -1;
  } else if (!(mode_.flow * sense * now.lead + now.lead_rounding > 0.0)) {
    mode_.flow = -mode_.flow;
  }
  set_slide(in, mode_.flow, now);
  if (now.jammed) jam(x, happened);
}

void Hybrid::jam(State& x, std::vector<Occurrence>& happened) {
  const Mode before = mode_;
  const double energy = kinetic_j(x);
  x[kFastSpeed] = x[kOutputSpeed] = 0.0;
  mode_ = {.phase = Phase::kStick, .contact = mode_.contact};
  happened.push_back({.what = "jams", .before = before, .after = mode_, .loss_J = energy});
}

void Hybrid::hit(State& x, int side, std::vector<Occurrence>& happened) {
  const Mode before = mode_;
  const double energy = kinetic_j(x);
  const double speed = gear_->speed_after_contact({x[kFastSpeed], x[kOutputSpeed]});
  x[kFastSpeed] = x[kOutputSpeed] = speed;
  mode_ = {.contact = side};
  if (speed != 0.0) {
    const int sense = sign_of_speed(speed);
    mode_ = {.phase = Phase::kSlide, .sense = sense, .flow = sense * side, .contact = side};
  }
  happened.push_back(
      {.what = "contact", .before = before, .after = mode_, .loss_J = energy - kinetic_j(x)});
}

void Hybrid::set_senses(const State& x, const Outside& o) {
  Instant now;
  now.outside = o;
  set_gap(x, mode_, now);
  const auto sense_of = [&](double speed, double acceleration, int sense, bool fast) {
    // A side that turns, or has just been started with the other one, keeps its sense.
    if (sense != 0 && sense * speed > -kSpeedFloor_rad_s &&
        (speed != 0.0 || sense * acceleration > 0.0)) {
      return sense;
    }
    return speed != 0.0 ? sign_of_speed(speed) : started(o, fast);
  };
  const int fast = sense_of(x[kFastSpeed], now.fast_rad_s2, mode_.fast_sense, true);
  mode_.output_sense = sense_of(x[kOutputSpeed], now.output_rad_s2, mode_.output_sense, false);
  mode_.fast_sense = fast;
}

void Hybrid::settle_gap(State& x, double time_s, std::vector<Occurrence>& happened) {
  const Outside o = surroundings_.at(time_s, sides_of(x));
  set_senses(x, o);
  const double ahead = x[kFastAngle] - x[kOutputAngle];
  if (std::abs(ahead) < half_gap_rad_ - hidden_room(x)) return;
  const int side = ahead > 0.0 ? 1 : -1;
  const double closing = side * (x[kFastSpeed] - x[kOutputSpeed]);
  if (closing > 0.0) {
    hit(x, side, happened);
    return;
  }
  if (closing < 0.0) return;
  Instant now;
  now.outside = o;
  set_gap(x, mode_, now);
  if (!(side * (now.fast_rad_s2 - now.output_rad_s2) > 0.0)) return;
  const bool together = mode_.fast_sense != 0 && mode_.fast_sense == mode_.output_sense;
  mode_ = together ? Mode{.phase = Phase::kSlide,
                          .sense = mode_.fast_sense,
                          .flow = mode_.fast_sense * side,
                          .contact = side}
                   : Mode{.contact = side};
}

void Hybrid::hold_signs(const State& x, double time_s) {
  if (mode_.phase == Phase::kStick && mode_.contact != 0) {
    const auto margins = rest_margins(surroundings_.at(time_s, sides_of(x)));
    for (std::size_t k = 0; k < margins.size(); ++k) {
      if (!(margins.at(k) > 0.0)) signs_.rest.at(k) = -signs_.rest.at(k);
    }
  }
  // The bus's power depends on the sign of the electrical one.
  for (int round = 0; round < 2; ++round) {
    const auto [electrical, bus, load] = power_margins(at(x, time_s), x);
    if (!(electrical > 0.0))
      signs_.electrical = -signs_.electrical;
    else if (!(bus > 0.0))
      signs_.bus = -signs_.bus;
    if (!(load > 0.0)) signs_.load = -signs_.load;
  }
}

void Hybrid::settle(State& x, double time_s, std::vector<Occurrence>& happened) {
  constexpr int kMostRounds = 50;
  for (int round = 0; round < kMostRounds; ++round) {
    const Mode before = mode_;
    switch (mode_.phase) {
      case Phase::kStick:
        settle_stick(x, time_s);
        break;
      case Phase::kSlide:
        settle_slide(x, time_s, happened);
        break;
      case Phase::kGap:
        settle_gap(x, time_s, happened);
        break;
    }
    if (mode_ == before) {
      hold_signs(x, time_s);
      return;
    }
  }
  throw std::runtime_error(fmt::format("no mode of motion holds at {:g} s", time_s));
}

}  // namespace gear3k::motion
