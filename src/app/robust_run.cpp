#include "app/robust_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "backlash/turn.hpp"
#include "backlash/turn_yield.hpp"
#include "design/built_series.hpp"
#include "optimize/cheapest_tolerances.hpp"
#include "optimize/robust.hpp"

namespace gear3k::app {

void restart(optimize::Progress& progress) {
  progress.phase = optimize::Progress::Phase::kSearch;
  progress.total = 0;
  progress.done = 0;
  progress.feasible = 0;
}

namespace {

/// The design of a refined set with the limits that were stated.
design::Design stated_limits_of(const OptimizeTask& task, const optimize::RefinedSet& set) {
  design::Design design = optimize::design_of(task.spec, set);
  design.limits = task.stated_limits;
  return design;
}

/// What gearboxes over a whole turn of two designs cost, in gearboxes built, before these are
/// known; and one position of one of them.
constexpr std::size_t kTurned = 8'000'000;
constexpr double kPosition = 0.6;

/// Gearboxes of a design over a whole turn.
backlash::TurnYield turn_of_built(const design::Design& design, std::uint64_t seed) {
  const auto model = design::clearance_model_of(design);
  return backlash::turn_yield(*model, design.train.teeth,
                              {.seed = seed,
                               .scatter = {.scatter = design.tolerances->scatter,
                                           .sigma_level = design.tolerances->sigma_level},
                               .limit_rad = design.limits[design::CheckId::kOutputBacklashMax]});
}

/// Tolerances that cost least for the design found, instead of the stated ones.
report::RobustRun::Cheapest cheapen(optimize::Specification& spec, const design::Design& design,
                                    const report::RobustRun& run, optimize::Progress& progress) {
  restart(progress);
  progress.phase = optimize::Progress::Phase::kGearboxes;
  auto model = design::clearance_model_of(design);
  const auto& limit = design.limits[design::CheckId::kOutputBacklashMax];
  report::RobustRun::Cheapest result{
      .model = std::move(*model), .stated = *spec.tolerances, .tolerances = {}, .built = {}};
  result.tolerances = optimize::cheapest_tolerances(
      result.model, {.yield = spec.robust.yield,
                     .limit_rad = limit.value_or(std::numeric_limits<double>::infinity()),
                     .cost = spec.robust.cost,
                     .scatter = {.scatter = spec.tolerances->scatter,
                                 .sigma_level = spec.tolerances->sigma_level},
                     .seed = spec.sampling.seed,
                     .may_widen =
                         [&](const std::vector<double>& factor) {
                           design::Design wide = design;
                           wide.tolerances =
                               optimize::scaled(*spec.tolerances, result.model, factor,
                                                std::cos(design.train.pressure_angle_rad));
                           return optimize::checks_hold(wide);
                         },
                     .stop = [&] { return progress.stop.load(); }});
  spec.tolerances = optimize::scaled(*spec.tolerances, result.model, result.tolerances.factor,
                                     std::cos(design.train.pressure_angle_rad));
  design::Design cheap = design;
  result.chosen = *spec.tolerances;
  cheap.tolerances = spec.tolerances;
  result.built = optimize::built_outcome(cheap, run.samples, run.fresh_seed);
  result.turn = turn_of_built(cheap, run.fresh_seed);
  return result;
}

/// What turn_of_built() costs, in gearboxes built.
std::size_t built_in_turn(const design::Design& design) {
  const auto gearboxes = static_cast<double>(backlash::TurnYieldOptions{}.gearboxes);
  const auto positions = static_cast<double>(backlash::turn_window(design.train.teeth).samples);
  return static_cast<std::size_t>(kPosition * gearboxes * positions);
}

}  // namespace

report::RobustRun hold_for_built(OptimizeTask& task, optimize::Progress& progress) {
  optimize::Specification& spec = task.spec;
  const bool best_only = optimize::has_bounds(spec) && !optimize::judged_by_model(spec);
  report::RobustRun run;
  progress.stage = optimize::Progress::Stage::kBuilt;
  progress.stage_done = 0;
  progress.searches = 0;
  progress.stage_total = optimize::most_robust_passes(spec.robust.hold);
  const auto samples = static_cast<std::size_t>(spec.sampling.samples);
  progress.built_per_pass = std::min<std::size_t>(optimize::kRobustSamples, samples);
  progress.built_after = 2 * samples + kTurned;
  run.search = optimize::robust_limits(spec, [&](const optimize::Specification& tightened) {
    restart(progress);
    ++progress.searches;
    optimize::OptimizeResult result =
        optimize::optimize(tightened, progress, {.best_only = best_only, .certify = false});
    ++progress.stage_done;
    progress.phase = optimize::Progress::Phase::kGearboxes;
    return optimize::SearchOutcome{.best = std::move(result.best),
                                   .interrupted = result.interrupted,
                                   .grid_cut = static_cast<std::size_t>(std::ranges::count_if(
                                       result.refined, &optimize::RefinedSet::grid_cut))};
  });
  progress.stage_done = progress.stage_total.load();  // what follows is built, not searched
  progress.total = 0;
  progress.done = 0;
  if (!run.search.chosen || run.search.interrupted) {
    progress.stage = optimize::Progress::Stage::kOne;
    return run;
  }
  const optimize::RobustPass& chosen = run.search.passes[*run.search.chosen];
  run.samples = static_cast<std::uint64_t>(spec.sampling.samples);
  run.fresh_seed = spec.sampling.seed + 1;
  const design::Design nominal = stated_limits_of(task, *run.search.passes.front().best);
  const design::Design held = stated_limits_of(task, *chosen.best);
  const std::array turned{built_in_turn(nominal), built_in_turn(held)};
  progress.total = 2 * run.samples + turned[0] + turned[1];
  run.nominal = optimize::built_outcome(nominal, run.samples, run.fresh_seed);
  progress.done += run.samples;
  run.chosen = optimize::built_outcome(held, run.samples, run.fresh_seed);
  progress.done += run.samples;
  run.nominal_turn = turn_of_built(nominal, run.fresh_seed);
  progress.done += turned[0];
  run.chosen_turn = turn_of_built(held, run.fresh_seed);
  progress.done += turned[1];
  if (spec.robust.cheapest) run.cheapest = cheapen(spec, held, run, progress);
  progress.stage = optimize::Progress::Stage::kOne;
  spec.limits = chosen.limits;
  return run;
}

}  // namespace gear3k::app
