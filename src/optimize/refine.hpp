#pragma once
// Refines one tooth set.

#include <atomic>
#include <optional>
#include <span>
#include <vector>

#include "optimize/refined_set.hpp"
#include "optimize/refinement_problem.hpp"
#include "optimize/set_bounds.hpp"

namespace gear3k::optimize {

/// The nonlinear programmes of a specification, prepared once for all of its tooth sets: one for
/// each choice of modules, number of planets and branch of the paper's lost motion.
class Refiner {
 public:
  explicit Refiner(const Specification& spec);

  /// Refines a tooth set that its bounds have not ruled out: every choice of modules whose bound
  /// is above what is found before, several starts each (the first where the bound lies), the best
  /// feasible end; when no start ends feasible, one more from the point of least violation.
  /// Thread-safe; the result depends on the arguments alone.
  /// @param bounds  of SetBounds::by_modules()
  /// @returns empty when `stop` became true before the set was done
  [[nodiscard]] std::optional<RefinedSet> refine(const Candidate& candidate,
                                                 const ShiftRanges& shifts,
                                                 std::span<const ModuleBound> bounds,
                                                 const std::atomic<bool>& stop) const;

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

}  // namespace gear3k::optimize
