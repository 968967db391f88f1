// Tables over time of a SCENARIO.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "io/files/scenario_file.hpp"
#include "io/text/complaints.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

class TimeTableReader {
 public:
  TimeTableReader(const std::string& name, const std::vector<std::string>& columns)
      : name_(name), columns_(columns) {}

  void read(std::string_view text, motion::Signal& signal) {
    TextLines lines(text);
    while (lines.next()) {
      const std::string_view line = lines.line();
      line_ = lines.number();
      if (line.empty() || line.front() == '#') continue;
      if (!fields_.split(line)) {
        complain(1, "a quote is left open");
      } else if (width_ == 0) {
        read_header();
        if (!complaints_.none()) break;
      } else {
        read_row(signal);
      }
    }
    if (width_ == 0) {
      line_ = 1;
      complain(1, fmt::format("no header: allowed: columns time_s and {}", names()));
    } else if (signal.time_s.empty() && complaints_.none()) {
      complain(1, "no row below the header: allowed: one or more");
    }
    if (!complaints_.none()) throw InvalidInput(complaints_.text(name_));
  }

 private:
  void complain(int column, std::string message) {
    complaints_.add({.line = line_, .column = column}, std::move(message));
  }
  [[nodiscard]] std::string names() const { return fmt::format("{}", fmt::join(columns_, " or ")); }

  [[nodiscard]] std::optional<std::size_t> place_of(std::string_view column) const {
    const auto& values = fields_.values();
    const auto found = std::ranges::find_if(
        values, [&](std::string_view field) { return trimmed(field) == column; });
    if (found == values.end()) return std::nullopt;
    return static_cast<std::size_t>(found - values.begin());
  }

  void read_header() {
    width_ = fields_.values().size();
    if (const auto slip = wrong_separator(width_, fields_.values()[0]); !slip.empty()) {
      complain(1, std::string(slip));
      return;
    }
    const auto time = place_of("time_s");
    if (!time) complain(1, "column time_s is missing");
    std::optional<std::size_t> value;
    for (const std::string& column : columns_) {
      if (!value && (value = place_of(column))) column_ = column;
    }
    if (!value) complain(1, fmt::format("column {} is missing", names()));
    time_place_ = time.value_or(0);
    value_place_ = value.value_or(0);
  }

  std::optional<double> finite(std::size_t place, std::string_view column) {
    const std::string_view field = trimmed(fields_.values()[place]);
    const auto value = csv_number(field);
    if (value && std::isfinite(*value)) return value;
    complain(fields_.column(place),
             fmt::format("{} = \"{}\": allowed: a finite number", column, field));
    return std::nullopt;
  }

  void read_row(motion::Signal& signal) {
    if (fields_.values().size() != width_) {
      complain(1, fmt::format("{} fields, allowed: {} as in the header", fields_.values().size(),
                              width_));
      return;
    }
    const auto time = finite(time_place_, "time_s");
    const auto value = finite(value_place_, column_);
    if (!time || !value) return;
    const std::size_t rows = signal.time_s.size();
    if (rows > 0 && *time < signal.time_s.back()) {
      complain(fields_.column(time_place_),
               fmt::format("time_s = {:g} after {:g}: allowed: times that do not decrease", *time,
                           signal.time_s.back()));
      return;
    }
    if (rows > 1 && *time == signal.time_s[rows - 1] && *time == signal.time_s[rows - 2]) {
      // Between jumps of one time nothing is seen.
      signal.value.back() = *value;
      return;
    }
    signal.time_s.push_back(*time);
    signal.value.push_back(*value);
  }

  const std::string& name_;
  const std::vector<std::string>& columns_;
  Complaints complaints_;
  CsvFields fields_;
  std::string column_;
  std::size_t width_ = 0, time_place_ = 0, value_place_ = 0;
  int line_ = 0;
};

}  // namespace

void parse_time_table(std::string_view text, const std::string& name,
                      const std::vector<std::string>& columns, motion::Signal& signal) {
  TimeTableReader(name, columns).read(without_mark(text), signal);
}

}  // namespace gear3k::io
