#pragma once
// What each candidate would add to a fit, by linearisation, and how much of that is luck.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calibrate/fit/linearisation.hpp"

namespace gear3k::calibrate {

/// A block of columns that explains part of a residual.
struct Block {
  Eigen::Index first = 0, count = 0;  ///< columns
  /// Bounds of a single parameter at 0: +1 it can only grow, −1 only fall, 0 either.
  int side = 0;
  double log_weight = 0.0;  ///< of its share before the data
};

/// What a block adds.
struct Gain {
  double sum_of_squares = 0.0;  ///< that it takes off the residual's
  double statistic = 0.0;       ///< like a χ² of its number of parameters
  /// −2 ln of the ratio of the likelihoods without and with it, as the BIC counts.
  double likelihood_ratio = 0.0;
  double evidence = 0.0;  ///< −ln of its p-value by itself, plus log_weight
};

/// Blocks of columns against a residual, after what is already fitted.
class Screen {
 public:
  /// @param own  columns of what is fitted; @param columns  of the blocks; all whitened
  /// @param known_scale  standard deviation of the rows when it is known, else 0: it is then taken
  /// from what the block leaves
  Screen(const Eigen::MatrixXd& own, Eigen::MatrixXd columns, std::vector<Block> blocks,
         double known_scale);

  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  /// Columns of a block that are independent of each other and of what is fitted.
  [[nodiscard]] Eigen::Index rank(std::size_t block) const { return rank_[block]; }
  /// Of every block on a residual (projected on what is free first).
  [[nodiscard]] std::vector<Gain> gains(const Eigen::VectorXd& residual) const;

  /// How residuals without structure are made of the residuals at hand.
  enum class Chance {
    kSigns,    ///< random signs: rows keep their own scatter
    kShuffled  ///< random signs and places: rows scatter alike; blocks of few rows need it, as a
               ///< structure in six rows survives every 32nd choice of their signs
  };

  /// Distribution of the greatest evidence of any block where there is nothing.
  struct Luck {
    double threshold = 0.0;  ///< that the greatest evidence passes with the probability asked for
    double rate = 0.0;       ///< that probability
    /// Probability of an evidence at least as great by luck.
    [[nodiscard]] double p_value(double evidence) const;
  };
  [[nodiscard]] Luck luck(const Eigen::VectorXd& residual, double rate, int simulations,
                          std::uint64_t seed, Chance chance = Chance::kSigns) const;
  /// The greatest evidence of any block on each of many residuals without structure.  Screens with
  /// the same `own` draw the same residuals: the greater of two of them is that of their blocks in
  /// one screen.
  [[nodiscard]] std::vector<double> greatest_by_luck(const Eigen::VectorXd& residual,
                                                     int simulations, std::uint64_t seed,
                                                     Chance chance = Chance::kSigns) const;
  /// @param greatest  of greatest_by_luck()
  [[nodiscard]] static Luck luck_of(std::vector<double> greatest, double rate);

 private:
  [[nodiscard]] Eigen::MatrixXd free_part(const Eigen::MatrixXd& x) const;
  [[nodiscard]] Gain gain_of(const Block& block, const double* projection, double total) const;

  std::vector<Block> blocks_;
  Eigen::MatrixXd own_basis_;
  Eigen::MatrixXd basis_;  ///< of the blocks, orthonormal within each, free of `own`
  std::vector<Eigen::Index> rank_;
  double known_scale_ = 0.0;
  double degrees_ = 1.0;
};

/// −ln P(χ²_k ≥ x).
double chi_square_evidence(double x, Eigen::Index k);

/// Orthonormal basis of columns; columns that add less than 1e-6 of their length are left out.
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns);

/// Columns without what an orthonormal basis takes of them; 0 where that is all.
Eigen::MatrixXd free_of(const Eigen::MatrixXd& basis, Eigen::MatrixXd columns);

/// A generator of reproducible streams: the same numbers on every machine.
class RandomBits {
 public:
  explicit RandomBits(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double uniform();  ///< [0, 1)
  double normal();   ///< of mean 0 and deviation 1

 private:
  std::uint64_t state_;
};

}  // namespace gear3k::calibrate
