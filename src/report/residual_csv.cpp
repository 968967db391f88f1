#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/condition_columns.hpp"
#include "report/diagnosis_report.hpp"
#include "report/display.hpp"
#include "report/series_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using calibrate::Diagnosis, calibrate::MeasurementSet, calibrate::RowResult;

/// The columns that any of the sets states, each once.
std::vector<ConditionColumn> all_columns(const std::vector<MeasurementSet>& sets) {
  std::vector<ConditionColumn> result;
  for (const MeasurementSet& set : sets) {
    for (const ConditionColumn& column : stated_columns(set)) {
      if (std::ranges::find(result, column.name, &ConditionColumn::name) == result.end()) {
        result.push_back(column);
      }
    }
  }
  return result;
}

/// 12 significant digits: less than rounding on the way through SI units, more than any sensor.
std::string clean_number(double value) { return exact(clean(value)); }

void add_rows(std::string& text, const Diagnosis& d, const MeasurementSet& set,
              const std::vector<ConditionColumn>& columns, bool gearboxes) {
  const ResponseText response = response_text(set.kind);
  const std::vector<ConditionColumn>& own = condition_columns(set.kind);
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    const calibrate::Observation& row = set.rows[k];
    const RowResult& result = d.rows[k];
    const auto file = static_cast<std::size_t>(row.file);
    std::vector<std::string> fields{
        std::string(calibrate::kKindNames[static_cast<std::size_t>(set.kind)]),
        file < set.files.size() ? set.files[file] : "", fmt::format("{}", row.line)};
    fields.reserve(columns.size() + 14);
    for (const ConditionColumn& column : columns) {
      const auto at = std::ranges::find(own, column.name, &ConditionColumn::name);
      fields.push_back(at == own.end() ? "" : condition_text(*at, row.condition, set.runs));
    }
    const auto add = [&](double si) { fields.push_back(clean_number(si / response.si)); };
    fields.emplace_back(response.unit);
    add(row.response);
    add(result.baseline);
    add(row.response - result.baseline);
    add(result.extended);
    add(row.response - result.extended);
    add(result.holdout);
    add(row.response - result.holdout);
    add(result.sigma);
    fields.push_back(result.block < 0 ? "" : fmt::format("{}", result.block));
    fields.emplace_back(result.outlier ? "1" : "0");
    if (gearboxes) fields.push_back(gearbox_of(set, row));
    text += csv_line(fields);
  }
}

}  // namespace

std::string residual_csv(const std::vector<Diagnosis>& diagnoses,
                         const std::vector<MeasurementSet>& sets) {
  require_matching(diagnoses, sets);
  const std::vector<ConditionColumn> columns = all_columns(sets);
  std::vector<std::string> header{"kind", "file", "line"};
  header.reserve(columns.size() + 14);
  for (const ConditionColumn& column : columns) header.emplace_back(column.name);
  for (const char* name :
       {"unit", "measured", "baseline", "residual_baseline", "extended", "residual_extended",
        "holdout", "residual_holdout", "sigma", "block", "outlier"}) {
    header.emplace_back(name);
  }
  const bool gearboxes =
      std::ranges::any_of(sets, [](const MeasurementSet& set) { return !set.units.empty(); });
  if (gearboxes) header.emplace_back("gearbox");
  std::string text = csv_line(header);
  for (std::size_t k = 0; k < sets.size(); ++k) {
    add_rows(text, diagnoses[k], sets[k], columns, gearboxes);
  }
  return text;
}

}  // namespace gear3k::report
