#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "tests/wide_rig/alternatives.hpp"
#include "tests/wide_rig/hidden_effect.hpp"
#include "tests/wide_rig/measurement_text.hpp"
#include "tests/wide_rig/sensor_noise.hpp"
#include "tests/wide_rig/strength_search.hpp"
#include "tests/wide_rig/test_plan.hpp"
#include "tests/wide_rig/torque_angle_record.hpp"
#include "tests/wide_rig/wide_rig.hpp"

namespace gear3k::wide_rig {
namespace {

// Expected difference of chi-square below which two explanations count as equal.
constexpr double kAsGood = 9.0;
// ... and above which a cause is ruled out, with a twentieth of the effect's own.
constexpr double kRuledOut = 60.0, kRuledOutShare = 0.05;

std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

// "" any law of the cause, "friction_*" those that begin so.
std::string drawn_law(const HiddenCause& hidden, const std::string& kind,
                      rig::DeterministicRandom& random) {
  if (!hidden.law.empty() && hidden.law.back() != '*') return hidden.law;
  const std::string start = hidden.law.empty() ? "" : hidden.law.substr(0, hidden.law.size() - 1);
  std::vector<std::string> fitting;
  for (const std::string& law : laws_of(hidden.cause, kind)) {
    if (law.compare(0, start.size(), start) == 0) fitting.push_back(law);
  }
  if (fitting.empty()) throw std::invalid_argument("no law of " + hidden.cause + " in " + kind);
  return fitting[random.index(fitting.size())];
}

bool has_cause(const std::vector<HiddenCause>& hidden, std::initializer_list<const char*> causes) {
  for (const HiddenCause& one : hidden) {
    for (const char* cause : causes) {
      if (one.cause == cause) return true;
    }
  }
  return false;
}

bool has_law(const std::vector<HiddenCause>& hidden, const std::string& part) {
  for (const HiddenCause& one : hidden) {
    if (one.law.find(part) != std::string::npos) return true;
  }
  return false;
}

// A plan in which a competent engineer can tell the causes apart.
std::string chosen_plan(const std::string& kind, const std::vector<HiddenCause>& hidden,
                        rig::DeterministicRandom& random) {
  std::vector<std::string> plans{"crossed"};
  if (kind == "torque_angle") return "loops";
  const bool wave = has_cause(hidden, {"runout", "mesh_order"});
  const bool warm = has_cause(hidden, {"friction_temperature", "thermal_expansion"}) ||
                    has_law(hidden, "warming");
  if (kind == "pair_loss") {
    if (has_cause(hidden, {"run_step"})) return "by_session";
  } else if (kind == "lost_motion") {
    if (wave) plans = {"crossed", "even_angles"};
    if (!wave && !warm) plans = {"crossed", "crossed", "by_session", "even_angles"};
  } else if (wave) {
    plans = {"crossed", "even_angles"};
  } else if (has_cause(hidden, {"run_step"})) {
    plans = {"crossed", "by_session"};
    if (warm) plans = {"crossed"};
  } else if (warm) {
    plans = {"crossed", "crossed", "sun_torque_set"};
  } else if (has_cause(hidden, {"friction_load"})) {
    plans = {"crossed", "crossed", "even_angles", "sun_torque_set"};
  } else {
    plans = {"crossed", "crossed", "crossed", "by_session", "even_angles", "sun_torque_set"};
  }
  return plans[random.index(plans.size())];
}

// Which optional columns the file has; those that a cause or a plan lives on stay.
void choose_columns(BenchColumns& columns, const std::string& kind, const std::string& plan,
                    int sessions, const std::vector<HiddenCause>& hidden,
                    rig::DeterministicRandom& random) {
  const auto drop = [&](bool& column, double share, bool needed) {
    const double drawn = random.uniform();
    if (drawn < share && !needed) column = false;
  };
  if (kind == "pair_loss") return;
  const bool unknown = has_cause(hidden, {"unknown"});
  drop(columns.temperature, 0.15,
       unknown || has_cause(hidden, {"friction_temperature", "thermal_expansion"}) ||
           has_law(hidden, "warming") || plan.find("temperature") != std::string::npos ||
           plan.find("warming") != std::string::npos);
  drop(columns.time, 0.15, has_cause(hidden, {"drift"}) || has_law(hidden, "creeping"));
  drop(columns.run, 0.2, has_cause(hidden, {"run_step"}) || sessions > 1);
  if (sessions == 1) columns.run = columns.run && random.uniform() < 0.5;
  if (kind == "transmission") {
    drop(columns.angle, 0.25, unknown || has_cause(hidden, {"runout", "mesh_order"}));
  }
}

Span span_of(const std::vector<BenchRow>& rows, double BenchRow::*field) {
  Span span{1e300, -1e300};
  for (const BenchRow& row : rows) {
    span.low = std::min(span.low, row.*field);
    span.high = std::max(span.high, row.*field);
  }
  return span;
}

double root_mean_square(const std::vector<double>& values) {
  double square = 0.0;
  for (const double v : values) square += v * v;
  return std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

std::vector<double> clean_of(const BenchSubject& subject, const std::string& kind,
                             const std::vector<BenchRow>& rows,
                             const std::vector<AppliedEffect>& effects) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const BenchRow& row : rows) {
    values.push_back(clean_reading(subject, kind, row, effects).value);
  }
  return values;
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

// The output torque at which the sun's sensor reads the torque that was set.
double output_torque_for(const BenchSubject& subject, BenchRow row, double set_Nm,
                         const std::vector<AppliedEffect>& effects) {
  double low = row.output_torque_Nm;
  double at_low = sun_torque(subject, row, effects).value - set_Nm;
  row.output_torque_Nm = low * (1.0 - 0.5 * at_low / set_Nm);
  if (row.output_torque_Nm == low) return low;
  for (int i = 0; i < 40; ++i) {
    const double high = row.output_torque_Nm;
    const double at_high = sun_torque(subject, row, effects).value - set_Nm;
    if (std::fabs(at_high) < 1e-12 * set_Nm || at_high == at_low) break;
    const double next = high - at_high * (high - low) / (at_high - at_low);
    low = high;
    at_low = at_high;
    row.output_torque_Nm = std::clamp(next, 0.2 * high, 5.0 * high);
  }
  return row.output_torque_Nm;
}

// The bench at work: subject, rows and effects together.
struct Bench {
  BenchSubject subject{};
  TestPlan plan{};
  SensorNoise noise{};
  std::vector<HiddenEffect> effects{};
  std::vector<AppliedEffect> applied{};
  std::vector<double> sigma{};  // per row, unit of the response
};

// Noise per row in the unit of the response, from the readings that the sensor sees.
void set_sigma(Bench& bench, const std::string& kind) {
  const std::vector<double> clean = clean_of(bench.subject, kind, bench.plan.rows, {});
  bench.sigma.clear();
  for (std::size_t i = 0; i < clean.size(); ++i) {
    const double torque_Nm = bench.plan.rows[i].output_torque_Nm;
    bench.sigma.push_back(bench.plan.sun_torque_set
                              ? sigma_of(bench.noise, torque_Nm) * clean[i] / torque_Nm
                              : sigma_of(bench.noise, clean[i]));
  }
}

double chi_square_of(const std::vector<double>& effect) {
  double sum = 0.0;
  for (const double v : effect) sum += v * v;
  return sum;
}

// What explains each truth as well, and what explains nothing that is in these data.
class Verdicts {
 public:
  Verdicts(const Bench& bench, const std::string& kind, const std::vector<BenchRow>& rows,
           const BenchColumns& columns, const std::vector<double>& sigma)
      : shapes_(usual_shapes(bench.subject, kind, rows, columns, sigma)) {
    // Each effect in the presence of the others, so that their products are told too.
    const std::vector<double> full = clean_of(bench.subject, kind, rows, bench.applied);
    for (std::size_t t = 0; t < bench.applied.size(); ++t) {
      std::vector<AppliedEffect> others = bench.applied;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(t));
      std::vector<double> effect = difference(full, clean_of(bench.subject, kind, rows, others));
      for (std::size_t i = 0; i < effect.size(); ++i) effect[i] /= sigma[i];
      effects_.push_back(std::move(effect));
    }
  }

