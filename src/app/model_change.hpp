#pragma once
// What an extended model changes in the best design of a specification.

#include "app/optimize.hpp"

namespace gear3k::app {

/// How many models are drawn for an interval: its ends then scatter by about 0.05 standard
/// deviations of the value.
inline constexpr std::uint64_t kModelDraws = 2000;

/// Optimises without the task's model, and judges that best design and the one with the model by
/// all of the model at the task's operating point, in both drive directions.
///
/// Intervals are from the 5 % to the 95 % quantile of what models drawn from the parameters'
/// covariance give (calibrate::ParameterDraws, seed solver.seed), the designs held: they hold for
/// the causes that the model names.
/// Does not account for: the choice of causes, and that the design was chosen by the same model.
/// Source: own derivation, docs/theory §30.
/// @param task  with a model
/// @param found  of optimize() with it
/// @param progress  may be watched, and ends the search by its `stop`
/// @returns without a change, and why, where a list of objectives asks for a front, a search found
///   nothing or was ended, or the model needs an operating point that nothing states
report::ModelComparison compare_with_model(const OptimizeTask& task, const Optimization& found,
                                           optimize::Progress& progress);

}  // namespace gear3k::app
