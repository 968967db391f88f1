#pragma once
// The whole task: search the tooth sets, bound them, refine those that may win, pick the best.

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "optimize/pareto.hpp"
#include "optimize/progress.hpp"
#include "optimize/refine.hpp"
#include "optimize/refined_set.hpp"
#include "optimize/set_bounds.hpp"
#include "optimize/specification.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// Sets refined between two looks at the best: few at first, when it is still poor; each wave has
/// twice as many as the one before, up to the second number.
inline constexpr std::size_t kFirstWave = 32, kWave = 128;

struct OptimizeOptions {
  /// Refines only sets whose bound reaches the best that was found; else all.
  bool best_only = false;
  /// Whether a search for the best alone also proves what no design is above: see Certificate.
  bool certify = true;
  /// With a certificate: goes on to prove the best of every number of planets, too.
  bool per_planets = false;
  /// Ends with the first wave that has a design.
  bool any = false;
  /// No further wave is begun when so many sets are refined.
  std::size_t most_refined = std::numeric_limits<std::size_t>::max();
  /// Sets that an earlier run refined, by rising index: they are taken as they are.
  std::vector<RefinedSet> known{};
  /// Called with the sets of a wave, known ones left out, when all of them are done.
  std::function<void(std::span<const RefinedSet>)> on_wave{};
  /// What is known of a set without refining it; called from many threads.
  std::function<std::optional<RefinedSet>(const Candidate&)> answer{};
  /// A design of a set to begin its refinement with, null where none is known; called from many
  /// threads.
  std::function<const KnownTrain*(const Candidate&)> design{};
  /// A design to begin with: only sets that may be better are of interest.
  std::optional<RefinedSet> incumbent{};
  /// A bound of merit_of() that is known of a set before its stages are relaxed: those that it
  /// rules out are left out of the search altogether, others are refined in its order where it is
  /// below the stages' own; called from many threads.
  std::function<double(const Candidate&)> bound_before{};
};

/// What the bounds prove of a result, for the specification's model (its search space, its checks
/// as inequalities, its loss model): a feasible design of an unrefined tooth set has at most
/// `largest_unrefined_bound`, any design at most `global_bound`.
struct Certificate {
  double best = 0.0;  ///< merit_of() the best design, as are the bounds
  std::size_t refined = 0, bounded = 0, infeasible = 0;
  /// Largest bound of the sets that were bounded away; empty when there is none.
  std::optional<double> largest_unrefined_bound;
  /// Largest bound of all sets, those of the refined ones that could still hold something better
  /// than the best sharpened.
  double global_bound = 0.0;
  bool objective_bounded = true;  ///< else the bounds are infinite: nothing bounds the objective
  /// Refined sets whose sharpened bound is above the best by more than kProven: their optima are
  /// local, and they might hold something better.
  std::size_t open = 0;
  /// Refined sets the search of whose grids of shifts was cut short: what is proven is the bounds',
  /// which know no grid.
  std::size_t grid_cut = 0;
  /// Limits of the load that the bounds know of, and those that they leave out.
  std::vector<std::string_view> strength_bounded, strength_not_bounded;
};
/// What counts as nothing in a certificate, in units of the objective's scale.
inline constexpr double kProven = 1e-6;

/// The certificate of the sets of a number of planets, as if there were no others; best is minus
/// infinity where none of them was refined to a design.
struct PlanetsCertificate {
  int planets = 0;
  Certificate proof;
};

/// Its bounds look into its own candidates: it may be moved, not copied.
struct OptimizeResult {
  OptimizeResult() = default;
  OptimizeResult(OptimizeResult&&) = default;
  OptimizeResult& operator=(OptimizeResult&&) = default;
  OptimizeResult(const OptimizeResult&) = delete;
  OptimizeResult& operator=(const OptimizeResult&) = delete;
  ~OptimizeResult() = default;

  ToothSearchResult search;
  /// Of the candidates; null when the search was interrupted.
  std::shared_ptr<const SetBounds> bounds;
  std::vector<RefinedSet> refined;  ///< by rising index
  std::optional<RefinedSet> best;
  std::vector<std::size_t> pareto;  ///< indices into `refined`, see pareto_front()
  std::optional<Certificate> certificate;
  /// Of OptimizeOptions::per_planets, by rising number; an interrupted run has those it came to.
  std::vector<PlanetsCertificate> by_planets;
  bool interrupted = false;
};

/// What is known of candidate k: as refined, proven infeasible or bounded; empty when it was not
/// reached.
std::optional<RefinedSet> set_at(const OptimizeResult& result, std::size_t k);

/// Calls visit(k, set) for every candidate in the order of the search; `set` is empty where the run
/// did not get to it.
void for_each_set(const OptimizeResult& result,
                  const std::function<void(std::size_t, const std::optional<RefinedSet>&)>& visit);

/// What merit_of() any feasible design of a set can have at most; minus infinity where a limit on
/// an objective is out of its reach.
double merit_bound(const Specification& spec, const SetBound& bound, const Candidate& candidate);

/// Searches, bounds and refines, OpenMP over stages and tooth sets, in waves of fixed order: the
/// result does not depend on the number of threads.  Ties, to ObjectiveRecord::resolution, go to
/// the set that comes first.
/// @param spec  must outlive the result
/// @throws std::invalid_argument for best_only where a calibrated model judges the sets: the bounds
///   are those of the model without it; and unless has_bounds(spec)
OptimizeResult optimize(const Specification& spec, Progress& progress,
                        const OptimizeOptions& options = {});

}  // namespace gear3k::optimize
