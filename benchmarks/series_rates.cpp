// How often `diagnose` is right about series of eight gearboxes: which differences are the design's
// and which the part's, and how great the part-to-part deviation is.
//
//   series_rates [SEEDS [SCENARIO-PREFIX [whole|quick [answers]]]]
//
// quick: without the diagnosis of what all gearboxes have in common, a fraction of the time.
//
// right: every difference named with its owner, nothing else.  owner: of those named.  within 20 %:
// estimated part-to-part deviation against that of the gearboxes as built.  in CI: the population's
// mean and deviation in the 95 % intervals.  Percent, with 95 % intervals.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "benchmarks/program.hpp"
#include "benchmarks/share.hpp"
#include "numerics/parallel.hpp"
#include "tests/calibrate/series_scoring.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace
using series_rig::SeriesScore;

struct SeriesSum {
  int count = 0, right = 0, truths = 0, named = 0, owner = 0, unexplained = 0, deviations = 0,
      near = 0, compared = 0, mean_inside = 0, deviation_inside = 0;
  double seconds = 0.0;
  std::vector<double> ratio = {};

  void add(const SeriesScore& s) {
    constexpr double kNear = 0.2;
    ++count;
    right += s.right ? 1 : 0;
    unexplained += s.unexplained ? 1 : 0;
    seconds += s.seconds;
    for (const auto& t : s.truths) {
      ++truths;
      named += t.named ? 1 : 0;
      owner += t.right ? 1 : 0;
      if (!t.measured) continue;
      ++compared;
      mean_inside += t.mean_inside ? 1 : 0;
      deviation_inside += t.deviation_inside ? 1 : 0;
      if (!(t.deviation > 0.0)) continue;
      ++deviations;
      near += std::abs(t.deviation - 1.0) <= kNear ? 1 : 0;
      ratio.push_back(t.deviation);
    }
  }
  void print(const std::string& name) {
    std::ranges::sort(ratio);
    const std::string median =
        ratio.empty() ? "     -" : fmt::format("{:6.3f}", ratio[ratio.size() / 2]);
    fmt::print("{:<42} {} {} {} {} {} {} {:4d} {:5.0f}\n", name, benchmarks::share(right, count),
               benchmarks::share(owner, named), median, benchmarks::share(near, deviations),
               benchmarks::share(mean_inside, compared),
               benchmarks::share(deviation_inside, compared), unexplained,
               1e3 * seconds / std::max(count, 1));
    std::fflush(stdout);
  }
};

}  // namespace

PROGRAM(series_rates)(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 100;
  const std::string prefix = argc > 2 ? argv[2] : "";
  const bool whole = argc <= 3 || std::string(argv[3]) != "quick";
  const bool answers = argc > 4;
  fmt::print(
      "{} series of 8 gearboxes a line\n{:<42} {:>19} {:>19} {:>6} {:>19} {:>19} {:>19} {:>4} "
      "{:>5}\n",
      seeds, "scenario", "right", "owner", "median", "within 20 %", "mean in CI", "deviation in CI",
      "unex", "ms");
  SeriesSum all;
  for (const series_rig::SeriesScenario& scenario : series_rig::scenarios()) {
    if (!scenario.name.starts_with(prefix)) continue;
    std::vector<SeriesScore> scores(static_cast<std::size_t>(seeds));
    std::vector<std::string> errors(scores.size());
    numerics::parallel_for(scores.size(), [&](std::size_t k) {
      try {
        scores[k] = series_rig::score(series_rig::make_series(scenario, k + 1), whole);
      } catch (const std::exception& error) {
        errors[k] = error.what();
      }
    });
    SeriesSum sum;
    for (std::size_t k = 0; k < scores.size(); ++k) {
      if (!errors[k].empty()) {
        fmt::print("  seed {}: {}\n", k + 1, errors[k]);
        continue;
      }
      sum.add(scores[k]);
      all.add(scores[k]);
    }
    sum.print(scenario.name);
    for (std::size_t k = 0; answers && k < scores.size(); ++k) {
      fmt::print("    {:>3} {} {}\n", k + 1, scores[k].right ? "right" : "     ", scores[k].answer);
    }
  }
  all.print("all");
  return 0;
}
