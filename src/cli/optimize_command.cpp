#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "calibrate/model/model_range.hpp"
#include "cli/commands.hpp"
#include "cli/model_option.hpp"
#include "cli/progress.hpp"
#include "cli/talk.hpp"
#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/refinement_journal.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_writer.hpp"
#include "io/text/toml_value.hpp"
#include "optimize/cheapest_tolerances.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/robust.hpp"
#include "report/analysis_report.hpp"
#include "report/search_report.hpp"

namespace gear3k::cli {

namespace {

constexpr std::array kResultNames{"best.toml", "refined.csv", "pareto.csv", "summary.json"};
constexpr const char* kJournalName = "optimize.journal";

std::string path_in(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

/// The task of a run, with what its model changes.
struct OptimizeTask {
  std::uint64_t fingerprint = 0;  ///< of the very bytes that were read
  optimize::Specification spec;
  std::optional<LoadedModel> model;
  Notes notes;
  std::string unreachable;       ///< why no design can reach the lost motion; "" when one may
  design::Limits stated_limits;  ///< `spec` has those that hold for the built gearboxes

  [[nodiscard]] const report::ModelUse* use() const { return model ? &model->use : nullptr; }
};
OptimizeTask load_task(const OptimizeOptions& options) {
  std::vector<std::string> contents{io::read_toml_text(options.file)};
  if (!options.model.empty()) contents.push_back(io::read_toml_text(options.model));
  OptimizeTask task{.fingerprint = io::task_fingerprint(contents),
                    .spec = io::parse_specification(contents.front(), options.file),
                    .model = parse_model(options.model, contents.back()),
                    .notes = {},
                    .unreachable = {},
                    .stated_limits = {}};
  if (task.model) {
    const optimize::Specification stated = task.spec;
    task.spec = with_model(stated, *task.model, task.notes);
    task.unreachable = unreachable_lost_motion(stated, *task.model);
  }
  if (options.certify && optimize::judged_by_model(task.spec)) {
    throw io::InvalidInput(
        "--certify: bounds are those of the simulation without the model's losses at an operating "
        "point, by which --model judges the sets; allowed: one of --certify and --model");
  }
  const bool front = task.spec.objectives.size() > 1;
  if ((options.certify || front) && !optimize::has_bounds(task.spec)) {
    throw io::InvalidInput(fmt::format(
        "{}: {} needs bounds, and with free.pressure_angle_deg there are none; allowed: one of "
        "them",
        options.file, options.certify ? "--certify" : "a list of objectives"));
  }
  if (task.spec.objectives.size() > 1 && optimize::judged_by_model(task.spec)) {
    throw io::InvalidInput(
        "--model: a list of objectives asks for a Pareto front, which has none of the model's "
        "losses at an operating point; allowed: one objective, or no --model");
  }
  task.stated_limits = task.spec.limits;
  return task;
}

/// The design of a refined set as files state it.
design::Design stated_design(const OptimizeTask& task, const optimize::RefinedSet& set) {
  design::Design design = optimize::design_of(task.spec, set);
  design.limits = task.stated_limits;
  return design;
}

/// Tolerances that cost least for the design found, instead of the stated ones.
report::RobustRun::Cheapest cheapen(optimize::Specification& spec, const design::Design& design,
                                    const report::RobustRun& run, bool quiet) {
  optimize::Progress progress;
  progress.phase = optimize::Progress::Phase::kGearboxes;
  const ProgressDisplay display(progress, quiet);
  auto model = design::clearance_model_of(design);
  const auto& limit = design.limits[design::CheckId::kOutputBacklashMax];
  report::RobustRun::Cheapest result{.model = std::move(*model), .tolerances = {}, .built = {}};
  result.tolerances = optimize::cheapest_tolerances(
      result.model, {.yield = spec.robust.yield,
                     .limit_rad = limit.value_or(std::numeric_limits<double>::infinity()),
                     .cost = spec.robust.cost,
                     .scatter = {.scatter = spec.tolerances->scatter,
                                 .sigma_level = spec.tolerances->sigma_level},
                     .seed = spec.sampling.seed,
                     .may_widen =
                         [&](const std::vector<double>& factor) {
                           design::Design wide = design;
                           wide.tolerances =
                               optimize::scaled(*spec.tolerances, result.model, factor,
                                                std::cos(design.train.pressure_angle_rad));
                           return optimize::checks_hold(wide);
                         },
                     .stop = [&] { return progress.stop.load(); }});
  spec.tolerances = optimize::scaled(*spec.tolerances, result.model, result.tolerances.factor,
                                     std::cos(design.train.pressure_angle_rad));
  design::Design cheap = design;
  cheap.tolerances = spec.tolerances;
  result.built = optimize::built_outcome(cheap, run.samples, run.fresh_seed);
  return result;
}

/// Gearboxes of a design over a whole turn.
backlash::TurnYield turn_of(const design::Design& design, std::uint64_t seed) {
  const auto model = design::clearance_model_of(design);
  return backlash::turn_yield(*model, design.train.teeth,
                              {.seed = seed,
                               .scatter = {.scatter = design.tolerances->scatter,
                                           .sigma_level = design.tolerances->sigma_level},
                               .limit_rad = design.limits[design::CheckId::kOutputBacklashMax]});
}

/// Tightens the task's limits until they hold as it asks; empty where it asks for the drawn gearbox
/// only.
std::optional<report::RobustRun> make_robust(const OptimizeOptions& options, OptimizeTask& task) {
  optimize::Specification& spec = task.spec;
  if (spec.robust.hold == optimize::Hold::kNominal) return std::nullopt;
  const bool best_only = optimize::has_bounds(spec) && !optimize::judged_by_model(spec);
  report::RobustRun run;
  run.search = optimize::robust_limits(spec, [&](const optimize::Specification& tightened) {
    optimize::Progress progress;
    const ProgressDisplay display(progress, options.quiet);
    optimize::OptimizeResult result =
        optimize::optimize(tightened, progress, {.best_only = best_only});
    return optimize::SearchOutcome{.best = std::move(result.best),
                                   .interrupted = result.interrupted};
  });
  if (!run.search.chosen || run.search.interrupted) return run;
  const optimize::RobustPass& chosen = run.search.passes[*run.search.chosen];
  run.samples = static_cast<std::uint64_t>(spec.sampling.samples);
  run.fresh_seed = spec.sampling.seed + 1;
  run.nominal = optimize::built_outcome(stated_design(task, *run.search.passes.front().best),
                                        run.samples, run.fresh_seed);
  run.chosen =
      optimize::built_outcome(stated_design(task, *chosen.best), run.samples, run.fresh_seed);
  run.nominal_turn = turn_of(stated_design(task, *run.search.passes.front().best), run.fresh_seed);
  run.chosen_turn = turn_of(stated_design(task, *chosen.best), run.fresh_seed);
  if (spec.robust.cheapest)
    run.cheapest = cheapen(spec, stated_design(task, *chosen.best), run, options.quiet);
  spec.limits = chosen.limits;
  return run;
}

/// The journal to go on with; one that is in the way of a new run is kept under another name.
io::Journal open_journal(const OptimizeOptions& options, const std::string& path,
                         std::uint64_t fingerprint) {
  if (io::journal_in_use(path)) {
    throw io::InvalidInput(
        fmt::format("{}: another run is writing it; allowed: another folder, or to wait", path));
  }
  if (options.resume) {
    io::Journal journal = io::read_journal(path, fingerprint);
    if (!options.quiet) {
      say(fmt::format("{}", journal.exists
                                ? fmt::format("{}: goes on after {} refined tooth sets\n", path,
                                              journal.sets.size())
                                : fmt::format("{}: there is none, the run starts anew\n", path)));
    }
    return journal;
  }
  std::error_code status;
  if (std::filesystem::exists(path, status)) {
    if (!options.quiet) {
      say(fmt::format("{}: of a run that did not end; --resume would go on with it\n", path));
    }
    set_aside(path, options.quiet);
  }
  return {};
}

struct Outcome {
  optimize::OptimizeResult result;
  std::optional<optimize::ParetoFront> front;  ///< of several objectives
  double wall_time_s = 0.0;

  [[nodiscard]] bool interrupted() const {
    return result.interrupted || (front && front->interrupted);
  }
};
Outcome run(const OptimizeOptions& options, const OptimizeTask& task) {
  const std::string path = path_in(options.out, kJournalName);
  io::Journal journal = open_journal(options, path, task.fingerprint);
  io::JournalWriter writer(path, task.fingerprint, journal);
  optimize::Progress progress;
  Outcome outcome;
  {
    const ProgressDisplay display(progress, options.quiet);
    outcome.result = optimize::optimize(
        task.spec, progress,
        {.best_only = options.certify,
         .known = std::move(journal.sets),
         .on_wave = [&](std::span<const optimize::RefinedSet> sets) { writer.append(sets); }});
    if (task.spec.objectives.size() > 1 && !outcome.result.interrupted) {
      outcome.front = optimize::search_pareto_front(task.spec, progress, outcome.result.refined);
    }
    outcome.wall_time_s = display.elapsed_s();
  }
  return outcome;
}

void write_results(const OptimizeOptions& options, const OptimizeTask& task, const Outcome& outcome,
                   const report::ResultTally& tally, const std::string& summary) {
  const optimize::OptimizeResult& result = outcome.result;
  const report::RefinedColumns columns = report::refined_columns(task.spec);
  io::write_file_in_pieces(path_in(options.out, "refined.csv"), [&](const auto& out) {
    report::write_refined_csv(result, columns, out);
  });
  io::write_file(path_in(options.out, "pareto.csv"),
                 outcome.front ? report::pareto_csv(task.spec, *outcome.front)
                               : report::pareto_csv(result, columns));
  io::write_file(path_in(options.out, "summary.json"), summary);
  const std::string best_path = path_in(options.out, "best.toml");
  if (result.best) {
    io::write_file(best_path, io::design_text(stated_design(task, *result.best)));
  } else {
    set_aside(best_path, options.quiet);
  }
  if (!options.quiet) {
    say(fmt::format("{}{}{}", report::search_counts_text(task.spec, result.search),
                    report::optimize_counts_text(result, tally),
                    report::certificate_text(task.spec, result)));
  }
  const std::string journal = path_in(options.out, kJournalName);
  if (outcome.interrupted()) {
    say(fmt::format(
        "interrupted: {} holds the {} tooth sets that were refined; --resume goes on with "
        "{}\n",
        options.out, result.refined.size(),
        result.interrupted ? "the rest" : "the front, which it searches anew"));
  } else {
    std::error_code ignored;
    std::filesystem::remove(journal, ignored);
  }
}

/// The design that is printed is the one that the file describes.
std::pair<design::Design, design::Evaluation> best_of(const OptimizeTask& task,
                                                      const std::string& path) {
  design::Design design = io::read_design(path);
  if (task.model &&
      (task.spec.operating_point || !calibrate::needs_operating_point(task.model->extension))) {
    design = design::extended(design, task.model->extension);
    design.operating_point = task.spec.operating_point;
  }
  auto evaluation = design::evaluate(design);
  if (const auto* undefined = std::get_if<design::NotDefined>(&evaluation)) {
    throw io::InvalidInput(fmt::format("{}: {}", path, undefined->message));
  }
  auto& best = std::get<design::Evaluation>(evaluation);
  best.notes.insert(best.notes.end(), task.notes.begin(), task.notes.end());
  return {std::move(design), std::move(best)};
}

}  // namespace

namespace {

/// A result that would overwrite its own input is a slip.
void refuse_overwriting_input(const OptimizeOptions& options) {
  for (const std::string& input : {options.file, options.model}) {
    for (const char* name :
         {"best.toml", "refined.csv", "pareto.csv", "summary.json", "optimize.journal"}) {
      std::error_code status;
      if (input.empty() ||
          !std::filesystem::equivalent(input, path_in(options.out, name), status)) {
        continue;
      }
      throw io::InvalidInput(fmt::format(
          "{}: is a result file of --out {}, allowed: another folder", input, options.out));
    }
  }
}

}  // namespace

ExitCode run_optimize(const OptimizeOptions& options) {
  OptimizeTask task = load_task(options);
  refuse_overwriting_input(options);
  warn(task.notes, options.quiet);
  io::prepare_folder(options.out);
  if (!task.unreachable.empty()) {
    for (const char* name : kResultNames) set_aside(path_in(options.out, name), options.quiet);
    say(fmt::format("{}: {}\n", options.file, task.unreachable));
    return kNoFeasibleDesign;
  }
  const int threads = use_threads(options);
  const std::optional<report::RobustRun> robust = make_robust(options, task);
  if (robust && (!robust->search.chosen || robust->search.interrupted)) {
    for (const char* name : kResultNames) set_aside(path_in(options.out, name), options.quiet);
    if (robust->search.interrupted) {
      say("interrupted before limits that hold for the built gearboxes were found\n");
      return kInterrupted;
    }
    say(fmt::format("{}: {}\n", options.file,
                    report::robust_blocking_text(task.spec, robust->search)));
    return kNoFeasibleDesign;
  }
  const Outcome outcome = run(options, task);
  const optimize::OptimizeResult& result = outcome.result;
  const report::ResultTally tally = report::tally_of(result);
  const std::string summary = report::summary_json(
      task.spec, result, tally, {.wall_time_s = outcome.wall_time_s, .threads = threads},
      task.use(), outcome.front ? &*outcome.front : nullptr, robust ? &*robust : nullptr);
  write_results(options, task, outcome, tally, summary);
  if (!result.best) {
    if (outcome.interrupted()) return kInterrupted;
    say(fmt::format("{}\n", report::blocking_text(task.spec, result, tally)));
    const bool all_failed =
        tally.status[static_cast<std::size_t>(optimize::Status::kFailed)] > 0 && !tally.nearest;
    return all_failed ? kSolverFailure : kNoFeasibleDesign;
  }
  const std::string best_path = path_in(options.out, "best.toml");
  const auto [design, best] = best_of(task, best_path);
  switch (options.format) {
    case Format::kJson:
      print_result(summary);
      break;
    case Format::kCsv:
      report::write_refined_csv(result, report::refined_columns(task.spec),
                                [](std::string_view piece) { print_result(std::string(piece)); });
      break;
    case Format::kTable: {
      const std::optional<design::BuiltSeries> series = design::table_series(design);
      print_result(
          report::analysis_table(best, design::sensitivities(design), task.use(),
                                 series ? &*series : nullptr) +
          (robust ? report::robust_table(task.spec, *robust) : "") +
          (outcome.front ? report::pareto_table(task.spec, *outcome.front) : "") +
          fmt::format("\nFiles in {}: best.toml (this design), refined.csv ({} tooth "
                      "sets), pareto.csv ({} designs), summary.json\n",
                      options.out, result.search.candidates.size() - tally.open,
                      outcome.front ? outcome.front->points.size() : result.pareto.size()));
      break;
    }
  }
  if (!best.efficiency.backdrivable && !options.quiet) {
    say(fmt::format("the best design found cannot be back-driven (margin {:.4f})\n",
                    best.efficiency.backdriving_margin));
  }
  if (!design::all_ok(best.checks)) {
    say(fmt::format("{}: fails a check when read back\n", best_path));
    return kSolverFailure;
  }
  return outcome.interrupted() ? kInterrupted : kDone;
}

}  // namespace gear3k::cli
