#include "optimize/pareto_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "optimize/front_gaps.hpp"
#include "optimize/held_objectives.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/set_answers.hpp"
#include "optimize/set_least.hpp"

namespace gear3k::optimize {

namespace {

/// Limits give way by this share of an objective's scale: refined values may lie beyond what is
/// feasible, efficiencies by less than lost motion and sizes, which are themselves limits.
constexpr double kLimitSlack = 20.0 * design::kFeasibilityTolerance;
/// Limits on lost motion within which sets are asked for their least first, over what bounds it:
/// of examples/ratio-96.toml most have a design beyond.
constexpr double kNarrow = 1.08;

double slack_of(const Specification& spec, Objective objective) {
  return is_efficiency(objective) ? design::kFeasibilitySlack
                                  : kLimitSlack * std::abs(objective_scale(objective, spec));
}

/// What an end of the front may lose of what its objective has alone: what is feasible; of a value
/// beside 0, as a lost motion may be, what limits give way elsewhere, as less is beyond reach.
double end_slack(const Specification& spec, Objective objective, double value) {
  constexpr double kBesideZero = 1e-3;  // of the objective's scale
  const double slack = slack_of(spec, objective);
  if (std::abs(value) < kBesideZero * std::abs(objective_scale(objective, spec))) return slack;
  return std::min(slack, design::kFeasibilitySlack * std::abs(value));
}

/// A design of the front as it is searched.
struct Found {
  ParetoPoint point;
  bool is_end = false;  ///< best in an objective: others take its place only where they are as good
  bool bettered = false;  ///< in what its search did not ask for
};

class FrontSearch {
 public:
  FrontSearch(const Specification& spec, Progress& progress, const FrontOptions& options)
      : spec_(spec), progress_(progress), options_(options), answers_(spec, costs_in(spec)) {
    if (LeastLostMotion::knows(spec) &&
        std::ranges::find(spec.objectives, Objective::kLostMotion) != spec.objectives.end()) {
      least_.emplace(spec);
    }
    learn();
  }

  ParetoFront run() {
    const std::size_t count = spec_.objectives.size();
    progress_.stage_done = 0;
    progress_.searches = 0;
    progress_.stage_total = count * count;
    progress_.stage = Progress::Stage::kFrontEnds;
    progress_.stop.open_part();
    const std::vector<double> alone = search_ends();
    if (alone.size() == count) {
      front_.ideal = alone;
      front_.reference = alone;
      for (const Found& end : points_) {
        for (std::size_t k = 0; k < count; ++k) {
          const double value = end.point.values[k];
          if (cost(k, value) < cost(k, front_.ideal[k])) front_.ideal[k] = value;
          if (cost(k, value) > cost(k, front_.reference[k])) front_.reference[k] = value;
        }
      }
      fill_gaps();
    }
    if (progress_.stop.close_part()) front_.ended = ParetoFront::Ended::kBudget;
    for (Found& found : points_) better(found);
    for (Found& found : front_of(std::move(points_))) {
      front_.points.push_back(std::move(found.point));
    }
    measure();
    progress_.stage = Progress::Stage::kOne;
    front_.interrupted = progress_.stop.load();
    if (front_.interrupted) front_.ended = ParetoFront::Ended::kInterrupted;
    return std::move(front_);
  }

 private:
  [[nodiscard]] double cost(std::size_t k, double value) const {
    return -sense_of(spec_.objectives[k]) * value;
  }

  /// The best of a search of the whole space, or what an earlier run had of it.
  std::optional<ParetoPoint> best_within(Objective first,
                                         const std::vector<ObjectiveLimit>& limits) {
    if (progress_.stop.load()) return std::nullopt;
    const std::size_t number = front_.searches;
    FrontStep step;
    if (number < options_.steps.size()) {
      step = options_.steps[number];
      answers_.take(ask_of(first, limits), options_.steps[number].refined);
    } else {
      ++progress_.searches;
      const Specification task = with_limits(spec_, first, limits);
      const OptimizeResult result = optimize(task, progress_, options_of(task, first, limits));
      if (result.interrupted) return std::nullopt;
      step = {.best = result.best, .refined = std::exchange(fresh_, {})};
      answers_.keep(ask_of(first, limits), step.refined);
      if (options_.on_step) options_.on_step(step);
    }
    front_.grid_cut += static_cast<std::size_t>(
        std::ranges::count_if(step.refined, [](const RefinedSet& set) { return set.grid_cut; }));
    ++front_.searches;
    ++progress_.stage_done;
    if (!step.best) return std::nullopt;
    return point_of(*step.best);
  }

