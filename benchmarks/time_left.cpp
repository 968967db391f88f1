// The time left that `optimize` tells against what was left, in CPU time of one thread.
//
//     time_left [--looks] [--phases] [--record FOLDER | --replay FOLDER] [--fresh] [TASK...]
//
// All tasks by default, some minutes; else those of the numbers, of --fresh those of other
// kinds.  --looks prints what was told, --phases what ran.  --record writes what progress
// showed into files of a folder, from which --replay tells the time left again without the runs.
//
// A look counts as right where what is left lies within the range told, whose ends are a factor of
// four apart, within a factor of two of the one number where that is told, or below the most that
// is told by a factor of four at most; "middle" is the share whose geometric middle of the range is
// within a factor of two.

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
  int threads = 1;
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

// Of other kinds; no number was chosen by those from the eleventh on.
const std::vector<TimedTask> kFreshTasks{
    {.name = "70:1 of the paper's losses",
     .file = "examples/rp96.toml",
     .lines = {{"target =", "target = 70.0"}}},
    {.name = "printed 38:1 of 3 or 4 planets, certified and rounded",
     .file = "examples/jobs/printed_30.toml",
     .lines = {{"target =", "target = 38.0"}, {"planets =", "planets = [3, 4]"}},
     .certify = true,
     .round = true},
    {.name = "a wrist of -80:1 of 3 or 4 planets, certified",
     .file = "examples/jobs/wrist_150.toml",
     .lines = {{"target =", "target = -80.0"}, {"planets =", "planets = [3, 4]"}},
     .certify = true},
    {.name = "80:1 for built gearboxes, worst case",
     .file = "examples/ratio-96-robust.toml",
     .lines = {{"target =", "target = 80.0"},
               {"hold =", "hold = \"worst_case\""},
               {"yield =", ""}}},
    {.name = "80:1 in the same envelope, modules of lists",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 80.0"},
               {"stage1_mm =", "stage1_mm = { series = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0] }"},
               {"stage2_mm =", "stage2_mm = { series = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0] }"}}},
    {.name = "printed 60:1 of 3 planets, front of efficiency and diameter",
     .file = "examples/jobs/printed_30.toml",
     .lines = {{"target =", "target = 60.0"},
               {"planets =", "planets = 3"},
               {"objective =", "objective = [\"backward_efficiency\", \"outer_diameter\"]"}}},
    {.name = "50:1 of the whole space, certified, 2 threads",
     .file = "examples/ratio-96-wide.toml",
     .lines = {{"target =", "target = 50.0"}},
     .certify = true,
     .threads = 2},
    {.name = "POM, any face width", .file = "examples/ratio-96-pom.toml"},
    {.name = "the paper's figures, certified",
     .file = "examples/paper-figures.toml",
     .certify = true},
    {.name = "75:1 within 40 mm, without a design",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 75.0"},
               {"max_ring_root_diameter_mm", "max_ring_root_diameter_mm = 40.0"}}},
    {.name = "130:1 of the paper's figures",
     .file = "examples/paper-figures.toml",
     .lines = {{"target =", "target = 130.0"}}},
    {.name = "printed 25:1 of finer modules, certified",
     .file = "examples/jobs/printed_30.toml",
     .lines = {{"target =", "target = 25.0"},
               {"planets =", "planets = [3, 4, 5]"},
               {"stage1_mm =", "stage1_mm = { series = [0.4, 0.5, 0.6, 0.8] }"},
               {"stage2_mm =", "stage2_mm = { series = [0.4, 0.5, 0.6, 0.8] }"}},
     .certify = true},
    {.name = "a wrist of -200:1, all sets",
     .file = "examples/jobs/wrist_150.toml",
     .lines = {{"target =", "target = -200.0"}}},
    {.name = "110:1 for built gearboxes, worst case",
     .file = "examples/ratio-96-robust.toml",
     .lines = {{"target =", "target = 110.0"},
               {"hold =", "hold = \"worst_case\""},
               {"yield =", ""}}},
    {.name = "45:1 in the same envelope, modules of lists, certified",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 45.0"},
               {"stage1_mm =", "stage1_mm = { series = [0.5, 0.6, 0.8, 1.0] }"},
               {"stage2_mm =", "stage2_mm = { series = [0.5, 0.6, 0.8, 1.0] }"}},
     .certify = true},
    {.name = "a wrist of -120:1, front of efficiency and diameter",
     .file = "examples/jobs/wrist_150.toml",
     .lines = {{"target =", "target = -120.0"},
               {"objective =", "objective = [\"backward_efficiency\", \"outer_diameter\"]"}}},
    {.name = "60:1 of the wide space by the paper's losses, certified, 2 threads",
     .file = "examples/wide-96.toml",
     .lines = {{"target =", "target = 60.0"}},
     .certify = true,
     .threads = 2},
    {.name = "POM at 70:1, certified",
     .file = "examples/ratio-96-pom.toml",
     .lines = {{"target =", "target = 70.0"}},
     .certify = true},
    {.name = "120:1 in the same envelope, front of efficiency and lost motion",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 120.0"},
               {"objective =", "objective = [\"backward_efficiency\", \"lost_motion\"]"}}},
    {.name = "printed 50:1 of 4 planets, all sets",
     .file = "examples/jobs/printed_30.toml",
     .lines = {{"target =", "target = 50.0"}, {"planets =", "planets = 4"}}},
    {.name = "printed 40:1, forward efficiency, certified",
     .file = "examples/jobs/printed_30.toml",
     .lines = {{"target =", "target = 40.0"},
               {"objective =", "objective = \"forward_efficiency\""}},
     .certify = true},
    {.name = "75:1 of the whole space, certified",
     .file = "examples/ratio-96-wide.toml",
     .lines = {{"target =", "target = 75.0"}},
     .certify = true},
    {.name = "a wrist of 100:1 of 3 to 5 planets, certified and rounded",
     .file = "examples/jobs/wrist_150.toml",
     .lines = {{"target =", "target = 100.0"}, {"planets =", "planets = [3, 4, 5]"}},
     .certify = true,
     .round = true},
    {.name = "110:1 in the same envelope, modules of lists, 2 threads",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 110.0"},
               {"stage1_mm =", "stage1_mm = { series = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0] }"},
               {"stage2_mm =", "stage2_mm = { series = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0] }"}},
     .threads = 2},
    {.name = "80:1 in the same envelope, front of forward efficiency and diameter",
     .file = "examples/jobs/same_envelope_96.toml",
     .lines = {{"target =", "target = 80.0"},
               {"objective =", "objective = [\"forward_efficiency\", \"outer_diameter\"]"}}},
    {.name = "85:1 for built gearboxes",
     .file = "examples/ratio-96-robust.toml",
     .lines = {{"target =", "target = 85.0"}}}};

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

