// How often `diagnose` is right on campaigns of the wide rig, whose laws, noise and plans are not
// those of the library, over many seeds and strengths.
//
//   wide_rates [SEEDS [STRENGTHS [LINE-PREFIX]]] [--first=SEED] [--answers] [--leave-out]
//   wide_rates 200 2,8,16 "single "
//
// LINE-PREFIX may be a group: single, special, pair, triple, null, confounded, unknown.  A line of
// the table per line of the rig and strength, then one per group and strength.  Percent of
// campaigns, with 95 % intervals of the rates of right answers.  --answers prints what was said of
// each; --leave-out tells how often the names stay when one session or tenth is left out.  At the
// end the probabilities that were stated against how often they were right.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "benchmarks/program.hpp"
#include "benchmarks/share.hpp"
#include "numerics/parallel.hpp"
#include "tests/app/wide_scoring.hpp"

namespace {

using namespace gear3k;  // NOLINT(google-build-using-namespace): a program's own namespace
using wide_rig::Score;

struct RateSum {
  int count = 0, right = 0, wrong = 0, remainder = 0, disclosed = 0, excluded = 0, unseen = 0,
      worse = 0, later = 0, later_worse = 0, stays = 0, intervals = 0, inside = 0, failed = 0,
      worse_read = 0, later_worse_read = 0;
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
    constexpr double kWorse = 1.05;
    if (std::isfinite(s.unseen) && std::isfinite(s.unseen_refit)) {
      ++unseen;
      worse += s.unseen > kWorse * s.unseen_refit ? 1 : 0;
      worse_read += read(s.unseen, s) > kWorse * read(s.unseen_refit, s) ? 1 : 0;
    }
    if (std::isfinite(s.later) && std::isfinite(s.later_refit)) {
      ++later;
      later_worse += s.later > kWorse * s.later_refit ? 1 : 0;
      later_worse_read += read(s.later, s) > kWorse * read(s.later_refit, s) ? 1 : 0;
    }
  }
  /// An error as a measurement of those rows would show it, with its noise.
  static double read(double error, const Score& s) { return std::hypot(error, s.noise); }
  void print_predictions(bool leave_out) const {
    fmt::print(
        "\nmore than 5 % worse than the refit of one parameter: of campaigns, with 95 % interval\n"
        "{:<58} {:>19} {:>19}\n{:<58} {} {}\n{:<58} {} {}\n",
        "", "without noise", "as read, with noise", "  on loads and speeds that were not measured",
        benchmarks::share(worse, unseen), benchmarks::share(worse_read, unseen),
        "  in a session after the campaign", benchmarks::share(later_worse, later),
        benchmarks::share(later_worse_read, later));
    if (leave_out) {
      fmt::print("names that stay without a session or a tenth of the rows: {}\n",
                 benchmarks::share(stays, count));
    }
  }
  void print(const std::string& name, bool leave_out) const {
    const auto percent = [](int hits, int of) {
      return of == 0 ? std::string("    -") : fmt::format("{:5.1f}", 100.0 * hits / of);
    };
    fmt::print(
        "{:<58} {} {} {} {} {} {} {} {}{} {:5.0f}{}\n", name, benchmarks::share(right, count),
        percent(wrong, count), percent(remainder, count), percent(disclosed, count),
        percent(excluded, count), percent(worse, unseen), percent(later_worse, later),
        percent(inside, intervals), leave_out ? fmt::format(" {}", percent(stays, count)) : "",
        1e3 * seconds / std::max(count, 1), failed > 0 ? fmt::format("  {} failed", failed) : "");
    std::fflush(stdout);
  }
};

/// Stated probabilities by tenths, beside the share of them that was right.
class Reliability {
 public:
  void add(const std::vector<wide_rig::Claim>& claims) {
    for (const wide_rig::Claim& claim : claims) {
      const auto tenth = std::min<std::size_t>(static_cast<std::size_t>(claim.probability * 10), 9);
      ++count_[tenth];
      stated_[tenth] += claim.probability;
      held_[tenth] += claim.holds ? 1 : 0;
    }
  }
  void print() const {
    fmt::print(
        "\nprobabilities of causes by tenths: stated, right with its 95 % interval, claims\n");
    for (std::size_t k = 0; k < count_.size(); ++k) {
      if (count_[k] == 0) continue;
      fmt::print("  {:5.1f} {} {:6}\n", 100.0 * stated_[k] / count_[k],
                 benchmarks::share(held_[k], count_[k]), count_[k]);
    }
  }

