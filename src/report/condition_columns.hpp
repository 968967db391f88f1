#pragma once
// The columns of DATA.csv that state under what a response was measured.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::report {

struct ConditionColumn {
  std::string_view name;   ///< as in DATA.csv
  std::string_view title;  ///< for axes and sentences, without the unit
  std::string_view unit;   ///< as in the name; "" = none
  /// In the column's unit; NaN = not stated.  Direction: 0 forward, 1 backward.  Run: its index.
  double (*value)(const calibrate::Condition& condition);
};

/// The columns of a kind, in the order of the interface.
const std::vector<ConditionColumn>& condition_columns(calibrate::Kind kind);

/// Those of them that any row states.
std::vector<ConditionColumn> stated_columns(const calibrate::MeasurementSet& set);

/// As DATA.csv would say it: "forward", the label of a run, a number, "" where nothing is stated.
std::string condition_text(const ConditionColumn& column, const calibrate::Condition& condition,
                           const std::vector<std::string>& runs);

/// The column that a covariate of a diagnosis means ("load", "speed", ...; or a column's name).
std::optional<ConditionColumn> column_of(std::string_view covariate, calibrate::Kind kind);

/// The response: its name in sentences, the unit of its column and SI per unit.
struct ResponseText {
  std::string_view title, unit;
  double si;
};
ResponseText response_text(calibrate::Kind kind);

}  // namespace gear3k::report