/// Ends of a range that are farther apart say little: at most so much is told as such a range.
constexpr double kUseful = 4.0;

/// How many times too much or too little was told; 1 within what was told as a range.
double factor_of(const optimize::RunForecast::Range& told, double left_s) {
  const double tiny = 1e-3;
  const auto apart = [&](double a, double b) { return std::max(a, tiny) / std::max(b, tiny); };
  if (told.is_one())
    return std::max(apart(told.middle_s(), left_s), apart(left_s, told.middle_s()));
  const double least_s = told.is_bound() ? told.most_s / kUseful : told.least_s;
  return std::max({1.0, apart(least_s, left_s), apart(left_s, told.most_s)});
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
        "first stages, empty {} and {}; {} bounds, later {} sets and {} bounds\n",
        looks[begin].at_s, looks[k].at_s, static_cast<int>(seen.stage), seen.searches,
        seen.stage_done, seen.stage_total, static_cast<int>(seen.phase), seen.done, seen.total,
        seen.sets, seen.open, seen.first_stages, seen.empty_first, seen.empty_second,
        seen.to_sharpen, seen.later_sets, seen.later_bounds);
    begin = k + 1;
  }
}

struct TimedPrint {
  bool looks = false, phases = false;
  std::string record, replay;
};

/// The numbers of what progress showed, each as one to read or write.
template <class Seen, class Visit>
void visit_numbers(Seen& seen, const Visit& visit) {
  auto& plan = seen.plan;
  visit(seen.phase), visit(seen.stage);
  visit(plan.front_objectives), visit(plan.front_designs), visit(plan.front_lost_motion);
  visit(plan.rounding), visit(plan.best_only), visit(plan.planets), visit(plan.told),
      visit(plan.explains);
  visit(plan.passes_least), visit(plan.passes_most);
  visit(plan.built_per_pass), visit(plan.built_after);
  visit(seen.done), visit(seen.total), visit(seen.stage_done), visit(seen.stage_total);
  visit(seen.searches), visit(seen.sets), visit(seen.first_stages), visit(seen.second_stages);
  visit(seen.empty_first);
  visit(seen.empty_second), visit(seen.to_sharpen), visit(seen.later_sets);
  visit(seen.later_bounds), visit(seen.open), visit(seen.feasible), visit(plan.ties);
}

