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
    low_ = {.at = problem_.lower[axis_]};
    high_ = {.at = problem_.upper[axis_]};
    defined_.reset();
    met_.reset();
    between_ = 0;
    looked_inside_ = stuck_ = false;
    double& x = v[axis_];
    for (int step = 0; step < kMostSteps; ++step) {
      const bool is_defined = evaluate_gradients(problem_, used(problem_, v), selection, at_);
      if (const End end = is_defined ? move(x) : back_to_defined(x)) return *end;
    }
    return end_at_met(x);
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
  /// Where the rows that are missed pull to.
  struct Pull {
    double up = 0.0, down = 0.0;  ///< the rows missed most that rise, and that fall; 0: none
    double step = 0.0;            ///< to where all of one side are met
    double meet = 0.0;            ///< to where the two missed most are missed alike
    bool flat = false;            ///< a row is missed that does not change here
    [[nodiscard]] bool any() const { return up < 0.0 || down < 0.0 || flat; }
  };
  /// Of a step: whether rows are met where the search ends; empty while it goes on, from x.
  using End = std::optional<bool>;

  [[nodiscard]] bool end_at_met(double& x) const {
    if (met_) x = *met_;
    return met_.has_value();
  }

  /// A step left what the model is defined for: half of it back.
  End back_to_defined(double& x) {
    if (!defined_) return false;
    (x > *defined_ ? high_ : low_) = {.at = x, .tried = true};
    x = 0.5 * (*defined_ + x);
    if (std::abs(x - *defined_) <= kSameValue) return end_at_met(x);
    return std::nullopt;
  }

  End move(double& x) {
    defined_ = x;
    const Pull pull = missed();
    if (!pull.any()) {
      met_ = x;
      return towards_less(x);
    }
    if (met_) return back_to_met(x, pull);
    if (pull.up < 0.0 && pull.down < 0.0) return between_two(x, pull);
    if (pull.step == 0.0) {
      stuck_ = true;
      return false;
    }
    const bool rises = pull.up < 0.0;
    (rises ? low_ : high_) = {.at = x, .tried = true};
    return go(x, x + pull.step, rises, false);
  }

  /// What rows say so far from where they were met proves nothing: towards that place.
  End back_to_met(double& x, const Pull& pull) {
    const bool rises = *met_ > x;
    (rises ? low_ : high_) = {.at = x, .tried = true};
    double next = x + pull.step;
    const bool is_between = rises ? x < next && next < *met_ : *met_ < next && next < x;
    if (!is_between) next = 0.5 * (x + *met_);
    if (std::abs(next - *met_) <= kSameValue) return end_at_met(x);
    x = next;
    return std::nullopt;
  }

  /// Rows pull to both sides: to where they are missed alike, a few times.
  End between_two(double& x, const Pull& pull) {
    if (++between_ > kBetween) return false;
    const double next = std::clamp(x + pull.meet, low_.at, high_.at);
    if (std::abs(next - x) <= kSameValue) return false;
    x = next;
    return std::nullopt;
  }

  /// All rows are met: towards less of the objective, up to the first row in the way or to where
  /// the slopes at both sides of the bracket say that it is level.
  End towards_less(double& x) {
    const double slope = at_.df[axis_];
    const bool rises = slope < 0.0;
    Side& behind = rises ? low_ : high_;
    const Side before = behind;
    behind = {.at = x, .tried = true, .slope = slope};
    const double free_way = blocked(rises, (rises ? high_ : low_).at - x);
    if (std::abs(free_way) <= kSameValue && look_inside(x, rises)) {
      behind = before;
      return std::nullopt;
    }
    double next = x + free_way;
    if (low_.slope < 0.0 && high_.slope > 0.0) {
      const double level = low_.at - low_.slope * (high_.at - low_.at) / (high_.slope - low_.slope);
      if (rises ? level < next : level > next) next = level;
    }
    if (slope == 0.0 || std::abs(next - x) <= kSameValue) return true;
    return go(x, next, rises, true);
  }

  /// The slope at a row's limit may be that of what lies beyond it, as where the limit of a contact
  /// ratio is where another number of teeth begins to share the load: a look from it inwards, once.
  bool look_inside(double& x, bool rises) {
    if (looked_inside_) return false;
    looked_inside_ = true;
    const double inside =
        std::clamp(x + (rises ? -kInside : kInside), problem_.lower[axis_], problem_.upper[axis_]);
    if (inside == x) return false;
    x = inside;
    return true;
  }

  /// Within the bracket, whose middle is next where a step would leave it.
  End go(double& x, double next, bool rises, bool is_met) const {
    const Side& ahead = rises ? high_ : low_;
    if (rises ? next >= ahead.at : next <= ahead.at) {
      next = ahead.tried ? 0.5 * (low_.at + high_.at) : ahead.at;
    }
    if (std::abs(next - x) <= kSameValue) return is_met;
    x = next;
    return std::nullopt;
  }

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
  Side low_, high_;
  std::optional<double> defined_, met_;  ///< where the model was, and all rows were, last
  int between_ = 0;                      ///< steps between rows that pull to both sides
  bool looked_inside_ = false, stuck_ = false;
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
  // Rows that nobody looked at let a round go far: the next one begins where the first did.
  const auto refine = [&](const Point& begin) {
    for (int round = 0; round < kMostRounds; ++round) {
      v = begin;
      const bool met = along.search(v, selection);
      outcome = outcome_at(problem, v, values);
      if (outcome.feasible()) return;
      if (!std::isfinite(outcome.violation)) {
        selection = all_rows(problem);
      } else if (!met || !select(-design::kFeasibilityTolerance, -design::kFeasibilityTolerance)) {
        return;
      }
    }
  };
  const SolveOutcome first = outcome;
  refine(Point(v));
  if (!outcome.feasible() && (along.is_stuck() || !std::isfinite(outcome.violation))) {
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
  return !outcome.feasible() && first.feasible() ? first : outcome;
}

}  // namespace gear3k::optimize
