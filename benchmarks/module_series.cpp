// A search whose modules are chosen from lists in both stages, beside a range of the same ends, and
// beside one search for every pair of modules, which says the same.
//
//   module_series     about two minutes of one core
//
// Times are CPU time of the process: on two cores a run takes about half of it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
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

/// Pairs of modules that bounds leave of each tooth set, in the mean.
double pairs_left(const TimedSearch& run) {
  std::size_t pairs = 0;
  for (std::size_t k = 0; k < run.result.search.candidates.size(); ++k) {
    if (!run.result.bounds->of(k).infeasible) pairs += run.result.bounds->by_modules(k).size();
  }
  return static_cast<double>(pairs) / static_cast<double>(run.result.search.candidates.size());
}

/// The printed 30:1 with four modules in each stage, by one thread.
void print_printed(const char* what, const Specification& spec, bool with_all) {
  fmt::print("printed 30:1, {}\n", what);
  const auto line = [](const char* of, const TimedSearch& run) {
    fmt::print("  {:<12} {:6.2f} s of CPU, {:6} of {} sets refined, best {:.6f}\n", of, run.seconds,
               run.result.refined.size(), run.result.search.candidates.size(),
               run.result.best ? run.result.best->eta_b : 0.0);
  };
  line("certified", timed_search(spec, true));
  if (with_all) {
    const TimedSearch all = timed_search(spec, false);
    line("all sets", all);
    fmt::print("  {:.2f} pairs of modules left of each set that is refined\n",
               pairs_left(all) * static_cast<double>(all.result.search.candidates.size()) /
                   static_cast<double>(all.result.refined.size()));
  }
  std::fflush(stdout);
}

void print_search(const char* what, const TimedSearch& run) {
  fmt::print("  {:<32} {:8.2f} s of CPU, {:5} sets refined, best {:.6f}\n", what, run.seconds,
             run.result.refined.size(), run.result.best ? run.result.best->eta_b : 0.0);
}

}  // namespace

PROGRAM(module_series)(int, char**) {
  Specification printed =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/jobs/printed_30.toml");
  print_printed("modules 0.5, 0.6, 0.8, 1.0 mm in both stages", printed, true);
  printed.shift_step = 0.05;
  print_printed("and shifts by 0.05", printed, false);
  printed.shift_step.reset();
  for (const std::size_t ring : {train::kR1, train::kR2}) {
    printed.cutter[ring] = {.teeth = 20, .profile_shift = 0.0, .tip_radius = 0.2};
    printed.cutter_teeth[ring] = {20, 25, 34};
  }
  print_printed("and three cutters for each ring", printed, false);

  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
  const std::vector<double> modules{0.5e-3, 0.6e-3, 0.8e-3, 1.0e-3};
  const TimedSearch range = timed_search(spec, false);
  for (ModuleChoice& choice : spec.module) choice = {.range_m = std::nullopt, .series_m = modules};
  const TimedSearch series = timed_search(spec, false);
  const TimedSearch certified = timed_search(spec, true);

  Specification grid = spec;
  grid.shift_step = 0.05;
  const TimedSearch on_grid = timed_search(grid, false);
  const TimedSearch grid_certified = timed_search(grid, true);
  Specification tools = spec;
  for (const std::size_t ring : {train::kR1, train::kR2}) {
    tools.cutter[ring] = {.teeth = 20, .profile_shift = 0.0, .tip_radius = 0.2};
  }
  const TimedSearch one_cutter = timed_search(tools, false);
  for (const std::size_t ring : {train::kR1, train::kR2}) tools.cutter_teeth[ring] = {20, 25, 34};
  const TimedSearch cutters = timed_search(tools, false);

  double seconds = 0.0, difference = 0.0;
  std::vector<double> best(series.result.search.candidates.size(), 0.0);
  for (const double m1 : modules) {
    for (const double m2 : modules) {
      Specification pair = spec;
      pair.module[0].series_m = {m1};
      pair.module[1].series_m = {m2};
      const TimedSearch one = timed_search(pair, false);
      seconds += one.seconds;
      for (const RefinedSet& set : one.result.refined) {
        if (set.status == Status::kOptimal) {
          best[set.index] = std::max(best[set.index], set.eta_b);
        }
      }
    }
  }
  for (std::size_t k = 0; k < best.size(); ++k) {
    const auto set = set_at(series.result, k);
    const double own = set && set->status == Status::kOptimal ? set->eta_b : 0.0;
    difference = std::max(difference, std::abs(own - best[k]));
  }

  fmt::print("ratio-96 with modules 0.5, 0.6, 0.8, 1.0 mm in both stages ({} tooth sets)\n",
             best.size());
  print_search("range 0.5 to 1.0 mm", range);
  print_search("lists", series);
  print_search("lists, certified", certified);
  print_search("lists, shifts by 0.05", on_grid);
  print_search("lists, shifts by 0.05, certified", grid_certified);
  fmt::print("    {:.2f} and {:.2f} times the range\n", on_grid.seconds / range.seconds,
             grid_certified.seconds / range.seconds);
  print_search("lists, a cutter in each ring", one_cutter);
  print_search("lists, three cutters for each", cutters);
  fmt::print("    {:.2f} times one cutter\n", cutters.seconds / one_cutter.seconds);
  fmt::print("  one search for each of 16 pairs  {:8.2f} s, {:.1f} times the lists'\n", seconds,
             seconds / series.seconds);
  fmt::print("  greatest difference of a set's eta_b between the lists and the pairs: {:.1e}\n",
             difference);
  return 0;
}
