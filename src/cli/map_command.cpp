#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "cli/commands.hpp"
#include "cli/model_option.hpp"
#include "cli/progress.hpp"
#include "design/operating_map.hpp"
#include "io/design_file.hpp"
#include "io/diagnostics.hpp"
#include "io/file_set.hpp"
#include "io/gnuplot.hpp"
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

/// Writes the result files; without gnuplot no figures, and says so on stderr.
/// @param written  the names of the files written
ExitCode write_map(const MapOptions& options, const design::OperatingMap& map,
                   const report::ModelUse* model, std::vector<std::string>& written) {
  const std::filesystem::path folder(options.out);
  const auto path_of = [&](const std::string& name) { return (folder / name).string(); };
  std::vector<io::FileText> files{
      {.path = path_of("map.csv"), .text = report::map_csv(map)},
      {.path = path_of("map.json"), .text = report::map_json(map, model)}};
  const std::vector<report::Plot> plots = report::map_plots(map);
  std::vector<io::FileText> figures;
  std::string failure;
  try {
    figures.reserve(plots.size());
    for (const report::Plot& plot : plots) {
      figures.push_back(
          {.path = path_of(plot.name + ".svg"), .text = io::run_gnuplot(plot.script)});
    }
    files.insert(files.end(), figures.begin(), figures.end());
  } catch (const io::InvalidInput& error) {
    failure = error.what();
  }
  io::write_files(files, options.file);
  for (const io::FileText& file : files) written.push_back(file.path);
  if (failure.empty()) return kDone;
  // Figures of an earlier run would pass for results of this one.
  for (const report::Plot& plot : plots) set_aside(path_of(plot.name + ".svg"));
  fmt::print(stderr, "{}\nwritten without figures: {}\n", failure, fmt::join(written, ", "));
  return kInvalidInput;
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
  std::vector<std::string> written;
  const ExitCode code = options.out.empty() ? kDone : write_map(options, map, use, written);
  switch (options.format) {
    case Format::kJson:
      print_result(report::map_json(map, use));
      break;
    case Format::kCsv:
      print_result(report::map_csv(map));
      break;
    case Format::kTable:
      print_result(report::map_table(map, use) +
                   (written.empty() ? "" : fmt::format("\nFiles: {}\n", fmt::join(written, ", "))));
      break;
  }
  return code;
}

}  // namespace gear3k::cli
