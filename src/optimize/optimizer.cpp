#include "optimize/optimizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "numerics/parallel.hpp"
#include "optimize/blocking.hpp"
#include "optimize/objective_value.hpp"

namespace gear3k::optimize {

namespace {

/// Sets refined between two looks at the best: few at first, when it is still poor.
constexpr std::size_t kFirstWave = 32;
constexpr std::size_t kWave = 128;

/// The refinement of one task's sets.
class Run {
 public:
  Run(const Specification& spec, Progress& progress, const OptimizeOptions& options,
      OptimizeResult& result)
      : spec_(spec),
        progress_(progress),
        options_(options),
        result_(result),
        refiner_(spec),
        no_gain_(is_efficiency(first_objective(spec))
                     ? 0.0
                     : 4.0 * design::kFeasibilityTolerance *
                           objective_scale(first_objective(spec), spec)) {}

  void bound() {
    progress_.total = 0;  // while done and phase change, nothing is known
    progress_.done = 0;
    progress_.phase = Progress::Phase::kBounds;
    result_.bounds = std::make_shared<const SetBounds>(spec_, result_.search.candidates, progress_);
  }

  /// The sets in the order in which they are to be refined.
  std::vector<std::uint32_t> ordered() {
    const std::size_t count = result_.search.candidates.size();
    std::vector<std::uint32_t> order;
    order.reserve(count);
    bound_.resize(count);
    std::vector<char> infeasible(count);
    numerics::parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t k = block * kBlock; k < std::min(count, (block + 1) * kBlock); ++k) {
        const SetBound bound = result_.bounds->of(k);
        infeasible[k] = bound.infeasible ? 1 : 0;
        bound_[k] = merit_bound(spec_, bound, result_.search.candidates[k]);
      }
    });
    for (std::size_t k = 0; k < count; ++k) {
      infeasible_ += infeasible[k] != 0 ? 1 : 0;
      const bool reaches = bound_[k] > -std::numeric_limits<double>::infinity();
      if (infeasible[k] == 0 && reaches) order.push_back(static_cast<std::uint32_t>(k));
    }
    if (options_.best_only) {
      std::ranges::stable_sort(
          order, [&](std::uint32_t a, std::uint32_t b) { return bound_[a] > bound_[b]; });
    }
    return order;
  }

  void refine_all() {
    const std::vector<std::uint32_t> order = ordered();
    progress_.total = 0;
    progress_.done = 0;
    progress_.phase = Progress::Phase::kRefinement;
    progress_.feasible = 0;
    progress_.best_merit = -std::numeric_limits<double>::infinity();
    const ObjectiveRecord& first = objective_record(first_objective(spec_));
    progress_.shown_per_merit = sense_of(first.id) / first.per_unit;
    progress_.total = order.size();
    std::size_t size = options_.best_only ? kFirstWave : kWave;
    for (std::size_t begin = 0; begin < order.size() && !progress_.stop.load();) {
      std::size_t end = std::min(order.size(), begin + size);
      if (options_.best_only && result_.best) {
        const double best = merit_of(spec_, *result_.best);
        const auto past =
            std::partition_point(order.begin() + static_cast<std::ptrdiff_t>(begin), order.end(),
                                 [&](std::uint32_t k) { return bound_[k] > best + no_gain_; });
        const auto last = static_cast<std::size_t>(past - order.begin());
        progress_.total = last;
        end = std::min(end, last);
        if (begin == end) break;
      }
      refine_wave({order.data() + begin, end - begin});
      begin = end;
      size = std::min(2 * size, kWave);
    }
    result_.interrupted = progress_.stop.load();
    std::ranges::sort(result_.refined, {}, &RefinedSet::index);
    if (options_.best_only && !result_.interrupted && result_.best) {
      certify(order);
      if (progress_.stop.load()) {
        result_.certificate.reset();
        result_.interrupted = true;
      }
    }
  }

 private:
  static constexpr std::size_t kBlock = 1024;

  void refine_wave(std::span<const std::uint32_t> wave) {
    std::vector<std::optional<RefinedSet>> refined(wave.size());
    std::vector<char> fresh(wave.size());
    numerics::parallel_for(wave.size(), [&](std::size_t i) {
      const std::uint32_t k = wave[i];
      const auto known = std::ranges::lower_bound(options_.known, k, {}, &RefinedSet::index);
      if (known != options_.known.end() && known->index == k) {
        refined[i] = *known;
      } else {
        const Candidate& candidate = result_.search.candidates[k];
        refined[i] = refiner_.refine(candidate, result_.bounds->shifts().of(candidate.teeth),
                                     result_.bounds->of(k), progress_.stop);
        fresh[i] = 1;
      }
      if (!refined[i]) return;
      refined[i]->index = k;
      if (refined[i]->status == Status::kOptimal) {
        const double value = merit_of(spec_, *refined[i]);
        double seen = progress_.best_merit.load();
        while (value > seen && !progress_.best_merit.compare_exchange_weak(seen, value)) {
        }
        ++progress_.feasible;
      }
      ++progress_.done;
    });
    std::vector<RefinedSet> news;
    for (std::size_t i = 0; i < wave.size(); ++i) {
      if (!refined[i]) continue;
      if (fresh[i] != 0) news.push_back(*refined[i]);
      offer(*refined[i]);
      result_.refined.push_back(std::move(*refined[i]));
    }
    if (options_.on_wave && !news.empty()) options_.on_wave(news);
  }

  void offer(const RefinedSet& set) {
    if (set.status != Status::kOptimal) return;
    if (!result_.best) {
      result_.best = set;
      return;
    }
    const Objective first = first_objective(spec_);
    const auto cost = [&](const RefinedSet& s) {
      return std::pair(cost_in_steps(first, sense_of(first) * merit_of(spec_, s)), s.index);
    };
    if (cost(set) < cost(*result_.best)) result_.best = set;
  }

  void certify(const std::vector<std::uint32_t>& order) {
    Certificate c;
    c.best = merit_of(spec_, *result_.best);
    c.refined = result_.refined.size();
    c.objective_bounded = !is_of_load(first_objective(spec_));
    c.infeasible = infeasible_;
    c.bounded = result_.search.candidates.size() - infeasible_ - c.refined;
    if (c.refined < order.size()) c.largest_unrefined_bound = bound_[order[c.refined]];
    const double proven = kProven * objective_scale(first_objective(spec_), spec_) + no_gain_;
    std::vector<double> sharp(result_.refined.size());
    numerics::parallel_for(sharp.size(), [&](std::size_t i) {
      const std::size_t k = result_.refined[i].index;
      sharp[i] =
          bound_[k] > c.best + proven && !progress_.stop.load() &&
                  is_efficiency(first_objective(spec_))
              ? merit_bound(spec_, result_.bounds->sharpened(k), result_.search.candidates[k])
              : bound_[k];
    });
    c.global_bound = std::max(c.best, c.largest_unrefined_bound.value_or(c.best));
    for (const double bound : sharp) {
      c.global_bound = std::max(c.global_bound, bound);
      if (bound > c.best + proven) ++c.open;
    }
    name_strength_limits(c);
    result_.certificate = c;
  }

  void name_strength_limits(Certificate& c) const {
    if (!spec_.rating) return;
    for (const ConstraintRow& row : make_problem_rows(spec_, spec_.planets.front(), {}).rows) {
      if (!row.check || !row.check->record->rating) continue;
      const bool bounded =
          row.check->record->id == design::CheckId::kFlankSafety && bounds_flanks(spec_);
      auto& names = bounded ? c.strength_bounded : c.strength_not_bounded;
      if (std::ranges::find(names, row.name) == names.end()) names.push_back(row.name);
    }
  }

  const Specification& spec_;
  Progress& progress_;
  const OptimizeOptions& options_;
  OptimizeResult& result_;
  Refiner refiner_;
  /// What a design may gain by missing its limits as far as it may.
  double no_gain_;
  std::vector<double> bound_;
  std::size_t infeasible_ = 0;
};

}  // namespace

