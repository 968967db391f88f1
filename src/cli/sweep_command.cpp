#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <random>
#include <string_view>

#include "cli/commands.hpp"
#include "cli/figures.hpp"
#include "cli/progress.hpp"
#include "cli/result_files.hpp"
#include "cli/sweep_workers.hpp"
#include "cli/talk.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_set.hpp"
#include "io/text/file_writer.hpp"
#include "sweep/atlas.hpp"
#include "sweep/compare.hpp"
#include "sweep/map_plot.hpp"
#include "sweep/merge.hpp"
#include "sweep/questions.hpp"
#include "sweep/store.hpp"
#include "sweep/sweep_file.hpp"

namespace gear3k::cli {

namespace {

using sweep::Database;

/// Tasks that need no word of consent.
constexpr std::uint64_t kMostWithoutConsent = 100'000;

std::string new_uid() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}", random(), random(),
                     static_cast<std::uint32_t>(::getpid()));
}

std::string rows_text(Format format, const sweep::Rows& rows) {
  switch (format) {
    case Format::kJson:
      return sweep::rows_json(rows);
    case Format::kCsv:
      return sweep::rows_csv(rows);
    case Format::kTable:
      break;
  }
  return sweep::rows_table(rows);
}

void deliver_rows(const CommonOptions& options, const sweep::Rows& rows) {
  deliver(options, rows_text(options.format, rows));
}

/// One and the same for a file, whether it is there or not.
std::string whole_path(const std::string& path) {
  std::error_code unknown;
  // Absolute before: of a name that is not there the canonical form may be relative.
  return std::filesystem::weakly_canonical(std::filesystem::absolute(path), unknown).string();
}

/// @throws io::InvalidInput where --out is one of the databases, or a file that SQLite keeps beside
void keep_databases(const std::string& out, const std::vector<std::string>& databases) {
  if (out.empty()) return;
  for (const std::string& database : databases) {
    const std::string slip = io::replaced_input(out, {database});
    if (!slip.empty()) throw io::InvalidInput("--out: " + slip);
    // They come and go with those who have the database open.
    for (const char* beside : {"-wal", "-shm", "-journal"}) {
      if (whole_path(out) != whole_path(database) + beside) continue;
      throw io::InvalidInput(
          fmt::format("--out: {} is a part of {}, allowed: another name", out, database));
    }
  }
}

/// The database of a question, whose answer does not replace it.
Database asked(const SweepQuestion& question) {
  keep_databases(question.out, {question.database});
  return sweep::open_sweep_database(question.database, Database::Access::kRead);
}

/// Puts the tasks into the queue.  @returns false where Ctrl-C came first
bool plan(sweep::Store& store, std::int64_t run, const sweep::Sweep& sweep,
          const sweep::Shard& shard, sweep::Planned& planned) {
  for (std::uint64_t place = 0; place < sweep.count();) {
    if (sweep_interrupted()) return false;
    place = store.plan(run, sweep, shard, place, planned);
  }
  store.end_plan();
  return true;
}

void refuse_by_mistake(const SweepOptions& options, const sweep::Sweep& sweep) {
  const std::uint64_t count = sweep.count() / options.shard.count;
  if (count <= kMostWithoutConsent || options.yes || options.most_s) return;
  throw io::InvalidInput(fmt::format(
      "{}: asks for {} tasks: allowed: at most {}, or more with --yes or a budget (--for 10h)",
      options.file, sweep.count(), kMostWithoutConsent));
}

}  // namespace

std::optional<sweep::Shard> shard_of(std::string_view text) {
  const auto slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto number = [](std::string_view digits) -> std::uint64_t {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() ? value : 0;
  };
  const sweep::Shard shard{.number = number(text.substr(0, slash)),
                           .count = number(text.substr(slash + 1))};
  if (shard.number < 1 || shard.number > shard.count) return std::nullopt;
  return shard;
}

std::optional<double> duration_s(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !(value > 0.0) || !std::isfinite(value) ||
      end + 1 != text.data() + text.size()) {
    return std::nullopt;
  }
  constexpr double kMinute = 60.0, kHour = 3600.0;
  switch (*end) {
    case 's':
      return value;
    case 'm':
      return value * kMinute;
    case 'h':
      return value * kHour;
    default:
      return std::nullopt;
  }
}

ExitCode run_sweep(const SweepOptions& options) {
  const sweep::Sweep sweep = sweep::read_sweep(options.file);
  refuse_by_mistake(options, sweep);
  const std::string slip = io::replaced_input(options.out, {options.file});
  if (!slip.empty()) throw io::InvalidInput("--out: " + slip);
  sweep_interrupted();
  SweepWork work{.database = options.out,
                 .run = 0,
                 .uid = new_uid(),
                 .workers = options.workers > 0 ? options.workers : 1,
                 .threads = options.threads > 0 ? options.threads : 1,
                 .most_s = options.most_s,
                 .quiet = options.quiet};
  sweep::Planned planned;
  {
    sweep::Store store(sweep::open_sweep_database(options.out, Database::Access::kCreate));
    work.run = store.begin({.uid = work.uid,
                            .workers = work.workers,
                            .shard = options.shard,
                            .started_s = now_s(),
                            .host = sweep::host_name()},
                           sweep);
    if (!plan(store, work.run, sweep, options.shard, planned)) {
      say("interrupted: nothing was begun; the same command goes on\n");
      return kInterrupted;
    }
  }
  if (!options.quiet) {
    say(fmt::format("{} tasks, {} of them known\n", planned.asked, planned.known));
  }
  const SweepEnd end = work_on_sweep(work);
  {
    sweep::Store store(sweep::open_sweep_database(options.out, Database::Access::kWrite));
    store.end(work.run, now_s());
    if (!end.failure.empty()) throw io::InvalidInput(end.failure);
    print_result(rows_text(options.format, sweep::status_of(store.database(), work.uid)));
  }
  if (end.open > 0 && !options.quiet) {
    const char* why = "still worked on elsewhere";
    if (end.interrupted) why = "open, as it was interrupted; the same command goes on";
    if (end.out_of_time) why = "open, as the time was up; the same command goes on";
    say(fmt::format("{} {} {}\n", end.open, end.open == 1 ? "task is" : "tasks are", why));
  }
  return end.interrupted ? kInterrupted : kDone;
}

