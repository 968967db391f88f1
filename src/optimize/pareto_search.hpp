#pragma once
// The Pareto front of a task over all of its tooth sets and their shifts, modules and distances.

#include <span>
#include <vector>

#include "optimize/optimizer.hpp"

namespace gear3k::optimize {

struct ParetoPoint {
  RefinedSet set;
  std::vector<double> values;  ///< of the specification's objectives, SI
};

/// Designs of which none is worse than another in every objective.
struct ParetoFront {
  std::vector<ParetoPoint> points;  ///< from best to worst by the first objective
  /// Best value of each objective alone, and its worst among the designs that are best in another.
  std::vector<double> ideal, reference;
  /// Share of the box between ideal and reference that the points dominate, see hypervolume().
  double hypervolume = 0.0;
  std::size_t searches = 0;  ///< searches of the whole space that were made
  bool interrupted = false;
};

/// Searches the front by limits on all objectives but the first (ε-constraints).
///
/// Each objective alone gives its best value and, by the designs that are best in the others, the
/// range over which it matters.  Over a grid of limits within these ranges, pareto_points in all,
/// the first objective is optimised over the whole space, tooth sets whose bounds are not good
/// enough left out: every point is the best that any tooth set has within its limits, as far as
/// the refinement of a set finds its optimum.  What other points dominate is dropped.
/// Source: Haimes, Lasdon, Wismer, 1971 (ε-constraint method).
/// @param spec  with two objectives or more; must outlive the call only
/// @param known  designs that are offered to the front besides; those without an optimum are not
/// @param progress  its stop ends the search, keeping the points found
ParetoFront search_pareto_front(const Specification& spec, Progress& progress,
                                std::span<const RefinedSet> known = {});

/// Volume of the part of the unit cube that points dominate, coordinates 0 = best, 1 = worst.
///
///   V = |∪_p [p, 1]|
///
/// Source: by slices along the last coordinate (exact); cost grows as n^d.
/// @returns 0 for no points; coordinates outside [0, 1] are clipped
double hypervolume(std::vector<std::vector<double>> points);

}  // namespace gear3k::optimize
