// The time left that `optimize` tells against what was left, in CPU time of one thread.
//
//     time_left [--looks] [--phases] [TASK...]
//
// All tasks by default, some minutes; else those of the numbers.  --looks prints what was told,
// --phases what ran.
//
// A look counts as right where what is left lies within the range told, or within a factor of two
// of the one number where that is told; "middle" is the share whose geometric middle of the range
// is within a factor of two, too.

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "app/optimize.hpp"
#include "benchmarks/cpu_time.hpp"
#include "benchmarks/program.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/run_forecast.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program

struct TimedTask {
  const char* name;
  const char* file;
  std::vector<std::array<const char*, 2>> lines{};  ///< a line that begins so becomes another one
  bool certify = false, round = false;
};

const std::vector<TimedTask> kTimedTasks{
    {.name = "ratio-96, all sets", .file = "examples/ratio-96.toml"},
    {.name = "the wrist, certified and rounded",
     .file = "examples/jobs/wrist_150.toml",
     .certify = true,
     .round = true},
    {.name = "printed 30:1, certified", .file = "examples/jobs/printed_30.toml", .certify = true},
    {.name = "the same envelope, all sets", .file = "examples/jobs/same_envelope_96.toml"},
    {.name = "ratio-96 for built gearboxes", .file = "examples/ratio-96-robust.toml"},
    {.name = "ratio-96, front of two objectives",
     .file = "examples/ratio-96.toml",
     .lines = {{"objective =", "objective = [\"backward_efficiency\", \"lost_motion\"]"}}},
    {.name = "ratio-96, front of three objectives",
     .file = "examples/ratio-96.toml",
     .lines = {{"objective =",
                "objective = [\"backward_efficiency\", \"lost_motion\", \"outer_diameter\"]"}}},
    {.name = "the whole space around 96:1, certified",
     .file = "examples/ratio-96-wide.toml",
     .certify = true},
    {.name = "printed 30:1 without a design, certified",
     .file = "examples/jobs/printed_30.toml",
     .lines = {{"max_ring_root_diameter_mm", "max_ring_root_diameter_mm = 45.0"}},
     .certify = true},
    // Those that follow were looked at for fronts, of which that of ratio-96 at 70:1 was not, and
    // searches beyond ranges only.
    {.name = "a wrist of -100:1, certified",
     .file = "examples/jobs/wrist_150.toml",
     .lines = {{"target =", "target = -100.0"}},
     .certify = true},
    {.name = "60:1 in the same envelope, front of efficiency and diameter",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 60.0"},
               {"objective =", "objective = [\"backward_efficiency\", \"outer_diameter\"]"}}},
    {.name = "140:1 in it, front of forward efficiency and lost motion",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 140.0"},
               {"objective =", "objective = [\"forward_efficiency\", \"lost_motion\"]"}}},
    {.name = "printed 45:1, certified and rounded",
     .file = "examples/jobs/printed_30.toml",
     .lines = {{"target =", "target = 45.0"}},
     .certify = true,
     .round = true},
    {.name = "ratio-96 within 1 arcmin, without a design",
     .file = "examples/ratio-96.toml",
     .lines = {{"max_output_arcmin", "max_output_arcmin = 1.0"}}},
    {.name = "60:1 in the same envelope, front of three objectives",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 60.0"},
               {"objective =",
                "objective = [\"backward_efficiency\", \"lost_motion\", \"outer_diameter\"]"}}},
    {.name = "the wrist within 40 mm, certified",
     .file = "examples/jobs/wrist_150.toml",
     .lines = {{"max_outer_diameter_mm", "max_outer_diameter_mm = 40.0"}},
     .certify = true},
    {.name = "140:1 in the same envelope, front of three objectives",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 140.0"},
               {"objective =",
                "objective = [\"forward_efficiency\", \"lost_motion\", \"outer_diameter\"]"}}},
    {.name = "ratio-96 at 70:1, front of two objectives",
     .file = "examples/ratio-96.toml",
     .lines = {{"target =", "target = 70.0"},
               {"objective =", "objective = [\"backward_efficiency\", \"lost_motion\"]"}}},
    {.name = "60:1 within 45 mm, all sets",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 60.0"},
               {"max_ring_root_diameter_mm", "max_ring_root_diameter_mm = 45.0"}}}};

std::string text_with_lines(const TimedTask& task) {
  std::ifstream file(std::string(GEAR3K_SOURCE_DIR) + "/" + task.file);
  std::string text, line;
  while (std::getline(file, line)) {
    for (const auto& [begin, other] : task.lines) {
      if (line.starts_with(begin)) line = other;
    }
    text += line + '\n';
  }
  return text;
}

struct TimedLook {
  double at_s = 0.0;
  optimize::ProgressSeen seen;
  std::optional<optimize::RunForecast::Range> left;
};

