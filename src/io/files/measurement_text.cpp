#include "io/files/measurement_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/measurement/left_out_rows.hpp"
#include "calibrate/measurement/sensor_limit.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/measurement_columns.hpp"
#include "io/files/measurement_header.hpp"
#include "io/files/measurement_repetitions.hpp"
#include "io/files/measurement_time.hpp"
#include "io/files/temperature_column.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/printable.hpp"
#include "io/text/text_lines.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

namespace {

using calibrate::Kind;
using calibrate::Observation;
using Column = MeasurementColumn;
using Type = MeasurementColumn::Type;

constexpr double kMostMissing = 0.2;  // of a file's rows
constexpr std::size_t kShownLines = 10;

/// What the rows hold under one column of the header.
struct ColumnContent {
  const HeaderColumn* header = nullptr;
  std::size_t blanks = 0, values = 0;
  std::vector<int> first_blanks = {};  ///< lines, ten of them
  // Of a column that the kind does not name:
  int first_text_line = 0;  ///< where it holds no number; 0: nowhere
  std::vector<double> value = {};

  [[nodiscard]] const std::string& name() const { return header->name; }
  [[nodiscard]] const Column* column() const { return header->column; }
};

bool is_label(const HeaderColumn& h) {
  return h.column != nullptr &&
         (h.column->type == Type::kRun || h.column->type == Type::kDirection);
}

std::vector<char> label_marks(const MeasurementHeader& header) {
  std::vector<char> marks;
  marks.reserve(header.columns.size());
  for (const HeaderColumn& h : header.columns) marks.push_back(is_label(h) ? 1 : 0);
  return marks;
}

/// Reads the rows below a header.
class RowReader {
 public:
  RowReader(MeasurementText& file, const MeasurementHeader& header)
      : file_(file), header_line_(header.line), texts_(label_marks(header)) {
    columns_.reserve(header.columns.size());
    for (const HeaderColumn& h : header.columns) columns_.push_back({.header = &h});
  }

  void read(std::string_view text) {
    TextLines lines(text);
    std::vector<double> extras(columns_.size());
    while (lines.next()) {
      line_ = lines.number();
      const std::string_view line = lines.line();
      if (line_ <= header_line_ || line.empty() || line.front() == '#') continue;
      ++rows_found_;
      if (!fields_.split(line)) {
        complain(line_, 1, "a quote is left open");
        continue;
      }
      if (fields_.values().size() != columns_.size()) {
        complain(line_, 1,
                 fmt::format("{} fields, allowed: {} as in the header", fields_.values().size(),
                             columns_.size()));
        continue;
      }
      read_row(line, extras);
    }
    check_missing();
    if (rows_found_ > 0) check_blanks();
  }

  [[nodiscard]] const RowTexts& texts() const { return texts_; }

  /// Moves columns of numbers that the kind does not name to the set.
  void take_covariates() {
    if (file_.set.kind == Kind::kTorqueAngle) return;
    for (ColumnContent& c : columns_) {
      if (c.column() != nullptr || c.first_text_line > 0 || c.values == 0) continue;
      file_.set.covariates.push_back({.name = c.name(), .value = std::move(c.value)});
    }
  }

  /// Notes the columns that the kind does not name and that are no covariates, and comments that
  /// look like notes or columns.
  void note_ignored() {
    std::vector<std::string> known, names;
    for (const Column& c : columns_of(file_.set.kind)) known.emplace_back(c.name);
    for (const ColumnContent& c : columns_) names.push_back(c.name());
    for (const std::string& text : file_.notes.header.idle(notes_of(file_.set.kind), known, names))
      note(text);
    for (const ColumnContent& c : columns_) {
      if (c.column() != nullptr) continue;
      if (c.first_text_line > 0) {
        note(fmt::format("column {} holds no number in line {}: ignored", c.name(),
                         c.first_text_line));
      } else if (c.values == 0) {
        note(fmt::format("column {} is blank throughout: ignored", c.name()));
      } else if (file_.set.kind == Kind::kTorqueAngle) {
        note(fmt::format("column {} is not used in a torque-angle record: ignored", c.name()));
      }
    }
  }

