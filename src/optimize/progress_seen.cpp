#include "optimize/run_forecast.hpp"

namespace gear3k::optimize {

ProgressSeen seen_of(const Progress& progress) {
  return {.phase = progress.phase.load(),
          .stage = progress.stage.load(),
          .plan = {.front_objectives = progress.front_objectives.load(),
                   .front_designs = progress.front_designs.load(),
                   .front_lost_motion = progress.front_lost_motion.load(),
                   .rounding = progress.rounding.load(),
                   .best_only = progress.best_only.load(),
                   .planets = progress.planets.load(),
                   .told = progress.told.load(),
                   .ties = progress.ties.load(),
                   .explains = progress.explains.load(),
                   .passes_least = progress.passes_least.load(),
                   .passes_most = progress.passes_most.load(),
                   .built_per_pass = progress.built_per_pass.load(),
                   .built_after = progress.built_after.load()},
          .done = progress.done.load(),
          .total = progress.total.load(),
          .stage_done = progress.stage_done.load(),
          .stage_total = progress.stage_total.load(),
          .searches = progress.searches.load(),
          .sets = progress.sets.load(),
          .first_stages = progress.first_stages.load(),
          .second_stages = progress.second_stages.load(),
          .empty_first = progress.empty_first.load(),
          .empty_second = progress.empty_second.load(),
          .to_sharpen = progress.to_sharpen.load(),
          .later_sets = progress.later_sets.load(),
          .later_bounds = progress.later_bounds.load(),
          .open = progress.open.load(),
          .feasible = progress.feasible.load()};
}

}  // namespace gear3k::optimize
