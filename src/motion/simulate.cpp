#include "motion/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "actuator/design_gear.hpp"

namespace gear3k::motion {

namespace {

/// Names of what changed from one mode to the next.
std::vector<std::string> changes(const Mode& before, const Mode& after) {
  std::vector<std::string> names;
  const auto side = [&](const char* name, int from, int to) {
    if (from == to) return;
    names.push_back(fmt::format("{}_{}", name,
                                to == 0     ? "stops"
                                : from == 0 ? "starts"
                                            : "reverses"));
  };
  if (before.phase != Phase::kGap && after.phase == Phase::kGap) names.emplace_back("separates");
  if (before.phase == Phase::kGap && after.phase != Phase::kGap) names.emplace_back("contact");
  if (before.phase == Phase::kGap && after.phase == Phase::kGap) {
    side("motor_side", before.fast_sense, after.fast_sense);
    side("output", before.output_sense, after.output_sense);
  }
  if (before.phase != Phase::kGap && after.phase != Phase::kGap) {
    if (before.sense != after.sense) {
      names.emplace_back(after.sense == 0 ? "stops" : before.sense == 0 ? "starts" : "reverses");
    } else if (before.flow != after.flow) {
      names.emplace_back(after.flow > 0 ? "flow_forward" : "flow_backward");
    }
  }
  return names;
}

constexpr std::array<const char*, 4> kShareNames{"stick", "forward", "backward", "gap"};
std::size_t share_of(const Mode& mode) {
  if (mode.phase == Phase::kStick) return 0;
  if (mode.phase == Phase::kGap) return 3;
  return mode.flow > 0 ? 1 : 2;
}

class MotionRun {
 public:
  MotionRun(const actuator::Actuator& actuator, const Scenario& scenario,
            const MotionProgress& progress)
      : scenario_(scenario),
        progress_(progress),
        ratio_(actuator.gearbox.ratio),
        hybrid_(actuator, scenario),
        max_step_s_(hybrid_.max_step_s()),
        stepper_([this](const State& x, State& dxdt, double t) { hybrid_.slopes(x, dxdt, t); },
                 scenario.solver.absolute_tolerance, scenario.solver.relative_tolerance,
                 max_step_s_),
        sample_s_(scenario.sample_s.value_or(1e-3 * scenario.duration_s)) {
    for (const char* name : kShareNames) motion_.shares.push_back({.name = name});
  }

  Motion run() {
    x_ = hybrid_.start();
    first_ = x_;
    hybrid_.enter(0.0);
    change(0.0, hybrid_.mode());
    if (scenario_.start_speed_rad_s != 0.0) {
      // What moves from the beginning does not start.
      std::erase_if(motion_.events, [](const auto& e) { return e.what.ends_with("starts"); });
    }
    note(row(x_, 0.0));
    next_sample_ = 1;
    constexpr double kFirst = 1e-2;
    step_s_ = kFirst * max_step_s_;
    while (time_s_ < scenario_.duration_s && motion_.complete) go_on();
    finish();
    return std::move(motion_);
  }

 private:
  [[nodiscard]] MotionRow row(const State& x, double time_s) const {
    const Instant now = hybrid_.at(x, time_s);
    MotionRow r{.time_s = time_s,
                .sides = sides_of(x),
                .acceleration_rad_s2 = now.output_rad_s2,
                .mode = hybrid_.mode(),
                .outside = now.outside};
    if (r.mode.phase != Phase::kStick) r.mesh_Nm = now.mesh_Nm;
    return r;
  }

  void note(const MotionRow& r) {
    note_peaks(r.outside, r.sides.fast_rad_s);
    motion_.rows.push_back(r);
  }

  void note_peaks(const Outside& o, double fast_rad_s) {
    Motion& m = motion_;
    m.peak_current_A = std::max(m.peak_current_A, std::abs(o.current_A));
    m.peak_voltage_V = std::max(m.peak_voltage_V, std::abs(o.voltage_V));
    m.peak_motor_speed_rad_s = std::max(m.peak_motor_speed_rad_s, std::abs(ratio_ * fast_rad_s));
  }

  /// Rows at multiples of the distance up to the end of a step, or of what is left of it.
  void sample(double until_s) {
    for (double t = next_sample_ * sample_s_; t < until_s; t = ++next_sample_ * sample_s_) {
      note(row(stepper_.between(t), t));
    }
    if (next_sample_ * sample_s_ == until_s) ++next_sample_;
  }