  static SetAnswers::Objectives costs_in(const Specification& spec) {
    SetAnswers::Objectives costs{.each = spec.objectives, .slack = {}};
    for (const Objective objective : spec.objectives) {
      costs.slack.push_back(slack_of(spec, objective));
    }
    return costs;
  }

  [[nodiscard]] CostAsk ask_of(Objective first, const std::vector<ObjectiveLimit>& limits) const {
    CostAsk ask{.first = 0, .limits = std::vector<double>(spec_.objectives.size(), kInfinity)};
    for (std::size_t k = 0; k < spec_.objectives.size(); ++k) {
      if (spec_.objectives[k] == first) ask.first = k;
      for (const ObjectiveLimit& limit : limits) {
        if (limit.objective == spec_.objectives[k]) ask.limits[k] = cost(k, limit.value);
      }
    }
    return ask;
  }

  /// Takes what the search for the first objective alone has of each set.
  void learn() {
    if (options_.searched == nullptr) return;
    const OptimizeResult& searched = *options_.searched;
    answers_.take(ask_of(spec_.objectives.front(), {}), searched.refined);
    const auto& candidates = searched.search.candidates;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      open_.emplace_back(candidates[k], static_cast<std::uint32_t>(k));
    }
    std::ranges::sort(open_);
  }

  /// What is known of the sets before a search within limits.
  [[nodiscard]] OptimizeOptions options_of(const Specification& task, Objective first,
                                           const std::vector<ObjectiveLimit>& limits) {
    const CostAsk ask = ask_of(first, limits);
    OptimizeOptions options{.best_only = true, .certify = false};
    const std::optional<double> most_lost_motion = lost_motion_limit(limits);
    options.answer = [this, ask,
                      most_lost_motion](const Candidate& candidate) -> std::optional<RefinedSet> {
      auto answer = answers_.answer(ask, candidate);
      if (answer || !most_lost_motion) return answer;
      return ruled_out(candidate, *most_lost_motion);
    };
    // The ends of the front are told as their own starts find them.
    if (most_lost_motion && progress_.stage == Progress::Stage::kFrontGaps) {
      options.design = [this, most = *most_lost_motion](const Candidate& candidate) {
        // Asked just before where the limit is narrow; beyond it what is known by chance is no
        // start, as a run that goes on with an earlier one does not know it.
        const auto* least = is_narrow(candidate, most) ? least_->known(candidate) : nullptr;
        const bool any = least != nullptr && std::isfinite(least->lost_motion_rad);
        return any && !keeps_not(least, most) ? &least->at : nullptr;
      };
    }
    options.on_wave = [this](std::span<const RefinedSet> sets) {
      fresh_.insert(fresh_.end(), sets.begin(), sets.end());
    };
    options.incumbent = answers_.best_within(ask);
    if (options_.searched != nullptr && options_.searched->bounds) {
      options.bound_before = [this, &task, ask](const Candidate& candidate) {
        const double known = -answers_.least_cost(ask, candidate);
        const auto own = std::ranges::lower_bound(open_, candidate, {}, &Numbered::first);
        if (own == open_.end() || own->first != candidate) return known;
        const SetBound bound = options_.searched->bounds->of(own->second);
        return bound.infeasible ? -kInfinity : std::min(known, merit_bound(task, bound, candidate));
      };
    }
    return options;
  }

  /// The limit on lost motion of a search where sets are asked for their least [rad], with what
  /// refined values may be beyond it.
  [[nodiscard]] std::optional<double> lost_motion_limit(
      const std::vector<ObjectiveLimit>& limits) const {
    const auto own = std::ranges::find(limits, Objective::kLostMotion, &ObjectiveLimit::objective);
    if (!least_ || own == limits.end()) return std::nullopt;
    return own->value + slack_of(spec_, Objective::kLostMotion);
  }

  static bool keeps_not(const LeastLostMotion::Least* least, double most_rad) {
    return least != nullptr && least->lost_motion_rad > most_rad;
  }

