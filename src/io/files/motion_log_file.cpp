#include "io/files/motion_log_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "io/files/header_notes.hpp"
#include "io/files/temperature_column.hpp"
#include "io/keys/temperature_range.hpp"
#include "io/text/complaints.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/fnv_hash.hpp"
#include "io/text/printable.hpp"
#include "io/text/text_lines.hpp"
#include "numerics/median.hpp"

namespace gear3k::io {

namespace {

constexpr std::size_t kMostLogBytes = std::size_t{1} << 30U;
constexpr double kLogGap = 8.0;          // median steps of time
constexpr double kLogLongStep_s = 0.5;   // median from which time is doubted to be in seconds
constexpr std::size_t kClippedRows = 8;  // at the same extreme, one after the other
constexpr double kMostClipped = 0.5;     // of the rows
constexpr double kLargest = 1e9;         // of any number
constexpr std::size_t kFewestRows = 50;  // of a file

enum LogColumn : std::size_t {
  kLogTime,
  kLogSpeed,
  kLogAngle,
  kLogMotorTorque,
  kLogMotorCurrent,
  kLogLoad,
  kLogMotorAngle,
  kLogMotorSpeed,
  kLogColumnCount
};
constexpr std::array<std::string_view, kLogColumnCount> kLogColumns{
    "time_s",          "speed_rad_s",      "angle_rad",       "motor_torque_nm",
    "motor_current_a", "output_torque_nm", "motor_angle_rad", "motor_speed_rad_s"};
// Named by the contract and not needed here, but for its range.
constexpr std::string_view kTemperatureColumn = "temperature_c", kRunColumn = "run";

const KindNotes kLogNotes{.kind = "dynamic", .keys = {"kind", "torque", "load_inertia_kgm2"}};

struct LogNotes {
  bool dynamic = false, other_kind = false, of_actuator = false;
  std::optional<double> load_kgm2{};
};

struct LogRows {
  std::array<std::vector<double>, kLogColumnCount> value{};
  std::vector<int> line, run;
};

struct LogFile {
  Complaints complaints;
  HeaderNotes header{kLogNotes.keys};
  LogNotes notes;
  std::array<std::optional<std::size_t>, kLogColumnCount> place{};
  std::optional<std::size_t> run_place{}, temperature_place{};
  TemperatureSpan temperature;
  std::vector<std::string> names, ignored;  ///< of columns: all, and those not used
  std::size_t fields = 0;
  int header_line = 0;
  LogRows rows;
};

void read_log_note(const HeaderNote& note, LogFile& file) {
  const auto wrong = [&](std::string_view allowed) {
    file.complaints.add({.line = note.line, .column = 1},
                        fmt::format("# {}: {}: allowed: {}", note.key, note.word, allowed));
  };
  if (note.key == "kind") {
    file.notes.dynamic = note.word == "dynamic";
    file.notes.other_kind = !file.notes.dynamic;
    if (file.notes.other_kind) {
      wrong("dynamic (other kinds are diagnosed apart from logs of motion)");
    }
  } else if (note.key == "torque") {
    file.notes.of_actuator = note.word == "actuator";
    if (note.word != "actuator" && note.word != "load") wrong("load or actuator");
  } else if (note.key == "load_inertia_kgm2") {
    file.notes.load_kgm2 = csv_number(note.word);
    if (!file.notes.load_kgm2 ||
        !(*file.notes.load_kgm2 >= 0.0 && *file.notes.load_kgm2 < kLargest)) {
      wrong("a number, at least 0");
    }
  }
}

void read_log_header(std::string_view line, int number, LogFile& file) {
  CsvFields fields;
  file.header_line = number;
  if (!fields.split(line)) {
    file.complaints.add({.line = number, .column = 1}, "a quote is left open");
    return;
  }
  file.fields = fields.values().size();
  if (const auto slip = wrong_separator(file.fields, fields.values()[0]); !slip.empty()) {
    file.complaints.add({.line = number, .column = 1}, std::string(slip));
    return;
  }
  for (std::size_t k = 0; k < file.fields; ++k) {
    const std::string name(trimmed(fields.values()[k]));
    file.names.push_back(name);
    const auto* const at = std::ranges::find(kLogColumns, name);
    if (name == kRunColumn) {
      file.run_place = k;
    } else if (name == kTemperatureColumn) {
      file.temperature_place = k;
    } else if (at != kLogColumns.end()) {
      auto& place = file.place.at(static_cast<std::size_t>(at - kLogColumns.begin()));
      if (place) {
        file.complaints.add({.line = number, .column = fields.column(k)},
                            fmt::format("column {} is there twice, allowed: once", name));
      }
      place = k;
    } else {
      file.ignored.push_back(name);
      const std::string near = closest_word(name, {kLogColumns.begin(), kLogColumns.end()});
      if (!near.empty()) file.ignored.back() += fmt::format(" ({} was meant?)", near);
    }
  }
  const auto lacks = [&](LogColumn a, LogColumn b) {
    return !file.place.at(a) && !file.place.at(b);
  };
  const auto missing = [&](std::string_view what) {
    file.complaints.add(
        {.line = number, .column = 1},
        fmt::format("column {} is missing{}", what,
                    file.ignored.empty()
                        ? ""
                        : fmt::format("; not known: {}", fmt::join(file.ignored, ", "))));
  };
  if (!file.place[kLogTime]) missing("time_s");
  if (lacks(kLogSpeed, kLogAngle)) missing("speed_rad_s or angle_rad");
  if (lacks(kLogMotorTorque, kLogMotorCurrent)) missing("motor_torque_nm or motor_current_a");
}

/// Of a temperature only its range is looked at, where it is a number.  @returns false beyond it
bool read_temperature(const CsvFields& fields, int line, LogFile& file) {
  if (!file.temperature_place) return true;
  const std::string_view field = trimmed(fields.values()[*file.temperature_place]);
  const std::optional<double> value = csv_number(field);
  if (!value || std::isnan(*value)) return true;
  if (*value >= kAbsoluteZero_C && *value <= kHottest_C) {
    file.temperature.add(*value);
    return true;
  }
  file.complaints.add({.line = line, .column = fields.column(*file.temperature_place)}, [&] {
    return fmt::format("{} = \"{}\": allowed: a number, {} to {}{}", kTemperatureColumn, field,
                       kAbsoluteZero_C, kHottest_C, kTemperatureHint);
  });
  return false;
}

/// Takes a row, or says what is wrong with it.
void read_log_row(const CsvFields& fields, int line, LogFile& file,
                  std::vector<std::string>& labels) {
  std::array<double, kLogColumnCount> row{};
  bool right = true;
  for (std::size_t c = 0; c < kLogColumnCount; ++c) {
    if (!file.place.at(c)) continue;
    const std::string_view field = trimmed(fields.values()[*file.place.at(c)]);
    const std::optional<double> value = csv_number(field);
    if (!value || !(std::abs(*value) <= kLargest)) {
      file.complaints.add({.line = line, .column = fields.column(*file.place.at(c))}, [&] {
        return fmt::format("{} = \"{}\": allowed: a number, -1e9 to 1e9", kLogColumns.at(c), field);
      });
      right = false;
    } else {
      row.at(c) = *value;
    }
  }
  right = read_temperature(fields, line, file) && right;
  int run = 0;
  if (file.run_place) {
    const std::string_view label = trimmed(fields.values()[*file.run_place]);
    if (labels.empty() || labels.back() != label) labels.emplace_back(label);
    run = static_cast<int>(labels.size());
  }
  if (!right) return;
  LogRows& rows = file.rows;
  if (!rows.line.empty() && rows.run.back() == run &&
      !(row[kLogTime] > rows.value[kLogTime].back())) {
    file.complaints.add({.line = line, .column = 1}, [&] {
      return fmt::format(
          "time_s = {} after {} in line {}: allowed: above the time before within a run (a clock "
          "that began anew is a new session: label it in the column run)",
          row[kLogTime], rows.value[kLogTime].back(), rows.line.back());
    });
  }
  for (std::size_t c = 0; c < kLogColumnCount; ++c) rows.value.at(c).push_back(row.at(c));
  rows.line.push_back(line);
  rows.run.push_back(run);
}

LogFile read_log(std::string_view text) {
  LogFile file;
  if (const std::optional<Diagnostic> fault = first_unprintable(text)) {
    file.complaints.add(fault->position, fault->message);
    return file;
  }
  TextLines lines(text);
  CsvFields fields;
  std::vector<std::string> labels;
  while (lines.next()) {
    const std::string_view line = lines.line();
    if (line.empty()) continue;
    if (line.front() == '#') {
      const auto note = file.header.read(line, lines.number(), [&](std::string message) {
        file.complaints.add({.line = lines.number(), .column = 1}, std::move(message));
      });
      if (note) read_log_note(*note, file);
      if (file.notes.other_kind) return file;
    } else if (file.header_line == 0) {
      read_log_header(line, lines.number(), file);
      if (!file.complaints.none()) break;
    } else if (!fields.split(line)) {
      file.complaints.add({.line = lines.number(), .column = 1}, "a quote is left open");
    } else if (fields.values().size() != file.fields) {
      file.complaints.add({.line = lines.number(), .column = 1},
                          fmt::format("{} fields, allowed: {} as in the header",
                                      fields.values().size(), file.fields));
    } else {
      read_log_row(fields, lines.number(), file, labels);
    }
  }
  file.header.refuse_others(kLogNotes, file.complaints);
  if (!file.notes.dynamic && file.complaints.none()) {
    file.complaints.add({},
                        "the note \"# kind: dynamic\" is missing, as another file of the same "
                        "command has it: allowed: logs of motion by themselves");
  }
  if (file.complaints.none() && file.header_line == 0) {
    file.complaints.add({},
                        "no header: allowed: columns time_s, speed_rad_s or angle_rad, and "
                        "motor_torque_nm or motor_current_a");
  }
  if (file.complaints.none() && file.rows.line.size() < kFewestRows) {
    file.complaints.add(
        {}, fmt::format("{} rows, allowed: at least {}", file.rows.line.size(), kFewestRows));
  }
  return file;
}

/// Whether a signal is held at an extreme: many values are exactly it, and far fewer at any level
/// next to it.  A smooth one in steps has at its top not three times as many as a step below.
bool is_held(const std::vector<double>& sorted, bool at_top) {
  const std::size_t n = sorted.size();
  const auto at = [&](std::size_t k) { return at_top ? sorted[n - 1 - k] : sorted[k]; };
  const auto level = [&](std::size_t from) {
    std::size_t k = from;
    while (k < n && at(k) == at(from)) ++k;
    return k;
  };
  const std::size_t held = level(0);
  if (held < kClippedRows) return false;
  std::size_t most = 0, from = held;
  constexpr int kLevels = 3;
  for (int k = 0; k < kLevels && from < n; ++k) {
    const std::size_t end = level(from);
    most = std::max(most, end - from);
    from = end;
  }
  constexpr std::size_t kTimes = 4;
  return held > kTimes * most;
}

/// Marks rows at which a signal stays at an extreme, or is held at it by a limit: then the rows
/// between them too, of which noise has decided.
std::vector<char> clipped_rows(const std::vector<double>& signal) {
  std::vector<double> sorted = signal;
  std::ranges::sort(sorted);
  const double low = sorted.front(), high = sorted.back();
  std::vector<char> clipped(signal.size(), 0);
  if (low == high) return clipped;
  const bool held_low = is_held(sorted, false), held_high = is_held(sorted, true);
  constexpr std::size_t kBetween = 6;
  std::optional<std::size_t> last;
  for (std::size_t k = 0; k < signal.size();) {
    std::size_t end = k + 1;
    while (end < signal.size() && signal[end] == signal[k]) ++end;
    const bool extreme = (signal[k] == low || signal[k] == high) && signal[k] != 0.0;
    const bool held = (signal[k] == low && held_low) || (signal[k] == high && held_high);
    if (extreme && (held || end - k >= kClippedRows)) {
      std::size_t from = k;
      if (held) {
        if (last && k - *last <= kBetween) from = std::min(from, *last);
        last = end;
      }
      std::fill(clipped.begin() + static_cast<std::ptrdiff_t>(from),
                clipped.begin() + static_cast<std::ptrdiff_t>(end), char{1});
    }
    k = end;
  }
  return clipped;
}

double median_step(const LogRows& rows) {
  const std::vector<double>& time = rows.value[kLogTime];
  std::vector<double> steps;
  steps.reserve(time.size());
  for (std::size_t k = 1; k < time.size(); ++k) {
    if (rows.run[k] == rows.run[k - 1]) steps.push_back(time[k] - time[k - 1]);
  }
  if (steps.empty()) return 0.0;
  return numerics::upper_median(std::move(steps));
}

/// Turns of one side between two rows, at the output: of its angle, else of its speed.
double turned(const LogFile& file, LogColumn angle, LogColumn speed, std::size_t before,
              std::size_t k) {
  const auto& value = file.rows.value;
  if (file.place.at(angle)) return value.at(angle)[k] - value.at(angle)[before];
  return 0.5 * (value.at(speed)[k] + value.at(speed)[before]) *
         (value[kLogTime][k] - value[kLogTime][before]);
}

bool logs_motor_side(const LogFile& file) {
  return file.place[kLogMotorAngle] || file.place[kLogMotorSpeed];
}
bool logs_both_angles(const LogFile& file) {
  return file.place[kLogMotorAngle] && file.place[kLogAngle];
}

void add_windup(const LogFile& file, std::size_t before, std::size_t k, const MotionLogScale& scale,
                calibrate::MotionStretch& s) {
  if (!logs_motor_side(file)) return;
  s.windup_drifts = !logs_both_angles(file);
  if (!s.windup_drifts) {
    const auto& value = file.rows.value;
    s.windup_rad.push_back(value[kLogMotorAngle][k] / scale.ratio - value[kLogAngle][k]);
    return;
  }
  const double more = s.windup_rad.empty()
                          ? 0.0
                          : turned(file, kLogMotorAngle, kLogMotorSpeed, before, k) / scale.ratio -
                                turned(file, kLogAngle, kLogSpeed, before, k);
  s.windup_rad.push_back(s.windup_rad.empty() ? 0.0 : s.windup_rad.back() + more);
}

/// How far the motor's side turns for the output's turn times the ratio; 1 where both agree.
std::optional<double> turns_of_motor(const LogFile& file, const MotionLogScale& scale) {
  if (!logs_motor_side(file)) return std::nullopt;
  double square = 0.0, product = 0.0;
  for (std::size_t k = 1; k < file.rows.line.size(); ++k) {
    if (file.rows.run[k] != file.rows.run[k - 1]) continue;
    const double output = turned(file, kLogAngle, kLogSpeed, k - 1, k);
    square += output * output;
    product += output * turned(file, kLogMotorAngle, kLogMotorSpeed, k - 1, k) / scale.ratio;
  }
  if (!(square > 0.0)) return std::nullopt;
  return product / square;
}

void add_sample(const LogFile& file, std::size_t before, std::size_t k, const MotionLogScale& scale,
                calibrate::MotionStretch& s) {
  const auto& value = file.rows.value;
  add_windup(file, before, k, scale, s);
  s.time_s.push_back(value[kLogTime][k]);
  if (file.place[kLogSpeed]) {
    s.speed_rad_s.push_back(value[kLogSpeed][k]);
  } else {
    s.angle_rad.push_back(value[kLogAngle][k]);
  }
  const double motor = file.place[kLogMotorTorque]
                           ? value[kLogMotorTorque][k]
                           : scale.torque_constant_Nm_A * value[kLogMotorCurrent][k];
  s.motor_Nm.push_back(scale.ratio * motor);
  if (file.place[kLogLoad]) {
    s.load_Nm.push_back(file.notes.of_actuator ? -value[kLogLoad][k] : value[kLogLoad][k]);
  }
}

/// Columns that are used.
std::vector<std::string> log_names() {
  std::vector<std::string> names(kLogColumns.begin(), kLogColumns.end());
  names.emplace_back(kRunColumn);
  return names;
}

void cut_log(LogFile& file, const std::string& path, const MotionLogScale& scale,
             calibrate::MotionRecord& record) {
  const LogRows& rows = file.rows;
  const std::size_t motor = file.place[kLogMotorTorque] ? kLogMotorTorque : kLogMotorCurrent;
  const std::vector<char> clipped = clipped_rows(rows.value.at(motor));
  const auto lost = static_cast<std::size_t>(std::ranges::count(clipped, char{1}));
  if (static_cast<double>(lost) > kMostClipped * static_cast<double>(clipped.size())) {
    file.complaints.add(
        {}, fmt::format("{} is at its limit in {} of {} rows, allowed: at most {:g} %",
                        kLogColumns.at(motor), lost, clipped.size(), 100.0 * kMostClipped));
    return;
  }
  if (lost > 0) {
    const auto first =
        static_cast<std::size_t>(std::ranges::find(clipped, char{1}) - clipped.begin());
    record.notes.push_back(
        fmt::format("{}: {} rows left out: {} stays at its limit, first in line {}", path, lost,
                    kLogColumns.at(motor), rows.line[first]));
  }
  const double step = median_step(rows);
  if (step >= kLogLongStep_s) {
    record.notes.push_back(fmt::format(
        "{}: a row every {:.4g} s shows little of a motion: time_s is in seconds, is this file's "
        "in milliseconds?",
        path, step));
  }
  constexpr double kOfTurn = 0.2;  // of steps between rows, which noise makes shorter
  if (const auto turns = turns_of_motor(file, scale);
      scale.known && turns && std::abs(*turns - 1.0) > kOfTurn) {
    file.complaints.add(
        {.line = file.header_line, .column = 1},
        fmt::format("{} turns {:.3g} times as far as the output times gearbox.ratio = {:g}: "
                    "allowed: the angle or speed of the motor's shaft, positive with a positive "
                    "output where the ratio is positive",
                    kLogColumns.at(file.place[kLogMotorAngle] ? kLogMotorAngle : kLogMotorSpeed),
                    *turns, scale.ratio));
    return;
  }
  const int sessions = record.stretches.empty() ? 0 : record.stretches.back().session + 1;
  const int log = record.stretches.empty() ? 0 : record.stretches.back().log + 1;
  std::size_t gaps = 0;
  int first_gap = 0;
  std::optional<std::size_t> last;
  for (std::size_t k = 0; k < rows.line.size(); ++k) {
    if (clipped[k] != 0) continue;
    const std::size_t before = last.value_or(k);
    const bool follows = last && rows.run[k] == rows.run[before];
    const bool gap =
        follows && rows.value[kLogTime][k] - rows.value[kLogTime][before] > kLogGap * step;
    if (gap && gaps++ == 0) first_gap = rows.line[k];
    if (!follows || gap) {
      record.stretches.emplace_back();
      record.stretches.back().load_kgm2 = file.notes.load_kgm2.value_or(scale.load_kgm2);
      record.stretches.back().session = logs_both_angles(file)
                                            ? sessions + rows.run[k]
                                            : sessions + static_cast<int>(record.stretches.size());
      record.stretches.back().log = log;
    }
    last = k;
    add_sample(file, before, k, scale, record.stretches.back());
  }
  if (gaps > 0) {
    record.notes.push_back(fmt::format(
        "{}: {} {} in the sampling (steps of more than {:g} times {:.4g} s), first before line {}: "
        "no window goes across",
        path, gaps, gaps == 1 ? "gap" : "gaps", kLogGap, step, first_gap));
  }
  if (const auto doubt = file.temperature.doubt()) {
    record.notes.push_back(fmt::format("{}: {}", path, *doubt));
  }
  for (const std::string& text : file.header.idle(kLogNotes, log_names(), file.names)) {
    record.notes.push_back(fmt::format("{}: {}", path, text));
  }
  for (const std::string& name : file.ignored) {
    record.notes.push_back(fmt::format("{}: column {} is not used: ignored", path, name));
  }
}

void add_log(const std::string& path, std::string_view text, const MotionLogScale& scale,
             calibrate::MotionRecord& record, CollectedErrors& errors) {
  LogFile file = read_log(without_mark(text));
  record.files.push_back(path);
  if (file.complaints.none() && scale.known && !file.place[kLogMotorTorque] &&
      !(scale.torque_constant_Nm_A > 0.0)) {
    file.complaints.add({.line = file.header_line, .column = 1},
                        "motor_current_a needs motor.torque_constant_nm_per_a, allowed: above 0");
  }
  if (file.complaints.none()) cut_log(file, path, scale, record);
  errors.attempt([&] {
    if (!file.complaints.none()) throw InvalidInput(file.complaints.text(path));
  });
}

}  // namespace

bool any_motion_log(const std::vector<std::string>& paths) {
  return std::ranges::any_of(paths, [](const std::string& path) {
    const FileBytes file = read_bytes(path, "a CSV file", kMostLogBytes);
    if (!file.failure.empty()) return false;
    TextLines lines(without_mark(file.bytes));
    while (lines.next()) {
      if (lines.line().empty()) continue;
      if (lines.line().front() != '#') return false;
      const auto note = note_of(lines.line(), lines.number());
      if (note && note->key == "kind") return note->word == "dynamic";
    }
    return false;
  });
}

calibrate::MotionRecord read_motion_logs(const std::vector<std::string>& paths,
                                         const MotionLogScale& scale) {
  calibrate::MotionRecord record;
  CollectedErrors errors;
  std::map<std::pair<std::uint64_t, std::size_t>, std::string> seen;  // paths by hash and size
  for (const std::string& path : paths) {
    const FileBytes file = read_bytes(path, "a CSV file", kMostLogBytes);
    const auto refuse = [&](const std::string& why) {
      errors.attempt([&] { throw InvalidInput(fmt::format("{}: {}", path, why)); });
    };
    if (!file.failure.empty()) {
      refuse(file.failure);
      continue;
    }
    const auto [other, is_new] =
        seen.try_emplace({hashed(kHashBasis, file.bytes), file.bytes.size()}, path);
    if (is_new) {
      add_log(path, file.bytes, scale, record, errors);
    } else {
      // Twice the same rows would be twice as sure of what they say.
      refuse(fmt::format("holds the same bytes as {}: allowed: each file once", other->second));
    }
  }
  errors.raise();
  return record;
}

calibrate::MotionRecord parse_motion_log(const std::string& path, std::string_view text,
                                         const MotionLogScale& scale) {
  calibrate::MotionRecord record;
  CollectedErrors errors;
  add_log(path, text, scale, record, errors);
  errors.raise();
  return record;
}

}  // namespace gear3k::io
