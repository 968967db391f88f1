#include "calibrate/search/stability.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <utility>

namespace gear3k::calibrate {

std::vector<double> inclusion_frequency(const Problem& problem, const SearchResult& result,
                                        const std::vector<std::vector<std::string_view>>& groups,
                                        const SearchOptions& options) {
  constexpr int kSamples = 40;
  std::vector<double> frequency(groups.size(), 0.0);
  if (groups.empty()) return frequency;
  const Columns columns = columns_at(problem, {}, result.candidates, 0.0);
  const Eigen::Index n = columns.residual.size();
  const Eigen::Index half = std::min<Eigen::Index>(n / 2, 500);
  constexpr Eigen::Index kFewRows = 8;
  if (half < kFewRows) return std::vector<double>(groups.size(), kUnknown);
  RandomBits random(options.seed + 77);
  std::vector<Eigen::Index> index(static_cast<std::size_t>(n));
  std::iota(index.begin(), index.end(), Eigen::Index{0});
  for (int sample = 0; sample < kSamples; ++sample) {
    for (Eigen::Index k = 0; k < half; ++k) {
      const auto left = static_cast<double>(n - k);
      const auto other = k + static_cast<Eigen::Index>(random.uniform() * left);
      std::swap(index[static_cast<std::size_t>(k)], index[static_cast<std::size_t>(other)]);
    }
    const std::vector<Eigen::Index> rows(index.begin(), index.begin() + half);
    const Eigen::VectorXd residual =
        winsorised(columns.residual(rows), robust_deviation(columns.residual(rows)));
    const Eigen::MatrixXd other = columns.other(rows, Eigen::all);
    Eigen::MatrixXd own(half, 0);
    std::vector<bool> hit(groups.size(), false);
    for (int size = 0; size < kMostEffects; ++size) {
      const Screen screen(own, other, blocks_of(result.candidates), 0.0);
      const auto gains = screen.gains(residual);
      const auto order = ranked(result.candidates, gains, 1);
      if (order.empty() || gains[order[0]].evidence < result.first_luck.threshold) break;
      const Candidate& c = result.candidates[order[0]];
      for (std::size_t g = 0; g < groups.size(); ++g) {
        hit[g] = hit[g] || std::ranges::find(groups[g], c.cause->id) != groups[g].end();
      }
      const Block block = screen.blocks()[order[0]];
      Eigen::MatrixXd grown(half, own.cols() + block.count);
      grown << own, other.middleCols(block.first, block.count);
      own = std::move(grown);
    }
    for (std::size_t g = 0; g < groups.size(); ++g) frequency[g] += hit[g] ? 1.0 : 0.0;
  }
  for (double& f : frequency) f /= kSamples;
  return frequency;
}

}  // namespace gear3k::calibrate
