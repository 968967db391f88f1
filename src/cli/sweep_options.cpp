#include "cli/sweep_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/common_options.hpp"
#include "sweep/compare.hpp"

namespace gear3k::cli {

namespace {

/// A question to a sweep's database: a subcommand with what all of them take.
CLI::App& add_sweep_question(CLI::App& sweep, const char* name, const char* text,
                             SweepQuestion& question, std::function<ExitCode()>& run,
                             ExitCode (*answer)(const SweepQuestion&)) {
  CLI::App& command = *sweep.add_subcommand(name, text);
  command.add_option("DB", question.database, "database of a sweep")->required();
  add_common_options(command, question);
  command.footer("");
  add_out_file(command, question);
  command.callback(
      [&question, &run, answer] { run = [&question, answer] { return answer(question); }; });
  return command;
}

/// Options of `sweep` before a subcommand, which has its own.
void refuse_before_subcommand(const CLI::App& sweep) {
  std::vector<std::string> given;
  for (const CLI::Option* option : sweep.get_options()) {
    if (option->count() > 0) given.push_back(option->get_name());
  }
  if (given.empty()) return;
  throw CLI::ValidationError(
      fmt::format("{}: no effect before {}: allowed: options of the subcommand, after it",
                  fmt::join(given, ", "), sweep.get_subcommands().front()->get_name()),
      CLI::ExitCodes::ValidationError);
}

void add_run(CLI::App& command, SweepQuestion& question) {
  command.add_option("--run", question.run, "a run's tasks alone, by its number in sweep status")
      ->option_text("N");
}

void add_run_options(CLI::App& sweep, SweepOptions& options) {
  sweep.add_option("SWEEP", options.file,
                   "SWEEP.toml: a task, and what of it is varied; its keys: gear3k keys");
  sweep.add_option("--out", options.out, "database for the results, made when missing")
      ->option_text("DB");
  sweep.add_option("--workers", options.workers, "processes that work on tasks")
      ->check(within(1, 1024))
      ->option_text("N [1]");
  sweep.add_option("--threads", options.threads, "OpenMP threads of each worker, 1 to 1024")
      ->check(within(1, 1024))
      ->option_text("N [1]");
  sweep
      .add_option_function<std::string>(
          "--for", [&options](const std::string& text) { options.most_s = duration_s(text); },
          "ends after this time, as 10h, 30m or 45s; the same command goes on")
      ->check([](const std::string& text) {
        return duration_s(text)
                   ? ""
                   : fmt::format("{}: allowed: a time above 0, as 10h, 30m or 45s", text);
      })
      ->option_text("TIME");
  sweep
      .add_option_function<std::string>(
          "--shard", [&options](const std::string& text) { options.shard = *shard_of(text); },
          "one of n parts of the tasks, for a database of its own; sweep merge")
      ->check([](const std::string& text) {
        return shard_of(text) ? "" : fmt::format("{}: allowed: i/n, 1 <= i <= n", text);
      })
      ->option_text("i/n");
  sweep.add_flag("--yes", options.yes, "do more than 100000 tasks");
  add_output_options(sweep, options);
  sweep.footer("");
}

void add_best(CLI::App& sweep, SweepQuestion& question, std::function<ExitCode()>& run) {
  CLI::App& best = add_sweep_question(sweep, "best", "the best design by keys or columns", question,
                                      run, run_sweep_best);
  best.add_option("--by", question.by, "keys or columns, a row for each of their values")
      ->delimiter(',')
      ->option_text("NAME,...");
  CLI::Option* most = best.add_option("--most", question.most, "what is best, more of it")
                          ->option_text("NAME [objective]");
  best.add_option("--least", question.least, "what is best, less of it")
      ->option_text("NAME")
      ->excludes(most);
  add_run(best, question);
}

void add_figure(CLI::App& sweep, SweepQuestion& question, std::function<ExitCode()>& run) {
  CLI::App& figure = add_sweep_question(sweep, "figure", "a map of the results, as SVG", question,
                                        run, run_sweep_figure);
  figure.add_option("--x", question.x, "key or column along the axis")
      ->required()
      ->option_text("NAME");
  figure.add_option("--y", question.y, "key or column upwards, the greatest of each point")
      ->required()
      ->option_text("NAME");
  figure.add_option("--by", question.by, "key or column, a line for each of its values")
      ->expected(1)
      ->option_text("NAME");
  add_run(figure, question);
}

void add_compare(CLI::App& sweep, SweepQuestion& question, std::function<ExitCode()>& run) {
  CLI::App& compare =
      add_sweep_question(sweep, "compare", "what is better, worse or newly infeasible, and why",
                         question, run, run_sweep_compare);
  compare.add_option("--since", question.since, "revision of the models, or time of UTC")
      ->required()
      ->check([](const std::string& text) {
        return sweep::since_of(text) ? ""
                                     : fmt::format("{}: allowed: {}", text, sweep::kAllowedSince);
      })
      ->option_text("REVISION | DATE");
  compare.add_flag("--strict", question.strict, "exit with 3 when anything is worse");
}

void add_merge(CLI::App& sweep, SweepMergeOptions& merge, std::function<ExitCode()>& run) {
  CLI::App& command = *sweep.add_subcommand(
      "merge", "takes the results of other databases over; a second time nothing");
  command.add_option("DB", merge.databases, "databases of sweeps")->required();
  command.add_option("--out", merge.out, "database that takes them, made when missing")
      ->required()
      ->option_text("DB");
  add_common_options(command, merge);
  command.footer("");
  command.callback([&merge, &run] { run = [&merge] { return run_sweep_merge(merge); }; });
}

}  // namespace

void add_sweep_commands(CLI::App& sweep, SweepCommands& commands, std::function<ExitCode()>& run) {
  SweepOptions& options = commands.sweep;
  SweepQuestion& question = commands.question;
  sweep.require_subcommand(0, 1);
  add_run_options(sweep, options);
  add_sweep_question(sweep, "status", "what is done, by run", question, run, run_sweep_status);
  add_best(sweep, question, run);
  add_sweep_question(sweep, "query", "the rows of an SQL statement that only reads", question, run,
                     run_sweep_query)
      .add_option("SQL", question.sql, "tables and views: docs/sweep.md")
      ->required();
  add_figure(sweep, question, run);
  add_compare(sweep, question, run);
  add_merge(sweep, commands.merge, run);
  sweep.callback([&sweep, &options, &run] {
    if (!sweep.get_subcommands().empty()) {
      refuse_before_subcommand(sweep);
      return;
    }
    if (options.file.empty() || options.out.empty()) {
      throw CLI::ValidationError("sweep: allowed: SWEEP.toml and --out DB, or a subcommand",
                                 CLI::ExitCodes::ValidationError);
    }
    run = [&options] { return run_sweep(options); };
  });
}

void add_atlas_options(CLI::App& command, AtlasOptions& options, std::function<ExitCode()>& run) {
  command.add_option("RATIO", options.question.ratio, "sun's speed over the output's")->required();
  command.add_option("--planets", options.question.planets, "3 to 6; all by default")
      ->option_text("N");
  command
      .add_option("--backlash", options.question.backlash_arcmin,
                  "greatest lost motion; all limits of the atlas by default")
      ->option_text("ARCMIN");
  command
      .add_option("--friction", options.question.friction,
                  "coefficient, the nearest of the atlas; all by default")
      ->check(within(0.001, 1.0))
      ->option_text("MU");
  command
      .add_option("--task", options.task, "file for a SPEC.toml to begin with; none is replaced")
      ->option_text("FILE");
  command
      .add_option("--figures", options.figures,
                  "folder for atlas.csv and its three figures; made when missing; figures need "
                  "gnuplot")
      ->option_text("DIR");
  add_common_options(command, options);
  add_out_file(command, options);
  command.callback([&options, &run] {
    if (const std::string error = sweep::atlas_error(options.question); !error.empty()) {
      throw CLI::ValidationError(error, CLI::ExitCodes::ValidationError);
    }
    run = [&options] { return run_atlas(options); };
  });
}

}  // namespace gear3k::cli
