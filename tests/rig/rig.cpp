#include "tests/rig/rig.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "tests/rig/deterministic_random.hpp"
#include "tests/rig/number_text.hpp"
#include "tests/rig/rig_response.hpp"

namespace gear3k::rig {
namespace {

double rounded(double value, double step) { return std::round(value / step) * step; }

// Every condition with its repeats, in the order in which the plan lists them.
std::vector<Condition> transmission_rows(const Plan& plan, DeterministicRandom& random) {
  std::vector<Condition> points;
  std::vector<int> parity;
  for (std::size_t v = 0; v < plan.sun_speeds_rpm.size(); ++v) {
    for (std::size_t t = 0; t < plan.torques_Nm.size(); ++t) {
      for (const bool forward : {true, false}) {
        if (!(forward ? plan.forward : plan.backward)) continue;
        points.push_back({.forward = forward,
                          .sun_speed_rpm = plan.sun_speeds_rpm[v],
                          .output_torque_Nm = plan.torques_Nm[t]});
        parity.push_back(static_cast<int>(v + t) + (forward ? 0 : 1));
      }
    }
  }
  std::vector<int> repeats(points.size(), plan.repeats);
  if (plan.unequal_repeats && !points.empty()) {
    for (std::size_t i = 0; i < 20 * points.size(); ++i) {
      int& from = repeats[random.index(points.size())];
      int& to = repeats[random.index(points.size())];
      if (from <= 1 || to >= 5) continue;
      --from;
      ++to;
    }
  }
  std::vector<Condition> rows;
  rows.reserve(points.size() * 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int r = 0; r < repeats[i]; ++r) {
      Condition row = points[i];
      // Alternates over repeats and over neighbours, so that neither goes with speed or load.
      row.rotation = plan.both_rotations && (parity[i] + r) % 2 != 0 ? -1 : 1;
      rows.push_back(row);
    }
  }
  return rows;
}

std::vector<Condition> lost_motion_rows(const Plan& plan) {
  std::vector<Condition> rows(static_cast<std::size_t>(plan.rows));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].output_torque_Nm = plan.torques_Nm[i % plan.torques_Nm.size()];
  }
  return rows;
}

std::vector<Condition> pair_rows(const Plan& plan) {
  std::vector<Condition> rows;
  rows.reserve(plan.pair_teeth.size() * plan.pair_teeth.size() * 3);
  for (const int driving : plan.pair_teeth) {
    for (const int driven : plan.pair_teeth) {
      for (int r = 0; r < plan.repeats; ++r) {
        rows.push_back({.driving_teeth = driving, .driven_teeth = driven});
      }
    }
  }
  return rows;
}

// Ramps 0, +T, -T, +T ... 0: starts and ends in the middle of a branch.
std::vector<Condition> loop_rows(const Plan& plan) {
  const double peak = *std::max_element(plan.torques_Nm.begin(), plan.torques_Nm.end());
  std::vector<Condition> rows;
  const int samples = plan.loops * plan.samples_per_loop;
  rows.reserve(static_cast<std::size_t>(samples) + 1);
  for (int i = 0; i <= samples; ++i) {
    const double phase = static_cast<double>(i % plan.samples_per_loop) / plan.samples_per_loop;
    const double triangle = phase < 0.25   ? 4.0 * phase
                            : phase < 0.75 ? 2.0 - 4.0 * phase
                                           : 4.0 * phase - 4.0;
    rows.push_back({.output_torque_Nm = peak * triangle,
                    .time_s = rounded(i * plan.sample_step_s, 1e-6),
                    .session = std::min(plan.sessions - 1,
                                        i / plan.samples_per_loop * plan.sessions / plan.loops)});
  }
  return rows;
}

