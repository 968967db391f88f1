#include "io/files/cycle_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "io/files/table_columns.hpp"
#include "io/text/complaints.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

/// Choices of columns, in this order.
enum CycleColumn : std::size_t { kTime, kTorque, kMotion };

class CycleReader {
 public:
  explicit CycleReader(const std::string& name)
      : name_(name), complain_([this](int column, std::string message) {
          complaints_.add({.line = line_, .column = column}, std::move(message));
        }) {}

  actuator::Cycle read(std::string_view text) {
    TextLines lines(text);
    while (lines.next()) {
      const std::string_view line = lines.line();
      line_ = lines.number();
      if (line.empty()) continue;
      if (line.front() == '#') {
        torque_note_.read(line, complain_);
      } else if (!fields_.split(line)) {
        complain_(1, "a quote is left open");
      } else if (columns_.width() == 0) {
        header_line_ = line_;
        columns_.read(fields_, complain_);
        cycle_.angles = columns_.name(kMotion) == "angle_rad";
      } else {
        read_row();
      }
    }
    finish();
    return std::move(cycle_);
  }

 private:
  void read_row() {
    ++rows_;
    if (fields_.values().size() != columns_.width()) {
      complain_(1, fmt::format("{} fields, allowed: {} as in the header", fields_.values().size(),
                               columns_.width()));
      return;
    }
    const double time = columns_.number(fields_, kTime, complain_);
    const double torque = columns_.number(fields_, kTorque, complain_);
    const double motion = columns_.number(fields_, kMotion, complain_);
    if (!cycle_.time_s.empty() && time - cycle_.time_s.back() < kShortest_s) {
      complain_(
          fields_.column(columns_.place(kTime).value_or(0)),
          fmt::format("time_s = {:g} after {:g}: allowed: increasing times, by {:g} s or more",
                      time, cycle_.time_s.back(), kShortest_s));
      return;
    }
    if (std::isnan(time)) return;
    cycle_.time_s.push_back(time);
    cycle_.load_Nm.push_back(torque);
    cycle_.motion.push_back(motion);
  }

  void finish() {
    cycle_.name = std::filesystem::path(name_).stem().string();
    if (columns_.width() == 0) {
      line_ = 1;
      complain_(1, fmt::format("no header: allowed: columns {}", columns_.names()));
    } else if (rows_ < 2) {
      line_ = header_line_;
      complain_(1, fmt::format("{} row{} below the header: allowed: two or more", rows_,
                               rows_ == 1 ? "" : "s"));
    }
    if (!complaints_.none()) throw InvalidInput(complaints_.text(name_));
    // A note may stand below rows.
    if (torque_note_.turned()) {
      for (double& torque : cycle_.load_Nm) torque = -torque;
    }
  }

  static constexpr double kShortest_s = 1e-9;  ///< between two rows

  const std::string& name_;
  ColumnComplaint complain_;
  actuator::Cycle cycle_;
  Complaints complaints_;
  CsvFields fields_;
  TableColumns columns_{{{"time_s"}, {"torque_nm"}, {"speed_rad_s", "angle_rad"}}};
  TorqueNote torque_note_;
  std::size_t rows_ = 0;
  int line_ = 0, header_line_ = 0;
};

}  // namespace

actuator::Cycle read_cycle(const std::string& path) {
  return parse_cycle(read_text(path, "a CSV file", kMostCycleBytes), path);
}

actuator::Cycle parse_cycle(std::string_view text, const std::string& name) {
  return CycleReader(name).read(without_mark(text));
}

}  // namespace gear3k::io
