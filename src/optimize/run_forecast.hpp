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
  std::size_t open = 0, feasible = 0;
};
ProgressSeen seen_of(const Progress& progress);

/// Time that a run has left, over the phase that runs and those that follow.
///
/// The phase that runs goes on as WorkRate has it.  What follows is counted in searches of the
/// whole space, each of which costs some refinements at the mean of those that were made and a
/// share of the time that the first search took to find and bound its sets; searches of a front
/// count by their own times as these come to be known. What is not known ahead (searches beyond the
/// ends of ranges or without limits, how often limits for built gearboxes are sought, what sets
/// cost of which none was refined) makes it a range.
/// Source: own derivation; the shares are measured, docs/theory §12 ("Time left").
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
  [[nodiscard]] double search_s() const;
  [[nodiscard]] double front_search_s() const;
  [[nodiscard]] std::optional<Range> range_now() const;
  [[nodiscard]] std::optional<double> rest_of_search_s() const;
  [[nodiscard]] std::optional<double> rest_of_first_s(const std::optional<double>& left) const;
  void add_passes(Range& left) const;
  void add_front(Range& left) const;

  bool begun_ = false;
  double last_s_ = 0.0, search_began_s_ = 0.0;
  ProgressSeen last_;
  WorkRate rate_;           ///< of the phase
  double finding_s_ = 0.0;  ///< search and bounds of the latest search of all sets
  struct Refined {
    double time_s = 0.0;
    std::size_t sets = 0;
    [[nodiscard]] double each_s() const {
      return sets > 0 ? time_s / static_cast<double>(sets) : 0.0;
    }
  };
  Refined& refined_in(Progress::Stage stage) {
    const bool limited =
        stage == Progress::Stage::kFrontEnds || stage == Progress::Stage::kFrontGaps;
    return limited ? limited_ : first_;
  }
  Refined first_, limited_;  ///< in the first search, and in those within limits
  double gaps_s_ = 0.0;      ///< in the gaps of a front, with the searches begun there
  std::size_t gap_searches_ = 0;
  std::optional<Range> told_;  ///< what was known last, and when
  double told_at_s_ = 0.0;
  double built_s_ = 0.0;  ///< with gearboxes in these searches
  double after_began_s_ = 0.0;
  double passes_s_ = 0.0;  ///< in searches for built gearboxes that ended
};

}  // namespace gear3k::optimize
