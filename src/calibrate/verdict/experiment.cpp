#include "calibrate/verdict/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrate/search/replacements.hpp"
#include "calibrate/verdict/possible_conditions.hpp"
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
/// The explanation that no cause of the library is behind an effect, in NextExperiment::separates.
constexpr const char* kNothingBehind = "no_cause";

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
    const Eigen::VectorXd j = slopes(condition);
    return value(normal_ + repeats * j * j.transpose(), moment_ + repeats * d * j,
                 total_ + repeats * d * d) -
           known_;
  }
  void take(Eigen::Index condition, double repeats) {
    const double d = difference_[condition];
    const Eigen::VectorXd j = slopes(condition);
    normal_ += repeats * j * j.transpose();
    moment_ += repeats * d * j;
    total_ += repeats * d * d;
  }
  [[nodiscard]] double now() const { return value(normal_, moment_, total_) - known_; }
  [[nodiscard]] Eigen::Index conditions() const { return difference_.size(); }

 private:
  [[nodiscard]] Eigen::VectorXd slopes(Eigen::Index condition) const {
    // A matrix without columns has no rows to point at.
    if (jacobian_.cols() == 0) return Eigen::VectorXd(0);
    return jacobian_.row(condition).transpose();
  }
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
    double least = std::numeric_limits<double>::infinity();
    for (const Distance& d : distances) least = std::min(least, d.now());
    return least;
  }
  [[nodiscard]] double with(Eigen::Index condition, double repeats) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Distance& d : distances) least = std::min(least, d.with(condition, repeats));
    return least;
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

/// The explanations at the old rows and at the possible conditions.
/// @param scale  standard deviation of the whitened rows
std::vector<View> views_of(const Problem& problem, const std::vector<Explanation>& explanations,
                           const std::vector<Condition>& conditions, double scale) {
  const MeasurementSet possible = rows_at(conditions, problem.data);
  const Problem imagined{.simulation = problem.simulation, .data = possible, .noise = {}};
  // A new row scatters like the old ones on average.
  const double row_deviation = scale * root_mean_square(problem.noise.weight.cwiseInverse());
  std::vector<Candidate> level = candidates_for(problem.simulation, problem.data);
  std::erase_if(level, [](const Candidate& c) {
    return c.cause->remedy != Remedy::kFrictionValue || !(c.form.weight > 0.0);
  });
  Eigen::MatrixXd measured_rows = measured(problem.data);
  problem.noise.whiten(measured_rows);
  std::vector<View> views;
  views.reserve(explanations.size());
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
  return views;
}

double least_of(const std::vector<Pair>& pairs) {
  return std::ranges::min_element(pairs, {}, &Pair::now)->now();
}

/// A condition of the choice and how often it is measured.
struct Chosen {
  Eigen::Index condition = 0;
  int repeats = 0;
};

/// First as many different conditions as help, then more repeats of the best of them, until every
/// pair is told apart or the rows are used up.
std::vector<Chosen> choose(Eigen::Index count, std::vector<Pair>& pairs) {
  std::vector<Chosen> chosen;
  std::vector<double> distances(pairs.size());
  const auto use_of = [&](Eigen::Index c) {
    std::ranges::transform(pairs, distances.begin(),
                           [&](const Pair& pair) { return pair.with(c, kRepeats); });
    return total_use(distances);
  };
  for (int rows = 0; rows < kMostRows && least_of(pairs) < kTellsApart; rows += kRepeats) {
    const bool fresh = static_cast<int>(chosen.size()) < kMostConditions;
    Eigen::Index best = -1;
    double best_use = -1.0;
    for (Eigen::Index c = 0; c < count; ++c) {
      const bool is_fresh = std::ranges::find(chosen, c, &Chosen::condition) == chosen.end();
      if (is_fresh != fresh) continue;
      const double use = use_of(c);
      if (use > best_use * (1.0 + 1e-9)) {
        best_use = use;
        best = c;
      }
    }
    if (best < 0) break;
    for (Pair& pair : pairs) pair.take(best, kRepeats);
    if (fresh) chosen.push_back({.condition = best});
    std::ranges::find(chosen, best, &Chosen::condition)->repeats += kRepeats;
  }
  return chosen;
}

