#include "calibrate/verdict/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>
#include <set>
#include <utility>

#include "calibrate/measurement/value_range.hpp"
#include "calibrate/search/replacements.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

namespace {

constexpr int kMostConditions = 4;
constexpr int kRepeats = 6;
constexpr int kMostRows = 120;  // a campaign as long as the first one
/// χ² that tells two explanations apart, and at which more of it is of no use.
constexpr double kTold = 9.0, kTellsApart = 40.0;
/// Below this it is chance: no rows are worth it.
constexpr double kUseless = 1.0;

using Limits = std::array<double, 2>;

/// Evenly over the limits; without any, over what the design is meant for and the data widened by a
/// quarter.
std::vector<double> levels(const std::optional<Limits>& limits, const ValueRange& data,
                           const design::GridAxis* meant, int count) {
  if (!data.known()) return {kUnknown};
  Limits range = limits.value_or(Limits{0.75 * data.low, 1.25 * data.high});
  if (!limits && meant != nullptr) {
    range = {std::min(range[0], meant->from), std::max(range[1], meant->to)};
  }
  if (!(range[1] > range[0])) return {range[0]};
  std::vector<double> result;
  result.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double level = range[0] + (range[1] - range[0]) * k / (count - 1);
    // Near the greatest number the product has none.
    result.push_back(std::min(level, range[1]));
  }
  return result;
}

bool about_sensor(const std::vector<Explanation>& explanations) {
  return std::ranges::any_of(explanations, [](const Explanation& e) {
    return std::ranges::any_of(e.fit.hypothesis.effects, [](const Candidate& c) {
      return c.cause->remedy == Remedy::kSensor;
    });
  });
}

bool about_angle(const std::vector<Explanation>& explanations) {
  return std::ranges::any_of(explanations, [](const Explanation& e) {
    return std::ranges::any_of(e.fit.hypothesis.effects,
                               [](const Candidate& c) { return c.form.order > 0.0; });
  });
}

/// Each condition at angles of one turn of the output, in golden sections: no order repeats itself
/// at all of them.
std::vector<Condition> at_angles(const std::vector<Condition>& conditions) {
  constexpr int kAngles = 12;
  std::vector<Condition> result;
  result.reserve(conditions.size() * kAngles);
  for (const Condition& c : conditions) {
    for (int k = 0; k < kAngles; ++k) {
      const double turn = k / std::numbers::phi;
      result.push_back(c);
      result.back().output_angle_rad = 2.0 * std::numbers::pi * (turn - std::floor(turn));
    }
  }
  return result;
}

/// Whether an explanation has the gearbox give more than it takes in (a sensor's error), or turn
/// the magnitude of a torque round (a sun that must be helped): such rows are not taken when they
/// are read.
bool is_beyond_physics(const Condition& c, double sun_torque_Nm, double ratio) {
  const double without_loss = c.output_torque_Nm / std::abs(ratio);
  return sun_torque_Nm < 0.0 ||
         (c.direction == design::Direction::kForward ? sun_torque_Nm < without_loss
                                                     : sun_torque_Nm > without_loss);
}

/// Rows to simulate, of a session after those of the data.
MeasurementSet rows_at(const std::vector<Condition>& conditions, const MeasurementSet& data) {
  MeasurementSet possible;
  possible.kind = data.kind;
  possible.runs = data.runs;
  possible.rows.reserve(conditions.size());
  for (const Condition& c : conditions) possible.rows.push_back({.condition = c});
  return possible;
}

/// An explanation in new rows: of a further session, with what drifts as the data left it.
Hypothesis later(Hypothesis h) {
  h.left_behind = true;
  return h;
}

/// Conditions at which every explanation stays within physics, where there are any.
std::vector<Condition> believable(const Problem& problem,
                                  const std::vector<Explanation>& explanations,
                                  const std::vector<Condition>& conditions) {
  if (problem.simulation.kind() != Kind::kTransmission) return conditions;
  const MeasurementSet possible = rows_at(conditions, problem.data);
  const Problem imagined{.simulation = problem.simulation, .data = possible, .noise = {}};
  std::vector<bool> out(conditions.size(), false);
  for (const Explanation& e : explanations) {
    const Eigen::VectorXd torque = linearise(imagined, later(e.fit.hypothesis), {}).simulated;
    for (std::size_t k = 0; k < conditions.size(); ++k) {
      out[k] = out[k] || is_beyond_physics(conditions[k], torque[static_cast<Eigen::Index>(k)],
                                           problem.simulation.ratio());
    }
  }
  std::vector<Condition> result;
  for (std::size_t k = 0; k < conditions.size(); ++k) {
    if (!out[k]) result.push_back(conditions[k]);
  }
  return result.empty() ? conditions : result;
}