  void judge(Campaign& campaign) {
    for (std::size_t t = 0; t < campaign.truths.size(); ++t) judge_truth(campaign, t);
    for (const std::string& cause : campaign.companions) judge_companion(cause);
    for (const CauseShape& shape : shapes_.shapes) {
      if (!possible_.insert(shape.cause).second) continue;
      campaign.excluded.push_back(shape.cause);
    }
  }

 private:
  void judge_truth(Campaign& campaign, std::size_t t) {
    Truth& truth = campaign.truths[t];
    std::vector<std::vector<double>> others = effects_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(t));
    const bool is_level = truth.cause == "friction_level";
    if (truth.cause != "unknown") truth.acceptable.push_back(truth.cause);
    possible_.insert(truth.cause);
    const double order = order_of(truth);
    if (order > 0.0) {
      for (const OrderAsGood& o : orders_as_good(shapes_, effects_[t], others, order, kAsGood)) {
        campaign.orders.push_back({o.cause, o.body.substr(0, o.body.find(' ')), o.order});
        possible_.insert(o.cause);
        const auto& known = truth.acceptable;
        if (std::find(known.begin(), known.end(), o.cause) == known.end()) {
          truth.acceptable.push_back(o.cause);
        }
      }
    }
    const auto all = left_over(shapes_, effects_[t], others, is_level);
    for (const LeftOver& left : all) {
      if (left.chi_square < kAsGood && left.cause != truth.cause) {
        truth.acceptable.push_back(left.cause);
        // Put in its place with another coefficient of friction.
        if (!is_level && !shapes_.always.empty()) add_companion(campaign, "friction_level");
      }
      keep_possible(left, chi_square_of(effects_[t]));
      if (left.cause == truth.cause && left.chi_square > kAsGood) judge_rest(left);
    }
  }

