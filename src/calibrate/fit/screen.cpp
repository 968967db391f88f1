#include "calibrate/fit/screen.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

double chi_square_evidence(double x, Eigen::Index k) {
  if (!(x > 0.0)) return 0.0;
  if (k == 2) return 0.5 * x;
  constexpr double kFar = 1200.0;  // beyond, the tail underflows: its leading term
  if (k == 1) {
    if (x < kFar) return -std::log(std::erfc(std::sqrt(0.5 * x)));
    return 0.5 * x + 0.5 * std::log(0.5 * std::numbers::pi * x);
  }
  const double half = 0.5 * static_cast<double>(k);
  if (x < kFar) {
    const double p = numerics::gamma_upper(half, 0.5 * x);
    if (p > 0.0) return -std::log(p);
  }
  return 0.5 * x - (half - 1.0) * std::log(0.5 * x) + std::lgamma(half);
}

Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns) {
  constexpr double kLeast = 1e-6;
  Eigen::MatrixXd basis(columns.rows(), columns.cols());
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    Eigen::VectorXd column = columns.col(k);
    const double length = column.norm();
    if (!(length > 0.0) || !std::isfinite(length)) continue;
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::VectorXd shares = basis.leftCols(rank).transpose() * column;
      column -= basis.leftCols(rank) * shares;
    }
    const double left = column.norm();
    if (left <= kLeast * length) continue;
    basis.col(rank++) = column / left;
  }
  return basis.leftCols(rank);
}

Eigen::MatrixXd free_of(const Eigen::MatrixXd& basis, Eigen::MatrixXd columns) {
  if (basis.cols() == 0) return columns;
  const Eigen::VectorXd whole = columns.colwise().norm();
  columns -= basis * (basis.transpose() * columns);
  constexpr double kRounding = 1e-6;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    if (columns.col(k).norm() <= kRounding * whole[k]) columns.col(k).setZero();
  }
  return columns;
}