std::vector<Condition> possible_conditions(const Problem& problem,
                                           const std::vector<Explanation>& explanations,
                                           const DiagnoseOptions& options) {
  const MeasurementSet& data = problem.data;
  const ValueRange time = range_of(data, &Condition::time_s);
  const ValueRange temperature = range_of(data, &Condition::temperature_K);
  std::optional<Limits> temperatures = options.temperature_K;
  constexpr double kMargin_K = 10.0;
  if (!temperatures && temperature.known()) {
    temperatures = Limits{temperature.low - kMargin_K, temperature.high + kMargin_K};
  }
  Condition start;
  start.run = data.runs.empty() ? -1 : static_cast<int>(data.runs.size());
  start.time_s = time.high;
  start.cycles = range_of(data, &Condition::cycles).high;
  std::vector<Condition> result;
  const std::vector<double> warm = levels(temperatures, temperature, nullptr, 2);
  const auto with_temperature = [&](Condition c) {
    for (const double t : warm) {
      c.temperature_K = t;
      result.push_back(c);
    }
  };
  switch (problem.simulation.kind()) {
    case Kind::kTransmission: {
      const design::MapGrid* grid = problem.simulation.grid();
      for (const double speed :
           levels(options.sun_speed_rad_s, range_of(data, &Condition::sun_speed_rad_s),
                  grid == nullptr ? nullptr : &grid->sun_speed_rad_s, 3)) {
        for (const double load :
             levels(options.output_torque_Nm, range_of(data, &Condition::output_torque_Nm),
                    grid == nullptr ? nullptr : &grid->output_torque_Nm, 3)) {
          for (const auto direction : {design::Direction::kForward, design::Direction::kBackward}) {
            for (const int rotation : {1, -1}) {
              Condition c = start;
              c.sun_speed_rad_s = speed;
              c.output_torque_Nm = load;
              c.direction = direction;
              c.rotation = rotation;
              with_temperature(c);
            }
          }
        }
      }
      break;
    }
    case Kind::kLostMotion:
    case Kind::kTorqueAngle:
      for (const double torque :
           levels(options.test_torque_Nm, range_of(data, &Condition::test_torque_Nm), nullptr, 4)) {
        Condition c = start;
        c.test_torque_Nm = torque;
        with_temperature(c);
      }
      break;
    case Kind::kPairLoss: {
      std::set<int> teeth;
      for (const Observation& row : data.rows) {
        teeth.insert(row.condition.driving_teeth);
        teeth.insert(row.condition.driven_teeth);
      }
      for (const int driving : teeth) {
        for (const int driven : teeth) {
          Condition c = start;
          c.driving_teeth = driving;
          c.driven_teeth = driven;
          c.module_m = data.rows.front().condition.module_m;
          result.push_back(c);
        }
      }
      break;
    }
  }
  if (about_angle(explanations)) result = at_angles(result);
  if (about_sensor(explanations)) {
    const std::size_t count = result.size();
    result.reserve(2 * count);
    for (std::size_t k = 0; k < count; ++k) {
      result.push_back(result[k]);
      result.back().reference_sensor = true;
    }
  }
  return result;
}

/// An explanation as the choice of conditions sees it; everything over a row's deviation.
struct View {
  std::string name;
  Eigen::VectorXd old_rows;  ///< simulated, whitened
  Eigen::MatrixXd jacobian;  ///< of the old rows: its parameters, then the level where it has none
  Eigen::VectorXd possible;  ///< simulated at the possible conditions
  Eigen::MatrixXd possible_jacobian;
  Eigen::Index parameters = 0;  ///< of its own
  bool has_level = false;       ///< the coefficient of friction is among them, or all that they do
  bool is_rest = false;         ///< as of the explanation
};

