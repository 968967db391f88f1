#include "tests/wide_rig/test_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "tests/wide_rig/hidden_effect.hpp"

namespace gear3k::wide_rig {
namespace {

double rounded(double value, double step) { return std::round(value / step) * step; }

// Levels that rise, the ends included, spaced at random but not too near to each other.
std::vector<double> levels_between(double low, double high, std::size_t count, bool by_ratio,
                                   rig::DeterministicRandom& random) {
  std::vector<double> levels(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool end = i == 0 || i + 1 == count;
    const double jitter = end ? 0.0 : random.between(-0.3, 0.3);
    const double at = (static_cast<double>(i) + jitter) / static_cast<double>(count - 1);
    levels[i] = by_ratio ? low * std::pow(high / low, at) : low + (high - low) * at;
  }
  return levels;
}

std::string plan_or_throw(const std::string& kind, const std::string& plan) {
  const auto known = plans_of(kind);
  if (std::find(known.begin(), known.end(), plan) == known.end()) {
    throw std::invalid_argument("no plan '" + plan + "' of " + kind);
  }
  return plan;
}

// Sessions in time: blocks of rows, with pauses between them that may be long.
void divide_into_sessions(TestPlan& plan, rig::DeterministicRandom& random) {
  const std::size_t n = plan.rows.size();
  const double pause_s =
      random.uniform() < 0.6 ? random.between(60.0, 900.0) : random.between(3600.0, 60000.0);
  const double step_s = random.between(10.0, 90.0);
  double time_s = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const int session = static_cast<int>(i * static_cast<std::size_t>(plan.sessions) / n);
    time_s += step_s * random.between(0.6, 1.4);
    if (i > 0 && session != plan.rows[i - 1].session) time_s += pause_s * random.between(0.5, 1.5);
    plan.rows[i].session = session;
    plan.rows[i].time_s = rounded(time_s, 0.01);
  }
  for (BenchRow& row : plan.rows) row.elapsed = row.time_s / time_s;
}

struct Temperatures {
  double low_c = 20.0, high_c = 40.0;
  std::string follows{};  // independent, time, speed, session
};

void set_temperatures(TestPlan& plan, const Temperatures& t, rig::DeterministicRandom& random) {
  double fastest = 1.0;
  for (const BenchRow& row : plan.rows) fastest = std::max(fastest, row.sun_speed_rpm);
  const double constant = random.between(0.15, 0.7), power = random.between(0.8, 1.5);
  std::vector<double> of_session(static_cast<std::size_t>(plan.sessions));
  for (std::size_t i = 0; i < of_session.size(); ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(of_session.size());
    of_session[i] = t.low_c + (t.high_c - t.low_c) * at;
  }
  random.shuffle(of_session);
  double housing_c = t.low_c;
  double chamber_c = random.between(t.low_c, t.high_c);
  for (BenchRow& row : plan.rows) {
    double c = t.low_c;
    if (t.follows == "time") {
      c += (t.high_c - t.low_c) * -std::expm1(-row.elapsed / constant) /
           -std::expm1(-1.0 / constant);
      c += random.between(-0.15, 0.15);
    } else if (t.follows == "speed") {
      c += (t.high_c - t.low_c) * std::pow(row.sun_speed_rpm / fastest, power);
      c += random.between(-0.15, 0.15);
    } else if (t.follows == "session") {
      c = of_session[static_cast<std::size_t>(row.session)] + random.between(-0.3, 0.3);
    } else {  // a chamber whose set point is changed now and then
      if (random.uniform() < 0.35) chamber_c = random.between(t.low_c, t.high_c);
      c = chamber_c + random.between(-0.5, 0.5);
    }
    row.temperature_c = rounded(c, 0.01);
    housing_c += 0.75 * (row.temperature_c - housing_c);
    row.housing_c = housing_c;
  }
}

void set_angles(TestPlan& plan, const std::string& name, rig::DeterministicRandom& random) {
  const auto n = static_cast<double>(plan.rows.size());
  double angle_deg = random.between(0.0, 360.0);
  const double step_deg = random.between(150.0, 1500.0);
  double turns = name == "one_turn" ? random.between(0.95, 1.05) : random.between(0.7, 3.0);
  const bool even = name == "even_angles" || name == "one_turn";
  if (even) {
    for (std::size_t i = 0; i < plan.rows.size(); ++i) {
      plan.rows[i].output_angle_deg = rounded(static_cast<double>(i) * turns * 360.0 / n, 1e-5);
    }
    // Either measured in the order of the angle, or the grid is visited at random.
    if (random.uniform() < 0.4) {
      std::vector<double> angles;
      for (const BenchRow& row : plan.rows) angles.push_back(row.output_angle_deg);
      random.shuffle(angles);
      for (std::size_t i = 0; i < angles.size(); ++i) plan.rows[i].output_angle_deg = angles[i];
    }
  } else {
    for (BenchRow& row : plan.rows) {
      angle_deg += step_deg * random.uniform();
      row.output_angle_deg = rounded(angle_deg, 1e-4);
    }
    turns = angle_deg / 360.0;
  }
  plan.turns = turns;
}

template <typename Value>
void cycle_through(std::vector<BenchRow>& rows, const std::vector<Value>& values,
                   Value BenchRow::*field, rig::DeterministicRandom& random) {
  std::vector<Value> all;
  while (all.size() < rows.size()) {
    std::vector<Value> block = values;
    random.shuffle(block);
    all.insert(all.end(), block.begin(), block.end());
  }
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*field = all[i];
}

void round_conditions(std::vector<BenchRow>& rows) {
  for (BenchRow& row : rows) {
    row.sun_speed_rpm = rounded(row.sun_speed_rpm, 0.1);
    row.output_torque_Nm = rounded(row.output_torque_Nm, 0.001);
    row.test_torque_Nm = rounded(row.test_torque_Nm, 0.001);
  }
}

// Other levels between and somewhat beyond those of the plan, in conditions that it had.
std::vector<BenchRow> unseen_rows(const TestPlan& plan, rig::DeterministicRandom& random) {
  double load_low = 1e9, load_high = 0.0, speed_low = 1e9, speed_high = 0.0;
  double test_low = 1e9, test_high = 0.0;
  for (const BenchRow& row : plan.rows) {
    load_low = std::min(load_low, row.output_torque_Nm);
    load_high = std::max(load_high, row.output_torque_Nm);
    speed_low = std::min(speed_low, row.sun_speed_rpm);
    speed_high = std::max(speed_high, row.sun_speed_rpm);
    test_low = std::min(test_low, row.test_torque_Nm);
    test_high = std::max(test_high, row.test_torque_Nm);
  }
  std::vector<BenchRow> rows;
  for (int i = 0; i < 40; ++i) {
    BenchRow row = plan.rows[random.index(plan.rows.size())];
    row.output_torque_Nm = random.between(load_low, 1.15 * load_high);
    row.sun_speed_rpm = random.between(speed_low, 1.15 * speed_high);
    if (test_high > test_low) row.test_torque_Nm = random.between(test_low, 1.15 * test_high);
    // An angle that was not measured, of the same turns.
    if (plan.turns > 0.0)
      row.output_angle_deg = rounded(random.uniform() * plan.turns * 360.0, 1e-4);
    rows.push_back(row);
  }
  round_conditions(rows);
  return rows;
}

// The next session, after the campaign, at the levels of `unseen`.
void set_later(TestPlan& plan, rig::DeterministicRandom random) {
  const double end_s = plan.rows.back().time_s;
  const double cycles = plan.rows.back().cycles;
  plan.later = plan.unseen;
  for (BenchRow& row : plan.later) {
    row.session = plan.sessions;
    row.elapsed = random.between(1.01, 1.1);
    row.time_s = rounded(row.elapsed * end_s, 0.01);
    row.cycles = std::round(row.elapsed * cycles);
  }
}

TestPlan transmission_plan(const std::string& name, int sessions_wanted,
                           rig::DeterministicRandom& random) {
  TestPlan plan{.name = name};
  const bool many = sessions_wanted > 0 || name == "by_session" || name == "load_by_session" ||
                    name == "temperature_by_session";
  const int least = std::max(sessions_wanted, 2);
  plan.sessions = many ? least + static_cast<int>(random.index(static_cast<std::size_t>(9 - least)))
                       : 1 + static_cast<int>(random.index(4));
  const std::size_t n = 60 + random.index(181);
  plan.rows.resize(n);
  divide_into_sessions(plan, random);

  const double load_low = random.between(3.0, 12.0),
               load_high = load_low * random.between(4.0, 9.0);
  const double speed_low = random.between(40.0, 200.0);
  const double speed_high = speed_low * random.between(5.0, 15.0);
  auto loads =
      levels_between(load_low, load_high, 4 + random.index(5), random.uniform() < 0.5, random);
  auto speeds =
      levels_between(speed_low, speed_high, 5 + random.index(4), random.uniform() < 0.5, random);
  if (random.uniform() < 0.25) {  // set by hand: no two alike
    loads.resize(n);
    for (double& v : loads) v = random.between(load_low, load_high);
    speeds.resize(n);
    for (double& v : speeds) v = random.between(speed_low, speed_high);
  }
  cycle_through(plan.rows, loads, &BenchRow::output_torque_Nm, random);
  cycle_through(plan.rows, speeds, &BenchRow::sun_speed_rpm, random);
  const bool only_forward = random.uniform() < 0.7;
  for (BenchRow& row : plan.rows) {
    const bool forward = random.uniform() < 0.5;
    row.forward = name == "one_direction" ? only_forward : forward;
    row.rotation = name == "one_rotation" || random.uniform() < 0.5 ? 1.0 : -1.0;
  }
  Temperatures t{.low_c = random.between(15.0, 28.0), .follows = "independent"};
  t.high_c = t.low_c + random.between(15.0, 35.0);
  if (name == "warming_with_speed") t.follows = "speed";
  if (name == "warming_with_time") t.follows = "time";
  if (name == "temperature_by_session") t.follows = "session";
  if (name == "by_session" || name == "load_by_session") {
    // Each session keeps two or three of the levels of one condition.
    const std::size_t own = name == "load_by_session" ? 0 : random.index(3);
    if (own == 2) t.follows = "session";
    const auto narrowed = [&](double low, double high, double BenchRow::*field, double levels) {
      std::vector<double> centre(static_cast<std::size_t>(plan.sessions));
      for (std::size_t i = 0; i < centre.size(); ++i) {
        centre[i] = (static_cast<double>(i) + 0.5) / static_cast<double>(centre.size());
      }
      random.shuffle(centre);
      for (BenchRow& row : plan.rows) {
        const double middle = low + (high - low) * centre[static_cast<std::size_t>(row.session)];
        const double half = (high - low) * levels;
        const double at = static_cast<double>(random.index(3)) - 1.0;
        row.*field = std::clamp(middle + half * at, low, high);
      }
    };
    const double width = name == "load_by_session" ? 0.0 : 0.25;
    if (own == 0) narrowed(load_low, load_high, &BenchRow::output_torque_Nm, width);
    if (own == 1) narrowed(speed_low, speed_high, &BenchRow::sun_speed_rpm, width);
  }
  round_conditions(plan.rows);
  set_temperatures(plan, t, random);
  set_angles(plan, name, random);
  plan.columns.rotation = name != "one_rotation" || random.uniform() < 0.5;
  plan.sun_torque_set = name == "sun_torque_set";
  plan.unseen = unseen_rows(plan, random);
  set_later(plan, random);
  return plan;
}

TestPlan lost_motion_plan(const std::string& name, int sessions_wanted,
                          rig::DeterministicRandom& random) {
  TestPlan plan{.name = name};
  const bool many = sessions_wanted > 0 || name == "by_session" || name == "temperature_by_session";
  const int least = std::max(sessions_wanted, 2);
  plan.sessions = many ? least + static_cast<int>(random.index(static_cast<std::size_t>(9 - least)))
                       : 1 + static_cast<int>(random.index(3));
  plan.rows.resize(60 + random.index(181));
  divide_into_sessions(plan, random);
  const std::size_t count = name == "one_torque" ? 1 : 2 + random.index(7);
  const double low_Nm = random.between(0.3, 3.0), high_Nm = low_Nm * random.between(5.0, 20.0);
  const auto torques = count == 1
                           ? std::vector<double>{low_Nm}
                           : levels_between(low_Nm, high_Nm, count, random.uniform() < 0.5, random);
  cycle_through(plan.rows, torques, &BenchRow::test_torque_Nm, random);
  Temperatures t{.low_c = random.between(15.0, 24.0), .follows = "independent"};
  t.high_c = t.low_c + random.between(15.0, 40.0);
  if (name == "warming_with_time") t.follows = "time";
  if (name == "temperature_by_session") t.follows = "session";
  if (name == "by_session" && random.uniform() < 0.4) t.follows = "session";
  round_conditions(plan.rows);
  set_temperatures(plan, t, random);
  set_angles(plan, name, random);
  const double cycles = std::round(random.between(2e3, 4e5));
  for (BenchRow& row : plan.rows) row.cycles = std::round(row.elapsed * cycles);
  plan.columns.rotation = false;
  plan.columns.cycles = random.uniform() < 0.4;
  plan.unseen = unseen_rows(plan, random);
  set_later(plan, random);
  return plan;
}

// An even grid of angles on which two orders of the gearbox are one.
struct CoarseGrid {
  double positions_a_turn = 12.0;
  int turns = 1;
  double first = 1.0, second = 1.0;  // orders
};

// The slowest order that looks the same at the positions.
double folded(double order, double positions_a_turn) {
  return std::fabs(order - positions_a_turn * std::round(order / positions_a_turn));
}

// The body, whose order may be relative to the carrier or not.
std::string first_word(const std::string& name) { return name.substr(0, name.find(' ')); }

// Two waves of orders a and b are the same at n positions a turn where a - b or a + b is a multiple
// of n; over some turns they stay together while they slip by less than a hundredth of a period.
// What looks constant, or changes its sign from each position to the next, is left out.
std::vector<CoarseGrid> coarse_grids(const std::vector<TurningBody>& firsts,
                                     const std::vector<TurningBody>& seconds) {
  std::vector<CoarseGrid> result;
  for (const TurningBody& a : firsts) {
    for (const TurningBody& b : seconds) {
      for (int turns = 1; turns <= 3; ++turns) {
        const double least = 0.95 / turns;
        if (a.order < std::max(0.8, least) || b.order < std::max(0.8, least)) continue;
        if (first_word(a.name) == first_word(b.name)) continue;
        if (std::fabs(a.order - b.order) < 1.0 / turns) continue;  // not resolved on any grid
        for (double n = 6.0; n <= 48.0; n += 1.0) {
          const double slip = std::min(folded(a.order - b.order, n), folded(a.order + b.order, n));
          const double low = folded(a.order, n);
          if (slip * turns < 0.01 && low > least && low < 0.45 * n && n * turns >= 12.0) {
            result.push_back({n, turns, a.order, b.order});
          }
        }
      }
    }
  }
  return result;
}

void set_coarse_grid(TestPlan& plan, const BenchSubject& subject,
                     rig::DeterministicRandom& random) {
  const auto shafts = turning_bodies(subject);
  const auto others = plan.name == "coarse_grid" ? tooth_orders(subject) : shafts;
  auto grids = coarse_grids(shafts, others);
  if (grids.empty()) {  // a step that the two orders themselves give
    for (const TurningBody& a : shafts) {
      for (const TurningBody& b : others) {
        const double sum = a.order + b.order, apart = std::fabs(a.order - b.order);
        if (a.order < 0.95 || b.order < 0.95 || apart < 1.0) continue;
        if (first_word(a.name) == first_word(b.name)) continue;
        const double n = sum / std::ceil(sum / 48.0);
        if (n >= 6.0) grids.push_back({n, 1 + static_cast<int>(12.0 / n), a.order, b.order});
      }
    }
  }
  if (grids.empty()) throw std::invalid_argument("no coarse grid for this gearbox");
  const CoarseGrid grid = grids[random.index(grids.size())];
  const auto positions = static_cast<std::size_t>(grid.positions_a_turn * grid.turns);
  for (std::size_t i = 0; i < plan.rows.size(); ++i) {
    plan.rows[i].output_angle_deg =
        rounded(static_cast<double>(i % positions) * 360.0 / grid.positions_a_turn, 1e-6);
  }
  for (std::vector<BenchRow>* rows : {&plan.unseen, &plan.later}) {
    for (BenchRow& row : *rows) {
      row.output_angle_deg = plan.rows[random.index(plan.rows.size())].output_angle_deg;
    }
  }
  plan.turns = grid.turns;
  plan.aliased_orders = {grid.first, grid.second};
}

TestPlan pair_loss_plan(const std::string& name, int sessions_wanted,
                        rig::DeterministicRandom& random) {
  TestPlan plan{.name = name};
  plan.sessions = sessions_wanted > 0 || name == "by_session"
                      ? std::max(sessions_wanted, 2) + static_cast<int>(random.index(4))
                      : 1;
  plan.rows.resize(60 + random.index(81));
  divide_into_sessions(plan, random);
  std::vector<int> teeth;
  const std::size_t count = 8 + random.index(8);
  while (teeth.size() < count) {
    const int z = 18 + static_cast<int>(random.index(110));
    if (std::find(teeth.begin(), teeth.end(), z) == teeth.end()) teeth.push_back(z);
  }
  for (BenchRow& row : plan.rows) {
    int a = teeth[random.index(count)], b = teeth[random.index(count)];
    while (a == b) b = teeth[random.index(count)];
    if (name == "one_sense" && a > b) std::swap(a, b);
    row.driving_teeth = a;
    row.driven_teeth = b;
    row.forward = a < b;
  }
  plan.columns = {.rotation = false, .angle = false, .temperature = false, .time = false};
  plan.columns.run = plan.sessions > 1;
  for (int i = 0; i < 30; ++i) {
    BenchRow row = plan.rows[random.index(plan.rows.size())];
    row.driving_teeth = teeth[random.index(count)];
    row.driven_teeth = 18 + static_cast<int>(random.index(110));
    if (row.driving_teeth == row.driven_teeth) ++row.driven_teeth;
    row.forward = row.driving_teeth < row.driven_teeth;
    plan.unseen.push_back(row);
  }
  set_later(plan, random);
  return plan;
}

}  // namespace