std::uint64_t RandomBits::next() {
  // SplitMix64 (Steele, Lea, Flood 2014).
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

double RandomBits::uniform() {
  constexpr double kUnit = 0x1p-53;
  return static_cast<double>(next() >> 11U) * kUnit;
}

double RandomBits::normal() {
  // Box and Muller 1958; the second deviate is not kept.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

Screen::Screen(const Eigen::MatrixXd& own, Eigen::MatrixXd columns, std::vector<Block> blocks,
               double known_scale)
    : blocks_(std::move(blocks)),
      own_basis_(orthonormal_basis(own)),
      basis_(std::move(columns)),
      known_scale_(known_scale) {
  rank_.reserve(blocks_.size());
  constexpr double kAlike = 1e-8;  // share of its squares that a column must keep
  for (const Block& block : blocks_) {
    const Eigen::MatrixXd given = basis_.middleCols(block.first, block.count);
    Eigen::MatrixXd left = free_part(given);
    for (Eigen::Index k = 0; k < left.cols(); ++k) {
      if (!(left.col(k).squaredNorm() > kAlike * given.col(k).squaredNorm())) left.col(k).setZero();
    }
    const Eigen::MatrixXd basis = orthonormal_basis(left);
    basis_.middleCols(block.first, basis.cols()) = basis;
    basis_.middleCols(block.first + basis.cols(), block.count - basis.cols()).setZero();
    rank_.push_back(basis.cols());
  }
  degrees_ = static_cast<double>(basis_.rows() - own_basis_.cols());
}

Eigen::MatrixXd Screen::free_part(const Eigen::MatrixXd& x) const {
  if (own_basis_.cols() == 0) return x;
  Eigen::MatrixXd left = x - own_basis_ * (own_basis_.transpose() * x);
  left -= own_basis_ * (own_basis_.transpose() * left);
  return left;
}

Gain Screen::gain_of(const Block& block, const double* projection, double total) const {
  const auto index = static_cast<std::size_t>(&block - blocks_.data());
  const Eigen::Index rank = rank_[index];
  if (rank == 0) return {};
  Gain gain;
  for (Eigen::Index k = 0; k < rank; ++k) {
    const double share = projection[block.first + k];
    gain.sum_of_squares += share * share;
  }
  if (block.side != 0 && projection[block.first] * block.side <= 0.0) return {};
  const double left_degrees = degrees_ - static_cast<double>(rank);
  if (known_scale_ > 0.0) {
    gain.statistic = gain.sum_of_squares / (known_scale_ * known_scale_);
    gain.likelihood_ratio = gain.statistic;
  } else if (left_degrees >= 1.0 && total > 0.0) {
    const double left = std::max(1.0 - gain.sum_of_squares / total, 1e-12);
    gain.statistic = -(left_degrees - 0.5) * std::log(left);
    gain.likelihood_ratio = -static_cast<double>(basis_.rows()) * std::log(left);
  }
  gain.evidence = chi_square_evidence(gain.statistic, rank) + block.log_weight +
                  (block.side != 0 ? std::numbers::ln2 : 0.0);
  return gain;
}

std::vector<Gain> Screen::gains(const Eigen::VectorXd& residual) const {
  const Eigen::VectorXd left = free_part(residual);
  const Eigen::VectorXd projection = basis_.transpose() * left;
  const double total = left.squaredNorm();
  std::vector<Gain> result;
  result.reserve(blocks_.size());
  for (const Block& block : blocks_) result.push_back(gain_of(block, projection.data(), total));
  return result;
}

double Screen::Luck::p_value(double evidence) const {
  // The evidence is −ln p: its tail falls as e^(−evidence).
  return std::min(1.0, rate * std::exp(threshold - evidence));
}

Screen::Luck Screen::luck(const Eigen::VectorXd& residual, double rate, int simulations,
                          std::uint64_t seed, Chance chance) const {
  return luck_of(greatest_by_luck(residual, simulations, seed, chance), rate);
}

std::vector<double> Screen::greatest_by_luck(const Eigen::VectorXd& residual, int simulations,
                                             std::uint64_t seed, Chance chance) const {
  const Eigen::VectorXd left = free_part(residual);
  const Eigen::Index n = left.size();
  RandomBits random(seed);
  std::vector<Eigen::Index> place(static_cast<std::size_t>(n));
  std::iota(place.begin(), place.end(), Eigen::Index{0});
  std::vector<double> greatest;
  greatest.reserve(static_cast<std::size_t>(simulations));
  // Samples of many rows are as large as all columns together.
  constexpr Eigen::Index kRowsOfLargeSamples = 20000;
  const Eigen::Index batch = n > kRowsOfLargeSamples ? 16 : 64;
  for (int done = 0; done < simulations; done += static_cast<int>(batch)) {
    Eigen::MatrixXd sample(n, batch);
    for (Eigen::Index k = 0; k < batch; ++k) {
      for (std::size_t i = place.size(); chance == Chance::kShuffled && i > 1; --i) {
        const double at = random.uniform() * static_cast<double>(i);
        std::swap(place[i - 1], place[static_cast<std::size_t>(at)]);
      }
      std::uint64_t bits = 0;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (known_scale_ > 0.0) {
          // Few rows have few patterns of signs, and what they show is not their scatter.
          sample(i, k) = known_scale_ * random.normal();
          continue;
        }
        if (i % 64 == 0) bits = random.next();
        const double r = left[place[static_cast<std::size_t>(i)]];
        sample(i, k) = (bits & 1U) != 0 ? r : -r;
        bits >>= 1U;
      }
    }
    sample = free_part(sample);
    const Eigen::MatrixXd projection = basis_.transpose() * sample;
    for (Eigen::Index k = 0; k < batch; ++k) {
      const double total = sample.col(k).squaredNorm();
      double best = 0.0;
      for (const Block& block : blocks_) {
        best = std::max(best, gain_of(block, projection.col(k).data(), total).evidence);
      }
      greatest.push_back(best);
    }
  }
  return greatest;
}

Screen::Luck Screen::luck_of(std::vector<double> greatest, double rate) {
  std::ranges::sort(greatest);
  // The tail is that of −ln p: quantiles further in, moved out by the ratio of their rates, all
  // estimate the threshold; their mean is steadier than the last of them.  Rates of less than one
  // of these cases are all told by those of one.
  const double told = std::max(rate, 1.0 / static_cast<double>(greatest.size()));
  double sum = 0.0;
  double count = 0.0;
  for (const double inner : {1.0, 1.5, 2.0, 3.0}) {
    const double share = 1.0 - std::min(inner * told, 0.5);
    const auto at = static_cast<std::size_t>(share * static_cast<double>(greatest.size() - 1));
    sum += greatest[at] + std::log(std::min(inner * told, 0.5) / rate);
    count += 1.0;
  }
  return {.threshold = sum / count, .rate = rate};
}

}  // namespace gear3k::calibrate
