#include "optimize/optimizer.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "optimize/blocking.hpp"
#include "optimize/parallel.hpp"

namespace gear3k::optimize {

namespace {

/// Sets refined between two looks at the best: few at first, when it is still poor.
constexpr std::size_t kFirstWave = 32;
constexpr std::size_t kWave = 512;

/// The refinement of one task's sets.
class Run {
 public:
  Run(const Specification& spec, Progress& progress, const OptimizeOptions& options,
      OptimizeResult& result)
      : spec_(spec), progress_(progress), options_(options), result_(result), refiner_(spec) {}

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
    parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t k = block * kBlock; k < std::min(count, (block + 1) * kBlock); ++k) {
        const SetBound bound = result_.bounds->of(k);
        infeasible[k] = bound.infeasible ? 1 : 0;
        bound_[k] = objective_bound(bound, spec_.objective);
      }
    });
    for (std::size_t k = 0; k < count; ++k) {
      if (infeasible[k] == 0) order.push_back(static_cast<std::uint32_t>(k));
    }
    infeasible_ = count - order.size();
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
    progress_.total = order.size();
    std::size_t size = options_.best_only ? kFirstWave : kWave;
    for (std::size_t begin = 0; begin < order.size() && !progress_.stop.load();) {
      std::size_t end = std::min(order.size(), begin + size);
      if (options_.best_only && result_.best) {
        const double best = objective_of(*result_.best, spec_.objective);
        const auto past =
            std::partition_point(order.begin() + static_cast<std::ptrdiff_t>(begin), order.end(),
                                 [&](std::uint32_t k) { return bound_[k] >= best; });
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
    if (options_.best_only && !result_.interrupted && result_.best) certify(order);
  }

 private:
  static constexpr std::size_t kBlock = 1024;

  void refine_wave(std::span<const std::uint32_t> wave) {
    std::vector<std::optional<RefinedSet>> refined(wave.size());
    std::vector<char> fresh(wave.size());
    parallel_for(wave.size(), [&](std::size_t i) {
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
        const double value = judged_objective(spec_, *refined[i]);
        double seen = progress_.best_objective.load();
        while (value > seen && !progress_.best_objective.compare_exchange_weak(seen, value)) {
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
    const double value = judged_objective(spec_, set);
    const double best = judged_objective(spec_, *result_.best);
    if (value > best || (value == best && set.index < result_.best->index)) result_.best = set;
  }

  void certify(const std::vector<std::uint32_t>& order) {
    Certificate c;
    c.best = objective_of(*result_.best, spec_.objective);
    c.refined = result_.refined.size();
    c.infeasible = infeasible_;
    c.bounded = order.size() - c.refined;
    if (c.bounded > 0) c.largest_unrefined_bound = bound_[order[c.refined]];
    std::vector<double> sharp(result_.refined.size());
    parallel_for(sharp.size(), [&](std::size_t i) {
      const std::size_t k = result_.refined[i].index;
      sharp[i] = bound_[k] > c.best + kProven && !progress_.stop.load()
                     ? objective_bound(result_.bounds->sharpened(k), spec_.objective)
                     : bound_[k];
    });
    c.global_bound = std::max(c.best, c.largest_unrefined_bound.value_or(c.best));
    for (const double bound : sharp) {
      c.global_bound = std::max(c.global_bound, bound);
      if (bound > c.best + kProven) ++c.open;
    }
    result_.certificate = c;
  }

  const Specification& spec_;
  Progress& progress_;
  const OptimizeOptions& options_;
  OptimizeResult& result_;
  Refiner refiner_;
  std::vector<double> bound_;
  std::size_t infeasible_ = 0;
};

}  // namespace

double objective_bound(const SetBound& bound, Objective objective) {
  return objective == Objective::kForwardEfficiency ? bound.eta_f : bound.eta_b;
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