std::vector<std::string> plans_of(const std::string& kind) {
  if (kind == "transmission") {
    return {"crossed",           "by_session",
            "even_angles",       "sun_torque_set",
            "one_turn",          "one_direction",
            "one_rotation",      "warming_with_speed",
            "warming_with_time", "temperature_by_session",
            "load_by_session",   "coarse_grid",
            "coarse_grid_shafts"};
  }
  if (kind == "lost_motion") {
    return {"crossed",
            "by_session",
            "even_angles",
            "one_turn",
            "one_torque",
            "warming_with_time",
            "temperature_by_session",
            "coarse_grid",
            "coarse_grid_shafts"};
  }
  if (kind == "pair_loss") return {"crossed", "by_session", "one_sense"};
  if (kind == "torque_angle") return {"loops"};
  throw std::invalid_argument("no kind of measurement named '" + kind + "'");
}

TestPlan make_plan(const std::string& kind, const std::string& plan, const BenchSubject& subject,
                   int sessions_wanted, rig::DeterministicRandom& random) {
  const std::string name = plan_or_throw(kind, plan);
  if (name.starts_with("coarse_grid")) {
    TestPlan result = kind == "lost_motion" ? lost_motion_plan(name, sessions_wanted, random)
                                            : transmission_plan(name, sessions_wanted, random);
    set_coarse_grid(result, subject, random);
    return result;
  }
  if (kind == "lost_motion") return lost_motion_plan(name, sessions_wanted, random);
  if (kind == "pair_loss") return pair_loss_plan(name, sessions_wanted, random);
  if (kind == "torque_angle") return {.name = name};
  TestPlan result = transmission_plan(name, sessions_wanted, random);
  if (result.sun_torque_set) {
    // Few exact torques of the sun; the output torque follows from the gearbox without effects,
    // and is corrected once the effects are known.
    const auto few = static_cast<double>(3 + random.index(4));
    double top_Nm = 0.0;
    for (const BenchRow& row : result.rows) {
      top_Nm = std::max(top_Nm, row.output_torque_Nm / std::fabs(subject.ratio));
    }
    const double step_Nm =
        std::pow(10.0, std::floor(std::log10(top_Nm / few))) *
        std::ceil(top_Nm / few / std::pow(10.0, std::floor(std::log10(top_Nm / few))));
    for (BenchRow& row : result.rows) {
      const double set =
          step_Nm * (1.0 + static_cast<double>(random.index(static_cast<std::size_t>(few))));
      result.set_torques_Nm.push_back(set);
      // The torque reading is proportional to the load without effects.
      row.output_torque_Nm = 1.0;
      row.output_torque_Nm = set / sun_torque(subject, row, {}).value;
    }
  }
  return result;
}

}  // namespace gear3k::wide_rig
