#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "app/tolerances.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "io/files/design_file.hpp"
#include "io/text/printable.hpp"
#include "report/built_series_report.hpp"
#include "report/tolerance_report.hpp"
#include "report/turn_plot.hpp"
#include "report/turn_report.hpp"

namespace gear3k::cli {

namespace {

app::TolerancesRequest request_of(const TolerancesOptions& options) {
  app::TolerancesRequest request{.design = io::read_design(options.file), .source = options.file};
  if (options.samples) request.design.sampling.samples = *options.samples;
  if (options.seed) request.design.sampling.seed = *options.seed;
  return request;
}

std::vector<report::Plot> plots_of(const design::Design& design, const app::Tolerances& result) {
  const double carrier_order = std::abs(train::speed_ratios(design.train.teeth).carrier);
  return {report::lost_motion_plot(design.name, result.series),
          report::tolerance_shares_plot(design.name, result.series),
          report::turn_plot(result.turn, carrier_order)};
}

app::Tolerances shown(const app::TolerancesRequest& request, bool quiet) {
  optimize::Progress progress;
  const ProgressDisplay display(progress, quiet);
  return app::tolerances(request, progress);
}

}  // namespace

ExitCode run_tolerances(const TolerancesOptions& options) {
  end_on_interrupt();
  use_threads(options);
  const app::TolerancesRequest request = request_of(options);
  std::optional<ResultFolder> folder;
  if (!options.out.empty()) {
    folder.emplace(ResultFolderTask{.path = options.out,
                                    .inputs = {options.file},
                                    .files = {"tolerances.json", "lost_motion.csv",
                                              "tolerances.csv", "turn.csv", "turn_orders.csv"},
                                    .figures = {"lost_motion.svg", "tolerances.svg", "turn.svg"},
                                    .quiet = options.quiet});
  }
  const app::Tolerances result = shown(request, options.quiet);
  end_on_interrupt();
  Figures figures;
  if (folder) figures = draw(plots_of(request.design, result));
  const std::string json =
      with_missing_figures(report::tolerances_json(result.evaluation, result.series), figures);
  std::vector<std::string> written;
  if (folder) {
    written = folder->write(
        {{.path = "tolerances.json", .text = json},
         {.path = "lost_motion.csv", .text = report::lost_motion_histogram_csv(result.series)},
         {.path = "tolerances.csv", .text = report::tolerance_shares_csv(result.series)},
         {.path = "turn.csv", .text = report::turn_csv(result.turn)},
         {.path = "turn_orders.csv", .text = report::turn_orders_csv(result.turn)}},
        figures);
  }
  switch (options.format) {
    case Format::kJson:
      print_result(json);
      break;
    case Format::kCsv:
      print_result(report::tolerance_shares_csv(result.series));
      break;
    case Format::kTable:
      print_result(fmt::format("{}\n", io::printable(result.evaluation.name)) +
                   report::tolerance_table(result.evaluation.tolerance_limits) +
                   report::built_series_table(result.series) + "\n" +
                   report::turn_table(result.turn) + files_text(written));
      break;
  }
  if (!result.interrupted) return kDone;
  say(fmt::format("interrupted: figures are of {} gearboxes\n", result.series.result.samples));
  return kInterrupted;
}

}  // namespace gear3k::cli
