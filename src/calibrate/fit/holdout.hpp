#pragma once
// Prediction of rows that a fit has not seen.

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/fit/fit.hpp"
#include "calibrate/measurement/covariate_levels.hpp"

namespace gear3k::calibrate {

/// A prediction outside the range that was fitted.
struct Extrapolation {
  std::string along;      ///< "load" or "speed"; "" = not possible with these data
  double left_out = 0.0;  ///< its highest value [in the column's unit]
  int rows = 0;
  double baseline = kUnknown, extended = kUnknown;  ///< errors there
};

/// Blocks of rows that are left out together.
struct Blocks {
  std::string name;     ///< "pinion", "load", "test torque", "speed", "run", "angle", "rows" or ""
  std::vector<int> of;  ///< of each row, from 0
  int count = 0;
};

/// The levels of a covariate, where there are at least three.
/// @param name  of covariate_levels()
std::optional<Blocks> blocks_along(std::string_view name, const std::vector<Levels>& levels);

/// Whether a law of a condition ("load" or "speed") has so many parameters that its levels less one
/// would leave nothing over: how it misses a level that is left out says nothing of the law.
bool bends_with_levels(const Hypothesis& hypothesis, std::string_view condition,
                       const std::vector<Levels>& levels);

/// Whole pinions, load levels, test torques, speeds, sessions or sectors of the angle: the first of
/// these of which there are at least three; else parts_of_rows().
/// @param hypothesis  to be held out; not along what it bends_with_levels()
/// @returns one block without a name where the hypothesis bends with all that has levels: whatever
///          else is left out, each level stays, and nothing tells of what lies between them
Blocks holdout_blocks(const MeasurementSet& data, const std::vector<Levels>& levels,
                      const Hypothesis& hypothesis = {});

/// Tenths of a turn where all rows state their angle, else of the rows in their order.
Blocks parts_of_rows(const MeasurementSet& data);

/// The block of the last session, where sessions are left out; -1: others are.
int last_session(const MeasurementSet& data, const Blocks& blocks);

/// Of which of a hypothesis' parameters one block must not hold all that the data say.
struct Shown {
  std::vector<bool> together = {};  ///< of each parameter; empty: none
  std::vector<bool> each = {};      ///< those that are asked for one by one; empty: none
  /// Of their information det(N)/det(N_others), N = JᵀJ: what is to be left without a block, of
  /// those asked for together the root of as many.
  double least = 0.0;
  /// Standard deviation of the prediction of a row by the others, in that of the weighted rows,
  /// from which on these say nothing of it.
  double most_deviation = std::numeric_limits<double>::infinity();
};

/// What a block of a law that bends must not hold alone: of rows that a curve through the others
/// may meet anyhow these say nothing.
Shown shown_by_bends(const Hypothesis& h, const Blocks& blocks);

/// Takes out of a prediction of held-out rows those beyond the range of the others in the condition
/// of a law of free shape: what the rest say of these is no part of the law as it is used.
void forget_beyond(const Hypothesis& h, const Blocks& blocks, const std::vector<Levels>& levels,
                   Eigen::VectorXd& predicted);

/// Each row as a fit without its block predicts it [SI].
///
/// Along the linearisation at the full fit; exact for what is linear in its parameters.  What
/// sessions share and readings remember is taken off the rows outside the block as if there were no
/// others.
/// @returns NaN in blocks without which the parameters are not determined, or those that are to be
///          shown too little, and in rows of which the others say nothing
Eigen::VectorXd predict_held_out(const Problem& problem, const Hypothesis& hypothesis,
                                 const Blocks& blocks, const Shown& shown = {});

/// The rows that a prediction of held-out rows is judged by: those that it knows, where these are
/// half of them at least; else none.
std::vector<Eigen::Index> known_rows(const Eigen::VectorXd& predicted);

/// The same as a model of the fit is used: of sessions that are left out (blocks "run") the last is
/// predicted as the fit without it leaves it behind (Cause::leave_behind), drift held at the last
/// row before it.  Sessions with a value each are undetermined, as above.
Eigen::VectorXd predict_left_out(const Problem& problem, const Hypothesis& hypothesis,
                                 const Blocks& blocks, const Shown& shown = {});

/// Whether predictions of held-out rows miss them by no more than others do: huber_square() of the
/// weighted rows, summed over those that both predict.
/// @param scale  standard deviation of the weighted rows
bool predicts_no_worse(const Problem& problem, const Eigen::VectorXd& predicted,
                       const Eigen::VectorXd& by_other, double scale);

/// Errors at the highest load, speed or test torque (the first of these of which there are at least
/// three) when the fit has not seen it.
/// @param measured, baseline  of the rows [SI]
Extrapolation extrapolate(const Problem& problem, const Hypothesis& hypothesis,
                          const std::vector<Levels>& levels, const Eigen::VectorXd& measured,
                          const Eigen::VectorXd& baseline);

}  // namespace gear3k::calibrate
