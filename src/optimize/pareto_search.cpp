#include "optimize/pareto_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "optimize/objective_value.hpp"

namespace gear3k::optimize {

namespace {

/// Limits give way by this share of an objective's scale: refined values may lie beyond what is
/// feasible, efficiencies by less than lost motion and sizes, which are themselves limits.
constexpr double kLimitSlack = 20.0 * design::kFeasibilityTolerance;
constexpr double kEfficiencySlack = 2.0 * design::kFeasibilityTolerance;

/// The specification with one objective and limits on the others [SI].
Specification limited(const Specification& spec, Objective first,
                      const std::vector<ObjectiveLimit>& limits) {
  using design::CheckId;
  Specification task = spec;
  task.objectives = {first};
  for (const ObjectiveLimit& limit : limits) {
    const auto lower = [&](std::optional<double>& bound, double value) {
      bound = bound ? std::min(*bound, value) : value;
    };
    switch (limit.objective) {
      case Objective::kLostMotion:
        lower(task.limits[CheckId::kOutputBacklashMax], limit.value);
        break;
      case Objective::kOuterDiameter:
        lower(task.limits[CheckId::kRingRootDiameter], limit.value - 2.0 * spec.bodies.ring_rim_m);
        break;
      case Objective::kRatioError:
        task.ratio.tolerance = std::min(task.ratio.tolerance, limit.value);
        break;
      default:
        task.objective_limits.push_back(limit);
        break;
    }
  }
  return task;
}

class FrontSearch {
 public:
  FrontSearch(const Specification& spec, Progress& progress, std::span<const RefinedSet> known)
      : spec_(spec), progress_(progress) {
    for (const RefinedSet& set : known) {
      if (set.status == Status::kOptimal) points_.push_back(point_of(set));
    }
  }

  ParetoFront run() {
    const std::size_t count = spec_.objectives.size();
    const auto anchors = anchor_points();
    if (anchors.size() == count) {
      front_.ideal.resize(count);
      front_.reference.resize(count);
      for (std::size_t k = 0; k < count; ++k) {
        front_.ideal[k] = anchors[k].values[k];
        front_.reference[k] = front_.ideal[k];
        for (const ParetoPoint& anchor : anchors) {
          if (cost(k, anchor.values[k]) > cost(k, front_.reference[k])) {
            front_.reference[k] = anchor.values[k];
          }
        }
      }
      points_.insert(points_.end(), anchors.begin(), anchors.end());
      over_grid();
    }
    keep_front();
    front_.interrupted = progress_.stop.load();
    return std::move(front_);
  }

 private:
  [[nodiscard]] double cost(std::size_t k, double value) const {
    return -sense_of(spec_.objectives[k]) * value;
  }

  std::optional<ParetoPoint> best_within(Objective first,
                                         const std::vector<ObjectiveLimit>& limits) {
    if (progress_.stop.load()) return std::nullopt;
    const Specification task = limited(spec_, first, limits);
    ++front_.searches;
    const OptimizeResult result = optimize(task, progress_, {.best_only = true});
    if (!result.best) return std::nullopt;
    return point_of(*result.best);
  }

  [[nodiscard]] ParetoPoint point_of(const RefinedSet& set) const {
    ParetoPoint point{.set = set, .values = {}};
    point.values.reserve(spec_.objectives.size());
    for (const Objective objective : spec_.objectives) {
      point.values.push_back(objective_of(spec_, set, objective));
    }
    return point;
  }

  /// For each objective a design that is best in it and, within that, in the others in turn.
  std::vector<ParetoPoint> anchor_points() {
    std::vector<ParetoPoint> anchors;
    for (const Objective objective : spec_.objectives) {
      auto point = best_within(objective, {});
      if (!point) break;
      points_.push_back(*point);
      std::vector<ObjectiveLimit> limits;
      Objective last = objective;
      for (const Objective other : spec_.objectives) {
        if (other == objective) continue;
        limits.push_back(limit_at(last, objective_of(spec_, point->set, last)));
        if (auto better = best_within(other, limits)) point = std::move(better);
        last = other;
      }
      anchors.push_back(std::move(*point));
    }
    return anchors;
  }

  [[nodiscard]] ObjectiveLimit limit_at(Objective objective, double value) const {
    const double slack = is_efficiency(objective) ? kEfficiencySlack
                                                  : kLimitSlack * objective_scale(objective, spec_);
    return {.objective = objective, .value = value - sense_of(objective) * slack};
  }

