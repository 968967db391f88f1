// How well `diagnose` predicts conditions that it has not seen where the hidden law is none of its
// causes', and how often it proposes a law where nothing is hidden: campaigns of the wide rig.
//
//   law_rates [SEEDS [STRENGTHS [LINE-PREFIX [FIRST-SEED [answers]]]]]     law_rates 20 4 unknown
//   101
//
// LINE-PREFIX may be a group.  A prediction counts where the root mean square of what a measurement
// would miss it by, noise included, is at most 1.1 of the noise:
//
//   √(1 + rms(predicted − clean)²/noise²) <= 1.1
//
// over the rows of the campaign, each predicted without its block, and over rows at speeds, loads
// and angles that no row of the campaign has.  Percent of campaigns, with 95 % intervals.

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

#include "app/diagnose.hpp"
#include "benchmarks/program.hpp"
#include "benchmarks/share.hpp"
#include "calibrate/fit/linearisation.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "numerics/parallel.hpp"
#include "tests/app/wide_scoring.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace

/// Root mean square of predicted − clean over the noise; infinite where a row has no prediction or
/// rows were left out, NaN where there are none.
/// @param unit  SI per unit of `clean`
double error_of(const std::vector<double>& predicted, const std::vector<double>& clean, double unit,
                double noise) {
  if (clean.empty()) return std::nan("");
  if (predicted.size() != clean.size()) return HUGE_VAL;
  double sum = 0.0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    const double e = predicted[i] / unit - clean[i];
    if (!std::isfinite(e)) return HUGE_VAL;
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(clean.size())) / noise;
}

struct Result {
  bool law = false, unexplained = false;
  double held_out = 0.0, unseen = 0.0;
  double seconds = 0.0;
  std::string answer, error;
};

Result result_of(const wide_rig::Campaign& campaign) {
  const calibrate::Subject subject = wide_rig::subject_of(campaign.subject_toml);
  const app::DiagnosisTask task = wide_rig::task_of(subject, campaign.files);
  const auto start = std::chrono::steady_clock::now();
  const auto results = app::diagnose(task, {});
  Result result;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const calibrate::Diagnosis& d = results->front();
  result.law = !d.laws.empty();
  result.unexplained = d.verdict == calibrate::Verdict::kUnexplained;
  const double unit = calibrate::response_unit(d.kind).si;
  // Rows that make power are left out of the data: those that stay, by their lines.
  const calibrate::MeasurementSet& set = task.sets.front();
  const std::string& text = campaign.files.front().text;
  const auto lines = std::ranges::count(text, '\n');
  std::vector<double> held_out;
  std::vector<double> clean;
  for (std::size_t k = 0; k < set.rows.size() && !campaign.clean.empty(); ++k) {
    const auto of_last = lines - set.rows[k].line;
    held_out.push_back(d.rows[k].holdout);
    clean.push_back(campaign.clean[campaign.clean.size() - 1 - static_cast<std::size_t>(of_last)]);
  }
  result.held_out = error_of(held_out, clean, unit, campaign.noise_sd);
  const app::DiagnosisTask unseen = wide_rig::task_of(subject, campaign.unseen);
  const calibrate::MeasurementSet& rows = unseen.sets.front();
  const calibrate::Simulation simulation(subject, rows.kind, {d.model});
  const auto at = calibrate::linearise(
      {.simulation = simulation, .data = rows, .noise = calibrate::make_noise_model(rows)}, {}, {});
  std::vector<double> predicted(at.simulated.data(), at.simulated.data() + at.simulated.size());
  result.unseen =
      at.runs ? error_of(predicted, campaign.unseen_clean, unit, campaign.noise_sd) : HUGE_VAL;
  for (const auto& e : d.effects) result.answer += e.id + ":" + e.form.name + " ";
  if (d.remainder.significant) result.answer += "remainder along " + d.remainder.along + " ";
  for (const auto& law : d.laws) result.answer += law.formula;
  return result;
}

struct Sum {
  int count = 0, unexplained = 0, laws = 0, held_out = 0, unseen = 0, with_unseen = 0, failed = 0;
  int laws_held_out = 0, laws_unseen = 0;
  double seconds = 0.0;

  void add(const Result& r) {
    // One that is refused predicts nothing well.
    ++count;
    if (!r.error.empty()) {
      ++failed;
      return;
    }
    constexpr double kMost = 1.1;
    const auto good = [](double e) { return std::sqrt(1.0 + e * e) <= kMost; };
    unexplained += r.unexplained ? 1 : 0;
    laws += r.law ? 1 : 0;
    held_out += good(r.held_out) ? 1 : 0;
    unseen += good(r.unseen) ? 1 : 0;
    laws_held_out += r.law && good(r.held_out) ? 1 : 0;
    laws_unseen += r.law && good(r.unseen) ? 1 : 0;
    seconds += r.seconds;
  }
  void print(const std::string& name) const {
    fmt::print("{:<52} {} {} {} {} {} {:5.0f}{}\n", name, benchmarks::share(laws, count),
               benchmarks::share(held_out, count), benchmarks::share(unseen, count),
               benchmarks::share(laws_held_out, laws), benchmarks::share(laws_unseen, laws),
               1e3 * seconds / std::max(count, 1),
               failed > 0 ? fmt::format("  {} failed", failed) : "");
    std::fflush(stdout);
  }
};

}  // namespace

PROGRAM(law_rates)(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 20;
  std::vector<double> strengths;
  std::istringstream list(argc > 2 ? argv[2] : "4");
  for (std::string one; std::getline(list, one, ',');) strengths.push_back(std::atof(one.c_str()));
  const std::string prefix = argc > 3 ? argv[3] : "unknown";
  const int first = argc > 4 ? std::max(1, std::atoi(argv[4])) : 1;
  const bool answers = argc > 5;
  fmt::print(
      "{} seeds a line from {} on; percent with 95 % intervals\n{:<52} {:>19} {:>19} {:>19} "
      "{:>19} {:>19} {:>5}\n",
      seeds, first, "line, strength in noise", "law proposed", "held out <= 1.1", "unseen <= 1.1",
      "laws: held out", "laws: unseen", "ms");
  std::map<std::string, Sum> groups;
  for (const wide_rig::Line& line : wide_rig::lines()) {
    if (!line.name.starts_with(prefix) && line.group != prefix) continue;
    for (const double strength : strengths) {
      std::vector<Result> results(static_cast<std::size_t>(seeds));
      numerics::parallel_for(results.size(), [&](std::size_t k) {
        try {
          results[k] = result_of(
              wide_rig::make_campaign(line, strength, k + static_cast<std::size_t>(first)));
        } catch (const std::exception& error) {
          results[k].error = error.what();
        }
      });
      Sum sum;
      Sum& group = groups[fmt::format("all {} at {}", line.group, strength)];
      for (const Result& r : results) {
        sum.add(r);
        group.add(r);
      }
      sum.print(fmt::format("{} at {}", line.name, strength));
      for (std::size_t k = 0; answers && k < results.size(); ++k) {
        const Result& r = results[k];
        fmt::print("    {:>3} {:5.2f} {:5.2f} {}{}\n", static_cast<std::size_t>(first) + k,
                   r.held_out, r.unseen, r.answer, r.error);
      }
      if (line.group == "null") break;
    }
  }
  fmt::print("\n");
  for (const auto& [name, sum] : groups) sum.print(name);
  return 0;
}
