#pragma once
// The best design on the lattice of what is made, near an optimum.

#include <cstddef>
#include <optional>
#include <vector>

#include "optimize/refined_set.hpp"
#include "optimize/stop_flag.hpp"

namespace gear3k::optimize {

/// A design whose shifts, modules, distance, ... are multiples of Specification::round.
struct RoundedDesign {
  Specification spec;      ///< with its modules and machining allowances
  RefinedSet set;          ///< its teeth and train; what the free optimum is rated by is not filled
  double objective = 0.0;  ///< the first objective, SI
  double violation = 0.0;  ///< largest, in scaled units
  std::vector<Miss> missed{};  ///< where that is beyond the tolerance: the limits, largest first
};

struct Rounding {
  /// The best that meets every check; empty: none was found.
  std::optional<RoundedDesign> best;
  /// Without one, the rounded design that misses its limits least.
  std::optional<RoundedDesign> nearest;
  std::size_t relaxations = 0;  ///< problems with some values free that were solved
  std::size_t points = 0;       ///< rounded designs that were evaluated
  /// The search was not cut short; no proof, as relaxations are local.
  bool complete = false;
  /// Pairs of modules that were tried, and those with a design where all else is free.
  std::size_t module_pairs = 0, module_pairs_with_design = 0;
};

struct RoundingOptions {
  int module_steps = 5;  ///< modules of a range go so many steps to either side
  std::size_t most_relaxations = 20'000;
};

/// Branch and bound over the lattice: in a box of the lattice the problem with all values free
/// bounds what its points can have; the box is cut in two at the value that is farthest between two
/// points (the pressure angle first, then the centre distance) until a point is left or the bound
/// is no better than the best point.
///
/// Modules of a range take every combination within module_steps of the optimum's, series and given
/// modules stay; allowances are rounded with each.  All else has its whole range.  Combinations are
/// compared in one unit and take turns.  Relaxations are solved locally, those of a combination
/// from several starts, those of a box that could be left from two: a box whose best point no run
/// finds is lost.
/// Source: own derivation, docs/theory §12.
/// @param set  an optimum of the specification
/// @param stop  ends the search, which is not complete then
Rounding round_design(const Specification& spec, const RefinedSet& set, const StopFlag& stop,
                      const RoundingOptions& options = {});

}  // namespace gear3k::optimize
