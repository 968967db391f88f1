#include "report/experiment_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "report/condition_columns.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

using calibrate::Diagnosis, calibrate::NextExperiment;

std::string experiment_table(const Diagnosis& d) {
  if (!d.next_experiment) return "";
  const NextExperiment& next = *d.next_experiment;
  std::string text =
      next.separates.size() == 1
          ? fmt::format("\nNext experiment, to tell where {} acts", next.separates[0])
          : fmt::format("\nNext experiment, to tell apart {}", fmt::join(next.separates, ", "));
  if (next.expected_statistic > 0.0) {
    text += fmt::format(" (expected chi-square {:.3g}; 9 tells them apart)",
                        clean(next.expected_statistic));
  }
  text += "\n";
  std::vector<ConditionColumn> columns;
  for (const ConditionColumn& column : condition_columns(d.kind)) {
    if (column.name == "run" || column.name == "time_s") continue;
    const bool stated = std::ranges::any_of(next.conditions, [&](const auto& proposed) {
      return std::isfinite(column.value(proposed.condition));
    });
    if (stated) columns.push_back(column);
  }
  if (!next.conditions.empty()) {
    const bool reference = std::ranges::any_of(
        next.conditions, [](const auto& c) { return c.condition.reference_sensor; });
    std::vector<std::string> header;
    header.reserve(columns.size() + 2);
    for (const ConditionColumn& column : columns) header.emplace_back(column.name);
    if (reference) header.emplace_back("sensor");
    header.emplace_back("repeats");
    TextTable table(header);
    for (const auto& proposed : next.conditions) {
      std::vector<std::string> row;
      row.reserve(header.size());
      for (const ConditionColumn& column : columns) {
        const double value = column.value(proposed.condition);
        row.push_back(column.name == "direction" ? condition_text(column, proposed.condition, {})
                      : std::isfinite(value)     ? fmt::format("{:.5g}", value)
                                                 : "");
      }
      if (reference) {
        row.emplace_back(proposed.condition.reference_sensor ? "reference" : "as before");
      }
      row.push_back(fmt::format("{}", proposed.repeats));
      table.add(row);
    }
    text += table.text(2);
  }
  if (!next.advice.empty()) text += fmt::format("  {}\n", next.advice);
  return text;
}

}  // namespace gear3k::report