 private:
  void complain(int line, int column, std::string message) {
    file_.complaints.add({.line = line, .column = column}, std::move(message));
  }
  void note(const std::string& text) {
    file_.set.notes.push_back(fmt::format("{}: {}", file_.set.files[0], text));
  }

  int run_of(std::string_view label) {
    const auto known = run_index_.find(std::string(label));
    if (known != run_index_.end()) return known->second;
    const int index = static_cast<int>(file_.set.runs.size());
    file_.set.runs.emplace_back(label);
    run_index_.emplace(label, index);
    return index;
  }

  /// Stores a field of a column that the kind names.  @returns false when it may not be
  bool store(const Column& column, std::string_view field, int at, Observation& o) {
    if (column.type == Type::kDirection) {
      if (field == "forward" || field == "backward") {
        o.condition.direction =
            field == "forward" ? design::Direction::kForward : design::Direction::kBackward;
        return true;
      }
      const std::string near = closest_word(std::string(field), {"forward", "backward"});
      complain(line_, at,
               fmt::format("direction = {}: allowed: forward or backward{}", field,
                           near.empty() ? "" : fmt::format("; did you mean {}?", near)));
      return false;
    }
    const std::optional<double> value = csv_number(field);
    if (!value || !column.allows(*value)) {
      complain(line_, at,
               fmt::format("{} = {}: allowed: {}", column.name, field, column.allowed_text()));
      return false;
    }
    column.store(o, units::to_si(*value, column.conversion));
    return true;
  }

  /// The number of a column that the kind does not name; NaN where it is blank or none.
  double extra_of(ColumnContent& c, std::string_view field) const {
    if (field.empty() || c.first_text_line > 0) return calibrate::kUnknown;
    const std::optional<double> value = csv_number(field);
    if (value && std::isfinite(*value)) {
      ++c.values;
      return *value;
    }
    c.first_text_line = line_;
    return calibrate::kUnknown;
  }

  void read_row(std::string_view line, std::vector<double>& extras) {
    Observation o;
    o.line = line_;
    o.condition.reference_sensor = file_.notes.reference_sensor;
    bool right = true;
    std::string_view missing, run;
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      ColumnContent& c = columns_[k];
      const std::string_view field = trimmed(fields_.values()[k]);
      if (c.column() == nullptr) {
        extras[k] = extra_of(c, field);
      } else if (c.column()->type == Type::kRun) {
        run = field;
      } else if (!field.empty()) {
        right = store(*c.column(), field, fields_.column(k), o) && right;
      } else if (c.column()->required) {
        missing = c.name();
      }
    }
    if (!right) return;
    if (!missing.empty()) {
      missing_lines_.push_back(line_);
      if (missing_shown_.size() < kShownLines) {
        missing_shown_.push_back(fmt::format("{} ({})", line_, missing));
      }
      return;
    }
    count_blanks();
    if (!run.empty()) o.condition.run = run_of(run);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      ColumnContent& c = columns_[k];
      if (c.column() == nullptr && c.first_text_line == 0) c.value.push_back(extras[k]);
    }
    file_.set.rows.push_back(o);
    texts_.add(line, fields_);
  }

  void count_blanks() {
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      ColumnContent& c = columns_[k];
      if (c.column() == nullptr) continue;
      if (!trimmed(fields_.values()[k]).empty()) {
        ++c.values;
      } else {
        ++c.blanks;
        if (c.first_blanks.size() < kShownLines) c.first_blanks.push_back(line_);
      }
    }
  }

  /// Rows without a required value.
  void check_missing() {
    if (rows_found_ == 0) {
      file_.complaints.add({}, "has no rows of measurements");
      return;
    }
    const std::size_t count = missing_lines_.size();
    if (count == 0) return;
    if (static_cast<double>(count) > kMostMissing * static_cast<double>(rows_found_)) {
      file_.complaints.add(
          {},
          fmt::format("{} of {} rows lack a required value ({}): allowed: at most {:g} %", count,
                      rows_found_, calibrate::line_list(missing_lines_), 100.0 * kMostMissing));
      return;
    }
    std::string shown = fmt::format("{}", fmt::join(missing_shown_, ", "));
    if (count > missing_shown_.size()) {
      shown += fmt::format(" and {} more", count - missing_shown_.size());
    }
    note(fmt::format("{} {} left out, a required value is blank: {} {}", count,
                     count == 1 ? "row" : "rows", count == 1 ? "line" : "lines", shown));
  }

  /// Optional columns that some rows leave blank.
  void check_blanks() {
    for (const ColumnContent& c : columns_) {
      if (c.column() == nullptr || c.column()->required) continue;
      if (c.values == 0) {
        if (!file_.set.rows.empty()) {
          note(fmt::format("column {} is blank throughout: ignored", c.name()));
        }
        continue;
      }
      const bool is_sigma = c.name().starts_with("sigma");
      const bool all_or_none =
          c.column()->type == Type::kRun || c.column()->type == Type::kSense || is_sigma;
      if (all_or_none && c.blanks > 0) {
        std::string lines = calibrate::line_list(c.first_blanks);
        if (c.blanks > c.first_blanks.size()) {
          lines += fmt::format(" and {} more", c.blanks - c.first_blanks.size());
        }
        complain(c.first_blanks[0], 1,
                 fmt::format("{} is blank in {} and stated in others: allowed: in every row or in "
                             "none",
                             c.name(), lines));
      }
      if (c.column()->type == Type::kRun) file_.has_run = true;
      if (is_sigma) file_.has_sigma = true;
    }
  }

  MeasurementText& file_;
  int header_line_ = 0, line_ = 0;
  CsvFields fields_;
  std::vector<ColumnContent> columns_;
  RowTexts texts_;
  std::unordered_map<std::string, int> run_index_;
  std::size_t rows_found_ = 0;
  std::vector<int> missing_lines_;
  std::vector<std::string> missing_shown_;
};

