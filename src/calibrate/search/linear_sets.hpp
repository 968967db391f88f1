#pragma once
// Sets of candidates along one linearisation: which of them are worth a fit.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrate/fit/columns.hpp"

namespace gear3k::calibrate {

/// Sums of squares of sets of blocks along one linearisation.
class LinearSets {
 public:
  LinearSets(const Columns& columns, std::vector<Block> blocks, const Problem& problem);

  /// Likelihood of the set with a price for its parameters and the choice of its forms:
  /// −(n/2) ln S − (p/2) ln n + Σ ln w, with S the squares that p columns leave in n rows (for
  /// known scatter −S/2σ² in the place of the first term).
  /// @returns −∞ where the columns are dependent or a sided parameter has the wrong sign
  [[nodiscard]] double score(const std::vector<std::size_t>& set) const;

  /// How often so many columns take so much off rows without structure: the tail of the F
  /// distribution, of S₀ − S over S.  1 where score() is −∞.
  [[nodiscard]] double chance(const std::vector<std::size_t>& set) const;

 private:
  struct Left {
    Eigen::Index columns = 0;
    double squares = 0.0;
  };
  /// @returns nothing where score() is −∞
  [[nodiscard]] std::optional<Left> left_by(const std::vector<std::size_t>& set) const;

  std::vector<Block> blocks_;
  Eigen::MatrixXd gram_;
  Eigen::VectorXd moment_;
  double total_, rows_, known_;
};

/// The best sets of two or three candidates, of a cause each, by score: at most `most` of them, of
/// different causes each.
/// @param pool  positions of the candidates to choose from
std::vector<std::vector<std::size_t>> best_linear_sets(const std::vector<Candidate>& candidates,
                                                       const std::vector<std::size_t>& pool,
                                                       const LinearSets& sets, int size, int most);

}  // namespace gear3k::calibrate
