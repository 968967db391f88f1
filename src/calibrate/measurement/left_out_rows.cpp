#include "calibrate/measurement/left_out_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "calibrate/measurement/row_selection.hpp"

namespace gear3k::calibrate {

std::string line_list(const std::vector<int>& lines) {
  constexpr std::size_t kShown = 10;
  const std::size_t shown = std::min(kShown, lines.size());
  std::string text = fmt::format(
      "{} {}", lines.size() == 1 ? "line" : "lines",
      fmt::join(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (shown < lines.size()) text += fmt::format(" and {} more", lines.size() - shown);
  return text;
}

std::string places_of(const MeasurementSet& set, const std::vector<char>& marked) {
  std::string text;
  for (std::size_t file = 0; file < set.files.size(); ++file) {
    std::vector<int> lines;
    for (std::size_t k = 0; k < set.rows.size(); ++k) {
      if (marked[k] != 0 && static_cast<std::size_t>(set.rows[k].file) == file) {
        lines.push_back(set.rows[k].line);
      }
    }
    if (lines.empty()) continue;
    if (!text.empty()) text += "; ";
    text += fmt::format("{}: {}", set.files[file], line_list(lines));
  }
  return text;
}

void leave_out(MeasurementSet& set, const std::vector<char>& marked) {
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < marked.size(); ++k) {
    if (marked[k] == 0) kept.push_back(k);
  }
  set = select_rows(set, kept);
  drop_empty_runs(set);
}

}  // namespace gear3k::calibrate
