#pragma once
// How long a run has still to go, all of its phases together.

#include <array>
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
  std::size_t sets = 0, first_stages = 0, second_stages = 0, empty_first = 0, empty_second = 0;
  std::size_t to_sharpen = 0, later_sets = 0, later_bounds = 0;
  std::size_t open = 0, feasible = 0;
};
ProgressSeen seen_of(const Progress& progress);

/// Time that a run has left, over the phase that runs and those that follow.
///
/// A run is a plan: a search of all tooth sets (or passes of it for built gearboxes), searches of a
/// front, searches with limits and ranges given way, rounding.  What a search takes is the mean of
/// those of its kind that are over; before, what is expected of it from what bounding and refining
/// took so far.  How many searches are to come is known where the plan counts them, else so many
/// for each design or limit as were needed so far.  What is only expected makes the time a range.
/// Source: own derivation; what is expected was measured or chosen, docs/theory §12 ("Time left").
/// Accuracy: benchmarks/time_left, docs/peers.md ("The time left").
class RunForecast {
 public:
  void observe(double now_s, const ProgressSeen& seen);
  /// Of the phase that runs.
  [[nodiscard]] std::optional<double> per_second() const { return rate_.per_second(); }
  struct Range {
    double least_s = 0.0, most_s = 0.0;
    /// Whether its middle says it alone.
    [[nodiscard]] bool is_one() const;
    [[nodiscard]] bool is_bound() const;  ///< whether its greater end is all that is worth telling
    /// As it is told: where it is neither one number nor a bound, a factor of two about its middle.
    [[nodiscard]] Range told() const;
    [[nodiscard]] double middle_s() const;  ///< as many times least as most is times it
  };
  /// Until the run ends; empty while nothing is known.
  [[nodiscard]] std::optional<Range> range_left() const;
  /// Its middle.
  [[nodiscard]] std::optional<double> seconds_left() const;

 private:
  using Phase = Progress::Phase;
  using Stage = Progress::Stage;
  /// Time that items of one kind took.
  struct Work {
    double time_s = 0.0, items = 0.0, longest_s = 0.0;
    double squared_s2 = 0.0;  ///< sum of the squares, of searches
    /// Of one, where so many count as done at what is expected of them; 0 while nothing is known.
    [[nodiscard]] double mean_s(double expected_s, double weight) const {
      const double all = weight + items;
      return all > 0.0 ? (weight * expected_s + time_s) / all : 0.0;
    }
  };
  void account(double passed_s, const ProgressSeen& seen);
  void count(double passed_s, const ProgressSeen& seen);
  void end_search(double now_s, const ProgressSeen& seen);
  /// Whether the passes for built gearboxes are over, and more are built.
  [[nodiscard]] bool builds_after() const;
  /// Whether all searches are.
  [[nodiscard]] bool is_over() const;
  [[nodiscard]] double stage_s() const;
  [[nodiscard]] double set_s() const;
  [[nodiscard]] double sharpening_s() const;
  [[nodiscard]] double sharpenings_s() const;
  [[nodiscard]] double front_search_s() const;
  [[nodiscard]] double scatter_of_gaps(double to_come) const;
  [[nodiscard]] double search_s(Stage stage) const;
  [[nodiscard]] double searches_left() const;
  [[nodiscard]] double built_in_pass_s() const;
  [[nodiscard]] double built_after_s() const;
  [[nodiscard]] std::optional<Range> range_now() const;
  [[nodiscard]] std::optional<Range> rest_of_search() const;
  [[nodiscard]] std::optional<Range> rest_of_first() const;
  [[nodiscard]] Range rest_of_all() const;
  [[nodiscard]] bool is_waved() const;
  [[nodiscard]] bool finds_nothing() const;
  [[nodiscard]] double left_of_wave() const;
  [[nodiscard]] double sharpened_share() const;
  [[nodiscard]] Range rest_of_best() const;
  [[nodiscard]] Range rest_of_contest() const;
  void add_contests(Range& left) const;
  void add_passes(Range& left) const;
  void add_later(Range& left) const;
  Work& searches(Stage stage) { return searches_.at(static_cast<std::size_t>(stage)); }
  [[nodiscard]] const Work& searches(Stage stage) const {
    return searches_.at(static_cast<std::size_t>(stage));
  }

  bool begun_ = false, is_explained_ = false;  ///< ranges or limits gave way
  ProgressSeen last_;
  double last_s_ = 0.0, search_began_s_ = 0.0;
  double item_began_s_ = 0.0;  ///< since when no item was done
  WorkRate rate_;              ///< of the phase
  double finding_s_ = 0.0;     ///< search and bounds of the latest search of all sets
  double found_s_ = 0.0;       ///< of the latest that is over
  double built_s_ = 0.0;       ///< with gearboxes in the passes
  Work sets_, bounds_;         ///< refined; sharpened
  /// Of stages bounded between looks: with a design n, without one m, in a time t.
  struct Moments {
    double nn = 0.0, nm = 0.0, mm = 0.0, nt = 0.0, mt = 0.0;
  };
  Moments stages_;
  double contest_sets_ = 0.0, contest_bounds_ = 0.0;  ///< of the contests that are over
  std::array<Work, 8> searches_;                      ///< that are over, by Stage
  std::optional<Range> told_;                         ///< what was known last, and when
  double told_at_s_ = 0.0;
};

}  // namespace gear3k::optimize
