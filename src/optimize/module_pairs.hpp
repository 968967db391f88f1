#pragma once
// Bounds of tooth sets whose modules are chosen from lists: with both modules given the stages are
// tied by their centre distance.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "optimize/progress.hpp"
#include "optimize/stage_combination.hpp"
#include "optimize/stage_relaxer.hpp"

namespace gear3k::optimize {

/// The modules that one refinement runs with [m]: empty = continuous.
using FixedModules = std::array<std::optional<double>, 2>;

/// Every choice of modules that a specification allows.
std::vector<FixedModules> module_combinations(const Specification& spec);

/// A bound of one choice of modules.
struct ModuleBound {
  std::optional<std::size_t> pair;  ///< of module_combinations(); empty: of any
  SetBound bound;
};

/// Bounds of one tooth set over its pairs of modules.
struct TiedBound {
  bool known = false;
  std::optional<Infeasibility> infeasible;  ///< of the pair that misses least
  double eta_b = 0.0, eta_f = 0.0;          ///< the greatest of all pairs
};

/// For every module of its list a stage is relaxed anew, with the limits that are lengths as that
/// module has them, in cells of its centre distance.  A pair of modules ties the stages,
///   d = m1 · (distance 1 in modules) = m2 · (distance 2 in modules)   [m],
/// so that its bound is the greatest over those cells of both stages that share a distance.
/// Source: own derivation, docs/theory §32.
class ModulePairs {
 public:
  /// Whether a specification has bounds, and lists of modules in both stages.
  static bool ties(const Specification& spec);

  /// @param stage1, stage2  relaxed for any module; all arguments must outlive it
  ModulePairs(const Specification& spec, std::span<const Candidate> candidates,
              const StageKeys& keys, std::span<const RelaxedStage1> stage1,
              std::span<const RelaxedStage2> stage2);

  /// Relaxes what bound() and in_order() need of these tooth sets; OpenMP over stages.
  /// @param sets  not proven infeasible
  /// @param most_distance  greatest of any stage 1 [modules]
  /// @param counted  whether the progress counts the stages
  /// @returns whether all of them are prepared; false when the progress was stopped
  bool prepare(std::span<const std::uint32_t> sets, double most_distance, Progress& progress,
               bool counted);

  /// @param k  one of the prepared sets
  [[nodiscard]] TiedBound bound(std::size_t k) const;
  /// The pairs of a prepared set that may have a feasible design, by falling bound, then by falling
  /// modules, with the points near it.
  [[nodiscard]] std::vector<ModuleBound> in_order(std::size_t k) const;
  /// The greatest bound of all pairs, their common distances divided until it is nearly reached.
  /// @param enough  ends the work when the bound of the efficiency that decides is not above it
  [[nodiscard]] SetBound sharpened(std::size_t k, double enough) const;

 private:
  static constexpr std::size_t kCells = 6;
  /// Least losses in a cell of stage 1 by level; infinite where it has no design.
  struct Losses {
    double sun = kInfinity, ring = kInfinity, weighted = kInfinity;
  };
  struct Profile1 {
    std::optional<Infeasibility> infeasible;
    std::array<std::array<Losses, kMostLevels>, kCells> cell{};
  };
  struct Profile2 {
    std::optional<Infeasibility> infeasible;
    std::array<std::array<double, kMostLevels>, kCells> cell{};
  };
  /// A stage with one of its modules.
  template <class Profile>
  struct Module {
    double m = 0.0;
    Specification spec;
    std::unique_ptr<StageRelaxer> relaxer;
    std::vector<std::unique_ptr<Profile>> of;  ///< by key; null: not needed so far
  };
  struct Pair {
    std::size_t combination, place1, place2;  ///< of module_combinations() and of each stage's list
    double m1, m2;
  };
  /// The common centre distances of a pair [m]; empty when there are none.
  [[nodiscard]] Interval common_distance(std::size_t k, const Pair& pair) const;
  /// Cell of the stage's distances.
  [[nodiscard]] static Interval cell_of(const Interval& distances, std::size_t cell);
  [[nodiscard]] Profile1 profile1(const Module<Profile1>& module, std::size_t key) const;
  [[nodiscard]] Profile2 profile2(const Module<Profile2>& module, std::size_t key) const;
  /// Both stages relaxed where they share these distances [m].
  [[nodiscard]] SetBound relaxed(std::size_t k, const Pair& pair, const Interval& distance_m,
                                 const RelaxationEffort& effort) const;
  /// What pair bounds have in common.
  struct PairResult {
    double eta_b = 0.0, eta_f = 0.0;
    Interval distance_m{};  ///< of the best cells
    std::optional<Infeasibility> infeasible;
  };
  [[nodiscard]] PairResult result_of(std::size_t k, const Pair& pair) const;

  const Specification* spec_;
  std::span<const Candidate> candidates_;
  const StageKeys* keys_;
  std::span<const RelaxedStage1> stage1_;
  std::span<const RelaxedStage2> stage2_;
  double most_distance_ = 0.0;
  std::size_t levels_ = 1;
  bool forward_ = false;
  std::vector<Pair> pairs_;
  std::vector<Module<Profile1>> modules1_;
  std::vector<Module<Profile2>> modules2_;
};

}  // namespace gear3k::optimize
