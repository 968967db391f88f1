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

/// The refit of one parameter (coefficient of friction, clearance or gain) that predicts rows held
/// out of its fit better than what was found does, by huber_square() summed over the blocks of
/// every condition that has them: a prediction is no worse than what a designer would refit.
/// @param scale  of the weighted rows about what was found
/// @returns empty where none does, and where what was found is such a refit
std::optional<FoundCorrection> better_refit(const Problem& problem, const Hypothesis& found,
                                            const std::vector<Candidate>& candidates,
                                            const std::vector<Levels>& levels, double scale);

}  // namespace gear3k::calibrate