  /// Whether a limit is so near what bounds a set that it is asked for its least first.
  [[nodiscard]] bool is_narrow(const Candidate& candidate, double most_rad) const {
    return most_rad <=
           kNarrow * best_value(Objective::kLostMotion, spec_, candidate.teeth, candidate.planets);
  }

  /// A set whose least lost motion is above a limit that is near what bounds it.
  std::optional<RefinedSet> ruled_out(const Candidate& candidate, double most_rad) {
    if (!is_narrow(candidate, most_rad)) return std::nullopt;
    if (!keeps_not(least_->of(candidate, progress_.stop), most_rad)) return std::nullopt;
    RefinedSet none;
    none.candidate = candidate;
    none.status = Status::kNoFeasibleFound;
    return none;
  }

  [[nodiscard]] ParetoPoint point_of(const RefinedSet& set) const {
    ParetoPoint point{.set = set, .values = {}};
    point.values.reserve(spec_.objectives.size());
    for (const Objective objective : spec_.objectives) {
      point.values.push_back(objective_of(spec_, set, objective));
    }
    return point;
  }

  /// Betters a design in what its search did not ask for, unless the search is to end.
  void better(Found& found) const {
    if (found.bettered) return;
    const auto set = bettered(spec_, found.point.set, progress_.stop);
    if (!set) return;
    found.point = point_of(*set);
    found.bettered = true;
  }

  /// For each objective a design that is best in it and, within that, in the others in turn.
  /// @returns what each has alone; fewer where one has no design
  std::vector<double> search_ends() {
    std::vector<double> alone;
    for (const Objective objective : spec_.objectives) {
      auto point = best_within(objective, {});
      if (!point) break;
      alone.push_back(objective_of(spec_, point->set, objective));
      std::vector<ObjectiveLimit> limits;
      Objective last = objective;
      for (const Objective other : spec_.objectives) {
        if (other == objective) continue;
        const double value = objective_of(spec_, point->set, last);
        limits.push_back(limit_at(last, value, end_slack(spec_, last, value)));
        if (auto better = best_within(other, limits)) point = std::move(better);
        last = other;
      }
      points_.push_back({.point = std::move(*point), .is_end = true});
      better(points_.back());
    }
    return alone;
  }

  static ObjectiveLimit limit_at(Objective objective, double value, double slack) {
    return {.objective = objective, .value = value - sense_of(objective) * slack};
  }

  /// A value between ideal (0) and reference (1).
  [[nodiscard]] double value_at(std::size_t k, double share) const {
    return front_.ideal[k] + share * (front_.reference[k] - front_.ideal[k]);
  }

  [[nodiscard]] std::vector<double> costs_of(const ParetoPoint& point) const {
    std::vector<double> costs(spec_.objectives.size());
    for (std::size_t k = 0; k < costs.size(); ++k) {
      const double range = cost(k, front_.reference[k]) - cost(k, front_.ideal[k]);
      costs[k] = range > 0.0 ? (cost(k, point.values[k]) - cost(k, front_.ideal[k])) / range : 0.0;
    }
    return costs;
  }

  void fill_gaps() {
    FrontGaps gaps(spec_.objectives.size());
    points_ = front_of(std::move(points_));
    for (const Found& found : points_) gaps.add(costs_of(found.point));
    const auto wanted = static_cast<std::size_t>(spec_.pareto_points);
    const std::size_t most = front_.searches + kMostSearches * wanted;
    progress_.stage_done = 0;
    progress_.searches = 0;
    progress_.stage_total = wanted > points_.size() ? wanted - points_.size() : 0;
    progress_.stage = Progress::Stage::kFrontGaps;
    const std::size_t at_first = points_.size();
    front_.ended = ParetoFront::Ended::kDesigns;
    while (points_.size() < wanted) {
      const auto place = gaps.next(kFrontFound);
      if (!place || front_.searches >= most) {
        front_.ended = place ? ParetoFront::Ended::kSearches : ParetoFront::Ended::kFound;
        break;
      }
      std::vector<ObjectiveLimit> limits;
      limits.reserve(place->size());
      for (std::size_t k = 1; k < spec_.objectives.size(); ++k) {
        const Objective objective = spec_.objectives[k];
        limits.push_back(
            limit_at(objective, value_at(k, (*place)[k - 1]), slack_of(spec_, objective)));
      }
      auto point = best_within(spec_.objectives.front(), limits);
      std::optional<Found> found;
      if (point) better(found.emplace(Found{.point = std::move(*point)}));
      if (progress_.stop.load()) break;
      gaps.found(found ? std::optional(costs_of(found->point)) : std::nullopt);
      if (found) {
        points_.push_back(std::move(*found));
        points_ = front_of(std::move(points_));
      }
      progress_.stage_done = std::max(points_.size(), at_first) - at_first;
    }
    front_.missing = gaps.missing();
  }

