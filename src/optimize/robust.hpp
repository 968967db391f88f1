#pragma once
// Limits that hold for the built gearboxes, not for the drawn one.

#include <functional>
#include <optional>
#include <vector>

#include "backlash/monte_carlo.hpp"
#include "optimize/refined_set.hpp"
#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// How gearboxes built to a design turn out.
struct BuiltOutcome {
  double yield = 0.0, jammed = 0.0, beyond_limit = 0.0;  ///< shares of all
  std::optional<double> limit_of_99_percent_rad;         ///< empty: more than 1 % jam
  double greatest_rad = 0.0;                             ///< lost motion in the worst case
  double least_margin_m = 0.0;  ///< of assembly, in the worst case; negative: it may jam
  bool checks_hold = false;     ///< every check at the corners of the tolerances
};

/// One search of all tooth sets under tightened limits.
struct RobustPass {
  /// Part of the way from the stated limits of backlash (0) to those that keep the worst case (1).
  double share = 0.0;
  design::Limits limits;
  std::optional<RefinedSet> best;  ///< empty: nothing is feasible under these limits
  std::size_t grid_cut = 0;        ///< see SearchOutcome
  /// Of the best; empty where the tolerances leave one of its meshes without a working angle.
  std::optional<BuiltOutcome> outcome;
};

struct RobustResult {
  std::vector<RobustPass> passes;  ///< the first with the limits as stated
  /// Index of the pass whose best design holds as asked for and has the best merit; empty: none.
  std::optional<std::size_t> chosen;
  bool interrupted = false;
};

/// What a search of a specification found.
struct SearchOutcome {
  std::optional<RefinedSet> best;
  bool interrupted = false;
  std::size_t grid_cut = 0;  ///< sets whose grids were not searched to the end
};

/// Finds limits under which the best design holds as spec.robust asks.
///
/// The best design under the stated limits shows how much each check loses at its worst corner, how
/// far the lost motion and the room of assembly go in the worst case. The limits are tightened by
/// that and the search repeated (not where its tolerances leave no gearbox at all to measure by):
///
///   worst case: until the best design holds in the worst case, each pass adding what is missing;
///   yield:      the least share t of the tightening of lost motion and normal backlash that
///               reaches the yield, by bisection; every other check holds at its worst corner.
///
/// Tightening does not depend on the design in the search itself: among the designs under these
/// limits the best is found (and may be certified), but a design elsewhere could need less.
/// The lost motion of built gearboxes is the kinematic one, at one position of the turn.
/// Built gearboxes are drawn with spec.sampling, at most kRobustSamples of them.
/// Source: own derivation, docs/theory §35.
/// @param search  the best design of a specification; empty where there is none; it may ask to stop
///   by returning interrupted
RobustResult robust_limits(const Specification& spec,
                           const std::function<SearchOutcome(const Specification&)>& search);
inline constexpr std::uint64_t kRobustSamples = 200'000;

/// Searches that robust_limits() makes at most; 0 where nothing is to hold for built gearboxes.
std::size_t most_robust_passes(Hold hold);

/// How gearboxes built to a design of this specification turn out.
/// @param seed  of the random gearboxes
/// @throws std::invalid_argument without tolerances, and where at an end of the centre distance's
///   limits a mesh has no working pressure angle: such gearboxes are none
BuiltOutcome built_outcome(const design::Design& design, std::uint64_t samples, std::uint64_t seed);

/// Whether every check but those of backlash holds at the corners of the design's tolerances.
bool checks_hold(const design::Design& design);

}  // namespace gear3k::optimize
