// A search whose modules are chosen from lists in both stages, beside a range of the same ends, and
// beside one search for every pair of modules, which says the same.
//
//     module_series [printed] [grid] [cutters] [pairs]     all of them by default: two minutes
//
// Times are CPU time of the process: on two cores a run takes about half of it.  Of each set that
// is refined: how many problems are refined from several starts (of the 16 pairs of modules), and
// how many boxes of its grid of shifts are relaxed from one start.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/cpu_time.hpp"
#include "benchmarks/program.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"

namespace {

using namespace gear3k;            // NOLINT(google-build-using-namespace): a program
using namespace gear3k::optimize;  // NOLINT(google-build-using-namespace)

struct TimedSearch {
  OptimizeResult result;
  double seconds = 0.0;
};
TimedSearch timed_search(const Specification& spec, bool best_only) {
  Progress progress;
  const double start_s = benchmarks::process_cpu_s();
  TimedSearch run{.result = optimize::optimize(spec, progress, {.best_only = best_only})};
  run.seconds = benchmarks::process_cpu_s() - start_s;
  return run;
}

/// Refinements and relaxations of each set that was refined, in the mean.
std::string counts_of(const TimedSearch& run) {
  std::size_t refinements = 0, relaxations = 0;
  for (const RefinedSet& set : run.result.refined) {
    refinements += set.refinements;
    relaxations += set.relaxations;
  }
  const auto sets = static_cast<double>(std::max<std::size_t>(1, run.result.refined.size()));
  return fmt::format("{:.2f} refinements, {:.2f} relaxations a set",
                     static_cast<double>(refinements) / sets,
                     static_cast<double>(relaxations) / sets);
}

void print_search(const char* what, const TimedSearch& run) {
  fmt::print("  {:<32} {:7.2f} s of CPU, {:5} of {} sets refined, best {:.6f}, {}\n", what,
             run.seconds, run.result.refined.size(), run.result.search.candidates.size(),
             run.result.best ? run.result.best->eta_b : 0.0, counts_of(run));
  std::fflush(stdout);
}

Specification read_example(const char* name) {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/" + name);
}

void put_cutters(Specification& spec, const std::vector<int>& teeth) {
  for (const std::size_t ring : {train::kR1, train::kR2}) {
    spec.cutter[ring] = {.teeth = 20, .profile_shift = 0.0, .tip_radius = 0.2};
    spec.cutter_teeth[ring] = teeth;
  }
}

const std::vector<double> kModules{0.5e-3, 0.6e-3, 0.8e-3, 1.0e-3};
const std::vector<int> kCutters{20, 25, 34};

Specification with_lists(Specification spec) {
  for (ModuleChoice& choice : spec.module) choice = {.range_m = std::nullopt, .series_m = kModules};
  return spec;
}

/// The printed 30:1, whose file has the lists.
void print_printed() {
  fmt::print("printed 30:1 with modules 0.5, 0.6, 0.8, 1.0 mm in both stages\n");
  Specification printed = read_example("jobs/printed_30.toml");
  print_search("certified", timed_search(printed, true));
  print_search("all sets", timed_search(printed, false));
  printed.shift_step = 0.05;
  print_search("shifts by 0.05, certified", timed_search(printed, true));
  printed.shift_step.reset();
  put_cutters(printed, kCutters);
  print_search("three cutters each, certified", timed_search(printed, true));
}

void print_grid(const Specification& range, const Specification& lists) {
  const double free_s = timed_search(range, false).seconds;
  Specification grid = lists;
  grid.shift_step = 0.05;
  const TimedSearch all = timed_search(grid, false), certified = timed_search(grid, true);
  print_search("lists, shifts by 0.05", all);
  print_search("lists, shifts by 0.05, certified", certified);
  fmt::print("    {:.2f} and {:.2f} times the range with free shifts\n", all.seconds / free_s,
             certified.seconds / free_s);
  Specification by_range = range;
  by_range.shift_step = 0.05;
  print_search("range, shifts by 0.05, certified", timed_search(by_range, true));
}

void print_cutters(const Specification& lists) {
  Specification tools = lists;
  put_cutters(tools, {});
  const TimedSearch one = timed_search(tools, false);
  put_cutters(tools, kCutters);
  const TimedSearch three = timed_search(tools, false);
  print_search("lists, a cutter in each ring", one);
  print_search("lists, three cutters for each", three);
  fmt::print("    {:.2f} times one cutter\n", three.seconds / one.seconds);
}

void print_pairs(const Specification& lists, const TimedSearch& series) {
  double seconds = 0.0, difference = 0.0;
  std::vector<double> best(series.result.search.candidates.size(), 0.0);
  for (const double m1 : kModules) {
    for (const double m2 : kModules) {
      Specification pair = lists;
      pair.module[0].series_m = {m1};
      pair.module[1].series_m = {m2};
      const TimedSearch one = timed_search(pair, false);
      seconds += one.seconds;
      for (const RefinedSet& set : one.result.refined) {
        if (set.status == Status::kOptimal) best[set.index] = std::max(best[set.index], set.eta_b);
      }
    }
  }
  for (std::size_t k = 0; k < best.size(); ++k) {
    const auto set = set_at(series.result, k);
    const double own = set && set->status == Status::kOptimal ? set->eta_b : 0.0;
    difference = std::max(difference, std::abs(own - best[k]));
  }
  fmt::print("  one search for each of 16 pairs  {:7.2f} s, {:.1f} times the lists'\n", seconds,
             seconds / series.seconds);
  fmt::print("  greatest difference of a set's eta_b between the lists and the pairs: {:.1e}\n",
             difference);
}

}  // namespace

PROGRAM(module_series)(int argc, char** argv) {
  const auto asked = [&](std::string_view part) {
    return argc < 2 || std::find(argv + 1, argv + argc, part) != argv + argc;
  };
  if (asked("printed")) print_printed();
  const Specification range = read_example("ratio-96.toml");
  const Specification lists = with_lists(range);
  fmt::print("ratio-96 with modules 0.5, 0.6, 0.8, 1.0 mm in both stages\n");
  print_search("range 0.5 to 1.0 mm", timed_search(range, false));
  const TimedSearch series = timed_search(lists, false);
  print_search("lists", series);
  print_search("lists, certified", timed_search(lists, true));
  if (asked("grid")) print_grid(range, lists);
  if (asked("cutters")) print_cutters(lists);
  if (asked("pairs")) print_pairs(lists, series);
  return 0;
}
