#include "calibrate/verdict/session_conditions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>

namespace gear3k::calibrate {

namespace {

/// Whether each session has one level, and not all the same.
bool is_told_by_session(const MeasurementSet& data, const Levels& levels) {
  constexpr int kNone = -2;
  std::vector<int> of_session(data.runs.size(), kNone);
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const int run = data.rows[i].condition.run;
    if (run < 0 || levels.of[i] < 0) return false;
    int& level = of_session[static_cast<std::size_t>(run)];
    if (level != kNone && level != levels.of[i]) return false;
    level = levels.of[i];
  }
  std::erase(of_session, kNone);
  return std::ranges::adjacent_find(of_session, std::ranges::not_equal_to()) != of_session.end();
}

}  // namespace

std::vector<Levels> conditions_by_session(const MeasurementSet& data,
                                          const std::vector<Levels>& levels) {
  constexpr std::size_t kFewestRows = 3;
  std::vector<Levels> result;
  if (data.runs.size() < 2 || data.rows.size() < kFewestRows * data.runs.size()) return result;
  for (const Levels& condition : levels) {
    // Time tells sessions apart by itself.
    const bool in_time = condition.name == "time" || condition.name == "session time" ||
                         condition.name == "cycles" || condition.name == "run" ||
                         condition.name == "angle";
    // Rooms differ by some kelvin.
    constexpr double kRoom_K = 5.0;
    const auto [least, most] = std::ranges::minmax(condition.at);
    const bool of_a_room = condition.name == "temperature" && most - least < kRoom_K;
    if (!in_time && !of_a_room && !condition.binned && is_told_by_session(data, condition)) {
      result.push_back(condition);
    }
  }
  return result;
}

std::string note_on_sessions(const Levels& condition) {
  return fmt::format(
      "every session has one {0} ({1:.4g}): what is named after sessions or time may be a law of "
      "the {0}; measured at two of them within one session it would show",
      condition.name, fmt::join(condition.at, ", "));
}

}  // namespace gear3k::calibrate
