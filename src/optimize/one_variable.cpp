#include "optimize/one_variable.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "optimize/gradients.hpp"

namespace gear3k::optimize {

namespace {

constexpr double kMissed = 1e-9;      ///< a row below it is missed
constexpr double kSameValue = 1e-12;  ///< of the variable
constexpr double kInside = 1e-7;      ///< of the variable: a look from a limit inwards
constexpr int kMostSteps = 60, kMostRounds = 4, kBetween = 3, kPlaces = 16;
/// Rows farther from their limits wait until they are missed; less for those that need tooth forms.
constexpr double kNearMargin = 0.3, kNearCostlyMargin = 0.05;

/// A search along one variable by some of the rows.
class AlongOne {
 public:
  AlongOne(const RefinementProblem& problem, std::size_t axis, Gradients& at)
      : problem_(problem), axis_(axis), n_(static_cast<std::size_t>(problem.variables)), at_(at) {}

  /// @returns whether the rows are met at the end
  bool search(Point& v, std::span<const std::uint16_t> selection) {
    Side low{.at = problem_.lower[axis_]}, high{.at = problem_.upper[axis_]};
    int between = 0;
    bool looked_inside = false;
    stuck_ = false;
    std::optional<double> defined, met;  // where it was so last
    const auto end = [&] {
      if (met) v[axis_] = *met;
      return met.has_value();
    };
    for (int step = 0; step < kMostSteps; ++step) {
      double& x = v[axis_];
      if (!evaluate_gradients(problem_, used(problem_, v), selection, at_)) {
        // A step left what the model is defined for: half of it back.
        if (!defined) return false;
        (x > *defined ? high : low) = {.at = x, .tried = true};
        x = 0.5 * (*defined + x);
        if (std::abs(x - *defined) <= kSameValue) return end();
        continue;
      }
      defined = x;
      const Pull pull = missed();
      const bool is_missed = pull.up < 0.0 || pull.down < 0.0 || pull.flat;
      double next = x;
      if (is_missed && met) {
        // What rows say so far from where they were met proves nothing: towards that place.
        const bool back_rises = *met > x;
        (back_rises ? low : high) = {.at = x, .tried = true};
        next = x + pull.step;
        const bool between_both = back_rises ? x < next && next < *met : *met < next && next < x;
        if (!between_both) next = 0.5 * (x + *met);
        if (std::abs(next - *met) <= kSameValue) return end();
        x = next;
        continue;
      }
      if (!is_missed) met = x;
      if (pull.up < 0.0 && pull.down < 0.0) {
        if (++between > kBetween) return false;
        next = std::clamp(x + pull.meet, low.at, high.at);
        if (std::abs(next - x) <= kSameValue) return false;
        x = next;
        continue;
      }
      if (is_missed && pull.step == 0.0) {
        stuck_ = true;
        return false;
      }
      const double slope = at_.df[axis_];
      const bool rises = is_missed ? pull.up < 0.0 : slope < 0.0;
      Side& behind = rises ? low : high;
      const Side& ahead = rises ? high : low;
      const Side before = behind;
      behind = {.at = x, .tried = true, .slope = is_missed ? 0.0 : slope};
      if (is_missed) {
        next = x + pull.step;
      } else {
        const double free_way = blocked(rises, ahead.at - x);
        if (std::abs(free_way) <= kSameValue && !looked_inside) {
          // The slope at a row's limit may be that of what lies beyond it, as where the limit of a
          // contact ratio is where another number of teeth begins to share the load.
          looked_inside = true;
          const double inside = std::clamp(x + (rises ? -kInside : kInside), problem_.lower[axis_],
                                           problem_.upper[axis_]);
          if (inside != x) {
            behind = before;
            x = inside;
            continue;
          }
        }
        next = x + free_way;
        if (low.slope < 0.0 && high.slope > 0.0) {
          const double level = low.at - low.slope * (high.at - low.at) / (high.slope - low.slope);
          if (rises ? level < next : level > next) next = level;
        }
        if (slope == 0.0 || std::abs(next - x) <= kSameValue) return true;
      }
      if (rises ? next >= ahead.at : next <= ahead.at) {
        next = ahead.tried ? 0.5 * (low.at + high.at) : ahead.at;
      }
      if (std::abs(next - x) <= kSameValue) return !is_missed;
      x = next;
    }
    return end();
  }

  /// Whether the last search ended at a row that is missed and does not change there.
  [[nodiscard]] bool is_stuck() const { return stuck_; }

