#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "actuator/co_design.hpp"
#include "app/optimize.hpp"
#include "cli/commands.hpp"
#include "cli/front_files.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/talk.hpp"
#include "design/built_series.hpp"
#include "design/output_terms.hpp"
#include "design/sensitivity.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/cycle_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/model_file.hpp"
#include "io/files/refinement_journal.hpp"
#include "io/files/specification_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/held_signals.hpp"
#include "io/text/toml_value.hpp"
#include "report/actuator_report.hpp"
#include "report/analysis_report.hpp"
#include "report/certificate_report.hpp"
#include "report/co_design_report.hpp"
#include "report/first_screen.hpp"
#include "report/front_plot.hpp"
#include "report/limits_report.hpp"
#include "report/model_change_report.hpp"
#include "report/relaxed_limits_report.hpp"
#include "report/robust_report.hpp"
#include "report/search_report.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::cli {

namespace {

constexpr const char* kJournalName = "optimize.journal";
constexpr const char* kFrontJournalName = "front.journal";
constexpr const char* kFrontFigure = "pareto.svg";
constexpr const char* kSummaryName = "summary.json";
constexpr const char* kRoundedName = "best_rounded.toml";
constexpr const char* kActuatorName = "actuator.toml";

/// What was read, each file once.
struct OptimizeInput {
  app::OptimizeRequest request;
  std::uint64_t fingerprint = 0;  ///< of the very bytes
};

OptimizeInput read_input(const OptimizeOptions& options) {
  std::vector<std::string> contents;
  optimize::Specification spec;
  std::optional<app::Model> model;
  io::CollectedErrors errors;
  errors.attempt([&] {
    contents.push_back(io::read_toml_text(options.file));
    spec = io::parse_specification(contents.back(), options.file, optimize::kMostRefinedSets);
  });
  errors.attempt([&] {
    if (options.model.empty()) return;
    contents.push_back(io::read_toml_text(options.model));
    model = app::model_of(io::parse_model(contents.back(), options.model), options.model);
  });
  errors.raise();
  const std::vector<std::string> sources = io::named_files(spec);
  std::vector<std::string> all = contents;
  for (const std::string& source : sources) {
    all.push_back(io::read_text(source, "a file", io::kMostCycleBytes));
  }
  OptimizeInput input{.request = {.spec = std::move(spec),
                                  .source = options.file,
                                  .certify = options.certify,
                                  .round = options.round},
                      .fingerprint = io::task_fingerprint(all)};
  input.request.model = std::move(model);
  return input;
}

/// What an earlier run of the task left, to go on with, and what this one leaves.
class RunJournal {
 public:
  /// @param name, what  of the file, and of what it records
  RunJournal(const ResultFolder& folder, std::uint64_t fingerprint, const OptimizeOptions& options,
             const char* name, const char* what)
      : folder_(folder), fingerprint_(fingerprint), options_(options), name_(name), what_(what) {}

  /// The sets to go on with; a journal that is in the way of a new run is kept under another name.
  std::vector<optimize::RefinedSet> open() {
    const std::string path = folder_.path_of(name_);
    io::Journal journal;
    if (options_.resume) {
      journal = io::read_journal(path, fingerprint_);
      known_ = journal.sets.size();
      if (journal.exists) {
        say_unless_quiet(
            fmt::format("{}: goes on after {} {}\n", path, journal.sets.size(), what_));
      } else if (!std::filesystem::exists(folder_.path_of(kSummaryName))) {
        // Of an earlier result it is said already.
        say_unless_quiet(fmt::format("{}: there is none, the run starts anew\n", path));
      }
    } else if (std::error_code none; std::filesystem::exists(path, none)) {
      say_unless_quiet(
          fmt::format("{}: of a run that did not end; --resume would go on with it\n", path));
      folder_.set_aside(name_);
    }
    writer_.emplace(path, fingerprint_, journal);
    return std::move(journal.sets);
  }
  void append(std::span<const optimize::RefinedSet> sets) { writer_->append(sets); }
  /// Sets that an earlier run refined.
  [[nodiscard]] std::size_t known() const { return known_; }
  /// Whether what this run refines is kept: searches that differ leave none.
  [[nodiscard]] bool is_open() const { return writer_.has_value(); }
  /// The task is done: nothing is left to go on with.
  void remove() {
    writer_.reset();
    std::error_code ignored;
    std::filesystem::remove(folder_.path_of(name_), ignored);
  }

