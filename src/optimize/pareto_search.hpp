#pragma once
// The Pareto front of a task over all of its tooth sets and their shifts, modules and distances.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "optimize/hypervolume.hpp"
#include "optimize/optimizer.hpp"

namespace gear3k::optimize {

struct ParetoPoint {
  RefinedSet set;
  std::vector<double> values;  ///< of the specification's objectives, SI
};

/// Designs of which none is worse than another in every objective.
struct ParetoFront {
  std::vector<ParetoPoint> points;  ///< from best to worst by the first objective
  /// Best value of each objective alone (or of the ends, where one is better yet), and its worst
  /// among the designs that are best in another: the box.
  std::vector<double> box_best, box_worst;
  /// The same, moved out to the points that lie beyond the box.
  std::vector<double> ideal, reference;
  /// Share of the box that the points dominate, see hypervolume().
  double hypervolume = 0.0;
  /// Share of the same box that designs not found may dominate besides, at most:
  /// FrontGaps::missing().
  double missing = 1.0;
  std::size_t searches = 0;  ///< searches of the whole space that were made
  /// Refinements in them that cut the search of a grid of shifts short.
  std::size_t grid_cut = 0;
  /// Why it ended: with the designs asked for, with less than kFrontFound missing, after
  /// kMostSearches for each design, when its time was spent (StopFlag::end_part()), when the run
  /// was stopped, or because an objective alone has no design.
  enum class Ended { kDesigns, kFound, kSearches, kBudget, kInterrupted, kNoEnds };
  Ended ended = Ended::kNoEnds;
  bool interrupted = false;
};
/// Names in result files, in the order of the enum.
inline constexpr std::array<std::string_view, 6> kFrontEndedNames{
    "designs", "found", "searches", "budget", "interrupted", "no_ends"};

/// A search of the whole space within limits.
struct FrontStep {
  std::optional<RefinedSet> best;   ///< empty: no design keeps them
  std::vector<RefinedSet> refined;  ///< the sets that it refined
};

struct FrontOptions {
  /// The first searches' results of an earlier run of the same task: they are taken as they are.
  std::span<const FrontStep> steps{};
  /// Called with what every further search found.
  std::function<void(const FrontStep&)> on_step{};
  /// A search of the same task for its first objective alone: its bounds hold within any limits,
  /// and what it found of a set is not refined again.  Its optima are no points of the front: each
  /// is the best of its own set only.
  const OptimizeResult* searched = nullptr;
};

/// Searches the front by limits on all objectives but the first (ε-constraints).
///
/// Each objective alone gives its best value and, by the designs that are best in the others, the
/// range over which it matters: the ends of the front.  Then the first objective is optimised over
/// the whole space, tooth sets whose bounds are not good enough left out, within limits where
/// FrontGaps finds the front known least, until it has pareto_points designs, or less than
/// kFrontFound of the box is missing, or the searches are kMostSearches as many.  Every point is
/// the best that any tooth set has within its limits, as far as the refinement of a set finds its
/// optimum, and then bettered() in what its search did not ask for.  What other points dominate is
/// dropped.  What searches within wider limits have found of a set is not refined again
/// (SetAnswers). Source: Haimes, Lasdon, Wismer, 1971 (ε-constraint method); own derivation,
/// docs/theory §12.
/// @param spec  with two objectives or more; must outlive the call only
/// @param progress  its stop ends the search, keeping the points found
ParetoFront search_pareto_front(const Specification& spec, Progress& progress,
                                const FrontOptions& options = {});

/// Of the box: what a front that is found may lack.
inline constexpr double kFrontFound = 1e-3;
/// For each design that is asked for.
inline constexpr int kMostSearches = 4;

}  // namespace gear3k::optimize