  // Periods per turn of the output of a wave, else 0.
  static double order_of(const Truth& truth) {
    for (const TruthParameter& p : truth.parameters) {
      if (p.name == "order") return p.value;
    }
    return 0.0;
  }

  // What the plainest shapes of the cause itself leave may be given to others.
  void judge_rest(const LeftOver& own) {
    for (const LeftOver& left : left_over(shapes_, own.rest, {}, false)) {
      if (left.chi_square < 0.9 * own.chi_square) possible_.insert(left.cause);
    }
  }

  // A companion may be told as any cause that does the same; its size is its share of the effects.
  void judge_companion(const std::string& cause) {
    possible_.insert(cause);
    static const std::set<std::string> constant{"friction_level", "clearance",
                                                "sensor_gain",    "sensor_offset",
                                                "drag_constant",  "friction_direction"};
    if (constant.count(cause) == 0) return;
    for (const CauseShape& shape : shapes_.shapes) {
      if (shape.cause != cause || shape.columns.size() != 1) continue;
      const std::vector<double>& column = shape.columns.front();
      double share = 0.0, square = chi_square_of(column);
      for (const std::vector<double>& effect : effects_) {
        for (std::size_t i = 0; i < column.size(); ++i) share += std::fabs(effect[i] * column[i]);
      }
      std::vector<double> part = column;
      for (double& v : part) v *= square > 0.0 ? share / square : 0.0;
      const double all = chi_square_of(part);
      for (const LeftOver& left : left_over(shapes_, part, {}, cause == "friction_level")) {
        keep_possible(left, all);
      }
    }
  }

  void keep_possible(const LeftOver& left, double all) {
    if (left.chi_square < std::max(kRuledOut, kRuledOutShare * all)) possible_.insert(left.cause);
  }

  static void add_companion(Campaign& campaign, const std::string& cause) {
    auto& list = campaign.companions;
    if (std::find(list.begin(), list.end(), cause) == list.end()) list.push_back(cause);
  }

  Alternatives shapes_;
  std::vector<std::vector<double>> effects_;  // over sigma
  std::set<std::string> possible_;
};

void judge(Campaign& campaign, const Bench& bench, const std::string& kind,
           const std::vector<BenchRow>& rows, const BenchColumns& columns,
           const std::vector<double>& sigma) {
  if (campaign.truths.empty()) return;
  Verdicts(bench, kind, rows, columns, sigma).judge(campaign);
}

