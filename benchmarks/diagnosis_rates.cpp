// How often `diagnose` is right: campaigns of the rig with hidden causes, over many seeds.
//
//   diagnosis_rates [SEEDS [SCENARIO-PREFIX]]
//
// "may be": the mean number of causes that an effect found may be, the named one and its
// alternatives.  With a prefix ("alone 0.3", "resolved") the most frequent answers are listed too.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/program.hpp"
#include "benchmarks/share.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "numerics/parallel.hpp"
#include "tests/calibrate/diagnosis_scoring.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace

/// @param answers_too  with the three most frequent answers
void print(const rig::Scenario& scenario, int seeds, bool answers_too) {
  std::vector<rig::Score> scores(static_cast<std::size_t>(seeds));
  const auto start = std::chrono::steady_clock::now();
  numerics::parallel_for(scores.size(), [&](std::size_t seed) {
    scores[seed] = rig::score(scenario, static_cast<std::uint64_t>(seed) + 1);
  });
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto count = [&](bool rig::Score::*what) {
    return static_cast<int>(std::ranges::count_if(scores, [&](const auto& s) { return s.*what; }));
  };
  const int intervals = count(&rig::Score::has_interval);
  std::map<std::string, int> answers;
  for (const rig::Score& s : scores) ++answers[s.answer];
  std::vector<std::pair<int, std::string>> common;
  common.reserve(answers.size());
  for (const auto& [answer, times] : answers) common.emplace_back(times, answer);
  std::ranges::sort(common, std::greater<>());
  std::string text;
  for (std::size_t k = 0; answers_too && k < common.size() && k < 3; ++k) {
    text += fmt::format(" {}x {};", common[k].first, common[k].second);
  }
  double explanations = 0.0;
  int named = 0;
  for (const rig::Score& s : scores) {
    explanations += s.explanations;
    named += s.explanations > 0.0 ? 1 : 0;
  }
  fmt::print("{:<46} {} {} {} {:>6} {:5.0f}{}\n", scenario.name,
             benchmarks::share(count(&rig::Score::right), seeds),
             benchmarks::share(count(&rig::Score::wrong), seeds),
             benchmarks::share(count(&rig::Score::inside), intervals),
             named == 0 ? "-" : fmt::format("{:.1f}", explanations / named), 1e3 * seconds / seeds,
             text);
  std::fflush(stdout);
}

}  // namespace

PROGRAM(diagnosis_rates)(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 200;
  const std::string_view prefix = argc > 2 ? argv[2] : "";
  fmt::print("{} seeds; percent with 95 % intervals\n{:<46} {:>19} {:>19} {:>19} {:>6} {:>5}{}\n",
             seeds, "scenario", "right", "wrong name", "truth in interval", "may be", "ms",
             prefix.empty() ? "" : "  most frequent answers");
  for (const rig::Scenario& scenario : rig::scenarios()) {
    if (scenario.name.starts_with(prefix)) print(scenario, seeds, !prefix.empty());
  }
  return 0;
}
