#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/diagnose_motion.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/motion_log_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::cli {

namespace {

/// Options of `diagnose` that only records of steady points take.
bool is_of_steady_points(std::string_view option) {
  return option == "--model" || option == "--seed" || option.starts_with("--min-") ||
         option.starts_with("--max-");
}

/// @throws io::InvalidInput naming every option that has no effect
void refuse_other_options(const std::vector<std::string>& stated) {
  io::CollectedErrors errors;
  for (const std::string& option : stated) {
    if (!is_of_steady_points(option)) continue;
    errors.attempt([&] {
      throw io::InvalidInput(
          fmt::format("{}: no effect on logs of motion: allowed: without it", option));
    });
  }
  errors.raise();
}

/// The ACTUATOR; where it has errors, those of the logs with them.
io::ActuatorFiles read_subject(const DiagnoseOptions& options) {
  io::ActuatorFiles files;
  io::CollectedErrors errors;
  errors.attempt([&] { files = io::read_actuator(options.file); });
  if (errors.any()) {
    errors.attempt([&] { io::read_motion_logs(options.data, {.known = false}); });
  }
  errors.raise();
  return files;
}

}  // namespace

ExitCode run_diagnose_motion(const DiagnoseOptions& options) {
  refuse_other_options(options.stated);
  io::ActuatorFiles files = read_subject(options);
  const app::DiagnoseMotionRequest request{.actuator = std::move(files.actuator),
                                           .source = options.file,
                                           .data = options.data,
                                           .false_discovery_rate = options.false_discovery_rate};
  std::optional<ResultFolder> folder;
  if (!options.out.empty()) {
    ResultFolderTask task{.path = options.out,
                          .inputs = options.data,
                          .files = {"diagnosis.json", "model.toml", "residuals.csv"},
                          .quiet = options.quiet};
    task.inputs.insert(task.inputs.end(), files.inputs.begin(), files.inputs.end());
    for (const std::string& name : report::motion_diagnosis_plot_names()) {
      task.figures.push_back(name + ".svg");
    }
    folder.emplace(std::move(task));
  }
  const report::MotionDiagnosisResult result = app::diagnose_motion(request);
  Figures figures;
  if (folder) figures = draw(report::motion_diagnosis_plots(result));
  const std::string json = with_missing_figures(report::motion_diagnosis_json(result), figures);
  const std::string csv = report::motion_window_csv(result);
  std::vector<std::string> written;
  if (folder) {
    written = folder->write({{.path = "diagnosis.json", .text = json},
                             {.path = "model.toml", .text = result.model},
                             {.path = "residuals.csv", .text = csv}},
                            figures);
  }
  switch (options.format) {
    case Format::kJson:
      print_result(json);
      break;
    case Format::kCsv:
      print_result(csv);
      break;
    case Format::kTable:
      print_result(report::motion_diagnosis_table(result) + files_text(written));
      break;
  }
  return kDone;
}

}  // namespace gear3k::cli