/// χ² that remains between explanation `a`, taken as true, and `b` refitted to it: with another
/// coefficient of friction beside it, as a diagnosis of the new rows would try, unless that is what
/// either of them says.
class Distance {
 public:
  Distance(const View& a, const View& b)
      : difference_(a.possible - b.possible), total_((a.old_rows - b.old_rows).squaredNorm()) {
    const bool beside = !a.has_level && !b.has_level;
    const Eigen::Index count = beside ? b.jacobian.cols() : b.parameters;
    const Eigen::MatrixXd jacobian = b.jacobian.leftCols(count);
    jacobian_ = b.possible_jacobian.leftCols(count);
    normal_ = jacobian.transpose() * jacobian;
    moment_ = jacobian.transpose() * (a.old_rows - b.old_rows);
    // What the old rows hold against `b` is known already: only what is new counts.
    known_ = value(normal_, moment_, total_);
  }
  [[nodiscard]] double with(Eigen::Index condition, double repeats) const {
    const double d = difference_[condition];
    const Eigen::VectorXd j = jacobian_.row(condition).transpose();
    return value(normal_ + repeats * j * j.transpose(), moment_ + repeats * d * j,
                 total_ + repeats * d * d) -
           known_;
  }
  void take(Eigen::Index condition, double repeats) {
    const double d = difference_[condition];
    const Eigen::VectorXd j = jacobian_.row(condition).transpose();
    normal_ += repeats * j * j.transpose();
    moment_ += repeats * d * j;
    total_ += repeats * d * d;
  }
  [[nodiscard]] double now() const { return value(normal_, moment_, total_) - known_; }
  [[nodiscard]] Eigen::Index conditions() const { return difference_.size(); }

 private:
  static double value(const Eigen::MatrixXd& normal, const Eigen::VectorXd& moment, double total) {
    if (moment.size() == 0) return total;
    return total - moment.dot(numerics::least_norm_solution(normal, moment));
  }
  Eigen::VectorXd difference_;  ///< at the possible conditions
  Eigen::MatrixXd jacobian_;    ///< there
  Eigen::MatrixXd normal_;
  Eigen::VectorXd moment_;
  double total_;
  double known_ = 0.0;
};

/// Two explanations, each taken as true that does not hold the other one.
struct Pair {
  std::string one, other;
  std::vector<Distance> distances;

  [[nodiscard]] double now() const {
    return std::ranges::min(distances | std::views::transform(&Distance::now));
  }
  [[nodiscard]] double with(Eigen::Index condition, double repeats) const {
    return std::ranges::min(distances | std::views::transform([&](const Distance& d) {
                              return d.with(condition, repeats);
                            }));
  }
  void take(Eigen::Index condition, double repeats) {
    for (Distance& d : distances) d.take(condition, repeats);
  }
};

/// Whether not even all possible conditions together, each as often as the plan has rows, tell a
/// pair apart.
bool is_hopeless(Pair pair) {
  const Eigen::Index conditions = pair.distances[0].conditions();
  for (Eigen::Index c = 0; c < conditions; ++c) pair.take(c, kMostRows);
  return pair.now() < kTold;
}

Pair pair_of(const View& a, const View& b) {
  Pair pair{.one = a.name, .other = b.name, .distances = {}};
  if (!a.is_rest) pair.distances.emplace_back(a, b);
  if (!b.is_rest) pair.distances.emplace_back(b, a);
  return pair;
}

/// What the level does as well would be nothing beside it, whatever stands there.
void mark_what_is_as_good_as_the_level(std::vector<View>& views) {
  std::vector<std::size_t> marked;
  for (const View& level : views) {
    for (std::size_t k = 0; level.has_level && k < views.size(); ++k) {
      if (!views[k].has_level && is_hopeless(pair_of(views[k], level))) marked.push_back(k);
    }
  }
  for (const std::size_t k : marked) views[k].has_level = true;
}

std::vector<Pair> pairs_of(const std::vector<View>& views) {
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < views.size(); ++a) {
    for (std::size_t b = a + 1; b < views.size(); ++b) {
      pairs.push_back(pair_of(views[a], views[b]));
    }
  }
  return pairs;
}

double total_use(const std::vector<double>& distances) {
  double sum = 0.0;
  double least = kTellsApart;
  for (const double d : distances) {
    sum += std::min(std::max(d, 0.0), kTellsApart);
    least = std::min(least, d);
  }
  return sum / static_cast<double>(distances.size()) + least;
}

std::string advice_on(const std::vector<std::array<std::string, 2>>& inseparable) {
  if (inseparable.empty()) return "";
  std::vector<std::string> pairs;
  pairs.reserve(inseparable.size());
  for (const auto& pair : inseparable) pairs.push_back(fmt::format("{} from {}", pair[0], pair[1]));
  return fmt::format("No measurement of this kind within the limits tells {}.",
                     fmt::join(pairs, ", or "));
}

}  // namespace