void add_truths(Campaign& campaign, const Bench& bench, const std::vector<double>& strengths) {
  std::set<std::string> companions;
  for (std::size_t t = 0; t < bench.effects.size(); ++t) {
    const HiddenEffect& effect = bench.effects[t];
    Truth truth{.cause = effect.cause,
                .law = effect.law,
                .acts_on = effect.acts_on,
                .acceptable = {},
                .parameters = {},
                .strength = strengths[t]};
    for (const auto& p : effect.parameters) {
      truth.parameters.push_back({p.name, p.unit, p.base + p.slope * bench.applied[t].amplitude});
    }
    companions.insert(effect.companions.begin(), effect.companions.end());
    campaign.truths.push_back(std::move(truth));
  }
  campaign.companions.assign(companions.begin(), companions.end());
}

void draw_effects(Bench& bench, const std::vector<HiddenCause>& hidden,
                  const EffectContext& context, rig::DeterministicRandom& random) {
  for (const HiddenCause& one : hidden) {
    bench.effects.push_back(make_effect(one.cause, one.law, context, random));
  }
}

// Amplitudes of the effects, each scaled by itself; their strengths.
std::vector<double> scale_effects(Bench& bench, const std::string& kind,
                                  const std::vector<BenchRow>& rows, double noise_sd,
                                  double strength) {
  bench.applied.clear();
  std::vector<double> strengths;
  for (const HiddenEffect& effect : bench.effects) {
    const FoundAmplitude found =
        amplitude_for(bench.subject, kind, rows, effect, noise_sd, strength);
    bench.applied.push_back({&effect, found.amplitude});
    strengths.push_back(found.strength);
  }
  // Together they may leave what each by itself does not: all weaker, by the same factor.
  const auto possible = [&] {
    return std::all_of(rows.begin(), rows.end(), [&](const BenchRow& row) {
      return clean_reading(bench.subject, kind, row, bench.applied).physical;
    });
  };
  for (int i = 0; i < 12 && bench.applied.size() > 1 && !possible(); ++i) {
    for (AppliedEffect& applied : bench.applied) applied.amplitude *= 0.8;
    for (double& s : strengths) s *= 0.8;
  }
  return strengths;
}

// Sun torques are set: the loads follow from the effects, and the strength from the loads. Where a
// gearbox comes near to locking, so that loads run away, the effects are made weaker.
std::vector<double> scale_at_set_torques(Bench& bench, const std::string& kind, double strength) {
  std::vector<BenchRow>& rows = bench.plan.rows;
  const std::vector<BenchRow> at_first = rows;
  for (int attempt = 0; attempt < 12 && !bench.effects.empty(); ++attempt) {
    bool near = true;
    rows = at_first;
    set_sigma(bench, kind);
    for (int round = 0; round < 4 && near; ++round) {
      scale_effects(bench, kind, rows, root_mean_square(bench.sigma), strength);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double load_Nm =
            output_torque_for(bench.subject, rows[i], bench.plan.set_torques_Nm[i], bench.applied);
        const double share = load_Nm / at_first[i].output_torque_Nm;
        near = near && share > 0.6 && share < 1.6;
        rows[i].output_torque_Nm = load_Nm;
      }
      set_sigma(bench, kind);
    }
    if (near) break;
    strength *= 0.7;
  }
  const std::vector<double> nominal = clean_of(bench.subject, kind, rows, {});
  std::vector<double> strengths;
  for (const AppliedEffect& applied : bench.applied) {
    const auto alone = difference(clean_of(bench.subject, kind, rows, {applied}), nominal);
    strengths.push_back(root_mean_square(alone) / root_mean_square(bench.sigma));
  }
  return strengths;
}

