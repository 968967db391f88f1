#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "app/diagnose.hpp"
#include "app/errors.hpp"
#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/verdict/model_update.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "io/files/model_file.hpp"
#include "io/files/motion_log_file.hpp"
#include "io/files/subject_file.hpp"
#include "report/condition_columns.hpp"
#include "report/diagnosis_plot.hpp"
#include "report/diagnosis_report.hpp"

namespace gear3k::cli {

namespace {

using calibrate::Diagnosis, calibrate::ExtendedModel, calibrate::MeasurementSet;

/// All files, with what is wrong in any of them.
app::DiagnoseRequest read_request(const DiagnoseOptions& options) {
  app::DiagnoseRequest request;
  request.source = options.file;
  app::Errors errors;
  errors.collect([&] {
    request.subject = io::read_subject(options.file,
                                       "SUBJECT takes a DESIGN, a PAIR or a black box ([gearbox]), "
                                       "with logs of motion (# kind: dynamic) an ACTUATOR");
  });
  errors.collect([&] { request.data = io::read_measurements(options.data); });
  if (!options.model.empty()) {
    errors.collect([&] {
      request.model =
          report::ModelUse{.file = options.model, .models = io::read_model(options.model)};
    });
  }
  errors.throw_if_any();
  return request;
}

/// A limit of the next experiment as options name it.
struct LimitNames {
  const calibrate::ConditionQuantity* quantity;
  ConditionLimit DiagnoseOptions::*stated;
  app::ExperimentLimit app::DiagnoseSettings::*limit;
};
constexpr std::array<LimitNames, 4> kLimits{{{.quantity = &calibrate::kSunSpeed,
                                              .stated = &DiagnoseOptions::sun_speed_rpm,
                                              .limit = &app::DiagnoseSettings::sun_speed_rad_s},
                                             {.quantity = &calibrate::kOutputTorque,
                                              .stated = &DiagnoseOptions::output_torque_nm,
                                              .limit = &app::DiagnoseSettings::output_torque_Nm},
                                             {.quantity = &calibrate::kTestTorque,
                                              .stated = &DiagnoseOptions::test_torque_nm,
                                              .limit = &app::DiagnoseSettings::test_torque_Nm},
                                             {.quantity = &calibrate::kTemperature,
                                              .stated = &DiagnoseOptions::temperature_c,
                                              .limit = &app::DiagnoseSettings::temperature_K}}};

app::DiagnoseSettings settings_of(const DiagnoseOptions& options) {
  app::DiagnoseSettings settings;
  settings.false_discovery_rate = options.false_discovery_rate;
  settings.seed = options.seed;
  for (const LimitNames& names : kLimits) {
    const ConditionLimit& stated = options.*names.stated;
    app::ExperimentLimit& limit = settings.*names.limit;
    if (stated.least) limit.least = names.quantity->si(*stated.least);
    if (stated.greatest) limit.greatest = names.quantity->si(*stated.greatest);
  }
  return settings;
}

/// Says which limits act on none of the data.
void warn_of_idle_limits(const DiagnoseOptions& options, const std::vector<MeasurementSet>& sets) {
  for (const LimitNames& names : kLimits) {
    const ConditionLimit& limit = options.*names.stated;
    if (!limit.least && !limit.greatest) continue;
    const std::string_view column = names.quantity->column;
    const bool acts = std::ranges::any_of(sets, [&](const MeasurementSet& set) {
      const auto stated = report::stated_columns(set);
      return std::ranges::find(stated, column, &report::ConditionColumn::name) != stated.end();
    });
    if (acts) continue;
    std::string name(column);
    std::ranges::replace(name, '_', '-');
    std::vector<std::string> words;
    if (limit.least) words.push_back("--min-" + name);
    if (limit.greatest) words.push_back("--max-" + name);
    say(fmt::format("{}: no effect, as the data state no {}\n", fmt::join(words, ", "), column));
  }
}

/// @returns empty when it was interrupted
std::optional<std::vector<Diagnosis>> shown(const app::DiagnosisTask& task,
                                            const DiagnoseOptions& options) {
  optimize::Progress progress;
  constexpr std::size_t kSteps = 1000;
  progress.total = kSteps;
  const ProgressDisplay display(progress, options.quiet, ProgressDisplay::Counts::kSharesDiagnosed);
  // A partial diagnosis has no result and nothing is written before the end: an interrupt need not
  // wait for the next step, which takes minutes for 100 000 rows.
  end_on_interrupt();
  app::DiagnoseSettings settings = settings_of(options);
  settings.progress = [&](double share) {
    progress.done = static_cast<std::size_t>(share * static_cast<double>(kSteps));
    return !progress.stop.load();
  };
  auto results = app::diagnose(task, settings);
  return progress.stop.load() ? std::nullopt : std::move(results);
}

std::string model_text(const app::DiagnosisTask& task, const std::vector<Diagnosis>& results) {
  std::vector<ExtendedModel> found;
  found.reserve(results.size());
  for (const Diagnosis& result : results) found.push_back(result.model);
  return io::model_text(calibrate::updated_models(task.models, found));
}

ResultFolderTask folder_task(const DiagnoseOptions& options) {
  ResultFolderTask task{.path = options.out,
                        .inputs = options.data,
                        .files = {"diagnosis.json", "model.toml", "residuals.csv"},
                        .quiet = options.quiet};
  task.inputs.push_back(options.file);
  task.inputs.push_back(options.model);
  for (const std::string& name : report::diagnosis_plot_names()) {
    task.figures.push_back(name + ".svg");
  }
  return task;
}

}  // namespace

ExitCode run_diagnose(const DiagnoseOptions& options) {
  end_on_interrupt();
  use_threads(options);
  if (io::any_motion_log(options.data)) return run_diagnose_motion(options);
  const app::DiagnoseRequest request = read_request(options);
  const app::DiagnosisTask task = app::diagnosis_task(request);
  std::optional<ResultFolder> folder;
  if (!options.out.empty()) folder.emplace(folder_task(options));
  warn(task.model_notes, options.quiet);
  if (!options.quiet) warn_of_idle_limits(options, task.sets);
  const std::optional<std::vector<Diagnosis>> results = shown(task, options);
  if (!results) {
    say("interrupted: a partial diagnosis has no result\n");
    return kInterrupted;
  }
  end_on_interrupt();
  const report::DiagnosisSetup setup{.seed = options.seed,
                                     .false_discovery_rate = options.false_discovery_rate,
                                     .model = request.model};
  Figures figures;
  if (folder) figures = draw(report::diagnosis_plots(*results, task.sets, task.orders));
  const auto json = [&] {
    return with_missing_figures(report::diagnosis_json(*results, task.sets, setup), figures);
  };
  std::vector<std::string> written;
  if (folder) {
    written = folder->write(
        {{.path = "diagnosis.json", .text = json()},
         {.path = "model.toml", .text = model_text(task, *results)},
         {.path = "residuals.csv", .text = report::residual_csv(*results, task.sets)}},
        figures);
  }
  switch (options.format) {
    case Format::kJson:
      print_result(json());
      break;
    case Format::kCsv:
      print_result(report::residual_csv(*results, task.sets));
      break;
    case Format::kTable:
      print_result(report::diagnosis_table(*results, task.sets, setup) + files_text(written));
      break;
  }
  return kDone;
}

}  // namespace gear3k::cli