// Puts rows into sessions and lets time, temperature, angle and cycles go on.
void schedule(const Plan& plan, std::vector<Condition>& rows, DeterministicRandom& random) {
  random.shuffle(rows);
  if (plan.load_by_session) {
    std::stable_sort(rows.begin(), rows.end(), [](const Condition& a, const Condition& b) {
      return a.output_torque_Nm < b.output_torque_Nm;
    });
  }
  const std::size_t sessions = static_cast<std::size_t>(std::max(1, plan.sessions));
  const double warm_up_s =
      60.0 * static_cast<double>(rows.size()) / static_cast<double>(sessions) / 3.0;
  double time = 0.0, angle = random.between(0.0, 360.0), cycles = 0.0, start = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int session = static_cast<int>(i * sessions / rows.size());
    time += random.between(45.0, 75.0);
    if (i > 0 && session != rows[i - 1].session) {
      time += plan.session_gap_s;
      start = time;
    }
    angle += 360.0 * random.between(0.5, 3.0);
    cycles += random.between(500.0, 1500.0);
    Condition& row = rows[i];
    row.session = session;
    row.time_s = rounded(time, 0.01);
    row.output_angle_deg = rounded(angle, 1e-4);
    row.cycles = rounded(cycles, 1.0);
    const double warm = plan.kind == Kind::lost_motion
                            ? random.uniform()  // a climate chamber
                            : 1.0 - std::exp(-(time - start) / warm_up_s);
    row.temperature_c = rounded(plan.cold_c + (plan.warm_c - plan.cold_c) * warm, 1e-3);
  }
}

std::vector<Condition> rows_of(const Plan& plan, DeterministicRandom& random) {
  if (plan.torques_Nm.empty()) throw std::invalid_argument("a plan needs torques");
  if (plan.kind == Kind::torque_angle) return loop_rows(plan);
  std::vector<Condition> rows = plan.kind == Kind::lost_motion ? lost_motion_rows(plan)
                                : plan.kind == Kind::pair_loss ? pair_rows(plan)
                                                               : transmission_rows(plan, random);
  if (rows.empty()) throw std::invalid_argument("the plan has no rows");
  schedule(plan, rows, random);
  return rows;
}

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// Amplitude with which a cause alone changes the rows by so much (secant on rms/amplitude).
double find_amplitude(const HiddenCause& cause, const Bench& bench,
                      const std::vector<Condition>& rows, const std::vector<double>& without,
                      double noise_sd) {
  const double target = std::fabs(*cause.rms_in_noise) * noise_sd;
  if (target == 0.0) return 0.0;
  const double sign = *cause.rms_in_noise < 0.0 ? -1.0 : 1.0;
  const auto excess = [&](double amplitude) {
    Effects effects;
    add_cause(effects, cause, sign * amplitude, bench.kind, bench.train);
    return rms_difference(responses(bench, rows, effects), without) - target;
  };
  const auto fail = [&]() -> double {
    throw std::invalid_argument("cause " + cause.id + " cannot change these rows by " +
                                number_text(*cause.rms_in_noise, 6) +
                                " standard deviations of the noise");
  };
  double a = 0.0, fa = -target;
  double b = usual_amplitude(cause, bench.kind, noise_sd);
  double fb = excess(b);
  if (!(fb > -target)) return fail();
  for (int i = 0; i < 60; ++i) {
    if (std::fabs(fb) <= 1e-10 * target) return sign * b;
    double next = b - fb * (b - a) / (fb - fa);
    if (!(next > 0.0) || !(next < 10.0 * b)) next = fb < 0.0 ? 3.0 * b : 0.5 * b;
    a = b;
    fa = fb;
    b = next;
    fb = excess(b);
    if (!std::isfinite(fb)) return fail();
  }
  return fail();
}

double draw_noise(const Plan& plan, DeterministicRandom& random) {
  return plan.noise == Noise::student ? random.student3() : random.normal();
}

void append_row(std::string& csv, const Plan& plan, const Condition& row, double value,
                double sigma, const std::string& run) {
  const auto put = [&](double number, int digits = 0) {
    csv += number_text(number, digits);
    csv += ',';
  };
  constexpr int kDigits = 9;
  switch (plan.kind) {
    case Kind::transmission:
      csv += row.forward ? "forward," : "backward,";
      put(row.sun_speed_rpm);
      put(row.output_torque_Nm);
      put(value, kDigits);
      if (plan.rotation) put(row.rotation);
      if (plan.angle) put(row.output_angle_deg, 12);
      if (plan.temperature) put(row.temperature_c, kDigits);
      if (plan.time) put(row.time_s, kDigits);
      break;
    case Kind::lost_motion:
      put(row.output_angle_deg, 12);
      put(row.output_torque_Nm);
      put(value, kDigits);
      if (plan.temperature) put(row.temperature_c, kDigits);
      if (plan.cycles) put(row.cycles, kDigits);
      if (plan.time) put(row.time_s, kDigits);
      break;
    case Kind::torque_angle:
      put(row.time_s, kDigits);
      put(value / 60.0, kDigits);
      put(row.output_torque_Nm, kDigits);
      break;
    case Kind::pair_loss:
      put(row.driving_teeth);
      put(row.driven_teeth);
      put(value, kDigits);
      put(plan.pair_module_mm);
      break;
  }
  if (plan.sigma && plan.kind != Kind::torque_angle) put(sigma, kDigits);
  if (plan.run) {
    csv += run;
    csv += ',';
  }
  csv.back() = '\n';
}

