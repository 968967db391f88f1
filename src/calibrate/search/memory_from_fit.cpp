#include "calibrate/search/memory_from_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "calibrate/fit/screen.hpp"
#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/search/order_scan.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

namespace {

/// Weighted residuals and what was fitted to them; likelihoods of memories of theirs.
class RememberingRows {
 public:
  RememberingRows(const ReadingOrder& order, const Eigen::VectorXd& residual,
                  const Eigen::MatrixXd& fitted)
      : order_(order), n_(residual.size()) {
    // Without their sessions' levels the columns that are left are independent of those; of one
    // that is constant in each session only rounding is left.
    Eigen::MatrixXd own = fitted;
    const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(n_, 1);
    if (own.cols() > 0) without_levels(ones, own);
    constexpr double kRounding = 1e-6;
    for (Eigen::Index k = 0; k < own.cols(); ++k) {
      if (own.col(k).norm() <= kRounding * fitted.col(k).norm()) own.col(k).setZero();
    }
    const Eigen::MatrixXd basis = orthonormal_basis(own);
    sessions_ = std::ranges::count(order_.step, 0);
    columns_.resize(n_, basis.cols() + 2);
    columns_ << residual, basis, Eigen::MatrixXd::Ones(n_, 1);
  }

  /// 2 ln of the likelihood of the wave along a clock that takes off most, over that of independent
  /// readings, less 2 ln of the number of orders that it was chosen from.
  [[nodiscard]] double wave_ratio(const std::vector<double>& phase) const {
    constexpr Eigen::Index kMostOrders = 200;
    constexpr Eigen::Index kProducts = 400'000;
    const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(n_, 1);
    Eigen::MatrixXd rest = columns_.leftCols(columns_.cols() - 1);
    without_levels(ones, rest);
    const Eigen::MatrixXd basis = orthonormal_basis(rest.rightCols(rest.cols() - 1));
    const Eigen::VectorXd left = free_of(basis, rest.leftCols(1));
    const Eigen::Index count = std::min({n_ / 2, kMostOrders, kProducts / n_ + 2});
    double most = 0.0;
    for (Eigen::Index k = 0; k < count; ++k) {
      Eigen::MatrixXd wave = waves(phase, 1.0 + 0.5 * static_cast<double>(k));
      without_levels(ones, wave);
      const Eigen::MatrixXd own = orthonormal_basis(free_of(basis, wave));
      most = std::max(most, (own.transpose() * left).squaredNorm());
    }
    const double kept = std::max(1.0 - most / left.squaredNorm(), 1e-12);
    return -static_cast<double>(n_) * std::log(kept) -
           2.0 * std::log(static_cast<double>(std::max<Eigen::Index>(count, 1)));
  }

  /// 2 ln of the restricted likelihood, up to a constant; −∞ where nothing is left.
  [[nodiscard]] double likelihood(const NoiseMemory& memory) const {
    Eigen::MatrixXd columns = columns_;
    const MemoryFilter filter(order_, memory);
    filter.whiten(columns);
    const Eigen::Index p = columns.cols() - 2;
    const Eigen::MatrixXd ones = columns.rightCols(1);
    Eigen::MatrixXd rest = columns.leftCols(p + 1);
    double log_determinant = filter.log_determinant() + without_levels(ones, rest);
    double left = rest.col(0).squaredNorm();
    if (p > 0) {
      const Eigen::MatrixXd own = rest.rightCols(p);
      const Eigen::MatrixXd normal = own.transpose() * own;
      const Eigen::VectorXd moment = own.transpose() * rest.col(0);
      log_determinant += numerics::symmetric_eigenvalues(normal).array().max(1e-12).log().sum();
      left -= moment.dot(numerics::solve_symmetric(normal, moment));
    }
    const auto degrees = static_cast<double>(n_ - p - sessions_);
    if (!(left > 0.0) || degrees < 1.0) return -std::numeric_limits<double>::infinity();
    return -log_determinant - degrees * std::log(left / degrees);
  }