 private:
  /// An end of the bracket: that of the range, until a point is tried.
  struct Side {
    double at = 0.0;
    bool tried = false;
    double slope = 0.0;  ///< of the objective there; 0 where a row is missed, or none was tried
  };
  struct Pull {
    double up = 0.0, down = 0.0;  ///< the rows missed most that rise, and that fall; 0: none
    double step = 0.0;            ///< to where all of one side are met
    double meet = 0.0;            ///< to where the two missed most are missed alike
    bool flat = false;            ///< a row is missed that does not change here
  };
  [[nodiscard]] Pull missed() const {
    Pull pull;
    double up_slope = 0.0, down_slope = 0.0;
    for (std::size_t k = 0; k < at_.g.size(); ++k) {
      const double g = at_.g[k], slope = at_.dg[k * n_ + axis_];
      if (!(g < -kMissed)) continue;
      if (slope == 0.0) {
        pull.flat = true;
        continue;
      }
      double& most = slope > 0.0 ? pull.up : pull.down;
      if (g < most) {
        most = g;
        (slope > 0.0 ? up_slope : down_slope) = slope;
      }
      if (std::abs(g / slope) > std::abs(pull.step)) pull.step = -g / slope;
    }
    if (up_slope > 0.0 && down_slope < 0.0) {
      pull.meet = (pull.down - pull.up) / (up_slope - down_slope);
    }
    return pull;
  }
  /// How far the rows let it go, to first order, at most `most`.
  [[nodiscard]] double blocked(bool rises, double most) const {
    double far = most;
    for (std::size_t k = 0; k < at_.g.size(); ++k) {
      const double slope = at_.dg[k * n_ + axis_];
      if (rises ? slope >= 0.0 : slope <= 0.0) continue;
      const double to = -std::max(0.0, at_.g[k]) / slope;
      if (rises ? to < far : to > far) far = to;
    }
    return far;
  }

  const RefinementProblem& problem_;
  std::size_t axis_, n_;
  Gradients& at_;
  bool stuck_ = false;
};

}  // namespace

std::optional<std::size_t> only_free_variable(const RefinementProblem& problem) {
  std::optional<std::size_t> free;
  for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
    if (!(problem.lower[k] < problem.upper[k])) continue;
    if (free) return std::nullopt;
    free = k;
  }
  return free;
}

SolveOutcome solve_one_variable(const RefinementProblem& problem, std::size_t axis,
                                const Point& start) {
  thread_local Gradients at;
  thread_local std::vector<double> values;
  thread_local std::vector<std::uint16_t> selection;
  values.resize(problem.rows.size());
  Point v = problem.lower;
  v[axis] = std::clamp(start[axis], problem.lower[axis], problem.upper[axis]);
  SolveOutcome outcome = outcome_at(problem, v, values);
  const auto select = [&](double near, double near_costly) {
    const std::size_t before = selection.size();
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto& check = problem.rows[k].check;
      const bool costly = check && (check->record->tooth_form || check->record->rating);
      const auto row = static_cast<std::uint16_t>(k);
      if (values[k] < (costly ? near_costly : near) &&
          !std::ranges::binary_search(
              selection.begin(), selection.begin() + static_cast<std::ptrdiff_t>(before), row)) {
        selection.push_back(row);
      }
    }
    std::ranges::sort(selection);
    return selection.size() > before;
  };
  selection.clear();
  if (std::isfinite(outcome.violation)) {
    select(kNearMargin, kNearCostlyMargin);
  } else {
    selection = all_rows(problem);
  }
  AlongOne along(problem, axis, at);
  const auto is_feasible = [](const SolveOutcome& of) {
    return of.violation <= design::kFeasibilityTolerance;
  };
  // Rows that nobody looked at let a round go far: the next one begins where the first did.
  const auto refine = [&](const Point& begin) {
    for (int round = 0; round < kMostRounds; ++round) {
      v = begin;
      const bool met = along.search(v, selection);
      outcome = outcome_at(problem, v, values);
      if (is_feasible(outcome)) return;
      if (!std::isfinite(outcome.violation)) {
        selection = all_rows(problem);
      } else if (!met || !select(-design::kFeasibilityTolerance, -design::kFeasibilityTolerance)) {
        return;
      }
    }
  };
  const SolveOutcome first = outcome;
  refine(Point(v));
  if (!is_feasible(outcome) && (along.is_stuck() || !std::isfinite(outcome.violation))) {
    // Nothing said where to: from the best of some places of the range.
    SolveOutcome best = outcome;
    for (int k = 1; k < kPlaces; ++k) {
      v[axis] = problem.lower[axis] + (problem.upper[axis] - problem.lower[axis]) * k / kPlaces;
      const SolveOutcome place = outcome_at(problem, v, values);
      if (place.violation < best.violation) best = place;
    }
    if (best.violation < outcome.violation) {
      selection = all_rows(problem);
      refine(best.v);
      if (best.violation < outcome.violation) outcome = best;
    }
  }
  return !is_feasible(outcome) && is_feasible(first) ? first : outcome;
}

}  // namespace gear3k::optimize