Campaign loop_campaign(const Line& line, const std::vector<HiddenCause>& hidden, double strength,
                       rig::DeterministicRandom& random) {
  Bench bench{.subject = random_gearbox(random, true)};
  const bool steps = has_cause(hidden, {"run_step"});
  const bool drifts = has_cause(hidden, {"drift"});
  const int loops = steps ? 6 + static_cast<int>(random.index(3))
                          : (drifts ? 5 : 2) + static_cast<int>(random.index(drifts ? 4 : 7));
  const int sessions = steps ? 2 + static_cast<int>(random.index(2)) : 1;
  const double play = lost_motion(bench.subject, {}, {}).value;
  const LoopBench loop_bench = random_loop_bench(loops, play, random);
  const std::vector<BenchRow> rows = loop_conditions(loop_bench, sessions);
  EffectContext context{.subject = &bench.subject, .kind = "torque_angle"};
  context.test_torque_Nm = {0.3 * loop_bench.peak_Nm, 0.8 * loop_bench.peak_Nm};
  context.sessions = sessions;
  context.typical = play;
  Campaign campaign{.subject_toml = bench.subject.toml,
                    .noise_sd = loop_bench.angle_noise_arcmin,
                    .kind = "torque_angle",
                    .plan = "loops",
                    .noise_model = "normal"};
  draw_effects(bench, hidden, context, random);
  const auto strengths = scale_effects(bench, "torque_angle", rows, campaign.noise_sd, strength);
  add_truths(campaign, bench, strengths);
  const auto effect = difference(clean_of(bench.subject, "torque_angle", rows, bench.applied),
                                 clean_of(bench.subject, "torque_angle", rows, {}));
  campaign.strength = root_mean_square(effect) / campaign.noise_sd;
  const BenchColumns columns{
      .rotation = false, .angle = false, .temperature = false, .time = true, .run = sessions > 1};
  // A row of a loop is a mean over many samples.
  const std::vector<double> sigma(rows.size(), campaign.noise_sd / 3.0);
  judge(campaign, bench, "lost_motion", rows, columns, sigma);
  campaign.files.push_back({line.kind + ".csv", loop_record(loop_bench, bench.subject,
                                                            bench.applied, sessions, random)});
  // What a test of lost motion at other torques would show at the end of the record.
  std::vector<BenchRow> unseen;
  for (int i = 0; i < 20; ++i) {
    BenchRow row = rows.back();
    row.test_torque_Nm = std::round(random.between(0.1, 1.0) * loop_bench.peak_Nm * 1e3) / 1e3;
    row.output_angle_deg = i;
    unseen.push_back(row);
  }
  campaign.unseen_clean = clean_of(bench.subject, "torque_angle", unseen, bench.applied);
  std::vector<double> readings;
  for (const double v : campaign.unseen_clean) {
    readings.push_back(v + campaign.noise_sd * random.normal());
  }
  campaign.unseen.push_back(
      {"unseen.csv",
       measurement_text("lost_motion",
                        {.rotation = false, .temperature = false, .time = false, .run = false},
                        unseen, readings, {})});
  return campaign;
}

}  // namespace