void note_kelvin(MeasurementText& file) {
  TemperatureSpan span;
  for (const Observation& o : file.set.rows) {
    if (std::isnan(o.condition.temperature_K)) continue;
    span.add(calibrate::kTemperature.written(o.condition.temperature_K));
  }
  const auto doubt = span.doubt();
  if (doubt) file.set.notes.push_back(fmt::format("{}: {}", file.set.files[0], *doubt));
}

void read_rows(std::string_view text, const MeasurementHeader& header, MeasurementText& file) {
  RowReader reader(file, header);
  reader.read(text);
  if (!file.complaints.none()) return;
  reader.take_covariates();
  leave_out_copies(file.set, reader.texts().repetitions());
  check_time(file.set, file.complaints);
  if (const auto refusal = calibrate::leave_out_saturated(file.set)) {
    file.complaints.add({}, *refusal);
  }
  reader.note_ignored();
  note_kelvin(file);
}

/// What a text looks like that is no measurement but another file of ours; "" where it is none.
std::string other_document(const std::string& path, std::string_view text) {
  try {
    return look_text(look_of(parse_toml(std::string(text), path)),
                     "DATA takes measurements, CSV files with a note \"# kind: ...\"");
  } catch (const InvalidInput&) {
    return "";
  }
}

}  // namespace

MeasurementText read_measurement_text(const std::string& path, std::string_view text) {
  MeasurementText file;
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    file.complaints.add({}, "is empty, allowed: notes, a header and rows of measurements");
    return file;
  }
  if (const std::optional<Diagnostic> fault = first_unprintable(text)) {
    file.complaints.add(fault->position, fault->message);
    return file;
  }
  file.notes = read_notes(text, file.complaints);
  if (!file.notes.kind) {
    if (const std::string other = other_document(path, text); !other.empty()) {
      file.complaints = {};
      file.complaints.add({}, other);
      return file;
    }
  }
  MeasurementHeader header = read_header(text, file.complaints);
  std::vector<std::string> names;
  names.reserve(header.columns.size());
  for (const HeaderColumn& h : header.columns) names.push_back(h.name);
  check_notes(file.notes, names, file.complaints);
  if (!file.notes.kind) return file;
  file.set.kind = *file.notes.kind;
  file.set.files = {path};
  if (header.line == 0) {
    file.complaints.add({}, "has no header, allowed: " + column_list(file.set.kind));
    return file;
  }
  match_header(header, file.set.kind, file.complaints);
  read_rows(text, header, file);
  return file;
}

}  // namespace gear3k::io
