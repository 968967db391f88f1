// The store of sweeps under load: rows a second of 16 writers, size and answers of 20,000 tasks,
// and what a sweep costs beside its tasks.
//
//   build/release/benchmarks/sweep_store [FOLDER]      (a local folder; by default a new one in
//   /tmp)
//
// Fails (1) where a writer sees an error, or a bound is missed: 5000 rows/s, 12 kB a task, 1 s for
// the best by ratio and diameter, 5 % of CPU beside the tasks.

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/sweep.hpp"
#include "benchmarks/program.hpp"
#include "sweep/questions.hpp"
#include "sweep/store.hpp"

namespace gear3k::benchmarks {
namespace {

namespace fs = std::filesystem;
using sweep::Database, sweep::Store;

double sweep_seconds() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// CPU time of all children that have ended.
double children_cpu_s() {
  rusage use{};
  ::getrusage(RUSAGE_CHILDREN, &use);
  return static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

constexpr int kSweepTasks = 20'000;
constexpr int kSweepWriters = 16;

/// 100 ratios x 5 diameters x 40 frictions of the task of examples/sweep/ratios.toml.
sweep::Sweep many_tasks(const fs::path& folder) {
  const fs::path example = fs::path(GEAR3K_SOURCE_DIR) / "examples" / "sweep" / "ratios.toml";
  std::ifstream file(example);
  std::string text(std::istreambuf_iterator<char>(file), {});
  text.resize(text.find("[vary]"));
  text.replace(text.find("coefficient = 0.08"), 18, "loss_model = \"sliding\"");
  std::ofstream(folder / "sweep.toml")
      << text
      << "[vary]\nratio.target = { min = 20, max = 200, count = 100, log = true }\n"
         "size.max_ring_root_diameter_mm = [40.0, 50.0, 60.0, 76.0, 90.0]\n"
         "friction.coefficient = { min = 0.04, max = 0.118, step = 0.002 }\n";
  return sweep::read_sweep((folder / "sweep.toml").string());
}

struct SweepLoad {
  std::string path;
  std::int64_t run = 0;
  sweep::TaskResult result;  ///< of one task, recorded for all of them
};

/// Records results until no task is left.  @returns 1 where anything was refused
int write_until_done(const SweepLoad& load) {
  try {
    Store store(sweep::open_sweep_database(load.path, Database::Access::kWrite));
    while (const auto claimed = store.claim(load.run, sweep::this_process(), 0.0)) {
      store.finish(claimed->id, load.result,
                   {.run = "run", .host = "here", .finished_s = 0.0, .cpu_s = 1.0});
    }
    return 0;
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 1;
  }
}

/// Removes a folder, also where the benchmark ends by an exception; "": none.
class RemovedAtTheEnd {
 public:
  explicit RemovedAtTheEnd(fs::path folder) : folder_(std::move(folder)) {}
  ~RemovedAtTheEnd() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  RemovedAtTheEnd(const RemovedAtTheEnd&) = delete;
  RemovedAtTheEnd& operator=(const RemovedAtTheEnd&) = delete;

 private:
  fs::path folder_;
};

bool report_bound(const char* what, double value, const char* unit, bool kept) {
  std::printf("%-56s %10.4g %s%s\n", what, value, unit, kept ? "" : "   MISSED");
  return kept;
}

}  // namespace

PROGRAM(sweep_store)(int argc, char** argv) {
  std::string made = (fs::temp_directory_path() / "gear3k_sweep_XXXXXX").string();
  const fs::path folder = argc > 1 ? fs::path(argv[1]) : fs::path(::mkdtemp(made.data()));
  const RemovedAtTheEnd removed{argc > 1 ? fs::path() : folder};
  const sweep::Sweep sweep = many_tasks(folder);
  SweepLoad load{.path = (folder / "many.db").string(), .run = 0, .result = {}};
  bool good = true;
  {
    Store store(sweep::open_sweep_database(load.path, Database::Access::kCreate));
    load.run = store.begin(
        {.uid = "run", .workers = kSweepWriters, .shard = {}, .started_s = 0.0, .host = "here"},
        sweep);
    sweep::Planned planned;
    const double begin = sweep_seconds();
    for (std::uint64_t at = 0; at < sweep.count();) {
      at = store.plan(load.run, sweep, {}, at, planned);
    }
    store.end_plan();
    report_bound("tasks put into the queue", kSweepTasks / (sweep_seconds() - begin), "/s", true);
    // One OpenMP region here, and none in the forked writers.
    optimize::Progress progress;
    load.result =
        app::solve_task(store.claim(load.run, sweep::this_process(), 0.0)->spec, progress);
  }
  const double begin = sweep_seconds();
  std::vector<pid_t> writers;
  for (int k = 0; k < kSweepWriters; ++k) {
    writers.push_back(::fork());
    if (writers.back() == 0) ::_exit(write_until_done(load));
  }
  ::usleep(300'000);
  {
    const double asked = sweep_seconds();
    const Database database = sweep::open_sweep_database(load.path, Database::Access::kRead);
    sweep::status_of(database);
    report_bound("status while they write", sweep_seconds() - asked, "s", true);
  }
  for (const pid_t writer : writers) {
    int status = -1;
    ::waitpid(writer, &status, 0);
    good = good && status == 0;
  }
  const double wall_s = sweep_seconds() - begin;
  {
    // The task that was worked on above is this process's still.
    Store store(sweep::open_sweep_database(load.path, Database::Access::kWrite));
    store.database().execute("UPDATE queue SET host = '', until = 0");
    write_until_done(load);
    const Database database = sweep::open_sweep_database(load.path, Database::Access::kRead);
    const auto rows = static_cast<double>(database.count("SELECT count(*) FROM design") +
                                          database.count("SELECT count(*) FROM refusal") +
                                          database.count("SELECT count(*) FROM provenance"));
    std::printf("%d tasks, %.0f rows of results, 16 writers, %s\n", kSweepTasks, rows,
                good ? "no error" : "ERRORS");
    good =
        report_bound("results recorded", rows / wall_s, "rows/s", rows / wall_s >= 5000.0) && good;
    report_bound("the same", kSweepTasks / wall_s, "tasks/s", true);
    store.database().execute("PRAGMA wal_checkpoint(TRUNCATE)");
    const double kilobytes = static_cast<double>(fs::file_size(load.path)) / 1000.0 / kSweepTasks;
    good = report_bound("size", kilobytes, "kB/task", kilobytes <= 12.0) && good;
    const double asked = sweep_seconds();
    const sweep::Rows best = sweep::best_of(
        database, {.by = {"ratio", "ring_root_diameter"}, .of = "eta_b", .least = false});
    const double answer_s = sweep_seconds() - asked;
    good = best.rows.size() == 500 && good;
    good = report_bound("best by ratio and diameter", answer_s, "s", answer_s < 1.0) && good;
  }
  const std::string example = std::string(GEAR3K_SOURCE_DIR) + "/examples/sweep/ratios.toml";
  for (const int workers : {1, 2}) {
    const std::string path = (folder / fmt::format("w{}.db", workers)).string();
    const double before_s = children_cpu_s();
    const double from = sweep_seconds();
    const std::string command =
        fmt::format("'{}' sweep '{}' --out '{}' --workers {} --quiet >/dev/null", GEAR3K_PROGRAM,
                    example, path, workers);
    good = std::system(command.c_str()) == 0 && good;
    const double all_s = children_cpu_s() - before_s;
    const double wall = sweep_seconds() - from;
    const Database database = sweep::open_sweep_database(path, Database::Access::kRead);
    const double tasks_s = std::get<double>(database.one("SELECT sum(cpu_s) FROM provenance"));
    std::printf("examples/sweep/ratios.toml, %d worker%s: %.2f s wall, %.2f s CPU in tasks\n",
                workers, workers == 1 ? "" : "s", wall, tasks_s);
    const double share = all_s / tasks_s - 1.0;
    good = report_bound("CPU beside the tasks", 100.0 * share, "%", share < 0.05) && good;
  }
  return good ? 0 : 1;
}

}  // namespace gear3k::benchmarks
