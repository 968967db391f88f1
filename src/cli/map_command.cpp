#include <fmt/format.h>

#include "cli/commands.hpp"
#include "cli/model_option.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "design/operating_map.hpp"
#include "io/files/design_file.hpp"
#include "io/text/diagnostics.hpp"
#include "report/map_plot.hpp"
#include "report/map_report.hpp"

namespace gear3k::cli {

namespace {

design::OperatingMap map_or_throw(const design::Design& design, const std::string& file) {
  auto result = design::make_operating_map(design);
  if (const auto* undefined = std::get_if<design::NotDefined>(&result)) {
    throw io::InvalidInput(fmt::format("{}: {}", file, undefined->message));
  }
  return std::get<0>(std::move(result));
}

}  // namespace

ExitCode run_map(const MapOptions& options) {
  end_on_interrupt();
  use_threads(options);
  design::Design design = io::read_design(options.file);
  const std::optional<LoadedModel> model = load_model(options.model);
  Notes notes;
  if (model) design = with_model_on_grid(design, *model, notes);
  const report::ModelUse* use = model ? &model->use : nullptr;
  design::OperatingMap map = map_or_throw(design, options.file);
  map.notes.insert(map.notes.end(), notes.begin(), notes.end());
  warn(notes, options.quiet);
  WrittenFiles written;
  if (!options.out.empty()) {
    written = write_results({.path = options.out,
                             .input = options.file,
                             .protected_inputs = {},
                             .quiet = options.quiet},
                            {{.path = "map.csv", .text = report::map_csv(map)},
                             {.path = "map.json", .text = report::map_json(map, use)}},
                            report::map_plots(map));
  }
  switch (options.format) {
    case Format::kJson:
      print_result(report::map_json(map, use));
      break;
    case Format::kCsv:
      print_result(report::map_csv(map));
      break;
    case Format::kTable:
      print_result(report::map_table(map, use) + files_text(written));
      break;
  }
  return written.code;
}

}  // namespace gear3k::cli
