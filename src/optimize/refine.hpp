#pragma once
// Refines one tooth set.

#include <optional>
#include <span>
#include <vector>

#include "optimize/refined_set.hpp"
#include "optimize/refinement_problem.hpp"
#include "optimize/set_bounds.hpp"
#include "optimize/stop_flag.hpp"

namespace gear3k::optimize {

/// A point of a tooth set to begin with.
struct KnownTrain {
  train::TrainParameters<double> train;
  LoadAt<double> load;
};

/// What is known of a tooth set before it is refined.
struct KnownOfSet {
  /// merit_of() that is of no use: a set whose grid has nothing above it is bounded.
  double to_beat = -kInfinity;
  /// A feasible design: one more start of every problem, the last, so that none is given up that
  /// has one.  Must outlive the call.
  const KnownTrain* design = nullptr;
};

/// The best end of a set's starts.
struct BestOfSet {
  double merit = -kInfinity;  ///< merit_of(); minus infinity where no end is feasible
  KnownTrain at;
};

/// The nonlinear programmes of a specification, prepared once for all of its tooth sets: one for
/// each choice of modules, number of planets and branch of the paper's lost motion.
class Refiner {
 public:
  explicit Refiner(const Specification& spec);

  /// Refines a tooth set that its bounds have not ruled out: every choice of modules whose bound
  /// is above what is found before, several starts each (the first where the bound lies), the best
  /// feasible end; when no start ends feasible, one more from the point of least violation.
  /// Thread-safe; the result depends on the arguments alone.
  ///
  /// Where shifts are on a grid, the optimum of every choice with free shifts bounds what its grid
  /// points can have.  Of cutters to choose from, the optimum without what they have a say in
  /// bounds all of them.  These optima are local: what they leave out is not proven to be no
  /// better.
  /// @param bounds  of SetBounds::by_modules()
  /// @returns empty when `stop` became true before the set was done
  [[nodiscard]] std::optional<RefinedSet> refine(const Candidate& candidate,
                                                 const ShiftRanges& shifts,
                                                 std::span<const ModuleBound> bounds,
                                                 const StopFlag& stop,
                                                 const KnownOfSet& known = {}) const;

  /// The best end that a set's starts find, which is not polished: the last starts first, and no
  /// more where two ended alike.
  /// @returns empty when `stop` became true before that
  [[nodiscard]] std::optional<BestOfSet> best_end(const Candidate& candidate,
                                                  const ShiftRanges& shifts,
                                                  const StopFlag& stop) const;

 private:
  const Specification* spec_;
  struct Prototype {
    std::size_t modules = 0;  ///< of module_combinations()
    RefinementProblem problem;
  };
  std::vector<Prototype> prototypes_;  ///< without a tooth set
};

/// Refines one tooth set by itself.
RefinedSet refine(const Specification& spec, const Candidate& candidate);
/// @returns empty when `stop` became true before it was done
std::optional<RefinedSet> refine(const Specification& spec, const Candidate& candidate,
                                 const StopFlag& stop, const KnownOfSet& known = {});

}  // namespace gear3k::optimize