std::string head_of(const Plan& plan) {
  std::string head;
  switch (plan.kind) {
    case Kind::transmission:
      head = "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,";
      if (plan.rotation) head += "rotation,";
      if (plan.angle) head += "output_angle_deg,";
      if (plan.temperature) head += "temperature_c,";
      if (plan.time) head += "time_s,";
      if (plan.sigma) head += "sigma_nm,";
      break;
    case Kind::lost_motion:
      head = "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin,";
      if (plan.temperature) head += "temperature_c,";
      if (plan.cycles) head += "cycles,";
      if (plan.time) head += "time_s,";
      if (plan.sigma) head += "sigma_arcmin,";
      break;
    case Kind::torque_angle:
      head = "# kind: torque_angle\n# locked: sun\ntime_s,angle_deg,torque_nm,";
      break;
    case Kind::pair_loss:
      head = "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,module_mm,";
      if (plan.sigma) head += "sigma,";
      break;
  }
  if (plan.run) head += "run,";
  head.back() = '\n';
  return head;
}

Bench make_bench(const Gearbox& gearbox, const Plan& plan) {
  return {.train = make_train(gearbox),
          .kind = plan.kind,
          .pair_module_mm = plan.pair_module_mm,
          .hysteresis_Nm = plan.hysteresis_Nm};
}

// Adds noise to the rows' clean responses and writes them.
void record(const Plan& plan, DeterministicRandom& random, const std::string& run_label,
            Dataset& data) {
  const std::size_t n = data.clean.size();
  double mean = 0.0;
  for (const double value : data.clean) mean += std::fabs(value) / static_cast<double>(n);
  std::vector<double> session_offset;
  if (plan.noise == Noise::session_offsets) {
    int last = 0;
    for (const Condition& row : data.conditions) last = std::max(last, row.session);
    for (int s = 0; s <= last; ++s) session_offset.push_back(0.5 * data.noise_sd * random.normal());
  }
  data.csv = head_of(plan);
  data.csv.reserve(n * 100);
  data.measured.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Condition& row = data.conditions[i];
    double sigma = data.noise_sd;
    if (plan.noise == Noise::proportional) sigma *= std::fabs(data.clean[i]) / mean;
    double value = data.clean[i] + sigma * draw_noise(plan, random);
    if (!session_offset.empty()) value += session_offset[static_cast<std::size_t>(row.session)];
    data.measured.push_back(value);
    std::string run = run_label;
    if (run.empty()) {
      run += 's';
      run += std::to_string(row.session + 1);
    }
    append_row(data.csv, plan, row, value, sigma, run);
  }
}

double single(const Gearbox& gearbox, Kind kind, double module_mm, const Condition& condition,
              const std::vector<HiddenCause>& causes) {
  Plan plan;
  plan.kind = kind;
  plan.pair_module_mm = module_mm;
  const Bench bench = make_bench(gearbox, plan);
  Effects effects;
  for (const HiddenCause& cause : causes) {
    if (!cause.amplitude) throw std::invalid_argument("cause " + cause.id + " has no amplitude");
    add_cause(effects, cause, *cause.amplitude, kind, bench.train);
  }
  return responses(bench, {condition}, effects).front();
}

}  // namespace

Plan transmission_plan() { return {}; }

Plan lost_motion_plan() {
  Plan plan;
  plan.kind = Kind::lost_motion;
  plan.torques_Nm = {1.0, 2.0, 3.0, 4.0, 5.0};
  plan.cold_c = 15.0;
  plan.warm_c = 45.0;
  return plan;
}

Plan torque_angle_plan() {
  Plan plan;
  plan.kind = Kind::torque_angle;
  plan.torques_Nm = {5.0};
  plan.sessions = 1;
  return plan;
}

