#pragma once
// The table of how right `diagnose` is, out of records of diagnosed campaigns.

#include <string>
#include <vector>

#include "benchmarks/rate_record.hpp"

namespace gear3k::benchmarks {

/// Share of campaigns, claims or parameters, or a value beside what is asked.
struct TableLine {
  std::string part{}, what{};
  int count = 0, hits = 0;
  /// Instead of a share where `value` is not NaN: a difference or a ratio, with its interval.
  double value = 0.0, low = 0.0, high = 0.0;
  /// Right names alone; -1: not asked of this line.
  int names = -1;
  double least = 0.0, most = 0.0;  ///< asked, percent (of values: as they are); NaN: nothing
  bool by_upper = false;           ///< what is asked is asked of the upper end of the interval
};

/// Whether a line of the rig has a law of friction whose reference point is free.
bool has_free_reference(const std::string& line);

std::vector<TableLine> must_show_table(const std::vector<RateRecord>& records);
/// Aligned, so that it is read as text as well.
std::string markdown_of(const std::vector<TableLine>& table);
/// As counts, which the other function reads again.
std::string csv_of(const std::vector<TableLine>& table);
/// @throws std::runtime_error for a line that is cut off
std::vector<TableLine> table_of_csv(const std::string& text);

}  // namespace gear3k::benchmarks
