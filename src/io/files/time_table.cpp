// Tables over time of a SCENARIO.

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "io/files/scenario_file.hpp"
#include "io/files/table_columns.hpp"
#include "io/text/complaints.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

class TimeTableReader {
 public:
  TimeTableReader(const std::string& name, const TimeTableKind& kind)
      : name_(name),
        complain_([this](int column, std::string message) {
          complaints_.add({.line = line_, .column = column}, std::move(message));
        }),
        kind_(kind),
        columns_({{"time_s"}, kind.columns}) {}

  void read(std::string_view text, motion::Signal& signal) {
    TextLines lines(text);
    while (lines.next()) {
      const std::string_view line = lines.line();
      line_ = lines.number();
      if (line.empty()) continue;
      if (line.front() == '#') {
        if (kind_.torque_of_load) torque_note_.read(line, complain_);
      } else if (!fields_.split(line)) {
        complain_(1, "a quote is left open");
      } else if (columns_.width() == 0) {
        columns_.read(fields_, complain_);
        if (!complaints_.none()) break;
      } else {
        read_row(signal);
      }
    }
    if (columns_.width() == 0) {
      line_ = 1;
      complain_(1, fmt::format("no header: allowed: columns {}", columns_.names()));
    } else if (signal.time_s.empty() && complaints_.none()) {
      complain_(1, "no row below the header: allowed: one or more");
    }
    if (!complaints_.none()) throw InvalidInput(complaints_.text(name_));
    // A note may stand below rows.
    if (torque_note_.turned()) {
      for (double& value : signal.value) value = -value;
    }
  }

 private:
  enum Choice : std::size_t { kTimeColumn, kValueColumn };

  void read_row(motion::Signal& signal) {
    if (fields_.values().size() != columns_.width()) {
      complain_(1, fmt::format("{} fields, allowed: {} as in the header", fields_.values().size(),
                               columns_.width()));
      return;
    }
    const double time = columns_.number(fields_, kTimeColumn, complain_);
    const double value = columns_.number(fields_, kValueColumn, complain_);
    if (std::isnan(time) || std::isnan(value)) return;
    const std::size_t rows = signal.time_s.size();
    if (rows > 0 && time < signal.time_s.back()) {
      complain_(fields_.column(columns_.place(kTimeColumn).value()),
                fmt::format("time_s = {:g} after {:g}: allowed: times that do not decrease", time,
                            signal.time_s.back()));
      return;
    }
    if (rows > 1 && time == signal.time_s[rows - 1] && time == signal.time_s[rows - 2]) {
      // Between jumps of one time nothing is seen.
      signal.value.back() = value;
      return;
    }
    signal.time_s.push_back(time);
    signal.value.push_back(value);
  }

  const std::string& name_;
  ColumnComplaint complain_;
  const TimeTableKind& kind_;
  Complaints complaints_;
  CsvFields fields_;
  TableColumns columns_;
  TorqueNote torque_note_;
  int line_ = 0;
};

}  // namespace

void parse_time_table(std::string_view text, const std::string& name, const TimeTableKind& kind,
                      motion::Signal& signal) {
  TimeTableReader(name, kind).read(without_mark(text), signal);
}

}  // namespace gear3k::io
