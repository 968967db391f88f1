#include "optimize/shift_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "optimize/grid_distances.hpp"
#include "optimize/lattice.hpp"
#include "optimize/one_variable.hpp"

namespace gear3k::optimize {

namespace {

class GridSearch {
 public:
  GridSearch(const RefinementProblem& problem, double to_beat, const StopFlag& stop)
      : problem_(problem),
        stop_(stop),
        shifts_(*problem.spec->shift_step, units::Unit::kModules),
        distances_(GridDistances::of(problem, shifts_)),
        best_(to_beat) {}

  GridEnd run(const SolveOutcome& free) {
    LatticeBox whole;
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      whole.push_back({shifts_.first_from(problem_.lower[i]), shifts_.last_to(problem_.upper[i])});
    }
    if (std::ranges::any_of(whole, [](const auto& axis) { return axis[0] > axis[1]; })) {
      return missed_at(with_all_rows(problem_), nearest_to(free.v), free.v);
    }
    BoxNode root;
    root.box = whole;
    const auto left = left_of(root.box);
    if (!left) return missed_at(problem_, nearest_to(free.v, whole), free.v);
    root.relaxed = free.feasible() && holds(root.box, free.v) ? free : root_end(*left, free.v);
    root.bound = root.relaxed.objective;
    if (!root.relaxed.feasible()) {
      end_.held = confined(root.box);
      end_.outcome = root.relaxed;
      return std::move(end_);
    }
    offer(root);
    end_.cut = !search_boxes(
        {.relax = [&](const BoxNode& from, BoxNode& half) { relax(from, half); },
         .steps_at = [&](std::size_t axis, const Point& v) { return shifts_.count(v[axis]); },
         .axis_to_cut =
             [&](const BoxNode& node) {
               std::array<double, train::kGearCount> steps{};
               for (std::size_t i = 0; i < steps.size(); ++i) {
                 steps[i] = shifts_.count(node.relaxed.v[i]);
               }
               return gains_.best_axis(node.box, steps);
             },
         .offer = [&](const BoxNode& node) { offer(node); },
         .can_win = [&](const BoxNode& node) { return can_win(node); },
         .cut = [&] { return cut(); },
         .learn = [&](const BoxNode& node, std::size_t axis,
                      const std::array<BoxNode, 2>& halves) { learn(node, axis, halves); },
         .best_first = true},
        std::move(root));
    if (!end_.found && end_.held) {
      // Points of boxes were given up early: what the nearest one misses is asked for in full.
      const SolveOutcome full = best_within(*end_.held, end_.outcome.v);
      if (full.feasible()) {
        if (full.objective < best_) {
          end_.outcome = full;
          end_.found = true;
        }
      } else {
        end_.outcome = full;
      }
    }
    return std::move(end_);
  }

 private:
  using Steps = std::array<long, train::kGearCount>;

  [[nodiscard]] Steps nearest_to(const Point& v) const {
    Steps steps{};
    for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = shifts_.nearest(v[i]);
    return steps;
  }
  [[nodiscard]] Steps nearest_to(const Point& v, const LatticeBox& box) const {
    Steps steps = nearest_to(v);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      steps[i] = std::clamp(steps[i], box[i][0], box[i][1]);
    }
    return steps;
  }

