#include <fmt/format.h>

#include <cmath>

#include "backlash/random_teeth.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"
#include "report/tolerance_report.hpp"
#include "report/turn_plot.hpp"
#include "report/turn_report.hpp"
#include "report/yield_report.hpp"

namespace gear3k::cli {

namespace {

design::Design read_with_tolerances(const TolerancesOptions& options) {
  design::Design design = io::read_design(options.file);
  if (!design.tolerances) {
    throw io::InvalidInput(fmt::format(
        "{}: has no [tolerances]; allowed: a DESIGN with them (docs/keys.md)", options.file));
  }
  if (options.samples) design.sampling.samples = *options.samples;
  if (options.seed) design.sampling.seed = *options.seed;
  return design;
}

design::Evaluation evaluate_or_throw(const design::Design& design, const std::string& file) {
  auto result = design::evaluate(design);
  if (const auto* undefined = std::get_if<design::NotDefined>(&result)) {
    throw io::InvalidInput(fmt::format("{}: {}", file, undefined->message));
  }
  return std::get<design::Evaluation>(std::move(result));
}

/// The first gearbox of the series over a turn.
report::TurnResult turn_of(const design::Design& design, const design::BuiltSeries& series) {
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

ExitCode run_tolerances(const TolerancesOptions& options) {
  use_threads(options);
  const design::Design design = read_with_tolerances(options);
  const design::Evaluation evaluation = evaluate_or_throw(design, options.file);
  const auto model = design::clearance_model_of(design);
  if (!model) {
    throw io::InvalidInput(fmt::format(
        "{}: tolerances.center_distance_um: a mesh has no working angle at the middle of these "
        "limits; allowed: limits nearer to 0",
        options.file));
  }
  optimize::Progress progress;
  design::BuiltSeries series;
  {
    const ProgressDisplay display(progress, options.quiet);
    progress.phase = optimize::Progress::Phase::kGearboxes;
    progress.total = static_cast<std::size_t>(design.sampling.samples);
    series = design::build_series(design, *model, design::kShareSamples, [&](std::uint64_t done) {
      progress.done = static_cast<std::size_t>(done);
      return !progress.stop;
    });
    if (!progress.stop) {
      series.turn = backlash::turn_yield(
          series.model, design.train.teeth,
          {.seed = series.seed, .scatter = series.scatter, .limit_rad = series.limit_rad});
    }
  }
  const report::TurnResult turn = turn_of(design, series);
  const std::string json = report::tolerances_json(evaluation, series);
  WrittenFiles written;
  if (!options.out.empty()) {
    const double carrier_order = std::abs(train::speed_ratios(design.train.teeth).carrier);
    written = write_results(
        {.path = options.out,
         .input = options.file,
         .protected_inputs = {},
         .quiet = options.quiet},
        {{.path = "tolerances.json", .text = json},
         {.path = "lost_motion.csv", .text = report::lost_motion_histogram_csv(series)},
         {.path = "tolerances.csv", .text = report::tolerance_shares_csv(series)},
         {.path = "turn.csv", .text = report::turn_csv(turn)},
         {.path = "turn_orders.csv", .text = report::turn_orders_csv(turn)}},
        {report::lost_motion_plot(design.name, series),
         report::tolerance_shares_plot(design.name, series),
         report::turn_plot(turn, carrier_order)});
  }
  switch (options.format) {
    case Format::kJson:
      print_result(json);
      break;
    case Format::kCsv:
      print_result(report::tolerance_shares_csv(series));
      break;
    case Format::kTable:
      print_result(fmt::format("{}\n", evaluation.name) +
                   report::tolerance_table(evaluation.tolerance_limits) +
                   report::yield_table(series) + "\n" + report::turn_table(turn) +
                   files_text(written));
      break;
  }
  if (series.result.samples < static_cast<std::uint64_t>(design.sampling.samples)) {
    say(fmt::format("interrupted: figures are of {} gearboxes\n", series.result.samples));
    return kInterrupted;
  }
  return written.code;
}

}  // namespace gear3k::cli
