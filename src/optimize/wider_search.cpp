#include "optimize/wider_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "numerics/parallel.hpp"
#include "optimize/moved_limit.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/refine.hpp"

namespace gear3k::optimize {

namespace {

constexpr int kMoreTeeth = 2;
constexpr double kMoreTolerance = 1.1;

/// A task with one bound given way.
struct WiderTask {
  Specification spec;
  double value = 0.0;       ///< of the key then
  bool beyond_only = true;  ///< it has only what lies beyond
};

std::optional<WiderTask> wider_range(const Specification& spec, const std::string& key,
                                     IntegerRange ToothRanges::*range, std::string_view gear) {
  WiderTask task{.spec = spec};
  const IntegerRange& stated = spec.teeth.*range;
  if (key == fmt::format("teeth.{}[1]", gear)) {
    task.spec.teeth.*range = {.min = stated.max + 1, .max = stated.max + kMoreTeeth};
    task.value = stated.max + kMoreTeeth;
    return task;
  }
  if (key != fmt::format("teeth.{}[0]", gear) || stated.min <= kMoreTeeth + 1) return std::nullopt;
  task.spec.teeth.*range = {.min = stated.min - kMoreTeeth, .max = stated.min - 1};
  task.value = stated.min - kMoreTeeth;
  return task;
}

std::optional<WiderTask> wider_task(const Specification& spec, const std::string& key) {
  for (const auto& [gear, range] :
       {std::pair{"S", &ToothRanges::S}, std::pair{"P1", &ToothRanges::P1},
        std::pair{"P2", &ToothRanges::P2}}) {
    if (auto task = wider_range(spec, key, range, gear)) return task;
  }
  WiderTask task{.spec = spec, .value = 0.0, .beyond_only = false};
  ToothRanges& teeth = task.spec.teeth;
  if (key == "teeth.R1_max") {
    task.value = teeth.R1_max += kMoreTeeth;
  } else if (key == "teeth.R2_max") {
    task.value = teeth.R2_max += kMoreTeeth;
  } else if (key == "teeth.max_coaxial_offset") {
    task.value = ++teeth.max_coaxial_offset;
  } else if (key == "teeth.min_internal_difference" && teeth.min_internal_difference > 1) {
    task.value = --teeth.min_internal_difference;
  } else if (key == "ratio.tolerance" && task.spec.ratio.tolerance > 0.0) {
    task.value = task.spec.ratio.tolerance *= kMoreTolerance;
  } else {
    return std::nullopt;
  }
  return task;
}

double step_si(const LimitPrice& price) { return giving_step(price) * units::si_per(price.unit); }

/// Whether all sets are searched again, beyond a range or with a limit given way.
bool is_searched_again(const Specification& spec) {
  return is_efficiency(first_objective(spec)) && has_bounds(spec) && !judged_by_model(spec);
}

/// The task beyond a bound; empty where it is not searched.
std::optional<WiderTask> task_beyond(const Specification& spec, const SearchBound& bound,
                                     std::size_t sets) {
  auto task = wider_task(spec, bound.key);
  if (!task || (!task->beyond_only && sets > kMostSearchedAgain)) return std::nullopt;
  task->spec.objectives = {first_objective(spec)};
  return task;
}

/// The optimum of a set as a start of the task with a limit moved.
KnownTrain start_in(const Specification& moved, const Specification& spec, const RefinedSet& set) {
  KnownTrain known{.train = train_of(spec, set),
                   .load = {.face_width_m = set.train.face_width_m,
                            .torque_Nm = set.torque_capacity_Nm.value_or(0.0)}};
  // Tips are shortened from the greatest addendum.
  for (double& shortening : known.train.tip_shortening) {
    shortening += moved.rack.addendum - spec.rack.addendum;
  }
  return known;
}

/// The task with the dearest limit given way by its step [SI]; empty where there is none, or it is
/// not asked for.
std::optional<Specification> relaxed_task(const Specification& spec, const LimitPrice* price) {
  if (price == nullptr || spec.robust.hold != Hold::kNominal || judged_by_model(spec)) {
    return std::nullopt;
  }
  auto own = with_limit_moved(spec, *price, step_si(*price));
  if (own) own->objectives = {first_objective(spec)};
  return own;
}

}  // namespace

std::size_t searches_again(const Specification& spec, std::size_t sets, const HeldBack& held) {
  if (!is_searched_again(spec)) return 0;
  const auto beyond = std::ranges::count_if(held.at, [&](const SearchBound& bound) {
    return task_beyond(spec, bound, sets).has_value();
  });
  const bool relaxed = sets <= kMostSearchedAgain && relaxed_task(spec, dearest(held));
  return static_cast<std::size_t>(beyond) + (relaxed ? 1 : 0);
}

void refine_gains(const Specification& spec, const RefinedSet& best, HeldBack& held,
                  Progress& progress) {
  const Objective first = first_objective(spec);
  const double before = objective_of(spec, best, first);
  std::atomic<bool> stopped{false};
  const auto is_moved = [](const LimitPrice& price) {
    return price.stated && price.loosened != 0.0;
  };
  progress.total = 0;
  progress.done = 0;
  progress.phase = Progress::Phase::kRefinement;
  progress.total = static_cast<std::size_t>(std::ranges::count_if(held.prices, is_moved));
  numerics::parallel_for(held.prices.size(), [&](std::size_t k) {
    LimitPrice& price = held.prices[k];
    if (!is_moved(price)) return;
    const std::optional<Specification> own = relaxed_task(spec, &price);
    if (!own) {
      ++progress.done;
      return;
    }
    const KnownTrain start = start_in(*own, spec, best);
    const std::optional<RefinedSet> again =
        refine(*own, best.candidate, progress.stop, {.design = &start});
    if (!again) {
      stopped = true;
      return;
    }
    ++progress.done;
    if (!has_design(again->status)) return;
    const double gain = objective_of(*own, *again, first) - before;
    if (sense_of(first) * gain > 0.0) {
      price.refined_gain_si = gain;
    } else if (again->status == Status::kOptimal) {
      price.refined_gain_si = 0.0;
    }
  });
  held.interrupted = held.interrupted || stopped;
}

void search_beyond(const Specification& spec, const RefinedSet& best, std::size_t sets,
                   HeldBack& held, Progress& progress) {
  if (!is_searched_again(spec)) return;
  const Objective first = first_objective(spec);
  progress.stage = Progress::Stage::kBeyond;
  progress.stage_done = 0;
  progress.searches = 0;
  progress.stage_total = searches_again(spec, sets, held);
  for (SearchBound& bound : held.at) {
    const auto task = task_beyond(spec, bound, sets);
    if (!task) continue;
    ++progress.searches;
    const OptimizeResult result =
        optimize(task->spec, progress, {.best_only = true, .certify = false});
    if (result.interrupted) {
      held.interrupted = true;
      break;
    }
    WiderSearch wider{.value = task->value, .better = std::nullopt};
    const auto cost = [&](const RefinedSet& set) {
      return cost_in_steps(first, objective_of(spec, set, first));
    };
    if (result.best && cost(*result.best) < cost(best)) wider.better = result.best;
    bound.wider = wider;
    ++progress.stage_done;
  }
  progress.stage = Progress::Stage::kOne;
}

void search_relaxed(const Specification& spec, const RefinedSet& best, std::size_t sets,
                    HeldBack& held, Progress& progress) {
  const LimitPrice* const price = dearest(held);
  const std::optional<Specification> own = relaxed_task(spec, price);
  if (!own) return;
  const Objective first = first_objective(spec);
  const auto cost = [&](const RefinedSet& set) {
    return cost_in_steps(first, objective_of(*own, set, first));
  };
  RelaxedAnswer relaxed{.key = price->key, .value_si = price->value_si + step_si(*price)};
  const KnownTrain start = start_in(*own, spec, best);
  const std::optional<RefinedSet> again =
      refine(*own, best.candidate, progress.stop, {.design = &start});
  if (!again) {
    held.interrupted = true;
    return;
  }
  if (has_design(again->status) && cost(*again) < cost(best)) relaxed.better = again;
  relaxed.all_sets = is_searched_again(*own) && sets <= kMostSearchedAgain;
  if (relaxed.all_sets) {
    progress.stage = Progress::Stage::kBeyond;
    progress.stage_total = std::max<std::size_t>(1, searches_again(spec, sets, held));
    progress.stage_done = progress.stage_total - 1;
    ++progress.searches;
    const OptimizeResult result = optimize(
        *own, progress, {.best_only = true, .certify = false, .incumbent = relaxed.better});
    progress.stage = Progress::Stage::kOne;
    if (result.interrupted) {
      held.interrupted = true;
      return;
    }
    const auto beaten = [&] { return cost(relaxed.better ? *relaxed.better : best); };
    if (result.best && cost(*result.best) < beaten()) relaxed.better = result.best;
  }
  held.relaxed = std::move(relaxed);
}

}  // namespace gear3k::optimize
