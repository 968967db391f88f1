#include "calibrate/verdict/correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/screen.hpp"
#include "calibrate/laws/law_result.hpp"

namespace gear3k::calibrate {

namespace {

/// What a designer would refit without asking why.
bool is_refit(const Candidate& c) {
  return c.cause->id == "friction_level" || c.cause->id == "clearance" ||
         c.cause->id == "sensor_gain";
}

double missed(const Problem& problem, const Eigen::VectorXd& measured,
              const Eigen::VectorXd& predicted, double scale) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    sum += huber_square((measured[i] - predicted[i]) * problem.noise.weight[i] / scale);
  }
  return sum;
}

/// Variance of a sum of what blocks contribute, k (x − x̄)² summed over k − 1: rows of a block are
/// missed together.  Blocks without a row that counts contribute nothing and are none of the k.
/// @param by_row  NaN: does not count
/// @returns empty for fewer than two blocks
std::optional<double> variance_of_sum(const Eigen::VectorXd& by_row, const Blocks& blocks) {
  std::map<int, double> sums;
  for (Eigen::Index i = 0; i < by_row.size(); ++i) {
    if (std::isfinite(by_row[i])) sums[blocks.of[static_cast<std::size_t>(i)]] += by_row[i];
  }
  if (sums.size() < 2) return std::nullopt;
  Eigen::VectorXd x(static_cast<Eigen::Index>(sums.size()));
  std::ranges::transform(sums, x.begin(), [](const auto& of_block) { return of_block.second; });
  const auto count = static_cast<double>(x.size());
  return (x.array() - x.mean()).square().sum() * count / (count - 1.0);
}

}  // namespace

std::optional<FoundCorrection> find_correction(const Problem& problem,
                                               const std::vector<Candidate>& candidates,
                                               const Blocks& blocks, double scale) {
  if (blocks.count < 2) return std::nullopt;
  std::vector<Candidate> plain;
  for (const Candidate& c : candidates) {
    if (c.form.weight > 0.0) plain.push_back(c);
  }
  const Columns base = columns_at(problem, {}, plain, scale);
  const Screen screen(base.own, base.other, blocks_of(plain), problem.noise.known_scale());
  std::vector<std::size_t> tried = ranked(plain, screen.gains(base.residual), 1);
  constexpr std::size_t kMost = 5;
  if (tried.size() > kMost) tried.resize(kMost);
  for (std::size_t k = 0; k < plain.size(); ++k) {
    if (is_refit(plain[k]) && std::ranges::find(tried, k) == tried.end()) tried.push_back(k);
  }
  const Eigen::VectorXd y = measured(problem.data);
  const Eigen::VectorXd given = fit(problem, {}, scale).simulated;
  double least = missed(problem, y, given, scale);
  std::optional<FoundCorrection> best;
  for (const std::size_t k : tried) {
    Fit trial = fit(problem, with({}, plain[k]), scale);
    Eigen::VectorXd predicted = predict_left_out(problem, trial.hypothesis, blocks);
    if (!predicted.allFinite()) continue;
    const double sum = missed(problem, y, predicted, scale);
    if (!(sum < least)) continue;
    least = sum;
    best = {.fit = std::move(trial), .predicted = std::move(predicted)};
  }
  if (!best) return best;
  // What predicts better than the simulation by no more than it scatters does so by luck.
  Eigen::VectorXd gain(y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double unit = scale / problem.noise.weight[i];
    gain[i] =
        huber_square((y[i] - given[i]) / unit) - huber_square((y[i] - best->predicted[i]) / unit);
  }
  const std::optional<double> variance = variance_of_sum(gain, blocks);
  if (!variance || !(gain.sum() > std::sqrt(*variance))) return std::nullopt;
  return best;
}

namespace {

/// The blocks that a prediction is judged by.
std::vector<Blocks> judging_blocks(const Problem& problem, const Hypothesis& found,
                                   const std::vector<Levels>& levels) {
  std::vector<Blocks> all{holdout_blocks(problem.data, levels, found)};
  for (const char* name : {"load", "test torque", "speed", "run"}) {
    if (bends_with_levels(found, name, levels)) continue;
    if (auto along = blocks_along(name, levels); along && along->name != all.front().name) {
      all.push_back(*std::move(along));
    }
  }
  return all;
}

/// Sums over rows that both predict.
struct Compared {
  double refit = 0.0, found = 0.0;                ///< squares
  double refit_missed = 0.0, found_missed = 0.0;  ///< by huber_square()
  int rows = 0;
};

/// The same of what rows contribute each by itself.
double variance_of_sum(const Eigen::VectorXd& x) {
  return x.size() < 2 ? 0.0 : (x.array() - x.mean()).square().sum();
}

}  // namespace