ExitCode run_sweep_merge(const SweepMergeOptions& options) {
  keep_databases(options.out, options.databases);
  print_result(rows_text(options.format, sweep::merge(options.databases, options.out)));
  return kDone;
}

namespace {

/// @throws io::InvalidInput where --task is there, cannot be written or is the file of --out
void refuse_task(const AtlasOptions& options) {
  if (!options.out.empty() && whole_path(options.out) == whole_path(options.task)) {
    throw io::InvalidInput(
        fmt::format("--out: {} is the file of --task, allowed: another name", options.out));
  }
  if (std::filesystem::exists(options.task)) {
    throw io::InvalidInput(fmt::format(
        "--task {}: is there already, and is not replaced; allowed: a new name", options.task));
  }
  io::expect_file(options.task);
}

/// The folder of --figures.
void write_atlas(const AtlasOptions& options) {
  end_on_interrupt();
  const std::vector<report::Plot> plots = sweep::atlas_plots();
  ResultFolderTask task{.path = options.figures,
                        .option = "--figures",
                        .inputs = {},
                        .result = options.out,
                        .files = {"atlas.csv"},
                        .figures = {},
                        .quiet = options.quiet};
  for (const report::Plot& plot : plots) task.figures.push_back(plot.name + ".svg");
  ResultFolder(std::move(task))
      .write({{.path = "atlas.csv", .text = std::string(sweep::atlas_csv())}}, draw(plots));
}

}  // namespace

ExitCode run_atlas(const AtlasOptions& options) {
  const std::vector<sweep::AtlasPoint> points = sweep::atlas_near(options.question);
  const std::string taken =
      points.empty() ? std::string() : sweep::atlas_snap_text(options.question, points);
  if (!taken.empty() && !options.quiet) say(taken + '\n');
  const std::string task = options.task.empty() ? "" : sweep::atlas_task(options.question);
  if (!options.task.empty()) refuse_task(options);
  refuse_replacing({}, options.out, options.figures);
  if (!options.figures.empty()) write_atlas(options);
  deliver_rows(options, sweep::atlas_rows(points));
  // Last: a run that failed can be repeated, as none is replaced.
  if (!options.task.empty()) io::write_file(options.task, task);
  return kDone;
}

ExitCode run_sweep_status(const SweepQuestion& question) {
  deliver_rows(question, sweep::status_of(asked(question)));
  return kDone;
}

ExitCode run_sweep_best(const SweepQuestion& question) {
  const bool least = !question.least.empty();
  const Database database = asked(question);
  const sweep::AskedTasks tasks{.run = question.run};
  const sweep::Rows rows = sweep::best_of(database, {.tasks = tasks,
                                                     .by = question.by,
                                                     .of = least ? question.least : question.most,
                                                     .least = least});
  deliver_rows(question, rows);
  if (question.quiet) return kDone;
  if (!least && question.most.empty()) say(sweep::ranking_of(database, tasks, question.by).text);
  say(sweep::pooled_text(database, tasks, rows.names));
  return kDone;
}

ExitCode run_sweep_query(const SweepQuestion& question) {
  deliver_rows(question, sweep::answer_to(asked(question), question.sql));
  return kDone;
}

ExitCode run_sweep_compare(const SweepQuestion& question) {
  const Database database = asked(question);
  const sweep::Comparison comparison =
      sweep::compare(database, sweep::since_of(question.since).value());
  if (question.format != Format::kTable || !comparison.changes.rows.empty()) {
    deliver_rows(question, comparison.changes);
  }
  if (!question.quiet) say(sweep::counts_text(comparison));
  return question.strict && comparison.any_worse() ? kNoFeasibleDesign : kDone;
}

ExitCode run_sweep_figure(const SweepQuestion& question) {
  if (other_form(question, "sweep figure", "SVG")) return kUsage;
  const Database database = asked(question);
  const sweep::AskedTasks tasks{.run = question.run};
  const sweep::Map map = sweep::map_of(database, {.tasks = tasks,
                                                  .x = question.x,
                                                  .y = question.y,
                                                  .by = question.by.empty() ? "" : question.by[0]});
  const Figures figures = draw({sweep::map_plot(map, "map")});
  if (figures.files.empty()) {
    throw io::InvalidInput(
        fmt::format("sweep figure: {}: allowed: with gnuplot", figures.missing.front().cause));
  }
  // As it is: not a text of lines for a terminal.
  deliver_in_pieces(question, [&](const auto& take) { take(figures.files.front().text); });
  if (!question.quiet) say(sweep::pooled_text(database, tasks, {map.x, map.by}));
  return kDone;
}

}  // namespace gear3k::cli
