#include "calibrate/measurement/left_out_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace gear3k::calibrate {

namespace {

template <class Value>
void remove_marked(std::vector<Value>& values, const std::vector<char>& marked) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (marked[k] == 0) values[kept++] = values[k];
  }
  values.resize(kept);
}

}  // namespace

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
  remove_marked(set.rows, marked);
  for (Covariate& covariate : set.covariates) remove_marked(covariate.value, marked);
}

}  // namespace gear3k::calibrate
