#pragma once
// What searches within limits have found of each tooth set, and what follows for narrower limits.

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "optimize/refined_set.hpp"

namespace gear3k::optimize {

/// One objective sought within limits on all, in costs (less is better).
struct CostAsk {
  std::size_t first = 0;       ///< of the objectives
  std::vector<double> limits;  ///< one for each objective; infinite where there is none
};

/// The designs that searches found of tooth sets, by what they were asked.
///
/// Of a set that was asked for within wider limits, nothing is to be refined again where it had no
/// design, where its design keeps the narrower limits as well, or where the least of one objective
/// that it had is above what is allowed now.  Answers are those of local refinements, as searches
/// are.
/// Source: own derivation, docs/theory §12 ("Pareto front").
class SetAnswers {
 public:
  struct Objectives {
    std::vector<Objective> each;
    /// What a least cost may be beyond a limit of it, and still leave a design within.
    std::vector<double> slack;
  };
  /// @param spec  must outlive it
  SetAnswers(const Specification& spec, Objectives objectives);

  /// Takes refined sets of an ask; those that failed or were not refined say nothing, and of grids
  /// that were cut short only the design counts.
  /// @param sets  must outlive it
  void take(const CostAsk& ask, std::span<const RefinedSet> sets);
  /// The same for sets that do not last.
  void keep(const CostAsk& ask, std::span<const RefinedSet> sets);

  /// What is known of a set; empty: it is to be refined.  Without a design: no_feasible_found.
  [[nodiscard]] std::optional<RefinedSet> answer(const CostAsk& ask,
                                                 const Candidate& candidate) const;
  /// The least that a set costs by the ask's first objective, as searches within wider limits found
  /// it: no less is within narrower ones.  Minus infinity where none was, infinite where there is
  /// no design.
  [[nodiscard]] double least_cost(const CostAsk& ask, const Candidate& candidate) const;
  /// The best design of any set that keeps the limits of an ask.
  [[nodiscard]] std::optional<RefinedSet> best_within(const CostAsk& ask) const;

  [[nodiscard]] std::vector<double> costs_of(const RefinedSet& set) const;

 private:
  struct Known {
    std::size_t ask = 0;
    const RefinedSet* set = nullptr;  ///< null: none
    bool optimal = false;  ///< else a design beside which a better one may be: it answers nothing
    std::vector<double> costs;
  };
  void add(std::size_t ask, const RefinedSet& set);

  const Specification* spec_;
  Objectives objectives_;
  std::vector<CostAsk> asks_;
  std::map<Candidate, std::vector<Known>> known_;
  std::deque<RefinedSet> kept_;
};

}  // namespace gear3k::optimize