 private:
  /// Takes the multiple of the ones off each session of the columns.
  /// @returns Σ ln of the ones' squares
  double without_levels(const Eigen::MatrixXd& ones, Eigen::MatrixXd& columns) const {
    double log_squares = 0.0;
    for (std::size_t first = 0; first < order_.row.size();) {
      std::size_t end = first + 1;
      while (end < order_.row.size() && order_.step[end] != 0) ++end;
      double square = 0.0;
      Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(columns.cols());
      for (std::size_t k = first; k < end; ++k) {
        square += ones(order_.row[k], 0) * ones(order_.row[k], 0);
        sum += ones(order_.row[k], 0) * columns.row(order_.row[k]);
      }
      for (std::size_t k = first; k < end; ++k) {
        columns.row(order_.row[k]) -= ones(order_.row[k], 0) / square * sum;
      }
      log_squares += std::log(square);
      first = end;
    }
    return log_squares;
  }

  const ReadingOrder& order_;
  Eigen::Index n_;
  Eigen::MatrixXd columns_;
  Eigen::Index sessions_ = 0;
};

/// P of so great a ratio where readings are independent: of one parameter at its bound, and of a
/// second that only matters beyond it.
double chance_of_ratio(double ratio) {
  if (!(ratio > 0.0)) return 1.0;
  constexpr double kPlaces = 1.3;
  return std::min(1.0, kPlaces * std::erfc(std::sqrt(0.5 * ratio)));
}

/// The clock of the readings, from 0 to 2π: time, cycles or angle where stated, else their number.
std::vector<double> phase_of(const Problem& problem) {
  const MeasurementSet& data = problem.data;
  std::vector<double> phase;
  ValueRange range;
  for (double Condition::*clock :
       {&Condition::time_s, &Condition::cycles, &Condition::output_angle_rad}) {
    phase = column_of(data, clock);
    range = range_of(phase);
    if (range.varies() && std::ranges::all_of(phase, [](double x) { return std::isfinite(x); })) {
      break;
    }
    range = {};
  }
  if (!range.varies()) {
    const std::vector<int>& row = problem.noise.order.row;
    for (std::size_t k = 0; k < row.size(); ++k) {
      phase[static_cast<std::size_t>(row[k])] = static_cast<double>(k);
    }
    range = {.low = 0.0, .high = static_cast<double>(row.size() - 1)};
  }
  for (double& x : phase) x = 2.0 * std::numbers::pi * (x - range.low) / (range.high - range.low);
  return phase;
}

/// 2 ln of its likelihood over that of independent readings.
struct TriedMemory {
  NoiseMemory memory;
  double ratio = 0.0;
};

/// The correlations of neighbours within χ² 3.84 of the likeliest memory of an estimate.
void set_interval(const std::vector<TriedMemory>& places, MemoryEstimate& estimate) {
  constexpr double kNinetyFive = 3.841;  // quantile of χ² with one degree of freedom
  estimate.low = estimate.high = estimate.memory.correlation();
  for (const TriedMemory& p : places) {
    if (p.ratio < estimate.likelihood_ratio - kNinetyFive) continue;
    estimate.low = std::min(estimate.low, p.memory.correlation());
    estimate.high = std::max(estimate.high, p.memory.correlation());
  }
}

}  // namespace