Campaign make_campaign(const Line& line, double strength, std::uint64_t seed) {
  rig::DeterministicRandom random(hash_of(line.name) ^ (seed * 0x9E3779B97F4A7C15ULL));
  std::vector<HiddenCause> hidden = line.hidden;
  for (HiddenCause& one : hidden) one.law = drawn_law(one, line.kind, random);
  if (line.kind == "torque_angle") return loop_campaign(line, hidden, strength, random);

  Bench bench;
  const bool needs_design = has_cause(hidden, {"mesh_order", "thermal_expansion"}) ||
                            has_law(hidden, "approach_recess") || has_law(hidden, "ring_meshes") ||
                            line.plan.starts_with("coarse_grid");
  bench.subject =
      line.kind == "pair_loss" ? random_pair(random) : random_gearbox(random, !needs_design);
  const std::string plan = line.plan.empty() ? chosen_plan(line.kind, hidden, random) : line.plan;
  const bool steps = has_cause(hidden, {"run_step"});
  const int least_sessions = !steps ? 0 : has_law(hidden, "one_step") ? 2 : 3;
  bench.plan = make_plan(line.kind, plan, bench.subject, least_sessions, random);
  std::vector<BenchRow>& rows = bench.plan.rows;
  BenchColumns columns = bench.plan.columns;
  choose_columns(columns, line.kind, plan, bench.plan.sessions, hidden, random);

  const std::vector<double> nominal = clean_of(bench.subject, line.kind, rows, {});
  std::vector<double> seen = nominal;
  if (bench.plan.sun_torque_set) {
    for (std::size_t i = 0; i < rows.size(); ++i) seen[i] = rows[i].output_torque_Nm;
  }
  // What soon makes readings of an efficiency above 1 is looked for with the better sensors.
  const bool bounded =
      has_cause(hidden, {"sensor_offset", "runout", "mesh_order", "friction_direction"}) ||
      has_law(hidden, "gain_") || has_law(hidden, "offset_");
  bench.noise = random_noise(line.noise, root_mean_square(seen), bounded ? 0.008 : 0.03, random);
  columns.sigma = random.uniform() < 0.3 && !bench.plan.sun_torque_set;
  set_sigma(bench, line.kind);

  EffectContext context{.subject = &bench.subject, .kind = line.kind};
  context.load_Nm = span_of(rows, &BenchRow::output_torque_Nm);
  context.speed_rpm = span_of(rows, &BenchRow::sun_speed_rpm);
  context.temperature_c = span_of(rows, &BenchRow::temperature_c);
  context.test_torque_Nm = span_of(rows, &BenchRow::test_torque_Nm);
  context.sessions = bench.plan.sessions;
  context.typical = root_mean_square(nominal);
  context.turns = bench.plan.turns;
  context.first_order = plan == "one_turn";
  context.orders = bench.plan.aliased_orders;
  draw_effects(bench, hidden, context, random);
  const auto strengths =
      bench.plan.sun_torque_set
          ? scale_at_set_torques(bench, line.kind, strength)
          : scale_effects(bench, line.kind, rows, root_mean_square(bench.sigma), strength);
  const double noise_sd = root_mean_square(bench.sigma);

  Campaign campaign{.subject_toml = bench.subject.toml,
                    .noise_sd = noise_sd,
                    .kind = line.kind,
                    .plan = plan,
                    .noise_model = bench.noise.model};
  add_truths(campaign, bench, strengths);
  const std::vector<double> clean = clean_of(bench.subject, line.kind, rows, bench.applied);
  campaign.strength =
      root_mean_square(difference(clean, clean_of(bench.subject, line.kind, rows, {}))) / noise_sd;
  judge(campaign, bench, line.kind, rows, columns, bench.sigma);

  std::vector<BenchRow> written = rows;
  std::vector<double> readings;
  NoisyReadings sensor(bench.noise);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (bench.plan.sun_torque_set) {
      const double read_Nm = sensor.read(rows[i].output_torque_Nm, rows[i].session, random);
      written[i].output_torque_Nm =
          std::max(std::round(read_Nm * 1e5) / 1e5, 0.05 * rows[i].output_torque_Nm);
      readings.push_back(bench.plan.set_torques_Nm[i]);
    } else {
      readings.push_back(std::max(sensor.read(clean[i], rows[i].session, random), 1e-9));
    }
  }
  // The stated deviation is the sensor's own at the reading without noise.
  campaign.files.push_back(
      {line.kind + ".csv", measurement_text(line.kind, columns, written, readings, bench.sigma)});

  campaign.clean = clean_of(bench.subject, line.kind, written, bench.applied);
  const auto further = [&](const char* name, const std::vector<BenchRow>& rows_there,
                           std::vector<double>& clean_there) -> File {
    clean_there = clean_of(bench.subject, line.kind, rows_there, bench.applied);
    std::vector<double> readings_there, sigma_there;
    for (const double v : clean_there) {
      const double sigma = bench.plan.sun_torque_set ? noise_sd : sigma_of(bench.noise, v);
      sigma_there.push_back(sigma);
      readings_there.push_back(std::max(v + sigma * random.normal(), 1e-9));
    }
    return {name, measurement_text(line.kind, columns, rows_there, readings_there, sigma_there)};
  };
  campaign.unseen.push_back(further("unseen.csv", bench.plan.unseen, campaign.unseen_clean));
  campaign.later.push_back(further("later.csv", bench.plan.later, campaign.later_clean));
  return campaign;
}

}  // namespace gear3k::wide_rig
