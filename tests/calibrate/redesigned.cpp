#include "tests/calibrate/redesigned.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "app/diagnose.hpp"
#include "io/files/measurement_file.hpp"
#include "tests/calibrate/built_design.hpp"
#include "tests/wide_rig/hidden_effect.hpp"
#include "tests/wide_rig/measurement_text.hpp"
#include "tests/wide_rig/sensor_noise.hpp"
#include "tests/wide_rig/strength_search.hpp"
#include "tests/wide_rig/test_plan.hpp"
#include "units/units.hpp"

namespace gear3k::wide_rig {

namespace {

constexpr const char* kKind = "transmission";

BenchSubject subject_of(const design::Design& design) {
  const rig::Gearbox gearbox = rig::built(design);
  BenchSubject subject;
  subject.train = rig::make_train(gearbox);
  subject.ratio = subject.train.ratio;
  subject.friction = gearbox.friction;
  return subject;
}

Span span_of(const std::vector<BenchRow>& rows, double BenchRow::*field) {
  const auto [low, high] = std::ranges::minmax(rows, {}, field);
  return {low.*field, high.*field};
}

double root_mean_square(const std::vector<double>& values) {
  double square = 0.0;
  for (const double v : values) square += v * v;
  return std::sqrt(square / static_cast<double>(values.size()));
}

/// A campaign's text, and what is true of its bench.
struct Measured {
  std::string csv;
  HiddenEffect effect;
  double amplitude = 0.0;
  BenchRow point;  ///< where the designs are compared
};

Measured measure(const BenchSubject& subject, const HiddenLaw& hidden,
                 rig::DeterministicRandom& random) {
  constexpr std::array<const char*, 4> kPlans{"crossed", "crossed", "by_session", "even_angles"};
  const std::string plan_name =
      hidden.plan.empty() ? kPlans[random.index(kPlans.size())] : hidden.plan;
  TestPlan plan = make_plan(kKind, plan_name, subject, 0, random);
  if (plan.rows.size() > hidden.rows) plan.rows.resize(hidden.rows);
  const auto clean_of = [&](const std::vector<AppliedEffect>& effects) {
    std::vector<double> values;
    values.reserve(plan.rows.size());
    for (const BenchRow& row : plan.rows) values.push_back(sun_torque(subject, row, effects).value);
    return values;
  };
  const std::vector<double> nominal = clean_of({});
  const SensorNoise noise = random_noise("", root_mean_square(nominal), 0.02, random);
  std::vector<double> sigma;
  sigma.reserve(nominal.size());
  for (const double v : nominal) sigma.push_back(sigma_of(noise, v));

  EffectContext context{.subject = &subject, .kind = kKind};
  context.load_Nm = span_of(plan.rows, &BenchRow::output_torque_Nm);
  context.speed_rpm = span_of(plan.rows, &BenchRow::sun_speed_rpm);
  context.temperature_c = span_of(plan.rows, &BenchRow::temperature_c);
  context.sessions = plan.sessions;
  context.typical = root_mean_square(nominal);
  context.turns = plan.turns;
  Measured result{.csv = {},
                  .effect = make_effect(hidden.cause, hidden.law, context, random),
                  .amplitude = 0.0,
                  .point = {}};
  const double strength = 3.0 * std::pow(25.0 / 3.0, random.uniform());
  const double change = random.between(0.2, 0.6) * (random.uniform() < 0.5 ? -1.0 : 1.0);
  result.amplitude = hidden.cause == "friction_level"
                         ? change
                         : amplitude_for(subject, kKind, plan.rows, result.effect,
                                         root_mean_square(sigma), strength)
                               .amplitude;
  std::vector<double> readings;
  wide_rig::NoisyReadings sensor(noise);
  const std::vector<double> clean = clean_of({{&result.effect, result.amplitude}});
  for (std::size_t i = 0; i < clean.size(); ++i) {
    readings.push_back(std::max(sensor.read(clean[i], plan.rows[i].session, random), 1e-9));
  }
  plan.columns.sigma = random.uniform() < 0.3;
  if (hidden.few_columns) {
    plan.columns.angle = plan.columns.time = plan.columns.run = plan.columns.temperature = false;
  }
  result.csv = measurement_text(kKind, plan.columns, plan.rows, readings, sigma);

  const auto within = [&](const Span& span) {
    return span.low + random.between(0.2, 0.8) * (span.high - span.low);
  };
  result.point.output_torque_Nm = std::round(within(context.load_Nm));
  result.point.sun_speed_rpm = std::round(within(context.speed_rpm));
  result.point.temperature_c = std::round(within(context.temperature_c));
  result.point.housing_c = result.point.temperature_c;
  return result;
}

/// Efficiency on the bench, without noise.
double true_efficiency(const design::Design& design, const BenchSubject& first, bool forward,
                       const Measured& measured) {
  BenchSubject subject = subject_of(design);
  subject.train.pin_radius_m = first.train.pin_radius_m;
  BenchRow row = measured.point;
  row.forward = forward;
  const double lossless_Nm = row.output_torque_Nm / std::abs(subject.ratio);
  const double torque_Nm = sun_torque(subject, row, {{&measured.effect, measured.amplitude}}).value;
  return forward ? lossless_Nm / torque_Nm : torque_Nm / lossless_Nm;
}

}  // namespace

FirstDesign first_design(const optimize::Specification& spec) {
  app::OptimizeTask task = app::optimize_task({.spec = spec, .certify = true});
  optimize::Progress progress;
  const app::Optimization run = app::optimize(task, {}, progress);
  if (!run.best) throw std::invalid_argument("first_design: nothing is feasible");
  return {.spec = spec, .design = run.best->stated};
}

bool Redesigned::covered() const {
  if (!change.gain || !change.gain->ci90) return false;
  const auto [low, high] = *change.gain->ci90;
  return low <= true_gain && true_gain <= high;
}

Redesigned redesigned(const FirstDesign& first, const HiddenLaw& hidden, std::uint64_t seed) {
  rig::DeterministicRandom random(seed);
  const BenchSubject subject = subject_of(first.design);
  const Measured measured = measure(subject, hidden, random);
  const auto diagnosis = app::diagnose(
      app::diagnosis_task(
          {.subject = first.design,
           .data = io::parse_measurements({{.path = "campaign.csv", .text = measured.csv}})}),
      {});
  Redesigned result;
  for (const calibrate::Effect& effect : diagnosis->front().effects) {
    result.answer += (result.answer.empty() ? "" : " + ") + effect.id + ":" + effect.form.name;
    if (!effect.alternatives.empty()) result.answer += " or " + effect.alternatives.front().id;
  }
  optimize::Specification spec = first.spec;
  spec.operating_point =
      design::OperatingPoint<double>{.sun_speed_rad_s = measured.point.sun_speed_rpm * units::kRpm,
                                     .output_torque_Nm = measured.point.output_torque_Nm,
                                     .temperature_K = measured.point.temperature_c + 273.15};
  const bool forward = random.uniform() < 0.5;
  spec.objectives = {forward ? optimize::Objective::kForwardEfficiency
                             : optimize::Objective::kBackwardEfficiency};
  app::OptimizeTask task = app::optimize_task(
      {.spec = spec, .model = app::model_of({diagnosis->front().model}, "model.toml")});
  optimize::Progress progress;
  const app::Optimization run = app::optimize(task, {}, progress);
  if (!run.comparison || !run.comparison->change) {
    throw std::invalid_argument("redesigned: " + run.comparison->missing);
  }
  result.change = *run.comparison->change;
  result.true_gain = true_efficiency(result.change.after.stated, subject, forward, measured) -
                     true_efficiency(result.change.before.stated, subject, forward, measured);
  return result;
}

}  // namespace gear3k::wide_rig