  /// Settles the mode at a time, after whatever has ended there.
  void change(double time_s, Mode before) {
    std::vector<Occurrence> happened;
    hybrid_.settle(x_, time_s, happened);
    const auto log = [&](const Mode& after) {
      for (std::string& name : changes(before, after)) add_event(time_s, name, before, after, 0.0);
      before = after;
    };
    for (Occurrence& o : happened) {
      log(o.before);
      (o.what == "jams" ? jam_J_ : contact_J_).add(o.loss_J);
      add_event(time_s, o.what, o.before, o.after, o.loss_J);
      before = o.after;
    }
    log(hybrid_.mode());
    ++motion_.shares[share_of(hybrid_.mode())].entries;
  }

  void add_event(double time_s, const std::string& what, const Mode& before, const Mode& after,
                 double loss_J) {
    motion_.events.push_back({.time_s = time_s,
                              .what = what,
                              .before = before,
                              .after = after,
                              .angle_rad = x_[kOutputAngle],
                              .speed_rad_s = x_[kOutputSpeed],
                              .loss_J = loss_J});
  }

  /// Where within the last step anything that is watched ends first; empty: nowhere.  Up to there
  /// the points of the step count for the peaks: rows may be further apart.
  std::optional<double> first_end() {
    constexpr int kPoints = 4;
    const double from = stepper_.from_s();
    const double width = stepper_.to_s() - from;
    double before = 0.0;
    for (int k = 1; k <= kPoints; ++k) {
      const double at = k == kPoints ? width : width * k / kPoints;
      const State x = k == kPoints ? stepper_.state() : stepper_.between(from + at);
      const Outside outside = hybrid_.watch(x, from + at, watched_);
      std::optional<double> first;
      for (std::size_t which = 0; which < watched_.size(); ++which) {
        if (watched_[which] > 0.0) continue;
        const double end = place_of_change(
            [&](double offset) {
              hybrid_.watch(stepper_.exact(from + offset), from + offset, trial_);
              return trial_[which];
            },
            before, at);
        first = first ? std::min(*first, end) : end;
      }
      if (first) return from + *first;
      note_peaks(outside, x[kFastSpeed]);
      before = at;
    }
    return std::nullopt;
  }

  /// From a restart of the stepper to the next one.
  void go_on() {
    const double limit = limit_s_ =
        std::min(hybrid_.surroundings().next_row_s(time_s_), scenario_.duration_s);
    stepper_.restart(x_, time_s_, std::min(step_s_, limit - time_s_));
    while (true) {
      const double wanted = stepper_.next_step_s();
      stepper_.advance(limit);
      ++motion_.steps;
      if (const auto end = first_end()) {
        cut(*end);
        return;
      }
      sample(stepper_.to_s());
      spend(stepper_.to_s());
      if (steps_are_spent() || is_interrupted()) {
        x_ = stepper_.state();
        return;
      }
      if (stepper_.to_s() < limit) continue;
      x_ = stepper_.state();
      step_s_ = std::max(wanted, std::min(stepper_.next_step_s(), max_step_s_));
      if (limit >= scenario_.duration_s) return;
      note(row(x_, limit));
      hybrid_.enter(limit);
      change(limit, hybrid_.mode());
      note(row(x_, limit));
      return;
    }
  }

  /// Ends the run where it has taken solver.max_steps and is not through.
  bool steps_are_spent() {
    const std::int64_t most = scenario_.solver.max_steps;
    if (static_cast<std::int64_t>(motion_.steps) < most || time_s_ >= scenario_.duration_s) {
      return false;
    }
    end_early(fmt::format("solver.max_steps = {} steps, the last of {:g} s", most,
                          stepper_.to_s() - stepper_.from_s()));
    return true;
  }

  /// Ends the run where its progress says so.
  bool is_interrupted() {
    if (!progress_ || progress_(time_s_ / scenario_.duration_s)) return false;
    motion_.interrupted = time_s_ < scenario_.duration_s;
    if (motion_.interrupted) end_early("interrupted");
    return motion_.interrupted;
  }

  void end_early(std::string why) {
    motion_.complete = false;
    why_ = std::move(why);
  }

  /// The time since the last mark goes to the mode that held.
  void spend(double time_s) {
    motion_.shares[share_of(hybrid_.mode())].time_s += time_s - time_s_;
    time_s_ = time_s;
  }

