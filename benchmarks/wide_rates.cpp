// How often `diagnose` is right on campaigns of the wide rig, whose laws, noise and plans are not
// those of the library, over many seeds and strengths.
//
//   wide_rates [SEEDS [STRENGTHS [LINE-PREFIX [answers]]]]        wide_rates 200 2,8,16 "single "
//
// LINE-PREFIX may be a group: single, special, pair, triple, null, confounded, unknown.  A line of
// the table per line of the rig and strength, then one per group and strength.  Percent of
// campaigns, with 95 % intervals of the rates of right answers.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/share.hpp"
#include "numerics/parallel.hpp"
#include "tests/calibrate/wide_scoring.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace
using wide_rig::Score;

struct Sum {
  int count = 0, right = 0, wrong = 0, remainder = 0, disclosed = 0, excluded = 0, unseen = 0,
      worse = 0, intervals = 0, inside = 0, failed = 0;
  double seconds = 0.0;

  void add(const Score& s) {
    ++count;
    right += s.right ? 1 : 0;
    wrong += s.wrong_name ? 1 : 0;
    remainder += s.false_remainder ? 1 : 0;
    disclosed += s.disclosed ? 1 : 0;
    excluded += s.lists_excluded ? 1 : 0;
    intervals += s.intervals;
    inside += s.inside;
    if (std::isfinite(s.unseen) && std::isfinite(s.unseen_refit)) {
      constexpr double kWorse = 1.05;
      ++unseen;
      worse += s.unseen > kWorse * s.unseen_refit ? 1 : 0;
    }
  }
  void print(const std::string& name) const {
    const auto percent = [](int hits, int of) {
      return of == 0 ? std::string("    -") : fmt::format("{:5.1f}", 100.0 * hits / of);
    };
    fmt::print("{:<58} {} {} {} {} {} {} {} {:5.0f}{}\n", name, benchmarks::share(right, count),
               percent(wrong, count), percent(remainder, count), percent(disclosed, count),
               percent(excluded, count), percent(worse, unseen), percent(inside, intervals),
               1e3 * seconds / std::max(count, 1),
               failed > 0 ? fmt::format("  {} failed", failed) : "");
    std::fflush(stdout);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 200;
  std::vector<double> strengths;
  std::istringstream list(argc > 2 ? argv[2] : "1,2,4,8,16");
  for (std::string one; std::getline(list, one, ',');) strengths.push_back(std::atof(one.c_str()));
  const std::string prefix = argc > 3 ? argv[3] : "";
  const bool answers = argc > 4;
  fmt::print(
      "{} seeds a line; percent, right with its 95 % interval\n{:<58} {:>19} {:>5} {:>5} "
      "{:>5} {:>5} {:>5} {:>5} {:>5}\n",
      seeds, "line, strength in noise", "right", "wrong", "rem.", "discl", "excl.", "worse",
      "in CI", "ms");
  std::map<std::string, Sum> groups;
  for (const wide_rig::Line& line : wide_rig::lines()) {
    if (!line.name.starts_with(prefix) && line.group != prefix) continue;
    for (const double strength : strengths) {
      std::vector<Score> scores(static_cast<std::size_t>(seeds));
      std::vector<std::string> errors(scores.size());
      std::vector<double> seconds(scores.size());
      numerics::parallel_for(scores.size(), [&](std::size_t k) {
        try {
          const auto campaign = wide_rig::make_campaign(line, strength, k + 1);
          const auto start = std::chrono::steady_clock::now();
          scores[k] = wide_rig::score(campaign);
          seconds[k] =
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        } catch (const std::exception& error) {
          errors[k] = error.what();
        }
      });
      Sum sum;
      Sum& group = groups[fmt::format("all {} at {}", line.group, strength)];
      for (std::size_t k = 0; k < scores.size(); ++k) {
        for (Sum* s : {&sum, &group}) {
          if (errors[k].empty()) {
            s->add(scores[k]);
            s->seconds += seconds[k];
          } else {
            ++s->failed;
          }
        }
        if (!errors[k].empty()) fmt::print("  seed {}: {}\n", k + 1, errors[k]);
      }
      sum.print(fmt::format("{} at {}", line.name, strength));
      for (std::size_t k = 0; answers && k < scores.size(); ++k) {
        fmt::print("    {:>3} {} {}\n", k + 1, scores[k].right ? "right" : "     ",
                   scores[k].answer);
      }
      if (line.group == "null") break;
    }
  }
  fmt::print("\n");
  for (const auto& [name, sum] : groups) sum.print(name);
}
