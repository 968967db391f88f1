#pragma once
// A prediction where nothing explains: the cause that, taken as a formula, predicts best.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrate/fit/holdout.hpp"

namespace gear3k::calibrate {

/// One cause as a formula for a discrepancy that it does not explain.
struct FoundCorrection {
  Fit fit;
  Eigen::VectorXd predicted;  ///< of each row by a fit without its block [SI]
};

/// The candidate whose fits without each block predict that block best, by huber_square(), among
/// the coefficient of friction, a clearance, a gain, and the five causes that by linearisation take
/// off most.
/// @param scale  of the weighted rows about the simulation as given
/// @returns empty without blocks, and where none predicts better than the simulation as given
std::optional<FoundCorrection> find_correction(const Problem& problem,
                                               const std::vector<Candidate>& candidates,
                                               const Blocks& blocks, double scale);

/// Whether one prediction misses rows by more than 5 % more than another, in the root of sums of
/// huber_square().
constexpr bool is_much_worse(double missed, double by_other) {
  constexpr double kMuch = 1.05;
  return missed > kMuch * kMuch * by_other;
}

/// A prediction against the refit of one parameter (coefficient of friction, clearance or gain), in
/// rows held out of either: over the blocks of load, test torque, speed and session, and those that
/// are shown.
struct RefitContest {
  FoundCorrection refit;                  ///< that predicts them best
  double refit_error = 0.0, error = 0.0;  ///< root mean squares over all blocks [SI]
  /// Sums of huber_square() of the weighted rows over all blocks.
  double missed_by_refit = 0.0, missed = 0.0;
  double gain = 0.0;  ///< of the prediction over the refit in these sums
  /// Standard error of that, by what blocks differ in: their rows are missed together.
  double gain_deviation = 0.0;
  /// The least gain in rows left out by one condition, in standard errors of its own; of sessions
  /// where the prediction is much worse there.
  double least_gain = 0.0;
  [[nodiscard]] bool refit_is_better() const { return gain < 0.0; }
  /// Whether it is not clear that what was found predicts better: over all, or along one condition.
  [[nodiscard]] bool refit_is_safer() const { return gain < gain_deviation || least_gain < -1.0; }
};

/// @param found  what predicts; empty: the simulation as given
/// @param candidates  of which the refits are taken
/// @param scale  of the weighted rows about what was found
/// @returns empty without blocks, without such a parameter, and where what was found is that refit
std::optional<RefitContest> contest_with_refit(const Problem& problem, const Hypothesis& found,
                                               const std::vector<Candidate>& candidates,
                                               const std::vector<Levels>& levels, double scale);

}  // namespace gear3k::calibrate
