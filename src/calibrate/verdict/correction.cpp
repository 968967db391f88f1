#include "calibrate/verdict/correction.hpp"

#include <algorithm>
#include <utility>

#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/screen.hpp"

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
  double least = missed(problem, y, fit(problem, {}, scale).simulated, scale);
  std::optional<FoundCorrection> best;
  for (const std::size_t k : tried) {
    Fit trial = fit(problem, with({}, plain[k]), scale);
    Eigen::VectorXd predicted = predict_held_out(problem, trial.hypothesis, blocks);
    if (!predicted.allFinite()) continue;
    const double sum = missed(problem, y, predicted, scale);
    if (!(sum < least)) continue;
    least = sum;
    best = {.fit = std::move(trial), .predicted = std::move(predicted)};
  }
  return best;
}

}  // namespace gear3k::calibrate