 private:
  void say_unless_quiet(const std::string& text) const {
    if (!options_.quiet) say(text);
  }

  const ResultFolder& folder_;
  std::uint64_t fingerprint_;
  const OptimizeOptions& options_;
  const char* name_;
  const char* what_;
  std::size_t known_ = 0;
  std::optional<io::JournalWriter> writer_;
};

/// The searches of a front on disk by rising number: the sets that each refined, with twice its
/// number, and what it found, with the odd one after it; where it found nothing that is no optimum.
class FrontJournal {
 public:
  FrontJournal(const ResultFolder& folder, std::uint64_t fingerprint,
               const OptimizeOptions& options)
      : journal_(folder, fingerprint, options, kFrontJournalName, "searches of the front") {}

  std::vector<optimize::FrontStep> open() {
    std::vector<optimize::FrontStep> steps;
    optimize::FrontStep step;
    for (optimize::RefinedSet& set : journal_.open()) {
      if (set.index == 2 * steps.size()) {
        step.refined.push_back(std::move(set));
      } else if (set.index == 2 * steps.size() + 1) {
        if (optimize::has_design(set.status)) step.best = std::move(set);
        steps.push_back(std::exchange(step, {}));
      } else {
        break;
      }
    }
    steps_ = steps.size();
    return steps;
  }
  void append(const optimize::FrontStep& step) {
    std::vector<optimize::RefinedSet> records = step.refined;
    for (optimize::RefinedSet& record : records)
      record.index = static_cast<std::uint32_t>(2 * steps_);
    records.push_back(step.best.value_or(optimize::RefinedSet{}));
    if (!step.best) records.back().status = optimize::Status::kInfeasible;
    records.back().index = static_cast<std::uint32_t>(2 * steps_ + 1);
    ++steps_;
    journal_.append(records);
  }
  void remove() { journal_.remove(); }