NextExperiment plan_experiment(const Problem& problem, const std::vector<Explanation>& explanations,
                               double scale, const DiagnoseOptions& options) {
  NextExperiment plan;
  for (const Explanation& e : explanations) {
    if (std::ranges::find(plan.separates, e.id) == plan.separates.end()) {
      plan.separates.push_back(e.id);
    }
  }
  const std::vector<Condition> conditions =
      believable(problem, explanations, possible_conditions(problem, explanations, options));
  const MeasurementSet possible = rows_at(conditions, problem.data);
  const Problem imagined{.simulation = problem.simulation, .data = possible, .noise = {}};

  // A new row scatters like the old ones on average.
  const double row_deviation = scale * root_mean_square(problem.noise.weight.cwiseInverse());
  std::vector<View> views;
  views.reserve(explanations.size());
  std::vector<Candidate> level = candidates_for(problem.simulation, problem.data);
  std::erase_if(level, [](const Candidate& c) {
    return c.cause->remedy != Remedy::kFrictionValue || !(c.form.weight > 0.0);
  });
  Eigen::MatrixXd measured_rows = measured(problem.data);
  problem.noise.whiten(measured_rows);
  for (const Explanation& e : explanations) {
    const std::vector<Candidate> beside = candidates_beside(level, e.fit.hypothesis);
    const Columns old = columns_at(problem, e.fit.hypothesis, beside, 0.0);
    const Linearisation fresh = linearise(imagined, later(e.fit.hypothesis), beside);
    View view{.name = e.body.empty() ? e.id : fmt::format("{} at the {}", e.id, e.body),
              .old_rows = (measured_rows.col(0) - old.residual) / scale,
              .jacobian = {},
              .possible = fresh.simulated / row_deviation,
              .possible_jacobian = {},
              .parameters = old.own.cols(),
              .has_level = !level.empty() && beside.empty(),
              .is_rest = e.is_rest};
    view.jacobian.resize(old.own.rows(), old.own.cols() + old.other.cols());
    view.jacobian << old.own / scale, old.other / scale;
    view.possible_jacobian.resize(fresh.own.rows(), fresh.own.cols() + fresh.other.cols());
    view.possible_jacobian << fresh.own / row_deviation, fresh.other / row_deviation;
    views.push_back(std::move(view));
  }
  const auto count = static_cast<Eigen::Index>(conditions.size());
  mark_what_is_as_good_as_the_level(views);
  std::vector<Pair> pairs = pairs_of(views);
  std::erase_if(pairs, [&](const Pair& pair) {
    if (!is_hopeless(pair)) return false;
    plan.inseparable.push_back({pair.one, pair.other});
    return true;
  });
  plan.advice = advice_on(plan.inseparable);
  if (pairs.empty()) return plan;
  const auto least = [&] { return std::ranges::min_element(pairs, {}, &Pair::now)->now(); };
  // First as many different conditions as help, then more repeats of the best of them.
  std::vector<Eigen::Index> taken;
  int rows = 0;
  std::vector<double> distances(pairs.size());
  const auto use_of = [&](Eigen::Index c) {
    std::ranges::transform(pairs, distances.begin(),
                           [&](const Pair& pair) { return pair.with(c, kRepeats); });
    return total_use(distances);
  };
  while (rows < kMostRows && least() < kTellsApart) {
    const bool fresh = static_cast<int>(taken.size()) < kMostConditions;
    Eigen::Index best = -1;
    double best_use = -1.0;
    for (Eigen::Index c = 0; c < count; ++c) {
      if ((std::ranges::find(taken, c) == taken.end()) != fresh) continue;
      const double use = use_of(c);
      if (use > best_use * (1.0 + 1e-9)) {
        best_use = use;
        best = c;
      }
    }
    if (best < 0) break;
    for (Pair& pair : pairs) pair.take(best, kRepeats);
    const auto same = std::ranges::find(taken, best);
    if (same == taken.end()) {
      taken.push_back(best);
      plan.conditions.push_back(
          {.condition = conditions[static_cast<std::size_t>(best)], .repeats = kRepeats});
    } else {
      plan.conditions[static_cast<std::size_t>(same - taken.begin())].repeats += kRepeats;
    }
    rows += kRepeats;
  }
  plan.expected_statistic = least();
  if (plan.expected_statistic < kTold) {
    const Pair& closest = *std::ranges::min_element(pairs, {}, &Pair::now);
    const bool useless = std::ranges::max_element(pairs, {}, &Pair::now)->now() < kUseless;
    plan.advice += fmt::format(
        "{}{} tell {} from {} (expected chi-square {:.2g}, {:g} is needed): {}, or widen the "
        "limits.",
        plan.advice.empty() ? "" : " ",
        useless ? fmt::format("Not even {} rows at {} conditions will", kMostRows, kMostConditions)
                : "These conditions will hardly",
        closest.one, closest.other, std::max(0.0, plan.expected_statistic), kTold,
        useless ? "measure something else" : "repeat more often");
    if (useless) plan.conditions.clear();
  }
  return plan;
}

}  // namespace gear3k::calibrate