  /// What b may be better by where a takes its place: what limits give way (an end's value may be
  /// at its limit, and the grid begins there), of an end what its objective is held to.
  [[nodiscard]] double covering_slack(std::size_t k, const Found& b) const {
    const Objective objective = spec_.objectives[k];
    if (b.is_end) return held_slack(b.point.values[k]);
    return is_efficiency(objective) ? design::kFeasibilitySlack
                                    : 4.0 * kLimitSlack * objective_scale(objective, spec_);
  }

  /// Whether a is no worse than b everywhere.
  [[nodiscard]] bool covers(const Found& a, const Found& b) const {
    for (std::size_t k = 0; k < spec_.objectives.size(); ++k) {
      const double worse = cost(k, a.point.values[k]) - cost(k, b.point.values[k]);
      if (worse > covering_slack(k, b)) return false;
    }
    return true;
  }

  /// The points that no other one covers, from best to worst by the first objective.
  [[nodiscard]] std::vector<Found> front_of(std::vector<Found> points) const {
    std::ranges::stable_sort(points, [&](const Found& a, const Found& b) {
      for (std::size_t k = 0; k < spec_.objectives.size(); ++k) {
        const double cost_a = cost_in_steps(spec_.objectives[k], a.point.values[k]);
        const double cost_b = cost_in_steps(spec_.objectives[k], b.point.values[k]);
        if (cost_a != cost_b) return cost_a < cost_b;
      }
      return a.point.set.candidate < b.point.set.candidate;
    });
    // In this order a point is covered by ones before it, or after it within the slack.
    std::vector<Found> kept;
    for (Found& found : points) {
      if (std::ranges::none_of(kept, [&](const Found& other) { return covers(other, found); })) {
        kept.push_back(std::move(found));
      }
    }
    std::vector<Found> front;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const bool covered =
          std::any_of(kept.begin() + static_cast<std::ptrdiff_t>(i) + 1, kept.end(),
                      [&](const Found& later) { return covers(later, kept[i]); });
      if (!covered) front.push_back(kept[i]);
    }
    return front;
  }

  /// Holds the designs found: a search may end beyond what an objective alone has come to.
  void hold_points() {
    for (const ParetoPoint& point : front_.points) {
      for (std::size_t k = 0; k < front_.ideal.size(); ++k) {
        const double value = point.values[k];
        if (cost(k, value) < cost(k, front_.ideal[k])) front_.ideal[k] = value;
        if (cost(k, value) > cost(k, front_.reference[k])) front_.reference[k] = value;
      }
    }
  }

  void measure() {
    if (front_.ideal.empty()) return;
    // The gaps are of this box, too.
    front_.box_best = front_.ideal;
    front_.box_worst = front_.reference;
    std::vector<std::vector<double>> unit;
    unit.reserve(front_.points.size());
    for (const ParetoPoint& point : front_.points) unit.push_back(costs_of(point));
    front_.hypervolume = hypervolume(std::move(unit));
    front_.missing = std::min(front_.missing, 1.0 - front_.hypervolume);
    hold_points();
  }

  const Specification& spec_;
  Progress& progress_;
  const FrontOptions& options_;
  ParetoFront front_;
  std::vector<Found> points_;
  SetAnswers answers_;
  std::optional<LeastLostMotion> least_;  ///< where lost motion is an objective
  using Numbered = std::pair<Candidate, std::uint32_t>;
  std::vector<Numbered> open_;     ///< the sets of the search before, sorted
  std::vector<RefinedSet> fresh_;  ///< what the search that runs has refined
};

}  // namespace

ParetoFront search_pareto_front(const Specification& spec, Progress& progress,
                                const FrontOptions& options) {
  return FrontSearch(spec, progress, options).run();
}

}  // namespace gear3k::optimize
