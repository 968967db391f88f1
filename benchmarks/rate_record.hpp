#pragma once
// What one diagnosed campaign of a table of rates came to, as a line of a CSV.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gear3k::benchmarks {

/// A probability that was stated and whether it held.
struct StatedProbability {
  double percent = 0.0;
  bool holds = false;
};

/// A difference of a series: named, whose it is told rightly, estimated over built deviation from
/// part to part (0: none to compare).
struct SeriesPart {
  bool named = false, owner = false;
  double deviation = 0.0;
};

struct RateRecord {
  std::string line{};     ///< of the rig, commas as semicolons
  double strength = 0.0;  ///< asked, in noise
  std::uint64_t seed = 0;
  std::string plan{}, noise{}, laws{}, verdict{};
  double reached = 0.0;  ///< strength of all effects together; less than asked: physics forbids it
  bool right = false, all_right = false, wrong_name = false, false_remainder = false,
       disclosed = false, lists_excluded = false, verdict_fits = false, own_order_listed = false,
       all_orders_listed = false;
  double gain = 0.0;  ///< stated; NaN: none
  /// Error over that of the refit of one parameter on unseen rows and in a later session, without
  /// noise and as read; NaN: none.
  double unseen = 0.0, unseen_read = 0.0, later = 0.0, later_read = 0.0;
  int orders = 0, intervals = 0, inside = 0;
  std::string left_out{};  ///< same, alternative, changed; empty: not tried
  std::vector<StatedProbability> claims{};
  std::vector<SeriesPart> parts{};
  double processor_s = 0.0;
  std::string answer{};  ///< of those that are not right in all

  std::string key() const;
};

std::string rate_header();
std::string text_of(const RateRecord& record);
/// @returns nothing for comments, the header and lines that were cut off
std::optional<RateRecord> record_of(const std::string& line);
/// Of all files, each campaign once.
/// @throws std::runtime_error for a file that cannot be read
std::vector<RateRecord> read_rate_records(const std::vector<std::string>& files);

}  // namespace gear3k::benchmarks
