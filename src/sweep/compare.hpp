#pragma once
// What changed in the results of a sweep, and why.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sweep/rows.hpp"

namespace gear3k::sweep {

/// What is before: results of revisions up to `revision`, or found before `time_s` (seconds since
/// 1970).
struct Since {
  std::optional<std::int64_t> revision;
  std::optional<double> time_s;
};
/// A revision ("3"), or a date or time of UTC as SQLite reads it ("2026-11-25 18:00").
/// @returns nothing for a text that is neither
std::optional<Since> since_of(const std::string& text);
/// What --since may be.
inline constexpr const char* kAllowedSince =
    "a revision of the models, as 3, or a time of UTC, as 2026-11-25 or \"2026-11-25 18:00\"";

/// Merits whose difference is at most this share of the greater one are the same.
inline constexpr double kSameMerit = 1e-6;

enum class Change { kSame, kBetter, kWorse, kNewlyFeasible, kNewlyInfeasible };
/// How a task's result changed: status and merit before and after.
Change change_of(const std::string& status_before, double merit_before,
                 const std::string& status_after, double merit_after);

struct Comparison {
  std::int64_t same = 0, better = 0, worse = 0, newly_feasible = 0, newly_infeasible = 0;
  /// Results after without one before, and the other way round.
  std::int64_t only_after = 0, only_before = 0;
  Rows changes;  ///< a row for each pair that is not the same
  /// Whether anything is worse than it was.
  [[nodiscard]] bool any_worse() const { return worse + newly_infeasible > 0; }
};

/// Pairs each result after with that before of the same question; where there is none, with that of
/// a run of the same name and axes at the same values of its axes, whose other keys differ: the
/// cause is the revision, or these keys.
/// @throws io::InvalidInput for a revision above those of all results, where there are none
Comparison compare(const Database& database, const Since& since);

/// Its counts in a line.
std::string counts_text(const Comparison& comparison);

}  // namespace gear3k::sweep
