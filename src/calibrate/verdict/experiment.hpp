#pragma once
// The measurement that would tell explanations apart.

#include <optional>
#include <string>
#include <vector>

#include "calibrate/search/search.hpp"
#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {

/// An explanation of the data: a fit and what it is called.
struct Explanation {
  std::string id;
  Fit fit;
  std::string body = {};  ///< where several bodies of the cause are in question
  /// What is left of each other one without the cause in question: where it is true, the others
  /// fit as well with none of it, so that only they are taken as true against it.
  bool is_rest = false;
};

/// Chooses up to four conditions, within the limits of the options, after which the explanations
/// would differ most, each refitted to old and new rows together.  Pairs that no such measurement
/// can tell apart are named and left out of the choice.
/// @param scale  standard deviation of the whitened rows
NextExperiment plan_experiment(const Problem& problem, const std::vector<Explanation>& explanations,
                               double scale, const DiagnoseOptions& options);

/// What separates the explanations of the weightiest part of the discrepancy that has several.
/// @param effects  of the result, with the probability that no cause is behind them; those of
///     `hypothesis` and `found`
/// @param scale  of the treatment of outliers, as of fit()
/// @param noise  standard deviation of the whitened rows
std::optional<NextExperiment> next_experiment(const Problem& problem, const Hypothesis& hypothesis,
                                              const std::vector<FoundEffect>& found,
                                              const std::vector<Effect>& effects, double scale,
                                              double noise, const DiagnoseOptions& options);

}  // namespace gear3k::calibrate
