#include "io/files/cycle_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "io/text/complaints.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

enum CycleColumn { kTime = 0, kTorque, kSpeed, kAngle, kCycleColumns };
constexpr std::array<std::string_view, kCycleColumns> kCycleColumnNames{"time_s", "torque_nm",
                                                                        "speed_rad_s", "angle_rad"};
constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

class CycleReader {
 public:
  explicit CycleReader(const std::string& name) : name_(name) { place_.fill(kAbsent); }

  actuator::Cycle read(std::string_view text) {
    TextLines lines(text);
    while (lines.next()) {
      const std::string_view line = lines.line();
      line_ = lines.number();
      if (line.empty()) continue;
      if (line.front() == '#') {
        read_note(line.substr(1));
      } else if (!fields_.split(line)) {
        complain(1, "a quote is left open");
      } else if (width_ == 0) {
        read_header();
      } else {
        read_row();
      }
    }
    finish();
    return std::move(cycle_);
  }

 private:
  void complain(int column, std::string message) {
    complaints_.add({.line = line_, .column = column}, std::move(message));
  }

  void read_note(std::string_view note) {
    const std::size_t colon = note.find(':');
    if (colon == std::string_view::npos || trimmed(note.substr(0, colon)) != "torque") return;
    const std::string_view value = trimmed(note.substr(colon + 1));
    if (!sign_.empty() && sign_ != value) {
      complain(1,
               fmt::format("# torque: {} after # torque: {}: allowed: one of them", value, sign_));
    }
    sign_ = value;
    if (value == "actuator") {
      turned_ = true;
    } else if (value != "load") {
      complain(1, fmt::format("# torque: {}: allowed: load (of the load on the output), actuator "
                              "(of the actuator on the load)",
                              value));
    }
  }

  void read_header() {
    width_ = fields_.values().size();
    header_line_ = line_;
    if (const auto slip = wrong_separator(width_, fields_.values()[0]); !slip.empty()) {
      complain(1, std::string(slip));
      return;
    }
    for (std::size_t k = 0; k < width_; ++k) {
      const std::string_view field = trimmed(fields_.values()[k]);
      const auto* const known = std::ranges::find(kCycleColumnNames, field);
      if (known == kCycleColumnNames.end()) {
        unknown_.emplace_back(field);
        continue;
      }
      auto& place = place_[static_cast<std::size_t>(known - kCycleColumnNames.begin())];
      if (place != kAbsent) {
        complain(fields_.column(k),
                 fmt::format("column {} stands twice, first as column {}", field, place + 1));
      }
      place = k;
    }
    for (const CycleColumn column : {kTime, kTorque}) {
      if (place_[column] == kAbsent) complain_missing(kCycleColumnNames[column]);
    }
    if (place_[kSpeed] == kAbsent && place_[kAngle] == kAbsent) {
      complain_missing("speed_rad_s or angle_rad");
    } else if (place_[kSpeed] != kAbsent && place_[kAngle] != kAbsent) {
      complain(fields_.column(place_[kAngle]),
               "columns speed_rad_s and angle_rad: allowed: one of them");
    }
    cycle_.angles = place_[kSpeed] == kAbsent;
    motion_ = cycle_.angles ? kAngle : kSpeed;
  }

  void complain_missing(std::string_view names) {
    std::string hint;
    for (const std::string& word : unknown_) {
      const std::string near = closest_word(
          word, std::vector<std::string>(kCycleColumnNames.begin(), kCycleColumnNames.end()));
      if (!near.empty() && names.find(near) != std::string_view::npos) {
        hint = fmt::format("; is column {} it?", word);
      }
    }
    complain(1, fmt::format("column {} is missing: allowed: time_s, torque_nm, and speed_rad_s or "
                            "angle_rad{}",
                            names, hint));
  }

  /// The number of a field; NaN where there is no such column, and with an error where it is none.
  double number(CycleColumn column) {
    if (place_[column] == kAbsent) return std::nan("");
    const std::string_view field = trimmed(fields_.values()[place_[column]]);
    const auto value = csv_number(field);
    if (value && std::abs(*value) <= kGreatest) return *value;
    complain(fields_.column(place_[column]),
             fmt::format("{} = \"{}\": allowed: a number from {:g} to {:g}",
                         kCycleColumnNames[column], field, -kGreatest, kGreatest));
    return std::nan("");
  }

  void read_row() {
    ++rows_;
    if (fields_.values().size() != width_) {
      complain(1, fmt::format("{} fields, allowed: {} as in the header", fields_.values().size(),
                              width_));
      return;
    }
    const double time = number(kTime);
    const double torque = number(kTorque);
    const double motion = number(motion_);
    // Beside a speed an angle is an error of the header; its slips are told with it.
    if (motion_ != kAngle) number(kAngle);
    if (!cycle_.time_s.empty() && time - cycle_.time_s.back() < kShortest_s) {
      complain(fields_.column(place_[kTime]),
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
    if (width_ == 0) {
      complaints_.add({.line = 1, .column = 1},
                      "no header: allowed: columns time_s, torque_nm, and speed_rad_s or "
                      "angle_rad");
    } else if (rows_ < 2) {
      line_ = header_line_;
      complain(1, fmt::format("{} row{} below the header: allowed: two or more", rows_,
                              rows_ == 1 ? "" : "s"));
    }
    if (!complaints_.none()) throw InvalidInput(complaints_.text(name_));
    // A note may stand below rows.
    if (turned_) {
      for (double& torque : cycle_.load_Nm) torque = -torque;
    }
  }

  static constexpr double kGreatest = 1e9;     ///< of any column, in its unit
  static constexpr double kShortest_s = 1e-9;  ///< between two rows

  const std::string& name_;
  actuator::Cycle cycle_;
  Complaints complaints_;
  CsvFields fields_;
  std::array<std::size_t, kCycleColumns> place_{};
  std::vector<std::string> unknown_;
  CycleColumn motion_ = kSpeed;
  std::size_t width_ = 0, rows_ = 0;
  int line_ = 0, header_line_ = 0;
  bool turned_ = false;
  std::string sign_;  ///< whose torque it is, as the note says
};

}  // namespace

actuator::Cycle read_cycle(const std::string& path) {
  return parse_cycle(read_text(path, "a CSV file", kMostCycleBytes), path);
}

actuator::Cycle parse_cycle(std::string_view text, const std::string& name) {
  return CycleReader(name).read(without_mark(text));
}

}  // namespace gear3k::io
