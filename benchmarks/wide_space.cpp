// The wide space of tooth sets (examples/wide-96.toml): rates, share that best-only refines,
// soundness of the bounds, speed-up by threads, time per set as the space grows.
//
//   wide_space [--quick]     about 8 minutes on two cores; quick (2 minutes): every 20th set from
//   all starts, no phased planets

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <vector>

#include "benchmarks/program.hpp"
#include "io/files/specification_file.hpp"
#include "numerics/parallel.hpp"
#include "optimize/optimizer.hpp"

namespace {

using namespace gear3k;            // NOLINT(google-build-using-namespace): a program
using namespace gear3k::optimize;  // NOLINT(google-build-using-namespace)

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Specification wide_space() {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/wide-96.toml");
}

struct Run {
  OptimizeResult result;
  double seconds = 0.0;

  [[nodiscard]] double sets() const { return static_cast<double>(result.search.candidates.size()); }
};
Run run(const Specification& spec, bool best_only) {
  Progress progress;
  const Stopwatch stopwatch;
  Run run{.result = optimize::optimize(spec, progress, {.best_only = best_only}), .seconds = 0.0};
  run.seconds = stopwatch.seconds();
  return run;
}

void print_run(const char* what, const Run& r) {
  fmt::print("  {:<52} {:8.2f} s {:9.0f} sets/s, {} refined ({:.2f} %)\n", what, r.seconds,
             r.sets() / r.seconds, r.result.refined.size(),
             100.0 * static_cast<double>(r.result.refined.size()) / r.sets());
}

/// Optima above their bounds, of the sets that were refined.
std::size_t above_bound(const Specification& spec, const OptimizeResult& result) {
  return static_cast<std::size_t>(std::ranges::count_if(result.refined, [&](const RefinedSet& s) {
    return s.status == Status::kOptimal &&
           merit_of(spec, s) > merit_bound(spec, result.bounds->of(s.index), s.candidate);
  }));
}

/// Every `step`-th set refined from all starts of the specification, without regard to its bound.
void compare_with_all_starts(const Specification& spec, const OptimizeResult& result,
                             std::size_t step) {
  const Refiner refiner(spec);
  const std::size_t count = result.search.candidates.size() / step;
  std::vector<double> difference(count, std::nan(""));
  std::vector<char> overlooked(count, 0);
  const optimize::StopFlag never;
  const Stopwatch stopwatch;
  numerics::parallel_for(count, [&](std::size_t i) {
    const std::size_t k = i * step;
    const bool infeasible = result.bounds->of(k).infeasible.has_value();
    const std::array unbound{ModuleBound{}};  // no start is spared, nor led by the bound
    const Candidate& candidate = result.search.candidates[k];
    const ShiftRanges shifts = result.bounds->shifts().of(candidate.teeth);
    if (std::ranges::any_of(shifts, [](const ShiftRange& s) { return s.infeasible.has_value(); })) {
      return;
    }
    const auto all = refiner.refine(candidate, shifts, unbound, never);
    const auto ours = set_at(result, k);
    const bool found = all && all->status == Status::kOptimal;
    if (infeasible) {
      overlooked[i] = found ? 1 : 0;
    } else if (found) {
      difference[i] = ours->status == Status::kOptimal ? all->eta_b - ours->eta_b : 1.0;
    }
  });
  std::erase_if(difference, [](double d) { return std::isnan(d); });
  const auto worse = std::ranges::count_if(difference, [](double d) { return d > 1e-5; });
  fmt::print(
      "  every {}{} set from {} starts, none led by its bound ({:.1f} s):\n"
      "    feasible {}, of these within 1e-5 of it or better {:.3f} %, worst shortfall {:.1e}\n"
      "    proven infeasible and yet feasible: {}\n",
      step, step == 1 ? "st" : "th", spec.solver.starts, stopwatch.seconds(), difference.size(),
      100.0 * (1.0 - static_cast<double>(worse) / static_cast<double>(difference.size())),
      difference.empty() ? 0.0 : std::max(0.0, *std::ranges::max_element(difference)),
      std::ranges::count(overlooked, 1));
}

/// One thread and all of them in turn, three times; the medians' ratio.
void print_speed_up(const Specification& spec, int threads) {
  std::array<std::vector<double>, 2> seconds;
  for (int repetition = 0; repetition < 3; ++repetition) {
    for (const bool single : {false, true}) {
      omp_set_num_threads(single ? 1 : threads);
      seconds[single ? 1 : 0].push_back(run(spec, false).seconds);
    }
  }
  omp_set_num_threads(threads);
  for (auto& times : seconds) std::ranges::sort(times);
  fmt::print("  every set refined, medians of 3: {:.2f} s on {} threads, {:.2f} s on one: {:.2f}\n",
             seconds[0][1], threads, seconds[1][1], seconds[1][1] / seconds[0][1]);
}

/// The same task over ever wider bands of the ratio: spaces of like make-up and growing size.
void time_per_set(Specification spec) {
  fmt::print(
      "\nTime per set as the space grows by its ratio's band, every set bounded and refined\n");
  spec.limits[design::CheckId::kIdenticalPlanets] = std::nullopt;
  const double widest = spec.ratio.tolerance;
  for (const double share : {0.001, 0.01, 0.1, 1.0}) {
    spec.ratio.tolerance = share * widest;
    const Run r = run(spec, false);
    fmt::print("  {:8.0f} sets {:8.3f} s {:8.1f} us/set ({} refined)\n", r.sets(), r.seconds,
               1e6 * r.seconds / r.sets(), r.result.refined.size());
  }
}

}  // namespace

PROGRAM(wide_space)(int argc, char** argv) {
  const std::string_view part = argc > 1 ? argv[1] : "";
  const bool quick = part == "--quick";
  const Specification spec = wide_space();
  const int threads = omp_get_max_threads();
  fmt::print("examples/wide-96.toml on {} threads\n", threads);
  if (part == "--sizes") {
    time_per_set(spec);
    return 0;
  }
  const Run all = run(spec, false);
  print_run("every set refined", all);
  const Run best = run(spec, true);
  print_run("best only (--certify)", best);
  const RefinedSet& a = *all.result.best;
  const RefinedSet& b = *best.result.best;
  const bool same = a.candidate == b.candidate && a.eta_b == b.eta_b &&
                    a.train.profile_shift == b.train.profile_shift;
  fmt::print("  {:.0f} tooth sets; both find the same design: {}; best-only {:.1f} times as fast\n",
             all.sets(), same ? "yes" : "NO", all.seconds / best.seconds);
  fmt::print("  optima above their bounds: {} of {}\n", above_bound(spec, all.result),
             all.result.refined.size());
  compare_with_all_starts(spec, all.result, quick ? 20 : 1);
  if (threads > 1) print_speed_up(spec, threads);
  if (!quick) time_per_set(spec);
  return same ? 0 : 1;
}
