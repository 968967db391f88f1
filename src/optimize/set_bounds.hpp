#pragma once
// Upper bounds of the efficiency of every tooth set, from the least losses of its stages.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "optimize/module_pairs.hpp"
#include "optimize/progress.hpp"
#include "optimize/stage_combination.hpp"
#include "optimize/stage_relaxer.hpp"

namespace gear3k::optimize {

/// Bounds of all tooth sets of a specification; unknown unless has_bounds().
///
/// Efficiency rises with that of each mesh, so that least losses give most efficiency.  Stage 1
/// (S, P1, R1) and stage 2 (P2, R2) are relaxed apart: what ties them (the centre distance in
/// metres) is dropped, lost motion that they share is split between them in every way.  Tooth
/// sets share stages, and each stage is searched once.  With a rating the flanks of each mesh ask
/// for a module, and those of each stage for a centre distance that the other one has to have.
/// Source: own derivation, docs/theory §32, §36.
class SetBounds {
 public:
  /// Relaxes the stages of these tooth sets; OpenMP over the stages, results independent of it.
  /// @param candidates  must outlive the bounds, as must the specification
  /// @param progress  its stop ends the work early: bounds must not be asked for then
  SetBounds(const Specification& spec, std::span<const Candidate> candidates, Progress& progress);

  SetBounds(const SetBounds&) = delete;
  SetBounds& operator=(const SetBounds&) = delete;
  ~SetBounds() = default;

  /// Takes it into the bounds of these sets that modules are chosen from lists, where they are;
  /// OpenMP over stages and sets.
  /// @param counted  whether the progress counts the stages that are relaxed for it
  /// @returns whether they are tied, or nothing is to be tied; false when the progress was stopped
  bool tie(std::span<const std::uint32_t> sets, Progress& progress, bool counted = true);
  /// Whether tie() changes anything.
  [[nodiscard]] bool ties() const { return pairs_ != nullptr; }

  /// @param k  index into the candidates
  [[nodiscard]] SetBound of(std::size_t k) const;
  /// Of a set that is not infeasible: a bound for every pair of modules that may have a feasible
  /// design, the greatest first, where modules are chosen from lists and the set is tied; else one
  /// for any modules.
  [[nodiscard]] std::vector<ModuleBound> by_modules(std::size_t k) const;
  /// The bound of one set with 100 times the effort.
  /// @param enough  ends the work when the bound of the efficiency that decides is not above it
  [[nodiscard]] SetBound sharpened(std::size_t k, double enough = -kInfinity) const;
  /// Stages relaxed, of both kinds.
  [[nodiscard]] std::size_t stages() const { return stage1_.size() + stage2_.size(); }
  [[nodiscard]] const ShiftTable& shifts() const { return relaxer_.shifts(); }

 private:
  static constexpr RelaxationEffort kUsual{.weighted = {.boxes = 200, .tolerance = 0.02},
                                           .alone = {.boxes = 24, .tolerance = 0.1}};
  static constexpr RelaxationEffort kSharp{.weighted = {.boxes = 20000, .tolerance = 1e-4},
                                           .alone = {.boxes = 2000, .tolerance = 1e-3}};

  /// Proof that flanks or roots of one stage ask for a centre distance that the other cannot have.
  [[nodiscard]] std::optional<Infeasibility> loads_apart(const StageReach& stage1,
                                                         const StageReach& stage2) const;
  [[nodiscard]] SetBound untied(std::size_t k) const;
  /// Proof that the greatest efficiencies of a bound keep no limit of what is felt.
  void refuse_felt(std::size_t k, SetBound& bound) const;
  [[nodiscard]] SetBound sharpened_untied(std::size_t k, const SetBound& usual) const;
  [[nodiscard]] SetBound combine(std::size_t k, const RelaxedStage1& stage1,
                                 const RelaxedStage2& stage2) const;

  const Specification* spec_;
  std::span<const Candidate> candidates_;
  StageKeys keys_;
  StageRelaxer relaxer_;
  double most_distance_ = 0.0;  ///< of any stage 1 [modules]
  std::optional<Infeasibility> of_any_set_;
  std::vector<RelaxedStage1> stage1_;
  std::vector<RelaxedStage2> stage2_;
  std::unique_ptr<ModulePairs> pairs_;  ///< null unless modules are chosen from lists
  std::vector<TiedBound> tied_;         ///< by set; empty without pairs
};

}  // namespace gear3k::optimize
