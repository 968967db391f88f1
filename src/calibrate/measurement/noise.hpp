#pragma once
// How much measurements scatter, and what they look like when every row counts alike.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "calibrate/measurement/noise_memory.hpp"

namespace gear3k::calibrate {

/// Where the noise level comes from.
enum class NoiseSource { kStated, kRepeats, kResiduals };

/// Rows that were measured under the same condition.
struct Repeats {
  std::vector<int> cell;  ///< of each row; rows of one cell repeat each other
  int cells = 0;
  int degrees = 0;  ///< rows beyond the first of each cell
};

/// Rows agree in what was set: direction, rotation, sensor, teeth, module, and to 2 % of their
/// range speed, load and test torque (without a range: exactly); temperature where it was set too,
/// that is where it takes at most eight values.  What varies beside that, session, angle and time
/// among it, is part of how measurements scatter.
Repeats find_repeats(const MeasurementSet& data);

/// Scale of the rows and correlation within sessions.
struct NoiseModel {
  NoiseSource source = NoiseSource::kResiduals;
  Eigen::VectorXd weight;  ///< 1/σ of each row, up to a common factor
  std::vector<int> run;    ///< of each row, -1 = none
  int runs = 0;
  std::vector<double> rows_per_run;
  /// Variance of sessions over that of a row, τ²/σ²; 0: sessions do not scatter.
  double session_variance = 0.0;
  /// Deviation of a reading by the last digit alone [SI]: its unit over √12.
  double rounding = 0.0;
  /// Step of readings that take few values (reading_steps()) [SI]; 0: they take any.
  double step = 0.0;
  ReadingOrder order{};  ///< of the rows, where the data tell it
  NoiseMemory memory{};  ///< of readings that follow each other so

  /// As a Whitening, for once.
  void whiten(Eigen::MatrixXd& columns) const;
  /// ln det of the rows' covariance, in units of the variance of a whitened row.
  [[nodiscard]] double log_determinant() const;
  /// What one unit more in all rows of a session is in whitened rows, with 1 for the unit of the
  /// weighted ones; and its squares, by session: its rows where nothing is remembered.
  [[nodiscard]] Eigen::VectorXd whitened_ones() const;
  [[nodiscard]] std::vector<double> squares_by_session(const Eigen::VectorXd& ones) const;
  [[nodiscard]] bool remembers() const { return memory.share > 0.0 && order.known(); }
  /// Deviation of whitened rows where it must be taken as stated, as few rows say nothing of their
  /// own scatter; 0: it is estimated.
  [[nodiscard]] double known_scale() const;
  /// Deviation of whitened rows that the last digit alone makes; above 0 in any case.
  [[nodiscard]] double least_scale() const;
  /// robust_deviation() of whitened residuals; of readings in steps of that of the readings spread
  /// evenly over a step to either side, less what the spread adds (within a quarter up to steps of
  /// twice the deviation): the median of few values tells nothing.
  [[nodiscard]] double deviation_of(const Eigen::VectorXd& whitened) const;
  /// Whether weighted residuals are no more than the last digit makes.
  [[nodiscard]] bool within_rounding(const Eigen::VectorXd& whitened) const;
  /// Whether whiten() makes a row of several.
  [[nodiscard]] bool mixes_rows() const;
  /// Whether whiten() only changes the unit.
  [[nodiscard]] bool counts_rows_alike() const;
};

/// Weights rows, takes off what the readings before say of each, and out of each session's mean
/// what sessions scatter: afterwards all rows are independent and scatter alike.
class Whitening {
 public:
  /// @param noise  must outlive this
  explicit Whitening(const NoiseModel& noise);
  void operator()(Eigen::MatrixXd& columns) const;

 private:
  const NoiseModel& noise_;
  std::optional<MemoryFilter> filter_;
  Eigen::VectorXd ones_;          // where sessions scatter
  std::vector<double> take_off_;  // share of its mean over its squares, by session
};

/// Unit of the last digit of the responses [SI]: the greatest power of ten from 1 down to 1e-9 of
/// the column's unit of which all are multiples; 0 where none is.
double resolution_of(const MeasurementSet& data);

NoiseModel make_noise_model(const MeasurementSet& data);

/// The noise of some of the rows, ascending; sessions keep their numbers.
NoiseModel subset_of(const NoiseModel& noise, const std::vector<std::size_t>& rows);

/// Sum of squares of weighted rows about the means of their cells, and its degrees of freedom.
struct PureError {
  double sum_of_squares = 0.0;
  int degrees = 0;
};
PureError pure_error(const Repeats& repeats, const Eigen::VectorXd& weighted);

/// Of a simulation: what it misses at the cells' means against pure error.
struct LackOfFit {
  double f = 0.0, p_value = 1.0;
  int degrees = 0, pure_degrees = 0;  ///< 0: nothing was repeated
};
/// @param weighted  measured − simulated, weighted
/// @param parameters  that were fitted to these rows; all 0 where there are as many cells or fewer
LackOfFit lack_of_fit(const Repeats& repeats, const Eigen::VectorXd& weighted, int parameters = 0);

/// P(F ≥ f) for Fisher's distribution; 1 where there are no degrees of freedom.
double f_tail(double f, int degrees1, int degrees2);

/// Root of the mean square; 0 of nothing.
double root_mean_square(const Eigen::VectorXd& x);

/// Median of |x| over that of a normal deviate: a standard deviation that outliers do not move.
double robust_deviation(const Eigen::VectorXd& x);

}  // namespace gear3k::calibrate
