#include "app/tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/evaluate.hpp"
#include "backlash/random_teeth.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::app {

namespace {

/// The first gearbox of the series over a turn.
report::TurnResult turn_of_first(const design::Design& design, const design::BuiltSeries& series) {
  const train::ToothSet& z = design.train.teeth;
  const backlash::RandomGearbox gearboxes(series.model, series.scatter, series.seed);
  const backlash::TurningPlays plays(
      series.model, z, gearboxes.deviations(0),
      backlash::random_teeth(series.model, z,
                             {.seed = series.seed, .gearbox = 0, .scatter = series.scatter}));
  const backlash::TurnWindow window = backlash::turn_window(z);
  report::TurnResult result{
      .name = design.name, .turn = backlash::turn(series.model.levers, plays, window), .fits = {}};
  result.fits = backlash::turn_orders(
      result.turn, backlash::turn_order_list(z, design.train.planets, window.revolutions));
  return result;
}

}  // namespace

Tolerances tolerances(const TolerancesRequest& request, optimize::Progress& progress) {
  const design::Design& design = request.design;
  if (!design.tolerances) {
    throw io::InvalidInput(fmt::format(
        "{}: has no [tolerances]; allowed: a DESIGN with them (docs/keys.md)", request.source));
  }
  Tolerances result{.evaluation = evaluate(design, request.source), .series = {}, .turn = {}};
  const auto model = design::clearance_model_of(design);
  if (!model) {
    throw io::InvalidInput(fmt::format(
        "{}: tolerances.center_distance_um: a mesh has no working angle at the middle of these "
        "limits; allowed: limits nearer to 0",
        request.source));
  }
  progress.phase = optimize::Progress::Phase::kGearboxes;
  progress.total = static_cast<std::size_t>(design.sampling.samples);
  design::BuiltSeries& series = result.series;
  series = design::build_series(design, *model, design::kShareSamples, [&](std::uint64_t done) {
    progress.done = static_cast<std::size_t>(done);
    return !progress.stop;
  });
  if (!progress.stop) {
    series.turn = backlash::turn_yield(
        series.model, design.train.teeth,
        {.gearboxes = std::min(backlash::TurnYieldOptions{}.gearboxes, series.result.samples),
         .seed = series.seed,
         .scatter = series.scatter,
         .limit_rad = series.limit_rad});
  }
  result.turn = turn_of_first(design, series);
  result.interrupted = series.result.samples < static_cast<std::uint64_t>(design.sampling.samples);
  return result;
}

}  // namespace gear3k::app
