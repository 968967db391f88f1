#include <optional>

#include "app/map.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"
#include "report/map_plot.hpp"
#include "report/map_report.hpp"

namespace gear3k::cli {

ExitCode run_map(const MapOptions& options) {
  end_on_interrupt();
  use_threads(options);
  app::MapRequest request{.design = {}, .model = {}, .source = options.file};
  io::CollectedErrors errors;
  errors.attempt([&] { request.design = io::read_design(options.file); });
  errors.attempt([&] { request.model = app::read_model(options.model); });
  errors.raise();
  std::optional<ResultFolder> folder;
  if (!options.out.empty()) {
    folder.emplace(ResultFolderTask{
        .path = options.out,
        .inputs = {options.file, options.model},
        .files = {"map.csv", "map.json"},
        .figures = {"efficiency_forward.svg", "efficiency_backward.svg", "torques.svg"},
        .quiet = options.quiet});
  }
  const app::Map result = app::map(request);
  warn(result.model_notes, options.quiet);
  Figures figures;
  if (folder) figures = draw(report::map_plots(result.map));
  const report::ModelUse* use = request.model ? &request.model->use : nullptr;
  const auto json = [&] {
    return with_missing_figures(report::map_json(result.map, use), figures);
  };
  std::vector<std::string> written;
  if (folder) {
    written = folder->write({{.path = "map.csv", .text = report::map_csv(result.map)},
                             {.path = "map.json", .text = json()}},
                            figures);
  }
  switch (options.format) {
    case Format::kJson:
      print_result(json());
      break;
    case Format::kCsv:
      print_result(report::map_csv(result.map));
      break;
    case Format::kTable:
      print_result(report::map_table(result.map, use) + files_text(written));
      break;
  }
  return kDone;
}

}  // namespace gear3k::cli