 private:
  RunJournal journal_;
  std::size_t steps_ = 0;
};

/// A run with what its files and tables are made of.
struct OptimizeRun {
  app::Optimization outcome;
  report::ResultTally tally;
  Figures figures;  ///< of the front
  std::string summary;
};

/// As summary.json has it.
std::string fingerprint_text(std::uint64_t fingerprint) {
  return fmt::format("fnv1a64:{:016x}", fingerprint);
}

/// @param held  holds signals from the end of the run on
OptimizeRun run(app::OptimizeTask& task, std::uint64_t fingerprint, RunJournal& journal,
                FrontJournal& front, const OptimizeOptions& options,
                std::optional<io::HeldSignals>& held) {
  const int threads = use_threads(options);
  OptimizeRun run;
  double wall_time_s = 0.0;
  {
    optimize::Progress progress;
    const ProgressDisplay display(progress, options.quiet, ProgressDisplay::Counts::kOfPhase,
                                  options.front_budget_s);
    run.outcome = app::optimize(
        task,
        {.known = [&] { return journal.open(); },
         .on_wave = [&](std::span<const optimize::RefinedSet> sets) { journal.append(sets); },
         .front_steps = [&] { return front.open(); },
         .on_front_step = [&](const optimize::FrontStep& step) { front.append(step); }},
        progress);
    wall_time_s = display.elapsed_s();
    held.emplace();
  }
  const app::Optimization& o = run.outcome;
  if (!o.searched()) return run;
  run.tally = report::tally_of(o.result);
  if (o.front && !o.front->points.empty()) {
    run.figures = draw({report::pareto_plot(task.spec, *o.front)});
  }
  const io::Json summary = report::summary_json(
      task.spec, o.result, run.tally,
      {.wall_time_s = wall_time_s,
       .threads = threads,
       .not_relaxed = o.not_relaxed,
       .interrupted = o.interrupted,
       .task_fingerprint = fingerprint_text(fingerprint)},
      task.use(), o.front ? &*o.front : nullptr, o.robust ? &*o.robust : nullptr,
      o.comparison ? &*o.comparison : nullptr, &task.stated_limits, o.held ? &*o.held : nullptr,
      o.rounding ? &*o.rounding : nullptr, o.co_design ? &o.co_design->report : nullptr, &o.felt,
      o.relaxed ? &*o.relaxed : nullptr);
  run.summary = with_missing_figures(summary, run.figures);
  return run;
}

/// @param replaces  what is there under a result's name: else, where no summary tells that a run
///   wrote it, it is set aside
void write_files(ResultFolder& folder, const app::OptimizeTask& task, const OptimizeRun& run,
                 bool replaces) {
  if (!replaces && !std::filesystem::exists(folder.path_of(kSummaryName))) folder.set_all_aside();
  const app::Optimization& o = run.outcome;
  const report::RefinedColumns columns = report::refined_columns(task.spec);
  std::vector<io::FileText> files{{.path = "refined.csv", .text = {}},
                                  {.path = "pareto.csv",
                                   .text = o.front ? report::pareto_csv(task.spec, *o.front)
                                                   : report::pareto_csv(o.result, columns)},
                                  {.path = kSummaryName, .text = run.summary}};
  report::write_refined_csv(o.result, columns,
                            [&](std::string_view piece) { files.front().text += piece; });
  if (o.best) files.push_back({.path = "best.toml", .text = io::design_text(o.best->stated)});
  if (o.rounded) {
    files.push_back({.path = kRoundedName, .text = io::design_text(o.rounded->stated)});
  }
  if (o.co_design) {
    files.push_back(
        {.path = kActuatorName, .text = io::actuator_text(o.co_design->actuator, "best.toml")});
  }
  for (io::FileText& file : front_files(o.front_designs)) {
    if (!replaces) folder.set_foreign_aside(file.path);
    files.push_back(std::move(file));
  }
  folder.write(std::move(files), run.figures);
  if (!o.best) folder.set_aside("best.toml");
  if (!o.rounded) folder.set_aside(kRoundedName);
  if (!o.co_design) folder.set_aside(kActuatorName);
}

std::string rounding_text(const app::OptimizeTask& task, const app::Optimization& o) {
  if (!o.rounding) return "";
  return report::rounding_table(
      task.spec,
      optimize::objective_of(task.spec, *o.result.best, optimize::first_objective(task.spec)),
      *o.rounding);
}

/// For scripts also where there is no design; the table is of one.
void print_results(const app::OptimizeTask& task, const OptimizeRun& run,
                   const OptimizeOptions& options) {
  const app::Optimization& o = run.outcome;
  switch (options.format) {
    case Format::kJson:
      print_result(run.summary);
      break;
    case Format::kCsv:
      report::write_refined_csv(o.result, report::refined_columns(task.spec),
                                [](std::string_view piece) { print_result(std::string(piece)); });
      break;
    case Format::kTable: {
      if (!o.best) break;
      const auto series = design::table_series(o.best->design);
      const std::size_t sets = o.result.search.candidates.size();
      const auto columns = known_columns(options.show.columns);
      const std::size_t width = columns ? static_cast<std::size_t>(*columns) : report::kAnyColumns;
      const std::string more =
          report::objective_line(task.spec, *o.result.best) +
          (o.co_design ? report::co_design_table(o.co_design->report) : std::string()) +
          report::limit_checks_text(o.felt) +
          report::held_back_table(task.spec, o.held->best, width) +
          report::planets_table(task.spec, *o.held, width) + rounding_text(task, o) +
          (o.robust ? report::robust_table(task.spec, *o.robust) : "") +
          (o.front ? report::pareto_table(task.spec, *o.front) : "") +
          (o.comparison ? report::model_change_table(*o.comparison) : "") + "\n" +
          report::broken(report::limits_line(task.stated_limits, report::limits_subject(task.spec)),
                         table_choice(options.show).columns, kBrokenIndent) +
          fmt::format(
              "\nFiles in {}: best.toml (this design), {}{}refined.csv ({} tooth sets), "
              "pareto.csv ({} designs), {}{}summary.json\n",
              options.out, o.rounded ? "best_rounded.toml, " : "",
              o.co_design ? "actuator.toml (its motor with it), " : "",
              o.result.search.candidates.size() - run.tally.open,
              o.front ? o.front->points.size() : o.result.pareto.size(),
              front_files_text(o.front_designs.size()),
              run.figures.files.empty() ? std::string() : fmt::format("{}, ", kFrontFigure));
      print_result(
          (o.result.interrupted || (o.front && o.front->interrupted)
               ? fmt::format("Stopped: {} of {} tooth sets are done, the best of them is\n",
                             sets - run.tally.open, sets)
               : std::string()) +
          report::analysis_text(
              o.best->evaluation,
              design::tightest_checks(o.best->design, o.best->evaluation, kTightestShown),
              table_choice(options.show), design::sensitivities(o.best->design), task.use(),
              series ? &*series : nullptr, o.best->torque_angle ? &*o.best->torque_angle : nullptr,
              design::stated_outer_diameter_m(o.best->design)) +
          (columns ? report::folded(more, *columns, kBrokenIndent) : more));
      break;
    }
  }
}

/// Limits that hold for the built gearboxes were not found.
ExitCode end_without_limits(const app::OptimizeTask& task, const app::Optimization& outcome,
                            const ResultFolder& folder) {
  folder.set_all_aside();
  if (outcome.robust->search.interrupted) {
    say("interrupted before limits that hold for the built gearboxes were found\n");
    return kInterrupted;
  }
  say(fmt::format("{}: {}\n", task.source,
                  report::robust_blocking_text(task.spec, outcome.robust->search)));
  say("limits that would have to give way are not told for built gearboxes: robust.hold = "
      "\"nominal\" tells those of the design as drawn\n");
  return kNoFeasibleDesign;
}

void say_carried_torque(const optimize::Specification& spec, const app::CarriedTorque& carried) {
  std::string held;
  if (const auto& k = spec.rating->factors.held_mesh_load) {
    held = fmt::format(", at the K_gamma that the last search held ({:.3g}, {:.3g}, {:.3g})",
                       (*k)[0], (*k)[1], (*k)[2]);
  }
  say(fmt::format(
      "the load forbids it: with every other limit kept {} carries most, {:.4g} N m of the {:.4g} "
      "N m that are asked for{}\n",
      report::teeth_text(carried.teeth), carried.torque_Nm, spec.rating->torque_Nm, held));
}

ExitCode end_without_design(const app::OptimizeTask& task, const OptimizeRun& run) {
  if (run.outcome.result.interrupted) return kInterrupted;
  if (const auto nearest = app::nearest_motor(task.spec, run.outcome.result)) {
    const auto designs = static_cast<std::size_t>(std::ranges::count_if(
        run.outcome.result.refined,
        [](const optimize::RefinedSet& set) { return optimize::has_design(set.status); }));
    say(report::no_motor_text(*actuator::co_design_of(task.spec.cycle_energy.get()), designs,
                              *nearest) +
        '\n');
    return kNoFeasibleDesign;
  }
  say(fmt::format("{}\n", report::blocking_text(task.spec, run.outcome.result, run.tally)));
  if (run.outcome.relaxed) say(report::relaxed_limits_text(task.spec, *run.outcome.relaxed));
  if (!run.outcome.not_relaxed.empty()) {
    say(fmt::format("limits that would have to give way are not told: {}\n",
                    run.outcome.not_relaxed));
  }
  if (run.outcome.interrupted) return kInterrupted;
  if (run.outcome.carried) say_carried_torque(task.spec, *run.outcome.carried);
  return report::only_failed(run.tally) ? kSolverFailure : kNoFeasibleDesign;
}

/// Whether the object of a summary has a member of its own: those within members are indented
/// further, and a text of JSON has no end of line.
bool has_member(const std::string& summary, std::string_view key, std::string_view value) {
  return summary.find(fmt::format("\n  \"{}\": {}", key, value)) != std::string::npos;
}

/// @throws io::InvalidInput where the folder holds the result of an earlier run, unless it is to be
///   replaced or gone on with
void refuse_earlier_result(const ResultFolder& folder, std::uint64_t fingerprint,
                           const OptimizeOptions& options) {
  const std::string summary = folder.path_of(kSummaryName);
  if (options.force || !std::filesystem::exists(summary)) return;
  if (options.resume) {
    if (std::filesystem::exists(folder.path_of(kJournalName)) ||
        std::filesystem::exists(folder.path_of(kFrontJournalName))) {
      return;
    }
    const std::string text = io::read_text(summary, "a file", io::kMostCycleBytes);
    if (!has_member(text, "task_fingerprint",
                    fmt::format("\"{}\"", fingerprint_text(fingerprint)))) {
      throw io::InvalidInput(fmt::format(
          "--resume: {} is the result of another task, or of another version, and there is no {} "
          "to go on with: allowed: another folder, --force to replace it",
          summary, kJournalName));
    }
    if (!options.quiet) {
      say(fmt::format("{}: the result of this task, which {}: the run starts anew\n", summary,
                      has_member(text, "interrupted", "true") ? "was interrupted and left nothing "
                                                                "to go on with"
                                                              : "ended"));
    }
    return;
  }
  throw io::InvalidInput(
      fmt::format("--out {}: holds the result of an earlier run ({}): allowed: another folder, "
                  "--force to replace it, --resume to go on with one that was interrupted",
                  options.out, summary));
}

/// What an interrupted run did not come to, or not to the end of.
const char* open_part(const app::Optimization& o) {
  if (o.result.interrupted) return "the rest";
  if (o.front && o.front->interrupted) return "the front";
  if (o.held && o.held->best.held.interrupted) {
    return "the searches beyond bounds and limits, which it begins anew";
  }
  if (o.relaxed && o.relaxed->interrupted) {
    return "the limits that would have to give way, which it begins anew";
  }
  if (o.rounding) return "the rounding, which it begins anew";
  if (!o.best) return "what can be carried, which it begins anew";
  return "the search without the model, which it begins anew";
}

/// Leaves the journals of a run that did not come to its end, and says how it goes on.
void keep_for_resume(const OptimizeOptions& options, const app::OptimizeTask& task,
                     const app::Optimization& outcome, RunJournal& journal, FrontJournal& front) {
  if (outcome.interrupted) {
    say(fmt::format("interrupted: {} holds the {} tooth sets that were refined; --resume {}\n",
                    options.out, outcome.result.refined.size(),
                    journal.is_open() ? fmt::format("goes on with {}", open_part(outcome))
                                      : std::string("begins anew")));
  } else if (outcome.front && outcome.front->ended == optimize::ParetoFront::Ended::kBudget) {
    if (!options.quiet) {
      say(fmt::format("the front's {:g} s were spent with {} of {} designs; --resume goes on\n",
                      options.front_budget_s, outcome.front->points.size(),
                      task.spec.pareto_points));
    }
  } else {
    journal.remove();
    front.remove();
  }
}

/// What the best design fails, as the run's exit code.
ExitCode end_with_design(const OptimizeOptions& options, const app::OptimizeTask& task,
                         const app::Optimization& outcome, const ResultFolder& folder) {
  const design::Evaluation& best = outcome.best->evaluation;
  if (!best.efficiency.backdrivable && !options.quiet) {
    say(fmt::format("the best design found cannot be back-driven (margin {:.4f})\n",
                    best.efficiency.backdriving_margin));
  }
  if (!design::all_ok(best.checks)) {
    say(fmt::format("{}: fails a check{}\n", folder.path_of("best.toml"),
                    outcome.interrupted ? " (the run was interrupted)" : ""));
    return outcome.interrupted ? kInterrupted : kSolverFailure;
  }
  if (outcome.rounded && !design::all_ok(outcome.rounded->evaluation.checks)) {
    say(fmt::format("{}: fails a check\n", folder.path_of(kRoundedName)));
    return kSolverFailure;
  }
  if (outcome.interrupted) return kInterrupted;
  if (outcome.rounding && !outcome.rounded) {
    say(fmt::format("{}: {}\n", options.file,
                    report::rounding_blocked_text(task.spec, *outcome.rounding)));
    return kNoFeasibleDesign;
  }
  return kDone;
}

}  // namespace