  void over_grid() {
    const std::size_t others = spec_.objectives.size() - 1;
    const auto steps = static_cast<std::size_t>(std::max(
        2.0, std::round(std::pow(spec_.pareto_points, 1.0 / static_cast<double>(others)))));
    std::vector<std::size_t> at(others, 0);
    while (!progress_.stop.load()) {
      std::vector<ObjectiveLimit> limits;
      for (std::size_t k = 0; k < others; ++k) {
        const double share = static_cast<double>(at[k]) / static_cast<double>(steps - 1);
        const double value =
            front_.ideal[k + 1] + share * (front_.reference[k + 1] - front_.ideal[k + 1]);
        limits.push_back(limit_at(spec_.objectives[k + 1], value));
      }
      if (auto point = best_within(spec_.objectives.front(), limits)) {
        points_.push_back(std::move(*point));
      }
      std::size_t k = 0;
      while (k < others && ++at[k] == steps) at[k++] = 0;
      if (k == others) break;
    }
  }

  /// Whether a is no worse than b everywhere, to what limits give way (an anchor's value may be at
  /// its limit, and the grid begins there).
  [[nodiscard]] bool covers(const ParetoPoint& a, const ParetoPoint& b) const {
    for (std::size_t k = 0; k < spec_.objectives.size(); ++k) {
      const double slack = is_efficiency(spec_.objectives[k])
                               ? kEfficiencySlack
                               : 4.0 * kLimitSlack * objective_scale(spec_.objectives[k], spec_);
      if (cost(k, a.values[k]) > cost(k, b.values[k]) + slack) return false;
    }
    return true;
  }

  void keep_front() {
    std::ranges::stable_sort(points_, [&](const ParetoPoint& a, const ParetoPoint& b) {
      for (std::size_t k = 0; k < spec_.objectives.size(); ++k) {
        const double cost_a = cost_in_steps(spec_.objectives[k], a.values[k]);
        const double cost_b = cost_in_steps(spec_.objectives[k], b.values[k]);
        if (cost_a != cost_b) return cost_a < cost_b;
      }
      return a.set.candidate < b.set.candidate;
    });
    // In this order a point is covered by ones before it, or after it within the slack.
    std::vector<ParetoPoint> kept;
    for (ParetoPoint& point : points_) {
      if (std::ranges::none_of(kept, [&](const auto& other) { return covers(other, point); })) {
        kept.push_back(std::move(point));
      }
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const bool covered =
          std::any_of(kept.begin() + static_cast<std::ptrdiff_t>(i) + 1, kept.end(),
                      [&](const ParetoPoint& later) { return covers(later, kept[i]); });
      if (!covered) front_.points.push_back(kept[i]);
    }
    if (front_.ideal.empty()) return;
    std::vector<std::vector<double>> unit;
    for (const ParetoPoint& point : front_.points) {
      std::vector<double> place;
      for (std::size_t k = 0; k < spec_.objectives.size(); ++k) {
        const double range = cost(k, front_.reference[k]) - cost(k, front_.ideal[k]);
        place.push_back(range > 0.0 ? (cost(k, point.values[k]) - cost(k, front_.ideal[k])) / range
                                    : 0.0);
      }
      unit.push_back(std::move(place));
    }
    front_.hypervolume = hypervolume(std::move(unit));
  }

  const Specification& spec_;
  Progress& progress_;
  ParetoFront front_;
  std::vector<ParetoPoint> points_;
};

}  // namespace

double hypervolume(std::vector<std::vector<double>> points) {
  if (points.empty()) return 0.0;
  const std::size_t last = points.front().size() - 1;
  for (auto& point : points) {
    for (double& x : point) x = std::clamp(x, 0.0, 1.0);
  }
  std::ranges::sort(points, {}, [&](const auto& point) { return point[last]; });
  if (last == 0) return 1.0 - points.front()[0];
  double volume = 0.0;
  std::vector<std::vector<double>> below;
  for (std::size_t k = 0; k < points.size(); ++k) {
    below.emplace_back(points[k].begin(), points[k].end() - 1);
    const double next = k + 1 < points.size() ? points[k + 1][last] : 1.0;
    if (next > points[k][last]) volume += (next - points[k][last]) * hypervolume(below);
  }
  return volume;
}

ParetoFront search_pareto_front(const Specification& spec, Progress& progress,
                                std::span<const RefinedSet> known) {
  return FrontSearch(spec, progress, known).run();
}

}  // namespace gear3k::optimize