  /// The end of a grid that is proven empty: what one point misses, where no design is to be beaten
  /// (else nobody asks).
  GridEnd missed_at(RefinementProblem held, const Steps& steps, const Point& start) {
    if (std::isfinite(best_)) return std::move(end_);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      held.lower[i] = held.upper[i] = shifts_.at(steps[i]);
    }
    end_.outcome = best_within(held, start);
    end_.held = std::move(held);
    return std::move(end_);
  }

  /// The best of the whole grid's box, from an end and, where that finds none, from the middle.
  SolveOutcome root_end(const RefinementProblem& problem, const Point& start) {
    ++end_.relaxations;
    const SolveOutcome first = best_within(problem, start);
    if (first.feasible()) return first;
    ++end_.relaxations;
    const SolveOutcome again = best_within(problem, middle_of(problem));
    return again.feasible() ? again : first;
  }

  [[nodiscard]] bool cut() const {
    return stop_.load(std::memory_order_relaxed) ||
           end_.relaxations >= problem_.spec->solver.grid_relaxations;
  }
  [[nodiscard]] bool can_win(const BoxNode& node) const {
    return node.bound < best_ - kBetterOnLattice;
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

  /// The best of a half without what is proven to have no feasible point; where none is found from
  /// the end of the box that was cut, the search begins once more in the middle.
  void relax(const BoxNode& from, BoxNode& half) {
    half.relaxed = {.v = from.relaxed.v, .objective = 0.0, .violation = kInfinity};
    const auto problem = left_of(half.box);
    if (!problem) return;
    ++end_.relaxations;
    half.relaxed = end_of(*problem, from.relaxed.v);
    if (!half.relaxed.feasible() && !only_free_variable(*problem)) {
      ++end_.relaxations;
      const SolveOutcome again = best_within(*problem, middle_of(*problem), true);
      if (again.feasible()) half.relaxed = again;
    }
    if (half.relaxed.feasible()) half.bound = half.relaxed.objective;
  }

  /// The problem of a box, from which what is proven to have no feasible point is taken off.
  /// @returns empty where nothing is left
  [[nodiscard]] std::optional<RefinementProblem> left_of(LatticeBox& box) const {
    if (!distances_) return confined(box);
    const auto angle_rad = distances_->confine(box);
    if (!angle_rad) return std::nullopt;
    RefinementProblem p = confined(box);
    const double least = std::clamp(angle_rad->lo, p.lower[kAngleA], p.upper[kAngleA]);
    p.upper[kAngleA] = std::clamp(angle_rad->hi, least, p.upper[kAngleA]);
    p.lower[kAngleA] = least;
    return p;
  }

  static Point middle_of(const RefinementProblem& problem) {
    Point v{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
      v[k] = 0.5 * (problem.lower[k] + problem.upper[k]);
    }
    return v;
  }

  static SolveOutcome end_of(const RefinementProblem& problem, const Point& start) {
    if (const auto axis = only_free_variable(problem)) {
      return solve_one_variable(problem, *axis, start);
    }
    return best_within(problem, start, true);
  }

  void learn(const BoxNode& node, std::size_t axis, const std::array<BoxNode, 2>& halves) {
    const double steps = shifts_.count(node.relaxed.v[axis]);
    for (const bool up : {false, true}) {
      const SolveOutcome& half = halves[up ? 1 : 0].relaxed;
      gains_.add(
          axis, up, steps,
          half.feasible() ? std::optional(half.objective - node.relaxed.objective) : std::nullopt);
    }
  }

  /// Takes the point of a box next to its relaxed one, with the other values refined for it.
  void offer(const BoxNode& node) {
    if (!can_win(node)) return;
    const Steps steps = nearest_to(node.relaxed.v, node.box);
    LatticeBox point = node.box;
    bool whole = true;
    for (std::size_t i = 0; i < point.size(); ++i) {
      whole = whole && node.box[i][0] == node.box[i][1];
      point[i] = {steps[i], steps[i]};
    }
    if (!whole && !offered_.insert(steps).second) return;
    const auto left = left_of(point);
    if (!left && end_.held) return;
    // What holds the distance there is a row too: the problem as it was made goes on from here.
    RefinementProblem held = confined(point);
    SolveOutcome outcome = node.relaxed;
    if (!whole) {
      ++end_.relaxations;
      outcome = end_of(left ? *left : held, node.relaxed.v);
    }
    if (outcome.feasible()) {
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
  const StopFlag& stop_;
  Multiples shifts_;
  std::optional<GridDistances> distances_;
  double best_;
  std::set<Steps> offered_;
  CutGains gains_{train::kGearCount};
  GridEnd end_;
};

}  // namespace

GridEnd best_on_grid(const RefinementProblem& problem, const SolveOutcome& free, double to_beat,
                     const StopFlag& stop) {
  return GridSearch(problem, to_beat, stop).run(free);
}

}  // namespace gear3k::optimize