ExitCode run_optimize(const OptimizeOptions& options) {
  const OptimizeInput input = read_input(options);
  app::OptimizeTask task = app::optimize_task(input.request);
  std::vector<std::string> inputs = io::named_files(task.spec);
  inputs.insert(inputs.end(), {options.file, options.model});
  std::vector<std::string> files{"best.toml",   kRoundedName, kActuatorName,
                                 "refined.csv", "pareto.csv", kSummaryName};
  for (std::string& name : possible_front_files(task.spec)) files.push_back(std::move(name));
  ResultFolder folder({.path = options.out,
                       .inputs = std::move(inputs),
                       .files = std::move(files),
                       .others = {kJournalName, kFrontJournalName},
                       .figures = {kFrontFigure},
                       .earlier = earlier_front_files(options.out),
                       .quiet = options.quiet});
  if (options.front_budget_s > 0.0 && task.spec.objectives.size() < 2) {
    throw io::InvalidInput(fmt::format(
        "--front-budget {:g}: {} has one objective and so no front; allowed: with a list of "
        "objectives",
        options.front_budget_s, options.file));
  }
  refuse_earlier_result(folder, input.fingerprint, options);
  warn(task.spec.notes, options.quiet);
  warn(task.model_notes, options.quiet);
  folder.open();
  if (!task.unreachable.empty()) {
    folder.set_all_aside();
    say(fmt::format("{}: {}\n", options.file, task.unreachable));
    return kNoFeasibleDesign;
  }
  RunJournal journal(folder, input.fingerprint, options, kJournalName, "refined tooth sets");
  FrontJournal front(folder, input.fingerprint, options);
  std::optional<io::HeldSignals> held;  // until what was found is written
  OptimizeRun result = run(task, input.fingerprint, journal, front, options, held);
  const app::Optimization& outcome = result.outcome;
  if (!outcome.searched()) return end_without_limits(task, outcome, folder);
  if (outcome.result.search.interrupted && journal.known() > 0) {
    say(fmt::format(
        "interrupted before the tooth sets were found: {} is as it was, with {} refined "
        "tooth sets; --resume goes on with the rest\n",
        options.out, journal.known()));
    return kInterrupted;
  }
  write_files(folder, task, result, options.force);
  if (!options.quiet) {
    say(fmt::format("{}{}{}", report::search_counts_text(task.spec, outcome.result.search),
                    report::optimize_counts_text(outcome.result, result.tally),
                    report::certificate_text(task.spec, outcome.result)));
  }
  keep_for_resume(options, task, outcome, journal, front);
  held.reset();
  print_results(task, result, options);
  if (!outcome.best) return end_without_design(task, result);
  return end_with_design(options, task, outcome, folder);
}

}  // namespace gear3k::cli