MemoryEstimate memory_of(const Problem& problem, const Hypothesis& hypothesis, double chance) {
  MemoryEstimate result;
  const NoiseModel& noise = problem.noise;
  if (!noise.order.known() || noise.weight.size() < kFewestRememberingRows) return result;
  const Linearisation at = linearise(problem, hypothesis, {});
  const Eigen::VectorXd weighted =
      (measured(problem.data) - at.simulated).cwiseProduct(noise.weight);
  const Eigen::MatrixXd own = noise.weight.asDiagonal() * at.own;
  const RememberingRows rows(noise.order, winsorised(weighted, robust_deviation(weighted)), own);
  const double independent = rows.likelihood({});
  std::vector<TriedMemory> places;
  const auto scan = [&](double first_decay, double decay_step, int decays, double first_share,
                        double share_step, int shares) {
    for (int k = 0; k < decays; ++k) {
      for (int j = 0; j < shares; ++j) {
        const NoiseMemory memory{.share = first_share + share_step * j,
                                 .decay = first_decay + decay_step * k};
        places.push_back({.memory = memory, .ratio = rows.likelihood(memory) - independent});
      }
    }
  };
  scan(0.2, 0.15, 6, 0.2, 0.2, 5);  // φ 0.2 to 0.95
  TriedMemory best = *std::ranges::max_element(places, {}, &TriedMemory::ratio);
  result.likelihood_ratio = std::max(0.0, best.ratio);
  result.p_value = chance_of_ratio(best.ratio);
  if (result.p_value > chance) return result;
  // A wave in time is no memory where it says clearly more.  Either has two numbers, but what a
  // zero does in one campaign is nearly a wave as well, and its memory is of no shape that is
  // known.
  constexpr double kClearly = 10.0;
  if (rows.wave_ratio(phase_of(problem)) > best.ratio + kClearly) return result;
  scan(0.05, 0.05, 19, 0.1, 0.1, 10);
  best = *std::ranges::max_element(places, {}, &TriedMemory::ratio);
  result.memory = best.memory;
  result.likelihood_ratio = best.ratio;
  set_interval(places, result);
  return result;
}

MemoryEvidence memory_evidence(const NoiseModel& noise, const Eigen::VectorXd& missed,
                               const Eigen::MatrixXd& own, double chance) {
  const auto n = static_cast<double>(missed.size());
  const auto twice_log_likelihood = [&](const NoiseMemory& memory) {
    NoiseModel trial = noise;
    trial.memory = memory;
    Eigen::MatrixXd columns(missed.size(), own.cols() + 1);
    columns << missed, own;
    trial.whiten(columns);
    const Eigen::MatrixXd left =
        free_of(orthonormal_basis(columns.rightCols(own.cols())), columns.leftCols(1));
    return -trial.log_determinant() - n * std::log(std::max(left.squaredNorm(), 1e-300) / n);
  };
  const double independent = twice_log_likelihood({});
  std::vector<TriedMemory> places;
  // What lasts for many readings and is more than the noise beside it is a drift or a step.
  constexpr double kLong = 0.7, kMostOfLong = 0.5;
  for (const double decay : {0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95}) {
    for (int k = 1; k <= 10; ++k) {
      const NoiseMemory memory{.share = 0.1 * k, .decay = decay};
      if (decay > kLong && memory.share > kMostOfLong) break;
      places.push_back({.memory = memory, .ratio = twice_log_likelihood(memory) - independent});
    }
  }
  const TriedMemory best = *std::ranges::max_element(places, {}, &TriedMemory::ratio);
  MemoryEvidence result;
  result.likeliest.likelihood_ratio = std::max(0.0, best.ratio);
  result.likeliest.p_value = chance_of_ratio(best.ratio);
  if (result.likeliest.p_value <= chance) {
    result.likeliest.memory = best.memory;
    set_interval(places, result.likeliest);
  }
  // As likely before the data to remember, anyhow, as not to.
  const double top = std::max(0.0, best.ratio);
  double mean = 0.0;
  for (const TriedMemory& p : places) mean += std::exp(0.5 * (p.ratio - top));
  mean /= static_cast<double>(places.size());
  result.twice_log_likelihood =
      independent + top + 2.0 * std::log(0.5 * mean + 0.5 * std::exp(-0.5 * top));
  return result;
}

}  // namespace gear3k::calibrate
