#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "app/actuator.hpp"
#include "app/selection.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/cycle_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/selection_file.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/file_set.hpp"
#include "report/actuator_plot.hpp"
#include "report/front_plot.hpp"
#include "report/selection_report.hpp"

namespace gear3k::cli {

namespace {

constexpr double kMostPoints = 100000;
constexpr double kMostHertz = 1e6;
constexpr const char* kFrontName = "pareto.csv";  ///< of --select

/// LO, HI in Hz and N; empty where the text has no such range.
std::optional<std::array<double, 3>> impedance_range(std::string_view text) {
  std::array<double, 3> numbers{};
  bool valid = std::ranges::count(text, ':') == 2;
  for (double& number : numbers) {
    const std::size_t end = std::min(text.find(':'), text.size());
    const auto value = io::csv_number(text.substr(0, end));
    valid = valid && value;
    number = value.value_or(0.0);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const auto [low, high, points] = numbers;
  valid = valid && low > 0.0 && high >= low && high <= kMostHertz && points >= 1.0 &&
          points <= kMostPoints && points == static_cast<int>(points);
  return valid ? std::optional(numbers) : std::nullopt;
}

/// "LO:HI:N".
/// @throws io::InvalidInput naming what is allowed
actuator::ImpedanceTask impedance_task(const ActuatorOptions& options) {
  const auto [low, high, points] = impedance_range(options.impedance).value();
  constexpr std::array<std::string_view, 3> kTerminals{"open", "shorted", "locked"};
  const auto* const motor = std::ranges::find(kTerminals, options.motor);
  return {.low_Hz = low,
          .high_Hz = high,
          .points = static_cast<int>(points),
          .amplitude_rad = options.amplitude_rad,
          .motor = static_cast<actuator::MotorTerminals>(motor - kTerminals.begin())};
}

/// Everything that the command reads; errors of all files and options at once.
/// @param inputs  takes the files
app::ActuatorRequest request_of(const ActuatorOptions& options, std::vector<std::string>& inputs) {
  app::ActuatorRequest request;
  request.source = options.file;
  request.without_each = options.without_each;
  io::CollectedErrors errors;
  errors.attempt([&] {
    io::ActuatorFiles files = io::read_actuator(options.file);
    request.actuator = std::move(files.actuator);
    inputs = std::move(files.inputs);
  });
  errors.attempt([&] {
    if (!options.cycle.empty()) request.cycle = io::read_cycle(options.cycle);
  });
  errors.attempt([&] {
    if (!options.impedance.empty()) request.impedance = impedance_task(options);
  });
  errors.raise();
  inputs.push_back(options.cycle);
  request.keep_instants = options.format == Format::kCsv || !options.figures.empty();
  request.drive_diagram = !options.figures.empty();
  return request;
}

/// What --figures may write.
ResultFolderTask figure_folder(const ActuatorOptions& options, std::vector<std::string> inputs) {
  ResultFolderTask task{.path = options.figures,
                        .option = "--figures",
                        .inputs = std::move(inputs),
                        .result = options.out,
                        .files = {},
                        .quiet = options.quiet};
  for (const std::string name : report::kActuatorFigures) {
    task.files.push_back(name + ".csv");
    task.figures.push_back(name + ".svg");
  }
  return task;
}

/// @returns paths of all that was written
std::vector<std::string> write_figures_of(const report::ActuatorResult& result,
                                          ResultFolder& folder, Figures& figures) {
  std::vector<report::Plot> plots;
  std::vector<io::FileText> files;
  for (report::ActuatorFigure& figure : report::actuator_figures(result)) {
    files.push_back({.path = figure.plot.name + ".csv", .text = std::move(figure.csv)});
    plots.push_back(std::move(figure.plot));
  }
  figures = draw(plots);
  return folder.write(std::move(files), figures);
}

std::string design_file_name(std::string gearbox) {
  std::ranges::replace(gearbox, '/', '_');
  return fmt::format("design_{}.toml", gearbox);
}

/// Names of the DESIGN files that an earlier run may have made for its front, which its pareto.csv
/// tells.
std::vector<std::string> earlier_designs(const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / kFrontName).string();
  std::vector<std::string> names;
  if (!std::filesystem::exists(path)) return names;
  try {
    const io::CsvTable front =
        io::parse_csv(io::read_text(path, "a CSV file", io::kMostCycleBytes), path);
    if (std::ranges::find(front.header, "gearbox") == front.header.end()) return names;
    for (const io::CsvTable::Row& row : front.rows) {
      const std::string gearbox = front.text(row, "gearbox").value_or("");
      // Made ones are named by their five gears.
      if (std::ranges::count(gearbox, '/') == 4) names.push_back(design_file_name(gearbox));
    }
  } catch (const io::InvalidInput&) {
    names.clear();  // no file of this program
  }
  return names;
}

/// DESIGN files of the gearboxes of the front that were made for it.
void append_designs(const io::SelectionFiles& files, const actuator::Selection& selection,
                    const std::vector<report::MadeGearbox>& made,
                    std::vector<io::FileText>& texts) {
  for (const report::MadeGearbox& m : made) {
    if (std::ranges::none_of(selection.front, [&](const actuator::PairResult& r) {
          return r.pair.gearbox == m.gearbox;
        })) {
      continue;
    }
    texts.push_back({.path = design_file_name(files.task.gearboxes[m.gearbox].name),
                     .text = io::design_text(m.design)});
  }
}

/// --select: the front of all pairs, into a folder.
ExitCode run_selection(const ActuatorOptions& options) {
  io::SelectionFiles files = io::read_selection(options.select);
  ResultFolder folder({.path = options.out,
                       .inputs = files.inputs,
                       .files = {"selection.csv", kFrontName, "summary.json"},
                       .figures = {"pareto.svg"},
                       .earlier = earlier_designs(options.out),
                       .quiet = options.quiet});
  app::MadeGearboxes made;
  if (!files.tasks.empty()) {
    optimize::Progress progress;
    const ProgressDisplay display(progress, options.quiet);
    made = app::make_gearboxes(files, progress);
    if (progress.stop) {
      say("interrupted: nothing is kept\n");
      return kInterrupted;
    }
  }
  end_on_interrupt();
  app::tell_apart(files.task.gearboxes);
  const actuator::Selection selection = actuator::select(files.task);
  const Figures figures = files.task.objectives.size() > 1 && !selection.front.empty()
                              ? draw({report::selection_plot(files.task, selection)})
                              : Figures();
  const std::string json =
      with_missing_figures(report::selection_json(files.task, selection), figures);
  const std::string front = report::selection_front_csv(files.task, selection);
  std::vector<io::FileText> texts{
      {.path = "selection.csv", .text = report::selection_csv(files.task, selection)},
      {.path = kFrontName, .text = front},
      {.path = "summary.json", .text = json}};
  append_designs(files, selection, made.gearboxes, texts);
  const std::vector<std::string> written = folder.write(std::move(texts), figures);
  switch (options.format) {
    case Format::kJson:
      print_result(json);
      break;
    case Format::kCsv:
      print_result(front);
      break;
    case Format::kTable:
      print_result(report::selection_table(files.task, selection) + files_text(written));
      break;
  }
  const std::string blocking = report::selection_blocking_text(files.task, selection);
  if (!blocking.empty() || !options.quiet) {
    for (const std::string& spec : made.blocked) say(spec + '\n');
  }
  if (blocking.empty()) return kDone;
  say(blocking + '\n');
  return kNoFeasibleDesign;
}

}  // namespace

std::string impedance_error(std::string_view value) {
  if (impedance_range(value)) return "";
  return fmt::format(
      "--impedance {}: allowed: LO:HI:N, 0 < LO <= HI <= {:g} Hz, N a whole number, 1 to {:g}",
      value, kMostHertz, kMostPoints);
}

ExitCode run_actuator(const ActuatorOptions& options) {
  end_on_interrupt();
  use_threads(options);
  if (!options.select.empty()) return run_selection(options);
  std::vector<std::string> inputs;
  const app::ActuatorRequest request = request_of(options, inputs);
  refuse_replacing(inputs, options.out, options.figures);
  std::optional<ResultFolder> folder;
  if (!options.figures.empty()) folder.emplace(figure_folder(options, std::move(inputs)));
  const report::ActuatorResult result = app::analyze_actuator(request);
  Figures figures;
  std::vector<std::string> written;
  if (folder) written = write_figures_of(result, *folder, figures);
  if (!options.quiet && options.format != Format::kTable) {
    for (const std::string& note : result.reflected.notes) say(fmt::format("note: {}\n", note));
    if (result.cycle) {
      for (const std::string& note : result.cycle->notes) say(fmt::format("note: {}\n", note));
    }
  }
  switch (options.format) {
    case Format::kJson:
      deliver(options, with_missing_figures(report::actuator_json(result), figures));
      break;
    case Format::kCsv:
      deliver(options, result.cycle ? report::actuator_cycle_csv(*result.cycle)
                                    : report::impedance_csv(result.impedance));
      break;
    case Format::kTable:
      deliver(options, report::actuator_table(result) + files_text(written));
      break;
  }
  const bool feasible = (!result.cycle || result.cycle->feasible) &&
                        std::ranges::all_of(result.felt_checks, &actuator::LimitCheck::ok);
  return options.strict && !feasible ? kNoFeasibleDesign : kDone;
}

}  // namespace gear3k::cli
