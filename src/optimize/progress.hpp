#pragma once

#include <atomic>
#include <cstddef>

#include "optimize/stop_flag.hpp"

namespace gear3k::optimize {

/// Counters of a run that another thread may watch, and its switch.
struct Progress {
  enum class Phase { kSearch, kBounds, kRefinement, kCertificate, kGearboxes };
  std::atomic<Phase> phase{Phase::kSearch};
  /// What a run does after its first search.
  struct Plan {
    std::size_t front_objectives = 0, front_designs = 0;  ///< of a front that is sought
    bool front_lost_motion = false;                       ///< whether lost motion is one of them
    bool rounding = false;
    bool best_only = false;   ///< the search refines only what can still win
    std::size_t planets = 0;  ///< numbers of planets whose best is proven after it
    std::size_t told = 0;     ///< designs, at most, of which it is told what holds them back
    bool ties = false;        ///< bounds know that both stages' modules are of lists
    bool explains = false;    ///< searches follow beyond ends of ranges, or without limits
    /// Searches for limits that hold for built gearboxes, where these come first.
    std::size_t passes_least = 0, passes_most = 0;
    /// Gearboxes built at random in each of them, and after them (positions of those that turn
    /// count as gearboxes, too).
    std::size_t built_per_pass = 0, built_after = 0;
  };
  std::atomic<std::size_t> front_objectives{0}, front_designs{0};
  std::atomic<bool> front_lost_motion{false}, rounding{false}, best_only{false}, explains{false},
      ties{false};
  std::atomic<std::size_t> planets{0}, told{0}, passes_least{0}, passes_most{0};
  std::atomic<std::size_t> built_per_pass{0}, built_after{0};
  /// What the searches of a run are for, where they are several.
  enum class Stage { kOne, kFrontEnds, kFrontGaps, kBeyond, kRelaxed, kBuilt, kPlanets, kHeldBack };
  std::atomic<Stage> stage{Stage::kOne};
  std::atomic<std::size_t> stage_done{0};  ///< searches, or designs in the gaps of a front
  std::atomic<std::size_t> stage_total{0};
  std::atomic<std::size_t> searches{0};  ///< begun in this stage
  std::atomic<std::size_t> done{0};      ///< (zS, zP1) pairs searched, stages bounded, tooth sets
                                         ///< refined or their bounds sharpened, gearboxes built,
                                         ///< limits moved
  std::atomic<std::size_t> total{0};     ///< 0 until it is known
  /// Of the search: tooth sets, stages of the first kind, and stages of both without a design.
  std::atomic<std::size_t> sets{0}, first_stages{0}, second_stages{0};
  std::atomic<std::size_t> empty_first{0}, empty_second{0};
  std::atomic<std::size_t> open{0};  ///< sets that a search of all of them has to refine
  /// Of a search for the best alone, as the best of now stands: bounds of refined sets that its
  /// certificate will sharpen, and what follows for the numbers of planets whose turn is to come:
  /// sets of their first waves, and bounds of those refined.
  std::atomic<std::size_t> to_sharpen{0}, later_sets{0}, later_bounds{0};
  std::atomic<std::size_t> feasible{0};
  std::atomic<double> best_merit{0.0};       ///< meaningless while feasible is 0
  std::atomic<double> shown_per_merit{1.0};  ///< of the objective in its unit
  /// Set it to end the run, keeping what is done.  A front that is sought is a part, which who
  /// counts its time may end.
  StopFlag stop;
};

}  // namespace gear3k::optimize
