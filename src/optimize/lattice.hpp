#pragma once
// Branch and bound over boxes of a lattice.

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "optimize/solve_outcome.hpp"
#include "units/units.hpp"

namespace gear3k::optimize {

/// Multiples of a step, as numbers of few digits in the unit of files.
class Multiples {
 public:
  Multiples(double step_si, units::Unit unit);
  [[nodiscard]] double at(long k) const;
  /// How many steps a value is.
  [[nodiscard]] double count(double si) const { return si / step_si_; }
  [[nodiscard]] long nearest(double si) const;
  [[nodiscard]] long first_from(double si) const;
  [[nodiscard]] long last_to(double si) const;

 private:
  units::Unit unit_;
  double step_, step_si_;
};

/// Multiples that a box has of each axis, both ends included.
using LatticeBox = std::vector<std::array<long, 2>>;

/// A box with the best of it where all values are free.
struct BoxNode {
  LatticeBox box;
  SolveOutcome relaxed;
  /// Of the objective of its points; infinite: it has none.
  double bound = std::numeric_limits<double>::infinity();
};

/// What cuts at each axis were worth, its pseudocosts: the mean gain of the relaxed objective for
/// each step that the cut took off its axis, downwards and upwards.  The axis to cut has the
/// greatest product of the gains expected of both halves; an axis without cuts takes the mean of
/// all.  No half is relaxed to try an axis (strong or reliability branching).
/// Source: Achterberg, Koch, Martin, Branching rules revisited, 2005 (pseudocost branching, product
/// score).
class CutGains {
 public:
  explicit CutGains(std::size_t axes) : of_(axes) {}
  /// @param steps  where the axis was, in steps; the half beyond it begins at the next multiple
  /// @param gain  what the relaxed optimum became worse by; empty: the half has no feasible point
  void add(std::size_t axis, bool up, double steps, std::optional<double> gain);
  /// The axis whose worse half and better half promise most together, of those off their
  /// multiples; else as farthest_axis().
  [[nodiscard]] std::optional<std::size_t> best_axis(const LatticeBox& box,
                                                     std::span<const double> steps) const;

 private:
  struct Mean {
    double sum = 0.0;
    int count = 0;
  };
  [[nodiscard]] double expected(std::size_t axis, bool up, double off) const;
  std::vector<std::array<Mean, 2>> of_;
  Mean all_;
};

/// What a search over boxes asks of its problem.
struct BoxProblem {
  /// Finds the best of a half with all values free, from that of the box that it was cut from, and
  /// its bound; may take off the half what has no feasible point.
  std::function<void(const BoxNode&, BoxNode&)> relax;
  /// How many steps an axis is at a point.
  std::function<double(std::size_t, const Point&)> steps_at;
  /// The axis to cut a box at; empty for a point.
  std::function<std::optional<std::size_t>(const BoxNode&)> axis_to_cut;
  std::function<void(const BoxNode&)> offer;    ///< is told of every box
  std::function<bool(const BoxNode&)> can_win;  ///< whether a box may hold the best point
  std::function<bool()> cut;                    ///< whether the search is to end
  /// Is told of both halves of a box that was cut at an axis.
  std::function<void(const BoxNode&, std::size_t, const std::array<BoxNode, 2>&)> learn{};
  /// Of all boxes left the one of the best bound next, not the latest, of whose halves the better
  /// one comes last.
  bool best_first = false;
};

/// Cuts a box in two at an axis, next to its relaxed value, and each half in turn, as long as they
/// can win.
/// @returns whether no box is left that can win: false where `cut` ended the search before
bool search_boxes(const BoxProblem& problem, BoxNode root);
/// The same from boxes on, the last one first; what is left of them where `cut` ended it stays, so
/// that the search can go on from there.
bool search_boxes(const BoxProblem& problem, std::vector<BoxNode>& open);

/// Of the axes of which a box has more than one multiple: the one farthest between two multiples;
/// where all are on theirs, the longest; empty for a point.
/// @param steps  how many steps each axis is
std::optional<std::size_t> farthest_axis(const LatticeBox& box, std::span<const double> steps);

/// The best of a problem's box from a start near its end; where that is not feasible, from the
/// point of least violation on, which is returned where that is not feasible either.
/// @param give_up  for one of many boxes: no more is asked of one without a feasible point than
///                 that rows which were seen are missed, and bounds are less sharp (1e-11)
SolveOutcome best_within(const RefinementProblem& problem, Point start, bool give_up = false);

inline constexpr double kOnLattice = 1e-6;        ///< of a step
inline constexpr double kBetterOnLattice = 1e-7;  ///< of the scaled objective: less is no gain

}  // namespace gear3k::optimize