double merit_bound(const Specification& spec, const SetBound& bound, const Candidate& candidate) {
  const auto best_of = [&](Objective objective) {
    switch (objective) {
      case Objective::kBackwardEfficiency:
        return bound.eta_b;
      case Objective::kForwardEfficiency:
        return bound.eta_f;
      default:
        return best_value(objective, spec, candidate.teeth, candidate.planets);
    }
  };
  for (const ObjectiveLimit& limit : spec.objective_limits) {
    const double slack =
        design::kFeasibilityTolerance * std::abs(objective_scale(limit.objective, spec));
    if (sense_of(limit.objective) * (best_of(limit.objective) - limit.value) < -slack) {
      return -std::numeric_limits<double>::infinity();
    }
  }
  const Objective first = first_objective(spec);
  return sense_of(first) * best_of(first);
}

std::optional<RefinedSet> set_at(const OptimizeResult& result, std::size_t k) {
  const auto refined = std::ranges::lower_bound(result.refined, k, {}, &RefinedSet::index);
  if (refined != result.refined.end() && refined->index == k) return *refined;
  if (!result.bounds) return std::nullopt;
  const SetBound bound = result.bounds->of(k);
  const Candidate& candidate = result.search.candidates[k];
  RefinedSet set;
  if (bound.infeasible) {
    set = proven_infeasible(candidate, *bound.infeasible);
  } else if (result.interrupted) {
    return std::nullopt;
  } else {
    set.candidate = candidate;
    set.status = Status::kBounded;
  }
  set.index = static_cast<std::uint32_t>(k);
  return set;
}

void for_each_set(const OptimizeResult& result,
                  const std::function<void(std::size_t, const std::optional<RefinedSet>&)>& visit) {
  for (std::size_t k = 0; k < result.search.candidates.size(); ++k) visit(k, set_at(result, k));
}

OptimizeResult optimize(const Specification& spec, Progress& progress,
                        const OptimizeOptions& options) {
  if (options.best_only && judged_by_model(spec)) {
    throw std::invalid_argument(
        "optimize: best_only with a calibrated model at an operating point, allowed: one of them");
  }
  if (options.best_only && !has_bounds(spec)) {
    throw std::invalid_argument(
        "optimize: best_only with a specification that has no bounds, allowed: one of them");
  }
  OptimizeResult result;
  result.search = search_teeth(spec, progress);
  if (result.search.interrupted) {
    result.interrupted = true;
    return result;
  }
  Run run(spec, progress, options, result);
  run.bound();
  if (progress.stop.load()) {
    result.bounds = nullptr;
    result.interrupted = true;
    return result;
  }
  run.refine_all();
  result.pareto = pareto_front(result.refined, judged_by_model(spec));
  return result;
}

}  // namespace gear3k::optimize