Plan pair_loss_plan() {
  Plan plan;
  plan.kind = Kind::pair_loss;
  plan.relative_noise = 0.05;
  return plan;
}

Dataset measure(const Gearbox& gearbox, const Plan& plan, const std::vector<HiddenCause>& causes,
                std::uint64_t seed) {
  DeterministicRandom order(seed), phases(seed ^ 0x5DEECE66DULL), noise(seed ^ 0xA5A5A5A5ULL);
  const Bench bench = make_bench(gearbox, plan);
  Dataset data;
  data.conditions = rows_of(plan, order);
  const std::vector<double> without = responses(bench, data.conditions, {});
  double mean = 0.0;
  for (const double value : without) mean += std::fabs(value);
  data.noise_sd = plan.relative_noise * mean / static_cast<double>(without.size());

  Effects effects;
  for (HiddenCause cause : causes) {
    const double phase = 2.0 * std::numbers::pi * phases.uniform();
    if (!cause.phase_rad) cause.phase_rad = phase;
    if (!cause.from_session) cause.from_session = plan.sessions / 2;
    if (cause.id == "run_step" &&
        (*cause.from_session < 1 || *cause.from_session >= plan.sessions)) {
      throw std::invalid_argument("a run_step needs sessions before and after it");
    }
    if (!cause.duration_s) cause.duration_s = data.conditions.back().time_s;
    if (!cause.cycles && plan.kind == Kind::lost_motion && plan.cycles && cause.id == "drift") {
      cause.cycles = data.conditions.back().cycles;
    }
    if (!cause.amplitude) {
      if (!cause.rms_in_noise) {
        throw std::invalid_argument("cause " + cause.id + " has neither amplitude nor rms");
      }
      cause.amplitude = find_amplitude(cause, bench, data.conditions, without, data.noise_sd);
    }
    add_cause(effects, cause, *cause.amplitude, plan.kind, bench.train);
    Truth truth = truth_of(cause, *cause.amplitude, plan.kind, bench.train);
    Effects alone;
    add_cause(alone, cause, *cause.amplitude, plan.kind, bench.train);
    truth.rms_in_noise =
        rms_difference(responses(bench, data.conditions, alone), without) / data.noise_sd;
    data.truth.push_back(std::move(truth));
    data.causes.push_back(std::move(cause));
  }
  data.clean = responses(bench, data.conditions, effects);
  record(plan, noise, "", data);
  return data;
}

Dataset measure_conditions(const Gearbox& gearbox, const Plan& plan,
                           const std::vector<Condition>& conditions,
                           const std::vector<HiddenCause>& causes, double noise_sd,
                           std::uint64_t seed, const std::string& run_label) {
  const Bench bench = make_bench(gearbox, plan);
  DeterministicRandom noise(seed ^ 0xC3C3C3C3ULL);
  Dataset data;
  data.noise_sd = noise_sd;
  for (const Condition& condition : conditions) {
    for (int r = 0; r < condition.repeats; ++r) data.conditions.push_back(condition);
  }
  if (data.conditions.empty()) throw std::invalid_argument("no conditions to measure");
  Effects effects;
  for (const HiddenCause& cause : causes) {
    if (!cause.amplitude) throw std::invalid_argument("cause " + cause.id + " has no amplitude");
    add_cause(effects, cause, *cause.amplitude, plan.kind, bench.train);
    data.truth.push_back(truth_of(cause, *cause.amplitude, plan.kind, bench.train));
  }
  data.causes = causes;
  data.clean = responses(bench, data.conditions, effects);
  record(plan, noise, run_label, data);
  return data;
}

double sun_torque(const Gearbox& gearbox, const Condition& condition,
                  const std::vector<HiddenCause>& causes) {
  return single(gearbox, Kind::transmission, 1.0, condition, causes);
}

double lost_motion_arcmin(const Gearbox& gearbox, const Condition& condition,
                          const std::vector<HiddenCause>& causes) {
  return single(gearbox, Kind::lost_motion, 1.0, condition, causes);
}

double pair_loss(const Gearbox& gearbox, double module_mm, const Condition& condition,
                 const std::vector<HiddenCause>& causes) {
  return single(gearbox, Kind::pair_loss, module_mm, condition, causes);
}

}  // namespace gear3k::rig