void write_looks(const std::string& path, const std::vector<TimedLook>& looks, double whole_s) {
  std::ofstream file(path);
  file << fmt::format("{:.6f}\n", whole_s);
  for (const TimedLook& look : looks) {
    file << fmt::format("{:.6f}", look.at_s);
    visit_numbers(look.seen, [&](auto number) { file << ' ' << static_cast<std::size_t>(number); });
    file << '\n';
  }
}

double read_looks(const std::string& path, std::vector<TimedLook>& looks) {
  std::ifstream file(path);
  double whole_s = 0.0;
  file >> whole_s;
  for (TimedLook look; file >> look.at_s; looks.push_back(look)) {
    visit_numbers(look.seen, [&]<class Number>(Number& number) {
      std::size_t read = 0;
      file >> read;
      number = static_cast<Number>(read);
    });
  }
  return whole_s;
}

/// Time of the task's clock: of CPU, whatever else the machine does, where one thread runs.
double task_clock_s(const TimedTask& timed) {
  if (timed.threads == 1) return benchmarks::process_cpu_s();
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Runs a task with somebody looking; the time that it took.
double look_at(const TimedTask& timed, std::vector<TimedLook>& looks) {
  omp_set_num_threads(timed.threads);
  app::OptimizeTask task =
      app::optimize_task({.spec = io::parse_specification(text_with_lines(timed), timed.file,
                                                          optimize::kMostRefinedSets),
                          .certify = timed.certify,
                          .round = timed.round});
  optimize::Progress progress;
  std::atomic<bool> ended{false};
  const double began_s = task_clock_s(timed);
  std::thread watcher([&] {
    while (!ended) {
      looks.push_back(
          {.at_s = task_clock_s(timed) - began_s, .seen = optimize::seen_of(progress), .left = {}});
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  app::optimize(task, {}, progress);
  const double whole_s = task_clock_s(timed) - began_s;
  ended = true;
  watcher.join();
  return whole_s;
}

void time_task(const TimedTask& timed, const std::string& file, const TimedPrint& print) {
  std::vector<TimedLook> looks;
  const double whole_s =
      print.replay.empty() ? look_at(timed, looks) : read_looks(print.replay + "/" + file, looks);
  if (looks.empty()) return;
  if (!print.record.empty()) write_looks(print.record + "/" + file, looks, whole_s);
  optimize::RunForecast forecast;
  for (TimedLook& look : looks) {
    forecast.observe(look.at_s, look.seen);
    look.left = forecast.range_left();
  }
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
  TimedPrint print;
  std::vector<std::size_t> numbers;
  bool fresh = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const auto number = static_cast<std::size_t>(std::max(0, std::atoi(argv[i])));
    if (number >= 1) numbers.push_back(number);
    fresh = fresh || word == "--fresh";
    print.looks = print.looks || word == "--looks";
    print.phases = print.phases || word == "--phases";
    if (word == "--record" && i + 1 < argc) print.record = argv[++i];
    if (word == "--replay" && i + 1 < argc) print.replay = argv[++i];
  }
  const std::vector<TimedTask>& tasks = fresh ? kFreshTasks : kTimedTasks;
  for (std::size_t k = 1; k <= tasks.size(); ++k) {
    if (!numbers.empty() && std::ranges::find(numbers, k) == numbers.end()) continue;
    time_task(tasks[k - 1], fmt::format("{}{}.looks", fresh ? "fresh" : "task", k), print);
  }
  return 0;
}