 private:
  std::array<int, 10> count_{}, held_{};
  std::array<double, 10> stated_{};
};

}  // namespace

PROGRAM(wide_rates)(int argc, char** argv) {
  std::uint64_t first_seed = 1;
  bool answers = false, leave_out = false;
  std::vector<std::string> words;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    constexpr std::string_view kFirst = "--first=";
    if (word.starts_with(kFirst)) {
      first_seed = std::strtoull(word.c_str() + kFirst.size(), nullptr, 10);
    } else if (word == "--answers") {
      answers = true;
    } else if (word == "--leave-out") {
      leave_out = true;
    } else {
      words.push_back(word);
    }
  }
  const int seeds = words.empty() ? 200 : std::max(1, std::atoi(words[0].c_str()));
  std::vector<double> strengths;
  std::istringstream list(words.size() > 1 ? words[1] : "1,2,4,8,16");
  for (std::string one; std::getline(list, one, ',');) strengths.push_back(std::atof(one.c_str()));
  const std::string prefix = words.size() > 2 ? words[2] : "";
  fmt::print(
      "{} seeds a line; percent, right with its 95 % interval\n{:<58} {:>19} {:>5} {:>5} "
      "{:>5} {:>5} {:>5} {:>5} {:>5} {}\n",
      seeds, "line, strength in noise", "right", "wrong", "rem.", "discl", "excl.", "worse",
      "later", "in CI", leave_out ? " stays    ms" : "   ms");
  std::map<std::string, RateSum> groups;
  RateSum all;
  Reliability reliability;
  for (const wide_rig::Line& line : wide_rig::lines()) {
    if (!line.name.starts_with(prefix) && line.group != prefix) continue;
    for (const double strength : strengths) {
      std::vector<Score> scores(static_cast<std::size_t>(seeds));
      std::vector<std::string> errors(scores.size());
      std::vector<double> seconds(scores.size());
      std::vector<char> stays(scores.size(), 0);
      numerics::parallel_for(scores.size(), [&](std::size_t k) {
        try {
          const auto campaign = wide_rig::make_campaign(line, strength, first_seed + k);
          const auto start = std::chrono::steady_clock::now();
          scores[k] = wide_rig::score(campaign);
          seconds[k] =
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
          if (leave_out) {
            stays[k] = wide_rig::leave_out(campaign, scores[k], first_seed + k).same ? 1 : 0;
          }
        } catch (const std::exception& error) {
          errors[k] = error.what();
        }
      });
      RateSum sum;
      RateSum& group = groups[fmt::format("all {} at {}", line.group, strength)];
      for (std::size_t k = 0; k < scores.size(); ++k) {
        for (RateSum* s : {&sum, &group, &all}) {
          if (errors[k].empty()) {
            s->add(scores[k]);
            s->seconds += seconds[k];
            s->stays += stays[k];
          } else {
            ++s->failed;
          }
        }
        if (!errors[k].empty()) fmt::print("  seed {}: {}\n", first_seed + k, errors[k]);
        reliability.add(scores[k].claims);
      }
      sum.print(fmt::format("{} at {}", line.name, strength), leave_out);
      for (std::size_t k = 0; answers && k < scores.size(); ++k) {
        const Score& s = scores[k];
        fmt::print("    {:>3} {:5} {}{}{}\n", first_seed + k, s.right ? "right" : "", s.answer,
                   s.disclosed ? "" : " [the truth is not disclosed]",
                   leave_out && stays[k] == 0 ? " [the names do not stay]" : "");
        for (const auto& [what, ours, refit] : {std::tuple("unseen", s.unseen, s.unseen_refit),
                                                std::tuple("later", s.later, s.later_refit)}) {
          if (!(ours > 1.05 * refit)) continue;
          fmt::print(
              "              {}: error {:.4g}, of one refitted parameter {:.4g}, noise {:.4g}\n",
              what, ours, refit, s.noise);
        }
      }
      if (line.group == "null") break;
    }
  }
  fmt::print("\n");
  for (const auto& [name, sum] : groups) sum.print(name, leave_out);
  all.print_predictions(leave_out);
  reliability.print();
  return 0;
}
