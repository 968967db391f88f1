#include "tests/series_rig/series_rig.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "tests/rig/deterministic_random.hpp"
#include "tests/wide_rig/bench_row.hpp"
#include "tests/wide_rig/bench_subject.hpp"
#include "tests/wide_rig/measurement_text.hpp"

namespace gear3k::series_rig {
namespace {

using wide_rig::AppliedEffect, wide_rig::BenchRow, wide_rig::BenchSubject, wide_rig::Channel,
    wide_rig::HiddenEffect, wide_rig::MeshPoint;

std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

double rounded(double value, double step) { return std::round(value / step) * step; }

// A law whose amplitude is the contract's parameter, and what is usual of it.
struct Law {
  HiddenEffect effect{};
  std::string parameter{};
  double usual = 1.0;
};

Law law_of(const std::string& cause, const BenchSubject& subject, double typical,
           double middle_load_Nm, double top_rpm) {
  Law law{.effect = {.cause = cause}};
  HiddenEffect& e = law.effect;
  if (cause == "friction_level") {
    e.channel = Channel::friction;
    e.value = [](double a, const BenchRow&, const MeshPoint&) { return a; };
    law.parameter = "relative_change";
  } else if (cause == "friction_load") {
    // mu falls or rises as a power of the force on the flanks, as stated at the middle load of the
    // mesh P1-R1.
    const double force =
        middle_load_Nm * subject.train.force_per_Nm[1] / subject.train.gearbox.planets;
    e.channel = Channel::friction;
    e.value = [force](double a, const BenchRow&, const MeshPoint& p) {
      return std::pow(p.force_N / force, a) - 1.0;
    };
    law.parameter = "exponent";
  } else if (cause == "drag_constant" || cause == "drag_viscous") {
    const bool viscous = cause == "drag_viscous";
    e.channel = Channel::drag;
    e.body = wide_rig::Body::sun;
    e.value = [viscous, top_rpm](double a, const BenchRow& row, const MeshPoint&) {
      return viscous ? a * row.sun_speed_rpm / top_rpm : a;
    };
    law.usual = typical;
    if (!viscous) law.parameter = "torque";
  } else if (cause == "clearance") {
    e.channel = Channel::lost_motion;
    e.value = [](double a, const BenchRow&, const MeshPoint&) { return a; };
    law.parameter = "extra_lost_motion";
    law.usual = typical;
  } else if (cause == "compliance") {
    e.channel = Channel::lost_motion;
    e.value = [](double a, const BenchRow& row, const MeshPoint&) {
      return a * row.test_torque_Nm;
    };
    law.usual = typical / 20.0;
  } else {
    throw std::invalid_argument("series rig: no cause '" + cause + "'");
  }
  return law;
}

double reading(const BenchSubject& subject, const std::string& kind, const BenchRow& row,
               const std::vector<AppliedEffect>& effects) {
  return kind == "transmission" ? wide_rig::sun_torque(subject, row, effects).value
                                : wide_rig::lost_motion(subject, row, effects).value;
}

// The programme of a gearbox: the same levels in every gearbox, in an order of its own.
std::vector<BenchRow> programme(const std::string& kind, int count, double low_Nm, double high_Nm,
                                double top_rpm, rig::DeterministicRandom& random) {
  constexpr int kLevels = 6, kSessions = 3;
  std::vector<BenchRow> rows(static_cast<std::size_t>(count));
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  random.shuffle(order);
  double time_s = 0.0;
  for (int i = 0; i < count; ++i) {
    BenchRow& row = rows[static_cast<std::size_t>(i)];
    const int cell = order[static_cast<std::size_t>(i)];
    row.forward = cell % 2 == 0;
    row.rotation = (cell / 2) % 2 == 0 ? 1.0 : -1.0;
    const double load = ((cell / 4) % kLevels) / (kLevels - 1.0);
    const double speed = ((cell / (4 * kLevels)) % kLevels) / (kLevels - 1.0);
    row.output_torque_Nm = rounded(low_Nm * std::pow(high_Nm / low_Nm, load), 0.001);
    row.sun_speed_rpm = rounded(top_rpm * (0.1 + 0.9 * speed), 0.1);
    row.test_torque_Nm = kind == "transmission" ? 0.0 : rounded(2.0 + 28.0 * load, 0.001);
    row.temperature_c = rounded(25.0 + random.between(-1.0, 1.0), 0.01);
    row.session = i * kSessions / count;
    time_s += random.between(20.0, 60.0);
    row.time_s = rounded(time_s, 0.01);
    row.output_angle_deg = rounded(random.uniform() * 3600.0, 1e-3);
  }
  return rows;
}

}  // namespace

std::vector<SeriesScenario> scenarios() {
  return {
      {"nothing", "transmission", {}},
      {"nothing in lost motion", "lost_motion", {}},
      {"design: friction 30 % above", "transmission", {{"friction_level", 0.3}}},
      {"design: friction falls with load", "transmission", {{"friction_load", -0.2}}},
      {"design: drag", "transmission", {{"drag_constant", 0.08}}},
      {"design: clearance", "lost_motion", {{"clearance", 0.2}}},
      {"part: friction", "transmission", {{"friction_level", 0.0, 0.1}}},
      {"part: friction, uniform", "transmission", {{"friction_level", 0.0, 0.1, true}}},
      {"part: clearance", "lost_motion", {{"clearance", 0.0, 0.1}}},
      {"part: clearance, uniform", "lost_motion", {{"clearance", 0.0, 0.1, true}}},
      {"both: drag", "transmission", {{"drag_constant", 0.1, 0.02}}},
      {"both: friction", "transmission", {{"friction_level", 0.3, 0.05}}},
      {"both: clearance", "lost_motion", {{"clearance", 0.3, 0.05, true}}},
      {"design: friction; both: drag",
       "transmission",
       {{"friction_level", 0.3}, {"drag_constant", 0.1, 0.02}}},
      {"design: friction by load; part: friction",
       "transmission",
       {{"friction_load", -0.2}, {"friction_level", 0.0, 0.1}}},
      {"design: compliance; part: clearance",
       "lost_motion",
       {{"compliance", 0.3}, {"clearance", 0.0, 0.1}}},
      {"design: drag; sessions scatter", "transmission", {{"drag_constant", 0.1}}, 1.0},
      {"part: friction; sessions scatter", "transmission", {{"friction_level", 0.0, 0.1}}, 1.0},
  };
}

SeriesCampaign make_series(const SeriesScenario& scenario, std::uint64_t seed, int units,
                           int rows_per_unit) {
  rig::DeterministicRandom random(hash_of(scenario.name) ^ (seed * 0x9E3779B97F4A7C15ULL));
  const BenchSubject subject = wide_rig::random_gearbox(random, false);
  const double low_Nm = random.between(4.0, 8.0), high_Nm = low_Nm * random.between(5.0, 8.0);
  const double top_rpm = random.between(600.0, 1500.0);
  SeriesCampaign campaign{.subject_toml = subject.toml};

  double square = 0.0;
  const auto first = programme(scenario.kind, rows_per_unit, low_Nm, high_Nm, top_rpm, random);
  for (const BenchRow& row : first) square += std::pow(reading(subject, scenario.kind, row, {}), 2);
  const double typical = std::sqrt(square / static_cast<double>(first.size()));

  std::vector<Law> laws;
  for (const auto& hidden : scenario.hidden) {
    laws.push_back(law_of(hidden.cause, subject, typical, std::sqrt(low_Nm * high_Nm), top_rpm));
    SeriesTruth truth{.cause = hidden.cause, .parameter = laws.back().parameter};
    if (hidden.cause == "friction_load") truth.companion = "friction_level";
    truth.owner =
        hidden.deviation > 0.0 ? (hidden.mean == 0.0 ? Owner::part : Owner::both) : Owner::design;
    truth.mean = hidden.mean * laws.back().usual;
    truth.deviation = hidden.deviation * laws.back().usual;
    for (int u = 0; u < units; ++u) {
      const double drawn =
          hidden.uniform ? std::sqrt(3.0) * random.between(-1.0, 1.0) : random.normal();
      // A drag below none would drive.
      truth.values.push_back(std::max(truth.mean + truth.deviation * drawn,
                                      hidden.cause == "drag_constant" ? 0.0 : -1e9));
    }
    campaign.truths.push_back(std::move(truth));
  }

  // Angles cost a search over all orders: one series in four states them.
  const wide_rig::BenchColumns columns{.angle = random.uniform() < 0.25};
  for (int u = 0; u < units; ++u) {
    const std::string name = "G" + std::to_string(u + 1);
    campaign.units.push_back(name);
    std::vector<AppliedEffect> effects;
    for (std::size_t k = 0; k < laws.size(); ++k) {
      effects.push_back({&laws[k].effect, campaign.truths[k].values[static_cast<std::size_t>(u)]});
    }
    const double sigma = 0.01 * typical * std::pow(2.0, random.between(-1.0, 1.0));
    const bool heavy = random.uniform() < 0.25;
    const auto rows = programme(scenario.kind, rows_per_unit, low_Nm, high_Nm, top_rpm, random);
    double offset[3];
    for (double& of_session : offset) {
      of_session = scenario.session_noise * sigma * random.normal();
    }
    // Two files: the first two sessions, and the last.
    std::vector<BenchRow> part[2];
    std::vector<double> read[2];
    for (const BenchRow& row : rows) {
      const double noise = heavy ? random.student3() : random.normal();
      const double clean = reading(subject, scenario.kind, row, effects);
      const std::size_t file = row.session < 2 ? 0 : 1;
      part[file].push_back(row);
      read[file].push_back(std::max(clean + offset[row.session] + sigma * noise, 1e-9));
    }
    for (std::size_t file = 0; file < 2; ++file) {
      campaign.files.push_back(
          {name + (file == 0 ? "_a.csv" : "_b.csv"),
           "# unit: " + name + "\n" +
               wide_rig::measurement_text(scenario.kind, columns, part[file], read[file], {})});
    }
  }
  return campaign;
}

}  // namespace gear3k::series_rig
