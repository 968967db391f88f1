#pragma once
// How long a run has still to go, all of its phases together.

#include <cstddef>
#include <optional>

#include "optimize/progress.hpp"
#include "optimize/work_rate.hpp"

namespace gear3k::optimize {

/// What Progress holds at one moment.
struct ProgressSeen {
  Progress::Phase phase = Progress::Phase::kSearch;
  Progress::Stage stage = Progress::Stage::kOne;
  Progress::Plan plan;
  std::size_t done = 0, total = 0, stage_done = 0, stage_total = 0, searches = 0;
  std::size_t sets = 0, first_stages = 0, empty_first = 0, empty_second = 0;
  std::size_t open = 0, feasible = 0;
};
ProgressSeen seen_of(const Progress& progress);

/// Time that a run has left, over the phase that runs and those that follow.
///
/// What a run does is counted in units of its own speed: stages bounded, sets refined, bounds
/// sharpened, gearboxes built.  A unit costs what those done so far did; before any is done, so
/// many times what bounding a stage that has a design took.  How many sets are refined follows from
/// the shares of stages without a design; what is not known ahead (how many of the sets may still
/// win, how many bounds are sharpened, searches beyond the ends of ranges or without limits) makes
/// it a range.  Searches of a front count by their own times as these come to be known.
/// Source: own derivation; the costs are measured, docs/theory §12 ("Time left").
/// Accuracy: what is left lies within the range, or within a factor of two of its middle where that
/// is told alone, in most looks from a tenth of a run on, for tasks of the kind measured there.
class RunForecast {
 public:
  void observe(double now_s, const ProgressSeen& seen);
  /// Of the phase that runs.
  [[nodiscard]] std::optional<double> per_second() const { return rate_.per_second(); }
  struct Range {
    double least_s = 0.0, most_s = 0.0;
    /// Whether its middle says it alone.
    [[nodiscard]] bool is_one() const;
    [[nodiscard]] double middle_s() const;  ///< as many times least as most is times it
  };
  /// Until the run ends; empty while nothing is known.
  [[nodiscard]] std::optional<Range> range_left() const;
  /// Its middle.
  [[nodiscard]] std::optional<double> seconds_left() const;

 private:
  /// Time that items of one kind took.
  struct Work {
    double time_s = 0.0;
    std::size_t items = 0;
    [[nodiscard]] double each_s() const {
      return items > 0 ? time_s / static_cast<double>(items) : 0.0;
    }
    /// The same with some items that took what is expected of them.
    [[nodiscard]] double each_s(double expected_s, double weight) const {
      return (weight * expected_s + time_s) / (weight + static_cast<double>(items));
    }
  };
  void account(double now_s, const ProgressSeen& seen);
  [[nodiscard]] double stage_s() const;
  [[nodiscard]] double set_s() const;
  [[nodiscard]] double sharpening_s() const;
  [[nodiscard]] double search_s() const;
  [[nodiscard]] double front_search_s() const;
  [[nodiscard]] double built_after_s() const;
  [[nodiscard]] bool certifies() const;
  [[nodiscard]] std::optional<Range> range_now() const;
  [[nodiscard]] std::optional<Range> rest_of_search() const;
  [[nodiscard]] std::optional<Range> rest_of_first() const;
  [[nodiscard]] Range after_bounds() const;
  void add_passes(Range& left) const;
  void add_front(Range& left) const;

  bool begun_ = false;
  double last_s_ = 0.0, search_began_s_ = 0.0, phase_began_s_ = 0.0, item_began_s_ = 0.0;
  ProgressSeen last_;
  WorkRate rate_;           ///< of the phase
  double finding_s_ = 0.0;  ///< search and bounds of the latest search of all sets
  double found_s_ = 0.0;    ///< of the latest that is over
  Work stages_;             ///< with a design; all of the time that bounding took
  Work& refined_in(Progress::Stage stage) {
    const bool limited =
        stage == Progress::Stage::kFrontEnds || stage == Progress::Stage::kFrontGaps;
    return limited ? limited_ : first_;
  }
  Work first_, limited_;        ///< sets, in the first search and in those within limits
  Work sharpened_;              ///< bounds
  double gaps_s_ = 0.0;         ///< in the gaps of a front, with the searches begun there
  double longest_gap_s_ = 0.0;  ///< of one of them
  std::size_t gap_searches_ = 0;
  std::optional<Range> told_;  ///< what was known last, and when
  double told_at_s_ = 0.0;
  double built_s_ = 0.0;  ///< with gearboxes in the searches for built ones
  double after_began_s_ = 0.0;
  double passes_s_ = 0.0;  ///< in searches for built gearboxes that ended
};

}  // namespace gear3k::optimize
