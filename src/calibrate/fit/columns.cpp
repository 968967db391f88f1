#include "calibrate/fit/columns.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace gear3k::calibrate {

Columns columns_at(const Problem& problem, const Hypothesis& hypothesis,
                   const std::vector<Candidate>& others, double scale) {
  Linearisation at = linearise(problem, hypothesis, others);
  // One after the other in their places: many rows have hundreds of megabytes of columns.
  Eigen::MatrixXd residual = measured(problem.data) - at.simulated;
  for (Eigen::MatrixXd* columns : {&residual, &at.own, &at.other}) problem.noise.whiten(*columns);
  return {.residual = winsorised(residual.col(0), scale),
          .raw = residual.col(0),
          .own = std::move(at.own),
          .other = std::move(at.other)};
}

std::vector<Block> blocks_of(const std::vector<Candidate>& candidates) {
  std::vector<Block> blocks;
  blocks.reserve(candidates.size());
  Eigen::Index first = 0;
  for (const Candidate& c : candidates) {
    const auto count = static_cast<Eigen::Index>(c.parameters.size());
    int side = 0;
    if (count == 1) side = c.parameters[0].lower >= 0.0 ? 1 : c.parameters[0].upper <= 0.0 ? -1 : 0;
    blocks.push_back({.first = first,
                      .count = count,
                      .side = side,
                      .log_weight = std::log(c.form.weight * c.cause->weight)});
    first += count;
  }
  return blocks;
}

std::vector<std::size_t> ranked(const std::vector<Candidate>& candidates,
                                const std::vector<Gain>& gains, int forms) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return gains[a].evidence > gains[b].evidence; });
  std::map<const Cause*, int> taken;
  std::erase_if(order, [&](std::size_t k) {
    return gains[k].statistic <= 0.0 || taken[candidates[k].cause]++ >= forms;
  });
  return order;
}

}  // namespace gear3k::calibrate
