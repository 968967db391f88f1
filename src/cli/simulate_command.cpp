#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/simulate.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::cli {

namespace {

/// Both files with all that they name; errors of all at once.
app::SimulateRequest simulate_request(const SimulateOptions& options,
                                      std::vector<std::string>& inputs) {
  app::SimulateRequest request;
  request.source = options.actuator;
  io::CollectedErrors errors;
  const auto take = [&inputs](const std::vector<std::string>& read) {
    inputs.insert(inputs.end(), read.begin(), read.end());
  };
  errors.attempt([&] {
    io::ActuatorFiles files = io::read_actuator(options.actuator);
    request.actuator = std::move(files.actuator);
    take(files.inputs);
  });
  errors.attempt([&] {
    io::ScenarioFiles files = io::read_scenario(options.scenario);
    request.scenario = std::move(files.scenario);
    take(files.inputs);
  });
  errors.raise();
  return request;
}

report::MotionResult shown(const app::SimulateRequest& request, bool quiet) {
  optimize::Progress progress;
  constexpr std::size_t kSteps = 1000;
  progress.total = kSteps;
  const ProgressDisplay display(progress, quiet, ProgressDisplay::Counts::kSharesSimulated);
  return app::simulate(request, [&progress](double share) {
    progress.done = static_cast<std::size_t>(share * static_cast<double>(kSteps));
    return !progress.stop.load();
  });
}

}  // namespace

ExitCode run_simulate(const SimulateOptions& options) {
  end_on_interrupt();
  use_threads(options);
  std::vector<std::string> inputs;
  const app::SimulateRequest request = simulate_request(options, inputs);
  std::optional<ResultFolder> folder;
  if (!options.out.empty()) {
    folder.emplace(ResultFolderTask{.path = options.out,
                                    .inputs = inputs,
                                    .files = {"motion.csv", "events.csv", "ledger.json"},
                                    .figures = {"motion.svg"},
                                    .quiet = options.quiet});
  }
  report::MotionResult result;
  try {
    result = shown(request, options.quiet);
  } catch (const std::runtime_error& error) {
    if (dynamic_cast<const io::InvalidInput*>(&error) != nullptr) throw;
    say(fmt::format("{}: {}\n", options.scenario, error.what()));
    return kSolverFailure;
  }
  end_on_interrupt();
  Figures figures;
  if (folder) figures = draw({report::motion_plot(result)});
  const std::string json = with_missing_figures(report::motion_json(result), figures);
  const std::string csv = report::motion_csv(result);
  std::vector<std::string> written;
  if (folder) {
    written = folder->write({{.path = "motion.csv", .text = csv},
                             {.path = "events.csv", .text = report::motion_events_csv(result)},
                             {.path = "ledger.json", .text = json}},
                            figures);
  }
  if (!options.quiet && options.format != Format::kTable) {
    for (const std::string& note : result.motion.notes) {
      if (note != result.motion.ended_early) say(fmt::format("note: {}\n", note));
    }
  }
  switch (options.format) {
    case Format::kJson:
      print_result(json);
      break;
    case Format::kCsv:
      print_result(csv);
      break;
    case Format::kTable:
      print_result(report::motion_table(result) + files_text(written));
      break;
  }
  if (result.motion.complete) return kDone;
  say(fmt::format("{}: {}\n", options.scenario, result.motion.ended_early));
  return result.motion.interrupted ? kInterrupted : kSolverFailure;
}

}  // namespace gear3k::cli
