#pragma once
// Where a Pareto front is known least.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gear3k::optimize {

/// The gaps of a front between designs that are known and what searches have proven.
///
/// In costs of the box between ideal (0) and reference (1), the front is a function
///
///   F(ε) = least cost of the first objective with cost_k ≤ ε_k of the others,
///
/// which falls as any ε_k grows.  The box of the ε is cut into cells; in a cell [lo, hi] no design
/// lies below F(hi), and designs that are known dominate a part of [lo, hi] × [F(hi), 1].  The rest
/// is the cell's gap: a front of which all is found leaves none, and all gaps together bound the
/// hypervolume that is missing.  The cell with the greatest gap is halved across its longest side,
/// F being searched for at the new corner.
/// Source: own derivation, docs/theory §12 ("Pareto front").
class FrontGaps {
 public:
  /// @param objectives  two or more
  explicit FrontGaps(std::size_t objectives);

  /// Takes a design that is known: its costs, of all objectives.
  void add(std::span<const double> costs);
  /// Limits of the other objectives' costs within which F is to be searched next; empty when the
  /// gaps together are no larger than `enough`.  Where what was searched answers, none is asked.
  std::optional<std::vector<double>> next(double enough);
  /// What that search found: the costs of its design; empty when there is none.
  void found(const std::optional<std::vector<double>>& costs);
  /// Sum of the gaps: the share of the box that designs not yet known may dominate at most.
  [[nodiscard]] double missing() const;

 private:
  struct Cell {
    std::vector<double> lo, hi;
    double least = 0.0;  ///< F(hi), as far as it is known: a lower bound
    double gap = 0.0;
  };
  struct Answer {
    std::vector<double> limits;
    std::optional<std::vector<double>> costs;
  };
  [[nodiscard]] double gap_of(const Cell& cell) const;
  [[nodiscard]] const Answer* known_answer(std::span<const double> limits) const;
  [[nodiscard]] std::size_t greatest() const;
  void split(const Answer& answer);

  std::vector<Cell> cells_;
  std::vector<std::vector<double>> designs_;
  std::vector<Answer> answers_;
  std::size_t cell_ = 0, side_ = 0;  ///< that are being halved
};

}  // namespace gear3k::optimize