  void cut(double end_s) {
    sample(end_s);
    const double from = stepper_.from_s();
    x_ = end_s > from ? stepper_.exact(end_s) : x_at_start();
    step_s_ = stepper_.next_step_s();
    spend(end_s);
    note(row(x_, end_s));
    hybrid_.watch(x_, end_s, watched_);
    const Mode before = hybrid_.mode();
    hybrid_.take(watched_, x_);
    const std::size_t events = motion_.events.size();
    if (end_s >= limit_s_) hybrid_.enter(end_s);  // an end that falls together with a row
    change(end_s, before);
    if (motion_.events.size() == events) --motion_.shares[share_of(hybrid_.mode())].entries;
    note(row(x_, end_s));
    ++motion_.cuts;
    constexpr double kMoment = 1e-13;
    idle_ = end_s > last_cut_s_ + kMoment * scenario_.duration_s ? 0 : idle_ + 1;
    last_cut_s_ = end_s;
    constexpr int kMostIdle = 100;
    if (idle_ > kMostIdle) {
      throw std::runtime_error(fmt::format("the modes of motion do not settle at {:g} s", end_s));
    }
    // Changes of a power's sign are no events, but cost as much.
    const std::size_t counted = std::max(motion_.events.size(), motion_.cuts / 2);
    const std::int64_t most = scenario_.solver.max_events;
    if (static_cast<std::int64_t>(counted) > most) {
      end_early(fmt::format("more than solver.max_events = {} events", most));
    } else if (!chatters(end_s) && !steps_are_spent()) {
      is_interrupted();
    }
  }

  /// Greatest of a stretch of events.
  [[nodiscard]] double most_of(std::size_t from, std::size_t to,
                               double (*value)(const MotionEvent&)) const {
    double most = 0.0;
    for (std::size_t k = from; k < to; ++k) most = std::max(most, value(motion_.events[k]));
    return most;
  }

  /// Whether events that repeat themselves will go on beyond solver.max_events: a quarter of them
  /// is past, the last eighth came as fast as the one before, and at that rate the rest comes
  /// before anything that is prescribed changes.  Ends it and says so.
  bool chatters(double time_s) {
    const auto& events = motion_.events;
    const auto most = static_cast<std::size_t>(scenario_.solver.max_events);
    const std::size_t part = most / 8;
    if (part < 100 || events.size() < 2 * part || events.size() < looked_ + part / 4) return false;
    looked_ = events.size();
    const std::size_t end = events.size() - 1, middle = end - part, begin = end + 1 - 2 * part;
    const double last = events[end].time_s - events[middle].time_s;
    const double before = events[middle].time_s - events[begin].time_s;
    constexpr double kSlower = 1.1;
    if (last > kSlower * before) return false;
    const double until = std::min(hybrid_.surroundings().next_row_s(time_s), scenario_.duration_s);
    const double expected = static_cast<double>(part) / last * (until - time_s);
    if (static_cast<double>(events.size()) + expected <= static_cast<double>(most)) return false;
    const auto share = [&](const char* what) {
      return std::ranges::count(events.begin() + static_cast<std::ptrdiff_t>(middle), events.end(),
                                what, &MotionEvent::what);
    };
    const auto jams = share("jams"), contacts = share("contact");
    const auto loss = [](const MotionEvent& e) { return e.loss_J; };
    const double now = most_of(middle, end, loss), earlier = most_of(begin, middle, loss);
    constexpr double kGrows = 1.1;
    const bool grows = contacts > 0 && now > kGrows * earlier;
    std::string what = "events repeat themselves";
    if (jams > contacts) {
      what = "judders, it jams and starts";
    } else if (contacts > 0 && scenario_.control == Control::kPosition) {
      what = grows ? "unstable: the gains of the control diverge across the gap, it is crossed"
                   : "unstable: the gains of the control chatter across the gap, it is crossed";
    } else if (contacts > 0) {
      what = grows ? "impacts across the gap grow, it is crossed"
                   : "chatters across the gap, it is crossed";
    }
    const char* const repeated = jams > contacts ? "jams" : contacts > 0 ? "contact" : nullptr;
    double rate = static_cast<double>(part) / last;
    if (repeated != nullptr) {
      const auto of = [&](const MotionEvent& e) { return e.what == repeated; };
      const auto from = events.begin() + static_cast<std::ptrdiff_t>(middle);
      const auto one = std::find_if(from, events.end(), of);
      const auto other = std::find_if(events.rbegin(), events.rend(), of);
      const auto count = std::count_if(from, events.end(), of);
      if (count > 1) rate = static_cast<double>(count - 1) / (other->time_s - one->time_s);
    }
    end_early(fmt::format(
        "{} {:.4g} times a second{}; to {:g} s more than solver.max_events = {} events would pass",
        what, rate,
        grows ? fmt::format(" and its impacts take {:.3g} times the energy of those before",
                            now / earlier)
              : "",
        until, scenario_.solver.max_events));
    return true;
  }
  [[nodiscard]] State x_at_start() const { return stepper_.between(stepper_.from_s()); }

  void finish();
  void fill_ledger();