/// What is said of a plan that leaves a pair together; drops conditions that tell nothing.
void say_what_is_too_little(const std::vector<Pair>& pairs, NextExperiment& plan) {
  const Pair& closest = *std::ranges::min_element(pairs, {}, &Pair::now);
  const bool useless = std::ranges::max_element(pairs, {}, &Pair::now)->now() < kUseless;
  plan.advice += fmt::format(
      "{}{} tell {} from {} (expected chi-square {:.2g}, {:g} is needed): {}, or widen the limits.",
      plan.advice.empty() ? "" : " ",
      useless ? fmt::format("Not even {} rows at {} conditions will", kMostRows, kMostConditions)
              : "These conditions will hardly",
      closest.one, closest.other, std::max(0.0, plan.expected_statistic), kTold,
      useless ? "measure something else" : "repeat more often");
  if (useless) plan.conditions.clear();
}

/// Where a candidate acts: its body, or the sensor whose zero it is.
std::string where(const Candidate& c) {
  if (!c.form.body.empty()) return c.form.body;
  return place_of(c) == Place::kMeasurement ? "sensor that was read" : "other sensor";
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
  const std::vector<Condition> conditions = possible_conditions(problem, explanations, options);
  std::vector<View> views = views_of(problem, explanations, conditions, scale);
  mark_what_is_as_good_as_the_level(views);
  std::vector<Pair> pairs = pairs_of(views);
  std::erase_if(pairs, [&](const Pair& pair) {
    if (!is_hopeless(pair)) return false;
    plan.inseparable.push_back({pair.one, pair.other});
    return true;
  });
  plan.advice = advice_on(plan.inseparable);
  if (pairs.empty()) return plan;
  for (const Chosen& c : choose(static_cast<Eigen::Index>(conditions.size()), pairs)) {
    plan.conditions.push_back(
        {.condition = conditions[static_cast<std::size_t>(c.condition)], .repeats = c.repeats});
  }
  plan.expected_statistic = least_of(pairs);
  if (plan.expected_statistic < kTold) say_what_is_too_little(pairs, plan);
  return plan;
}

std::optional<NextExperiment> next_experiment(const Problem& problem, const Hypothesis& hypothesis,
                                              const std::vector<FoundEffect>& found,
                                              const std::vector<Effect>& effects, double scale,
                                              double noise, const DiagnoseOptions& options) {
  const auto first = [&](const auto& is_open) -> std::optional<std::size_t> {
    for (std::size_t e = 0; e < found.size(); ++e) {
      if (is_open(e)) return e;
    }
    return std::nullopt;
  };
  // Which cause it is, or whether any, comes before where it sits: that is a question of its own,
  // for its own rows.
  std::optional<std::size_t> open = first(
      [&](std::size_t e) { return !found[e].replacements.empty() || effects[e].is_doubtful(); });
  const bool asks_where = !open;
  if (asks_where) open = first([&](std::size_t e) { return !found[e].other_bodies.empty(); });
  if (!open) return std::nullopt;
  const Candidate& own = hypothesis.effects[*open];
  std::vector<Explanation> explanations{{.id = std::string(own.cause->id),
                                         .fit = fit(problem, hypothesis, scale),
                                         .body = asks_where ? where(own) : std::string()}};
  for (const Replacement& r : found[*open].replacements) {
    explanations.push_back({.id = std::string(r.candidate.cause->id), .fit = r.fit});
  }
  if (asks_where) {
    for (const Replacement& r : found[*open].other_bodies) {
      explanations.push_back(
          {.id = std::string(r.candidate.cause->id), .fit = r.fit, .body = where(r.candidate)});
    }
  } else if (effects[*open].is_doubtful()) {
    explanations.push_back({.id = kNothingBehind,
                            .fit = fit(problem, without(hypothesis, *open), scale),
                            .is_rest = true});
  }
  return plan_experiment(problem, explanations, noise, options);
}

}  // namespace gear3k::calibrate
