#include "optimize/shift_grid.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "optimize/lattice.hpp"

namespace gear3k::optimize {

namespace {

constexpr std::size_t kMostRelaxations = 20'000;

class GridSearch {
 public:
  GridSearch(const RefinementProblem& problem, double to_beat, const std::atomic<bool>& stop)
      : problem_(problem),
        stop_(stop),
        shifts_(*problem.spec->shift_step, units::Unit::kModules),
        best_(to_beat) {}

  GridEnd run(const SolveOutcome& free) {
    LatticeBox whole;
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      whole.push_back({shifts_.first_from(problem_.lower[i]), shifts_.last_to(problem_.upper[i])});
    }
    if (std::ranges::any_of(whole, [](const auto& axis) { return axis[0] > axis[1]; })) {
      return beside_the_box(free);
    }
    BoxNode root{.box = whole, .relaxed = {}};
    root.relaxed = feasible(free) && holds(whole, free.v) ? free : relax(whole, free.v);
    if (!feasible(root.relaxed)) {
      end_.held = confined(whole);
      end_.outcome = root.relaxed;
      return std::move(end_);
    }
    offer(root);
    search_boxes(
        {.relax = [&](const LatticeBox& box, const Point& start) { return relax(box, start); },
         .steps_at = [&](std::size_t axis, const Point& v) { return shifts_.count(v[axis]); },
         .axis_to_cut =
             [&](const BoxNode& node) {
               std::array<double, train::kGearCount> steps{};
               for (std::size_t i = 0; i < steps.size(); ++i) {
                 steps[i] = shifts_.count(node.relaxed.v[i]);
               }
               return farthest_axis(node.box, steps);
             },
         .offer = [&](const BoxNode& node) { offer(node); },
         .can_win = [&](const BoxNode& node) { return can_win(node); },
         .cut = [&] { return cut(); }},
        std::move(root));
    end_.complete = !cut();
    return std::move(end_);
  }

 private:
  /// The grid point next to an end, where the box has none: it misses what confines the shifts.
  GridEnd beside_the_box(const SolveOutcome& free) {
    RefinementProblem held = with_all_rows(problem_);
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      held.lower[i] = held.upper[i] = shifts_.at(shifts_.nearest(free.v[i]));
    }
    ++end_.relaxations;
    end_.outcome = best_within(held, free.v);
    end_.held = std::move(held);
    return std::move(end_);
  }
  static bool feasible(const SolveOutcome& outcome) {
    return outcome.violation <= design::kFeasibilityTolerance;
  }
  [[nodiscard]] bool cut() const {
    return stop_.load(std::memory_order_relaxed) || end_.relaxations >= kMostRelaxations;
  }
  [[nodiscard]] bool can_win(const BoxNode& node) const {
    return feasible(node.relaxed) && node.relaxed.objective < best_ - kBetterOnLattice;
  }
  /// Whether the shifts of a point are within a box.
  [[nodiscard]] bool holds(const LatticeBox& box, const Point& v) const {
    for (std::size_t i = 0; i < box.size(); ++i) {
      if (v[i] < shifts_.at(box[i][0]) || v[i] > shifts_.at(box[i][1])) return false;
    }
    return true;
  }

  [[nodiscard]] RefinementProblem confined(const LatticeBox& box) const {
    RefinementProblem p = problem_;
    for (std::size_t i = 0; i < box.size(); ++i) {
      p.lower[i] = shifts_.at(box[i][0]);
      p.upper[i] = shifts_.at(box[i][1]);
    }
    return p;
  }

  SolveOutcome relax(const LatticeBox& box, const Point& start) {
    ++end_.relaxations;
    return best_within(confined(box), start);
  }

  /// Takes the point of a box next to its relaxed one, with the other values refined for it.
  void offer(const BoxNode& node) {
    if (!can_win(node)) return;
    LatticeBox point = node.box;
    for (std::size_t i = 0; i < point.size(); ++i) {
      const long at =
          std::clamp(shifts_.nearest(node.relaxed.v[i]), node.box[i][0], node.box[i][1]);
      point[i] = {at, at};
    }
    ++end_.relaxations;
    RefinementProblem held = confined(point);
    const SolveOutcome outcome = best_within(held, node.relaxed.v);
    if (feasible(outcome)) {
      if (!(outcome.objective < best_)) return;
      best_ = outcome.objective;
      end_.found = true;
    } else if (end_.found || (end_.held && !(outcome.violation < end_.outcome.violation))) {
      return;
    }
    end_.outcome = outcome;
    end_.held = std::move(held);
  }

  const RefinementProblem& problem_;
  const std::atomic<bool>& stop_;
  Multiples shifts_;
  double best_;
  GridEnd end_;
};

}  // namespace

GridEnd best_on_grid(const RefinementProblem& problem, const SolveOutcome& free, double to_beat,
                     const std::atomic<bool>& stop) {
  return GridSearch(problem, to_beat, stop).run(free);
}

}  // namespace gear3k::optimize