  const Scenario& scenario_;
  const MotionProgress& progress_;
  double ratio_;
  Hybrid hybrid_;
  double max_step_s_;
  Stepper stepper_;
  double sample_s_;
  State x_{}, first_{};
  double time_s_ = 0.0, step_s_ = 0.0, limit_s_ = 0.0;
  double next_sample_ = 1.0;
  int idle_ = 0;
  double last_cut_s_ = -1.0;
  std::size_t looked_ = 0;  ///< events when chatters() looked last
  std::string why_;         ///< why the run was ended early; "" else
  actuator::CompensatedSum contact_J_, jam_J_;
  std::vector<double> watched_, trial_;
  Motion motion_;
};

void MotionRun::fill_ledger() {
  Ledger& l = motion_.ledger;
  l.drawn_J = x_[kDrawn];
  l.regenerated_J = x_[kRegenerated];
  l.positive_J = x_[kPositive];
  l.negative_J = x_[kNegative];
  l.losses = {{.cause = "copper", .energy_J = x_[kCopper]},
              {.cause = "motor_coulomb", .energy_J = x_[kMotorCoulomb]},
              {.cause = "motor_viscous", .energy_J = x_[kMotorViscous]}};
  const auto& causes = hybrid_.gear().causes();
  for (std::size_t k = 0; k < causes.size(); ++k) {
    l.losses.push_back({.cause = causes[k], .energy_J = x_[kGearLosses + k]});
  }
  l.losses.push_back({.cause = "drive", .energy_J = x_[kDrive]});
  l.losses.push_back({.cause = "contact", .energy_J = contact_J_.value()});
  l.losses.push_back({.cause = "jam", .energy_J = jam_J_.value()});
  const Surroundings& s = hybrid_.surroundings();
  l.kinetic_J = hybrid_.kinetic_j(x_) - hybrid_.kinetic_j(first_);
  l.spring_J = s.spring_j(x_[kOutputAngle]) - s.spring_j(first_[kOutputAngle]);
  l.gravity_J = s.gravity_j(x_[kOutputAngle]) - s.gravity_j(first_[kOutputAngle]);
  actuator::CompensatedSum difference;
  double magnitude = 0.0;
  const auto add = [&](double energy) {
    difference.add(energy);
    magnitude += std::abs(energy);
  };
  for (const double energy : {l.drawn_J, -l.regenerated_J, -l.positive_J, l.negative_J,
                              -l.kinetic_J, -l.spring_J, -l.gravity_J}) {
    add(energy);
  }
  for (const actuator::LossEnergy& loss : l.losses) add(-loss.energy_J);
  l.balance_error = magnitude > 0.0 ? std::abs(difference.value()) / magnitude : 0.0;
}

void MotionRun::finish() {
  motion_.end = row(x_, time_s_);
  note(motion_.end);
  fill_ledger();
  if (!motion_.complete) {
    motion_.ended_early =
        fmt::format("ended at {:g} s of {:g} s: {}", time_s_, scenario_.duration_s, why_);
    motion_.notes.push_back(motion_.ended_early);
  }
  const auto jams = [](const MotionEvent& event) { return event.what == "jams"; };
  const auto first = std::ranges::find_if(motion_.events, jams);
  if (first == motion_.events.end()) return;
  motion_.notes.push_back(fmt::format(
      "the self-locking train jams at {:g} s: driven from the output, J1 + eta_b J2 is not above "
      "0, and no acceleration satisfies both sides",
      first->time_s));
  const auto count = std::ranges::count_if(motion_.events, jams);
  if (count < 2) return;
  const auto last = std::ranges::find_if(motion_.events.rbegin(), motion_.events.rend(), jams);
  motion_.notes.push_back(fmt::format(
      "it jams {} times, on average every {:g} s: at rest the motor's torque is above what the "
      "pressed mesh holds, in motion below what keeps ahead of the output",
      count, (last->time_s - first->time_s) / static_cast<double>(count - 1)));
}

}  // namespace

Motion simulate(const actuator::Actuator& actuator, const Scenario& scenario,
                const MotionProgress& progress) {
  Motion motion = MotionRun(actuator, scenario, progress).run();
  motion.checks =
      actuator::drive_checks(actuator, {.current_A = motion.peak_current_A,
                                        .voltage_V = motion.peak_voltage_V,
                                        .motor_speed_rad_s = motion.peak_motor_speed_rad_s});
  for (const actuator::LimitCheck& check : motion.checks) {
    if (check.ok) continue;
    motion.notes.push_back(fmt::format(
        "the {} reaches {:.4g} {}, above the limit of {:.4g} {}, to which the motion is not held",
        check.name, check.value.value_or(0.0), check.unit, check.limit, check.unit));
  }
  return motion;
}

}  // namespace gear3k::motion