/// How many times too much or too little was told; 1 within what was told as a range.
double factor_of(const optimize::RunForecast::Range& told, double left_s) {
  const double tiny = 1e-3;
  const auto apart = [&](double a, double b) { return std::max(a, tiny) / std::max(b, tiny); };
  if (told.is_one())
    return std::max(apart(told.middle_s(), left_s), apart(left_s, told.middle_s()));
  return std::max({1.0, apart(told.least_s, left_s), apart(left_s, told.most_s)});
}

/// What ran, from one phase to the next.
void print_phases(const std::vector<TimedLook>& looks) {
  for (std::size_t k = 0, begin = 0; k < looks.size(); ++k) {
    const optimize::ProgressSeen& seen = looks[k].seen;
    if (k + 1 < looks.size() && looks[k + 1].seen.phase == seen.phase &&
        looks[k + 1].seen.stage == seen.stage && looks[k + 1].seen.searches == seen.searches) {
      continue;
    }
    fmt::print(
        "    {:7.2f} to {:7.2f} s: stage {} search {} ({}/{}) phase {}: {}/{}; {} sets, {} open, "
        "{} "
        "first stages, empty {} and {}\n",
        looks[begin].at_s, looks[k].at_s, static_cast<int>(seen.stage), seen.searches,
        seen.stage_done, seen.stage_total, static_cast<int>(seen.phase), seen.done, seen.total,
        seen.sets, seen.open, seen.first_stages, seen.empty_first, seen.empty_second);
    begin = k + 1;
  }
}

struct TimedPrint {
  bool looks = false, phases = false;
};

void time_task(const TimedTask& timed, const TimedPrint& print) {
  app::OptimizeTask task =
      app::optimize_task({.spec = io::parse_specification(text_with_lines(timed), timed.file,
                                                          optimize::kMostRefinedSets),
                          .certify = timed.certify,
                          .round = timed.round});
  optimize::Progress progress;
  std::vector<TimedLook> looks;
  std::atomic<bool> ended{false};
  const double began_s = benchmarks::process_cpu_s();
  std::thread watcher([&] {
    optimize::RunForecast forecast;
    while (!ended) {
      const double now_s = benchmarks::process_cpu_s() - began_s;
      const optimize::ProgressSeen seen = optimize::seen_of(progress);
      forecast.observe(now_s, seen);
      looks.push_back({.at_s = now_s, .seen = seen, .left = forecast.range_left()});
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  app::optimize(task, {}, progress);
  const double whole_s = benchmarks::process_cpu_s() - began_s;
  ended = true;
  watcher.join();
  if (print.phases) print_phases(looks);
  int right = 0, middle = 0, ranges = 0, unknown = 0, judged = 0;
  double worst = 1.0, worst_at = 0.0;
  // Looks that are even in CPU time, whatever else the machine did.
  std::size_t next = 0;
  for (double share = 0.1; share < 0.95; share += 0.0025) {
    while (next + 1 < looks.size() && looks[next + 1].at_s <= share * whole_s) ++next;
    const TimedLook& look = looks[next];
    ++judged;
    if (!look.left) {
      ++unknown;
      continue;
    }
    const double factor = factor_of(*look.left, whole_s - look.at_s);
    const double allowed = look.left->is_one() ? 2.0 : 1.0 + 1e-9;
    right += factor <= allowed ? 1 : 0;
    ranges += look.left->is_one() ? 0 : 1;
    const double left_s = whole_s - look.at_s;
    const double middle_s = std::sqrt(look.left->least_s * look.left->most_s);
    middle += middle_s <= 2.0 * left_s && left_s <= 2.0 * middle_s ? 1 : 0;
    if (factor > worst) worst = factor, worst_at = share;
    if (print.looks && judged % 10 == 1) {
      fmt::print("    at {:6.2f} s: {:.2f} to {:.2f} s, left {:.2f} s; stage {} phase {} {}/{}\n",
                 look.at_s, look.left->least_s, look.left->most_s, whole_s - look.at_s,
                 static_cast<int>(look.seen.stage), static_cast<int>(look.seen.phase),
                 look.seen.done, look.seen.total);
    }
  }
  const auto percent = [&](int count) { return 100.0 * count / judged; };
  fmt::print(
      "  {:<42} {:7.1f} s {:5.0f} % right, {:3.0f} % middle, {:3.0f} % ranges, {:3.0f} % unknown, "
      "worst {:.1f} at {:.0f} %\n",
      timed.name, whole_s, percent(right), percent(middle), percent(ranges), percent(unknown),
      worst, 100.0 * worst_at);
}

}  // namespace

PROGRAM(time_left)(int argc, char** argv) {
  omp_set_num_threads(1);
  TimedPrint print;
  std::vector<TimedTask> chosen;
  for (int i = 1; i < argc; ++i) {
    const auto number = static_cast<std::size_t>(std::atoi(argv[i]));
    if (number >= 1 && number <= kTimedTasks.size()) chosen.push_back(kTimedTasks[number - 1]);
    print.looks = print.looks || std::string_view(argv[i]) == "--looks";
    print.phases = print.phases || std::string_view(argv[i]) == "--phases";
  }
  for (const TimedTask& task : chosen.empty() ? kTimedTasks : chosen) time_task(task, print);
  return 0;
}
