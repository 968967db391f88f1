#include "calibrate/measurement/blank_conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/measurement/left_out_rows.hpp"

namespace gear3k::calibrate {

namespace {

/// A condition that a file need not state, and what follows it.
struct OptionalCondition {
  const ConditionQuantity* quantity;
  std::string_view followers;
};
constexpr std::array<OptionalCondition, 5> kOptionalConditions{
    {{&kTemperature, "friction, drag, a zero or a clearance that follows temperature"},
     {&kTime, "drifts and steps in time"},
     {&kCycles, "drifts with cycles"},
     {&kOutputAngle, "run-out and mesh orders"},
     {&kModule, ""}}};

/// The rows without a condition that others state.
struct LackingRows {
  const OptionalCondition* condition = nullptr;
  std::vector<char> marked;
  std::ptrdiff_t count = 0;
};

bool states(const Observation& row, const ConditionQuantity& quantity) {
  const double value = row.condition.*quantity.member;
  return &quantity == &kModule ? value > 0.0 : std::isfinite(value);
}

/// By file, whether its rows were read from a record: those state no condition that is blank.
std::vector<char> files_of_records(const MeasurementSet& set) {
  std::vector<char> of_record(set.files.size(), 0);
  for (const LoopSession& loop : set.loops) of_record[static_cast<std::size_t>(loop.file)] = 1;
  return of_record;
}

LackingRows rows_without(const MeasurementSet& set, const OptionalCondition& condition) {
  const std::vector<char> of_record = files_of_records(set);
  LackingRows lacking{.condition = &condition, .marked = std::vector<char>(set.rows.size(), 0)};
  bool some_state = false;
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    const Observation& row = set.rows[k];
    if (states(row, *condition.quantity)) {
      some_state = true;
    } else if (of_record[static_cast<std::size_t>(row.file)] == 0) {
      lacking.marked[k] = 1;
      ++lacking.count;
    }
  }
  return some_state ? lacking : LackingRows{.condition = &condition, .marked = {}};
}

/// @param rows  that could state it
std::string note_on_unused(const MeasurementSet& set, const LackingRows& lacking,
                           std::ptrdiff_t rows) {
  const std::string_view column = lacking.condition->quantity->column;
  const std::string blank =
      fmt::format("{}: {} is blank in {} of {} rows, more than a fifth",
                  places_of(set, lacking.marked), column, lacking.count, rows);
  if (lacking.condition->quantity == &kModule) {
    return blank + ": these rows count as of 1 mm, as where the column is not stated";
  }
  return fmt::format(
      "{}: the column is not used, and {} are not looked for: what they do may be told as another "
      "cause; fill the column in, or leave these rows out",
      blank, lacking.condition->followers);
}

}  // namespace

void settle_blank_conditions(MeasurementSet& set) {
  std::vector<LackingRows> all;
  for (const OptionalCondition& condition : kOptionalConditions) {
    LackingRows lacking = rows_without(set, condition);
    if (lacking.count > 0) all.push_back(std::move(lacking));
  }
  std::ranges::stable_sort(all, {}, &LackingRows::count);
  const std::vector<char> of_record = files_of_records(set);
  const auto rows = std::ranges::count_if(set.rows, [&](const Observation& row) {
    return of_record[static_cast<std::size_t>(row.file)] == 0;
  });
  const double most = kMostBlank * static_cast<double>(rows);
  std::vector<char> left_out(set.rows.size(), 0);
  for (const LackingRows& lacking : all) {
    std::vector<char> both = left_out;
    for (std::size_t k = 0; k < both.size(); ++k) {
      if (lacking.marked[k] != 0) both[k] = 1;
    }
    const auto count = std::ranges::count(both, 1);
    const ConditionQuantity& quantity = *lacking.condition->quantity;
    if (static_cast<double>(count) <= most) {
      left_out = std::move(both);
      set.notes.push_back(fmt::format(
          "{}: {} left out, {} is blank and other rows state it", places_of(set, lacking.marked),
          lacking.count == 1 ? "1 row" : fmt::format("{} rows", lacking.count), quantity.column));
    } else if (range_of(set, quantity.member).varies()) {
      set.notes.push_back(note_on_unused(set, lacking, rows));
      set.unused.push_back(quantity.member);
    }
  }
  if (std::ranges::count(left_out, 1) > 0) leave_out(set, left_out);
}

bool is_unused(const MeasurementSet& set, const ConditionQuantity& quantity) {
  return std::ranges::find(set.unused, quantity.member) != set.unused.end();
}

ValueRange used_range(const MeasurementSet& set, const ConditionQuantity& quantity) {
  return is_unused(set, quantity) ? ValueRange{} : range_of(set, quantity.member);
}

}  // namespace gear3k::calibrate