std::optional<RefitContest> contest_with_refit(const Problem& problem, const Hypothesis& found,
                                               const std::vector<Candidate>& candidates,
                                               const std::vector<Levels>& levels, double scale) {
  const auto is_one_refit = [](const Hypothesis& h) {
    return h.effects.size() == 1 && is_refit(h.effects.front());
  };
  const std::vector<Blocks> all = judging_blocks(problem, found, levels);
  if (all.front().count < 2 || is_one_refit(found)) return std::nullopt;
  const Eigen::VectorXd y = measured(problem.data);
  std::vector<Eigen::VectorXd> by_found;
  by_found.reserve(all.size());
  // Rows at a level that alone shows a law say nothing against it: of the tail of a peak its height
  // is not known.  Nor does a session that alone shows how fast something runs in: what follows it
  // is known without.
  constexpr double kLeast = 0.01;
  Shown shown{.together = {}, .each = {}, .least = kLeast};
  for (const Candidate& c : found.effects) {
    shown.together.insert(shown.together.end(), c.parameters.size(), is_law(c));
    shown.each.insert(shown.each.end(), c.parameters.size(), c.cause->id == "drift");
  }
  for (const Blocks& blocks : all) {
    shown.most_deviation = shown_by_bends(found, blocks).most_deviation;
    by_found.push_back(predict_left_out(problem, found, blocks, shown));
    forget_beyond(found, blocks, levels, by_found.back());
    // The linearisation of a peak is not the peak that the other rows show.
    if (found.effects.empty() || !is_law(found.effects.back())) continue;
    const Eigen::VectorXd refitted = predict_law_held_out(problem, found, blocks, scale);
    by_found.back() = by_found.back().array().isFinite().select(refitted, kUnknown);
  }
  std::optional<RefitContest> best;
  for (const Candidate& c : candidates) {
    if (!(c.form.weight > 0.0) || !is_refit(c)) continue;
    Fit trial = fit(problem, with({}, c), scale);
    Compared sum;
    Eigen::VectorXd by_row = Eigen::VectorXd::Zero(y.size());
    double least = std::numeric_limits<double>::infinity();
    double beyond_rows = 0.0;
    std::optional<Eigen::VectorXd> predicted;
    for (std::size_t k = 0; k < all.size(); ++k) {
      Eigen::VectorXd by_refit = predict_held_out(problem, trial.hypothesis, all[k]);
      Eigen::VectorXd here = Eigen::VectorXd::Constant(y.size(), kUnknown);
      std::array<double, 2> missed_here{};  // by the refit, by what was found
      for (Eigen::Index i = 0; i < y.size(); ++i) {
        if (!std::isfinite(by_refit[i]) || !std::isfinite(by_found[k][i])) continue;
        const double unit = scale / problem.noise.weight[i];
        const double refit_misses = y[i] - by_refit[i];
        const double found_misses = y[i] - by_found[k][i];
        const double by_refit_here = huber_square(refit_misses / unit);
        const double by_found_here = huber_square(found_misses / unit);
        here[i] = by_refit_here - by_found_here;
        missed_here[0] += by_refit_here;
        missed_here[1] += by_found_here;
        sum.refit += refit_misses * refit_misses;
        sum.found += found_misses * found_misses;
        ++sum.rows;
      }
      const std::optional<double> by_blocks = variance_of_sum(here, all[k]);
      here = here.array().isFinite().select(here, 0.0).eval();
      if (by_blocks) beyond_rows += *by_blocks - variance_of_sum(here);
      sum.refit_missed += missed_here[0];
      sum.found_missed += missed_here[1];
      // Of sessions neither knows the next: their mean and a refitted value are nearly one.
      const bool as_good = all[k].name == "run" && !is_much_worse(missed_here[1], missed_here[0]);
      if (by_blocks && *by_blocks > 0.0 && !as_good) {
        least = std::min(least, here.sum() / std::sqrt(*by_blocks));
      }
      by_row += here;
      if (k == 0) predicted = std::move(by_refit);
    }
    const double gain = by_row.sum();
    if (sum.rows == 0 || !predicted->allFinite() || (best && !(gain < best->gain))) continue;
    best = {.refit = {.fit = std::move(trial), .predicted = *std::move(predicted)},
            .refit_error = std::sqrt(sum.refit / sum.rows),
            .error = std::sqrt(sum.found / sum.rows),
            .missed_by_refit = sum.refit_missed,
            .missed = sum.found_missed,
            .gain = gain,
            // Sums over different conditions have the scatter of rows in common.
            .gain_deviation = std::sqrt(std::max(0.0, variance_of_sum(by_row) + beyond_rows)),
            .least_gain = least};
  }
  return best;
}

}  // namespace gear3k::calibrate
