#pragma once
// Noise that remembers: readings that are off together with those before them.

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// The rows one after the other as they were read, session by session.
struct ReadingOrder {
  std::vector<int> row;
  /// Readings from the row before to this one; 0: the first of its session.
  std::vector<int> step;
  [[nodiscard]] bool known() const { return !row.empty(); }
};

/// The condition that was set and that moves in one sense with the order of the lines (of pairs of
/// lines of a session that differ by more than 2 % of its range 99 %, but for one line in twenty):
/// lines may have been sorted by it, and what is off with it would look like memory.  An angle is
/// none, nor is a temperature that was only read: it moves in one sense because time does.
/// @returns "" where there is none
std::string_view lines_sorted_by(const MeasurementSet& data);

/// By time, else by cycles, where all rows state it; else as in the files, unless
/// lines_sorted_by() some condition.  Empty where the data do not tell.
ReadingOrder reading_order(const MeasurementSet& data);

/// The order of some of the rows, ascending, by their places among these.
ReadingOrder subset_of(const ReadingOrder& order, const std::vector<std::size_t>& rows);

/// Share ρ of the variance of a reading that it has in common with those before it: k readings
/// apart they correlate by ρ φ^k, in one session.
///
///   y = s + e,  s_i = φ s_(i−1) + w_i,  var s = ρ, var e = 1 − ρ, var w = ρ (1 − φ²)
///
/// ρ = 1: autoregression of first order; ρ < 1 and φ near 1: a zero that creeps under noise.
/// Source: docs/theory §30 (noise that remembers).
struct NoiseMemory {
  double share = 0.0;  ///< ρ; 0: readings are independent
  double decay = 0.0;  ///< φ, 0 to 1
  [[nodiscard]] double correlation() const { return share * decay; }  ///< of neighbours
};

/// The memory of the noise by likelihood.
struct MemoryEstimate {
  NoiseMemory memory;  ///< the likeliest; none where independent readings look like this by luck
  double likelihood_ratio = 0.0;  ///< 2 ln of the likelihood over that of independent readings
  double p_value = 1.0;
  double low = 0.0, high = 0.0;  ///< 95 % of the correlation of neighbours, by likelihood
};

/// Makes rows of unit variance that remember independent: one-step predictions of Kalman's filter
/// are taken off, and what is left is divided by its deviation.
class MemoryFilter {
 public:
  MemoryFilter(const ReadingOrder& order, const NoiseMemory& memory);
  void whiten(Eigen::MatrixXd& columns) const;
  /// ln det of the correlations.
  [[nodiscard]] double log_determinant() const { return log_determinant_; }

 private:
  const ReadingOrder& order_;
  std::vector<double> fade_, gain_, unit_;  // φ^step; of the prediction; 1/deviation
  double log_determinant_ = 0.0;
};

}  // namespace gear3k::calibrate
