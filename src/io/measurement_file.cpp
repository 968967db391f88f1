#include "io/measurement_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "io/csv_table.hpp"
#include "io/diagnostics.hpp"
#include "io/measurement_columns.hpp"
#include "io/measurement_rows.hpp"

namespace gear3k::io {

namespace {

using calibrate::Kind;
using calibrate::MeasurementSet;
using calibrate::Observation;
using Column = MeasurementColumn;
using Type = MeasurementColumn::Type;

constexpr std::size_t kMostMessages = 50;      // of one file
constexpr double kMostMissing = 0.2;           // of a file's rows
constexpr std::size_t kSaturatedRows = 5;      // from which a repeated extreme is suspicious
constexpr double kSaturatedLoadSpread = 0.05;  // relative
constexpr double kMostSaturated = 0.5;         // of a file's rows
constexpr std::size_t kStepsPerStepBack = 10;  // more steps back: rows not in order of time
constexpr std::uint64_t kHashBasis = 14695981039346656037U, kHashPrime = 1099511628211U;  // FNV-1a

std::uint64_t hashed(std::uint64_t hash, std::string_view bytes) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * kHashPrime;
  return hash;
}

std::uint64_t hashed(std::uint64_t hash, double value) {
  // Word by word: quick and good enough to find candidates, which are then compared.
  auto bits = std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value);
  for (int half = 0; half < 2; ++half, bits >>= 32U) {
    hash = (hash ^ (bits & 0xFFFFFFFFU)) * kHashPrime;
    hash ^= hash >> 29U;
  }
  return hash;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// The number that a field holds; infinite or NaN where it says so.
std::optional<double> number_of(std::string_view field) {
  if (field.size() > 1 && field.front() == '+' && field[1] != '-') field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

/// Messages of one file, as many as are read.
class Complaints {
 public:
  void add(Position position, std::string message) {
    if (position.line == 0 || messages_.size() < kMostMessages) {
      messages_.push_back({.position = position, .message = std::move(message)});
    } else {
      ++more_;
    }
  }
  [[nodiscard]] bool none() const { return messages_.empty(); }
  [[nodiscard]] std::string text(const std::string& path) const {
    std::string text = format_diagnostics(path, messages_);
    if (more_ > 0) text += fmt::format("\n{}: and {} more", path, more_);
    return text;
  }

 private:
  std::vector<Diagnostic> messages_;
  std::size_t more_ = 0;
};

/// The lines of a text, numbered, without their ends.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next() {
    if (rest_.empty()) return false;
    const auto end = rest_.find('\n');
    line_ = trimmed(rest_.substr(0, end));
    rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
    ++number_;
    return true;
  }
  /// Without blanks around it.
  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] int number() const { return number_; }

 private:
  std::string_view rest_, line_;
  int number_ = 0;
};

/// What the lines that begin with '#' say.
struct Notes {
  std::optional<Kind> kind;
  std::optional<bool> sun_locked;
  bool reference_sensor = false, runs_shared = false;
};

/// A file as read.
struct MeasurementText {
  std::string path;
  Complaints complaints;
  Notes notes;
  MeasurementSet set;  ///< of this file alone
  bool has_run = false, has_sigma = false;
  std::size_t size = 0;
  std::uint64_t hash = kHashBasis;  ///< of its bytes
};

/// A column of a file's header.
struct HeaderColumn {
  std::string name;
  const Column* column = nullptr;  ///< null: a column that the kind does not name
  std::size_t blanks = 0, values = 0;
  std::vector<int> first_blanks = {};  ///< lines, ten of them
  // Of a column that the kind does not name:
  int first_text_line = 0;  ///< where it holds no number; 0: nowhere
  std::vector<double> value = {};
};

class FileReader {
 public:
  FileReader(MeasurementText& file, std::string_view text) : file_(file), text_(text) {}

  void read() {
    if (trimmed_all().empty()) {
      file_.complaints.add({}, "is empty, allowed: notes, a header and rows of measurements");
      return;
    }
    if (text_.find('\0') != std::string_view::npos) {
      file_.complaints.add({}, "is no text in UTF-8");
      return;
    }
    read_notes();
    find_header();
    check_kind();
    if (!file_.notes.kind) return;
    file_.set.kind = *file_.notes.kind;
    file_.set.files = {file_.path};
    if (header_line_ == 0) {
      file_.complaints.add({}, "has no header, allowed: " + column_list());
      return;
    }
    match_header();
    read_rows();
    check_rows();
    if (!file_.complaints.none()) return;
    drop_repetitions();
    check_time();
    drop_saturated();
    finish_covariates();
  }

 private:
  static constexpr std::size_t kShownLines = 10;

  void complain(int line, int column, std::string message) {
    file_.complaints.add({.line = line, .column = column}, std::move(message));
  }
  void note(const std::string& text) {
    file_.set.notes.push_back(fmt::format("{}: {}", file_.path, text));
  }
  [[nodiscard]] std::string_view trimmed_all() const {
    const auto begin = text_.find_first_not_of(" \t\r\n");
    return begin == std::string_view::npos ? std::string_view{} : text_.substr(begin);
  }
  [[nodiscard]] std::string column_list() const {
    std::vector<std::string_view> required, optional;
    for (const Column& c : columns_of(*file_.notes.kind)) {
      (c.required ? required : optional).push_back(c.name);
    }
    return fmt::format("columns {}, and optionally {}", fmt::join(required, ", "),
                       fmt::join(optional, ", "));
  }

  /// A word of a note that must be one of these; -1 where it is not.
  template <class Words>
  int choice(std::string_view key, std::string_view word, const Words& words) {
    for (std::size_t k = 0; k < words.size(); ++k) {
      if (words[k] == word) return static_cast<int>(k);
    }
    const std::vector<std::string> known(words.begin(), words.end());
    const std::string near = closest_word(std::string(word), known);
    complain(line_, 1,
             fmt::format("# {}: {}: allowed: {}{}", key, word, fmt::join(words, " or "),
                         near.empty() ? "" : fmt::format("; did you mean {}?", near)));
    return -1;
  }

  void read_notes() {
    Lines lines(text_);
    while (lines.next()) {
      if (!lines.line().starts_with('#')) continue;
      line_ = lines.number();
      std::string_view rest = lines.line().substr(1);
      while (rest.ends_with(',')) rest.remove_suffix(1);  // spreadsheets fill rows up
      const auto colon = rest.find(':');
      if (colon == std::string_view::npos) continue;
      const std::string_view key = trimmed(rest.substr(0, colon));
      const std::string_view word = trimmed(rest.substr(colon + 1));
      note_keys_.emplace_back(key);
      if (key == "kind") {
        const int k = choice(key, word, calibrate::kKindNames);
        kind_stated_ = true;
        if (k < 0) continue;
        const auto kind = static_cast<Kind>(k);
        if (file_.notes.kind && *file_.notes.kind != kind) {
          complain(line_, 1,
                   fmt::format("# kind: {}: the kind was {} before, allowed: one kind", word,
                               calibrate::kKindNames[static_cast<std::size_t>(*file_.notes.kind)]));
        }
        file_.notes.kind = kind;
      } else if (key == "locked") {
        locked_line_ = line_;
        const int k = choice(key, word, std::array<std::string_view, 2>{"sun", "output"});
        if (k >= 0) file_.notes.sun_locked = k == 0;
      } else if (key == "sensor") {
        file_.notes.reference_sensor =
            choice(key, word, std::array<std::string_view, 1>{"reference"}) == 0;
      } else if (key == "runs") {
        file_.notes.runs_shared = choice(key, word, std::array<std::string_view, 1>{"shared"}) == 0;
      }
    }
  }

  void find_header() {
    Lines lines(text_);
    while (lines.next()) {
      if (lines.line().empty() || lines.line().starts_with('#')) continue;
      header_line_ = lines.number();
      if (!fields_.split(lines.line())) {
        complain(header_line_, 1, "a quote is left open");
      }
      for (const std::string_view name : fields_.values()) {
        header_.push_back({.name = std::string(trimmed(name))});
        header_columns_.push_back(fields_.column(header_.size() - 1));
      }
      return;
    }
  }

  void check_kind() {
    if (!file_.notes.kind) {
      if (kind_stated_) return;
      std::string message = fmt::format("the note \"# kind: ...\" is missing, allowed: {}",
                                        fmt::join(calibrate::kKindNames, ", "));
      const std::string near = closest_word("kind", note_keys_);
      if (!near.empty()) {
        message += fmt::format("; \"# {}:\" was meant?", near);
      } else {
        for (std::size_t k = 0; k < calibrate::kKindNames.size(); ++k) {
          if (!has_columns_of(static_cast<Kind>(k))) continue;
          message += fmt::format("; the columns are those of {}", calibrate::kKindNames[k]);
        }
      }
      file_.complaints.add({}, message);
      return;
    }
    const bool loop = *file_.notes.kind == Kind::kTorqueAngle;
    if (loop && locked_line_ == 0) {
      file_.complaints.add({},
                           "the note \"# locked: ...\" is missing, allowed: sun (measured at the "
                           "output) or output (measured at the sun)");
    }
    if (*file_.notes.kind == Kind::kLostMotion && !file_.notes.sun_locked.value_or(true)) {
      complain(locked_line_, 1,
               "# locked: output: allowed: sun (lost motion is measured at the output)");
    }
  }

  [[nodiscard]] bool has_columns_of(Kind kind) const {
    return std::ranges::all_of(columns_of(kind), [&](const Column& c) {
      return !c.required ||
             std::ranges::any_of(header_, [&](const HeaderColumn& h) { return h.name == c.name; });
    });
  }

  void match_header() {
    const std::vector<Column>& columns = columns_of(file_.set.kind);
    std::vector<const Column*> absent;
    for (const Column& column : columns) {
      const auto at = std::ranges::find(header_, column.name, &HeaderColumn::name);
      if (at == header_.end()) {
        absent.push_back(&column);
      } else {
        at->column = &column;
      }
    }
    if (header_.size() == 1 && header_[0].name.find_first_of(";\t") != std::string::npos) {
      complain(header_line_, 1, "the header is one field: allowed: fields parted by commas");
      return;
    }
    if (absent.size() == columns.size() && std::ranges::all_of(header_, [](const HeaderColumn& h) {
          return number_of(h.name).has_value();
        })) {
      complain(header_line_, 1, "a row before the header, allowed: " + column_list());
      return;
    }
    std::vector<const Column*> meant;
    for (std::size_t k = 0; k < header_.size(); ++k) {
      const std::string& name = header_[k].name;
      if (name.empty()) {
        complain(header_line_, header_columns_[k], fmt::format("column {} has no name", k + 1));
        continue;
      }
      for (std::size_t j = 0; j < k; ++j) {
        if (header_[j].name == name) {
          complain(header_line_, header_columns_[k],
                   fmt::format("column {} stands twice, first as column {}", name, j + 1));
          break;
        }
      }
      if (header_[k].column != nullptr) continue;
      const MeantColumn found = meant_column(name, absent);
      if (found.column == nullptr) continue;
      meant.push_back(found.column);
      complain(header_line_, header_columns_[k],
               found.other_unit
                   ? fmt::format("column {}: expected {} (the unit is part of the name; other "
                                 "units are not converted)",
                                 name, found.column->name)
                   : fmt::format("column {}: did you mean {}?", name, found.column->name));
    }
    for (const Column* column : absent) {
      if (column->required && std::ranges::find(meant, column) == meant.end()) {
        complain(header_line_, 1,
                 fmt::format("column {} is missing: {}", column->name, column->allowed_text()));
      }
    }
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
    const std::optional<double> value = number_of(field);
    if (!value || !column.allows(*value)) {
      complain(line_, at,
               fmt::format("{} = {}: allowed: {}", column.name, field, column.allowed_text()));
      return false;
    }
    column.store(o, column.factor * *value + column.shift);
    return true;
  }

  void read_rows() {
    Lines lines(text_);
    std::vector<double> extras(header_.size());
    while (lines.next()) {
      line_ = lines.number();
      const std::string_view line = lines.line();
      if (line_ <= header_line_ || line.empty() || line.front() == '#') continue;
      ++rows_found_;
      if (!fields_.split(line)) {
        complain(line_, 1, "a quote is left open");
        continue;
      }
      if (fields_.values().size() != header_.size()) {
        complain(line_, 1,
                 fmt::format("{} fields, allowed: {} as in the header", fields_.values().size(),
                             header_.size()));
        continue;
      }
      read_row(line, extras);
    }
  }

  void read_row(std::string_view line, std::vector<double>& extras) {
    Observation o;
    o.line = line_;
    o.condition.reference_sensor = file_.notes.reference_sensor;
    bool right = true;
    std::string_view missing, run;
    for (std::size_t k = 0; k < header_.size(); ++k) {
      HeaderColumn& h = header_[k];
      const std::string_view field = trimmed(fields_.values()[k]);
      if (h.column == nullptr) {
        extras[k] = calibrate::kUnknown;
        if (field.empty() || h.first_text_line > 0) continue;
        const std::optional<double> value = number_of(field);
        if (value && std::isfinite(*value)) {
          extras[k] = *value;
          ++h.values;
        } else {
          h.first_text_line = line_;
        }
      } else if (h.column->type == Type::kRun) {
        run = field;
      } else if (!field.empty()) {
        right = store(*h.column, field, fields_.column(k), o) && right;
      } else if (h.column->required) {
        missing = h.name;
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
    for (std::size_t k = 0; k < header_.size(); ++k) {
      if (header_[k].column == nullptr && header_[k].first_text_line == 0) {
        header_[k].value.push_back(extras[k]);
      }
    }
    file_.set.rows.push_back(o);
    row_begin_.push_back(static_cast<std::size_t>(line.data() - text_.data()));
    row_size_.push_back(static_cast<std::uint32_t>(line.size()));
    row_hash_.push_back(hash_of_fields());
  }

  void count_blanks() {
    for (std::size_t k = 0; k < header_.size(); ++k) {
      HeaderColumn& h = header_[k];
      if (h.column == nullptr) continue;
      if (!trimmed(fields_.values()[k]).empty()) {
        ++h.values;
      } else {
        ++h.blanks;
        if (h.first_blanks.size() < kShownLines) h.first_blanks.push_back(line_);
      }
    }
  }

  [[nodiscard]] bool is_text(std::size_t k) const {
    const Column* column = header_[k].column;
    return column != nullptr && (column->type == Type::kRun || column->type == Type::kDirection);
  }

  /// Equal where rows are: 1.0 and 1.00 are the same.
  [[nodiscard]] std::uint64_t hash_of_fields() const {
    std::uint64_t hash = kHashBasis;
    for (std::size_t k = 0; k < header_.size(); ++k) {
      const std::string_view field = trimmed(fields_.values()[k]);
      const std::optional<double> value = is_text(k) ? std::nullopt : number_of(field);
      hash = value ? hashed(hash, *value) : hashed(hash, field);
      hash = (hash ^ 0xFFU) * kHashPrime;
    }
    return hash;
  }

  [[nodiscard]] bool same_rows(std::size_t a, std::size_t b) const {
    CsvFields left, right;
    left.split(text_.substr(row_begin_[a], row_size_[a]));
    right.split(text_.substr(row_begin_[b], row_size_[b]));
    for (std::size_t k = 0; k < header_.size(); ++k) {
      const std::string_view x = trimmed(left.values()[k]), y = trimmed(right.values()[k]);
      if (x == y) continue;
      if (is_text(k)) return false;
      const std::optional<double> u = number_of(x), v = number_of(y);
      if (!u || !v || *u != *v) return false;
    }
    return true;
  }

  void check_rows() {
    if (rows_found_ == 0) {
      file_.complaints.add({}, "has no rows of measurements");
      return;
    }
    if (!missing_lines_.empty()) {
      const std::size_t count = missing_lines_.size();
      if (static_cast<double>(count) > kMostMissing * static_cast<double>(rows_found_)) {
        file_.complaints.add(
            {}, fmt::format("{} of {} rows lack a required value ({}): allowed: at most {:g} %",
                            count, rows_found_, line_list(missing_lines_), 100.0 * kMostMissing));
      } else {
        std::string shown = fmt::format("{}", fmt::join(missing_shown_, ", "));
        if (count > missing_shown_.size()) {
          shown += fmt::format(" and {} more", count - missing_shown_.size());
        }
        note(fmt::format("{} {} left out, a required value is blank: {} {}", count,
                         count == 1 ? "row" : "rows", count == 1 ? "line" : "lines", shown));
      }
    }
    for (HeaderColumn& h : header_) {
      if (h.column == nullptr || h.column->required) continue;
      if (h.values == 0) {
        if (!file_.set.rows.empty())
          note(fmt::format("column {} is blank throughout: ignored", h.name));
        continue;
      }
      const bool all_or_none = h.column->type == Type::kRun || h.column->type == Type::kSense ||
                               h.name.starts_with("sigma");
      if (all_or_none && h.blanks > 0) {
        std::string lines = line_list(h.first_blanks);
        if (h.blanks > h.first_blanks.size()) {
          lines += fmt::format(" and {} more", h.blanks - h.first_blanks.size());
        }
        complain(h.first_blanks[0], 1,
                 fmt::format("{} is blank in {} and stated in others: allowed: in every row or in "
                             "none",
                             h.name, lines));
      }
      if (h.column->type == Type::kRun) file_.has_run = true;
      if (h.name.starts_with("sigma")) file_.has_sigma = true;
    }
  }

  void drop(const std::vector<char>& marked) {
    leave_out(file_.set, marked);
    for (HeaderColumn& h : header_) {
      if (h.value.size() != marked.size()) continue;
      std::size_t kept = 0;
      for (std::size_t k = 0; k < marked.size(); ++k) {
        if (marked[k] == 0) h.value[kept++] = h.value[k];
      }
      h.value.resize(kept);
    }
  }

  void drop_repetitions() {
    std::vector<std::uint32_t> order(file_.set.rows.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(row_hash_[a], a) < std::pair(row_hash_[b], b);
    });
    std::vector<char> marked(order.size(), 0);
    std::size_t count = 0;
    for (std::size_t first = 0, k = 1; k < order.size(); ++k) {
      if (row_hash_[order[k]] != row_hash_[order[first]]) {
        first = k;
      } else if (same_rows(order[first], order[k])) {
        marked[order[k]] = 1;
        ++count;
      }
    }
    if (count > 0) {
      file_.set.notes.push_back(
          fmt::format("{}: {} left out, the same in every column as a row before",
                      places_of(file_.set, marked), count == 1 ? "row" : "rows"));
      drop(marked);
    }
    row_hash_ = {};
    row_begin_ = {};
    row_size_ = {};
  }

  void check_time() {
    struct Latest {
      double time_s = calibrate::kUnknown;
      int line = 0;
    };
    struct StepBack {
      Latest from, to;
    };
    const bool loop = file_.set.kind == Kind::kTorqueAngle;
    std::vector<Latest> latest(file_.set.runs.size() + 1);
    std::vector<StepBack> back;
    std::size_t steps = 0, steps_back = 0;
    for (const Observation& o : file_.set.rows) {
      if (std::isnan(o.condition.time_s)) continue;
      Latest& last =
          latest[o.condition.run < 0 ? 0 : static_cast<std::size_t>(o.condition.run) + 1];
      const Latest now{.time_s = o.condition.time_s, .line = o.line};
      if (last.line > 0) {
        ++steps;
        if (loop ? now.time_s <= last.time_s : now.time_s < last.time_s) {
          ++steps_back;
          if (back.size() <= kMostMessages) back.push_back({.from = last, .to = now});
        }
      }
      last = now;
    }
    if (steps_back == 0) return;
    if (!loop && steps_back > 1 && steps_back * kStepsPerStepBack > steps) {
      note(fmt::format(
          "rows are not in the order of time_s ({} after {} in lines {} and {}, the "
          "first of {}): each is taken at its time",
          back[0].to.time_s, back[0].from.time_s, back[0].from.line, back[0].to.line, steps_back));
      return;
    }
    for (const StepBack& step : back) {
      complain(
          step.to.line, 1,
          fmt::format("time_s = {} after {} in line {}: allowed: {} within a run (a clock that "
                      "began anew is a new session: label it in the column run)",
                      step.to.time_s, step.from.time_s, step.from.line,
                      loop ? "above the time before" : "not below the time before"));
    }
  }

  void drop_saturated() {
    const std::vector<Observation>& rows = file_.set.rows;
    if (file_.set.kind != Kind::kTransmission || rows.size() < kSaturatedRows) return;
    std::vector<double> values, slopes;
    values.reserve(rows.size());
    slopes.reserve(rows.size());
    for (const Observation& o : rows) {
      values.push_back(o.response);
      if (o.condition.output_torque_Nm > 0.0) {
        slopes.push_back(o.response / o.condition.output_torque_Nm);
      }
    }
    std::ranges::sort(values);
    double resolution = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < values.size(); ++k) {
      const double gap = values[k] - values[k - 1];
      if (gap > 0.0) resolution = std::min(resolution, gap);
    }
    if (!std::isfinite(resolution)) resolution = 0.0;
    if (slopes.empty()) return;
    const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
    std::ranges::nth_element(slopes, middle);
    const double slope = *middle;
    struct End {
      const char* name;
      double value;
    };
    std::vector<End> ends{{"greatest", values.back()}};
    if (values.front() < values.back()) ends.push_back({"least", values.front()});
    std::vector<char> marked(rows.size(), 0);
    std::vector<std::string> found;
    std::size_t count = 0;
    for (const End& end : ends) {
      std::vector<char> at_end(rows.size(), 0);
      std::size_t repeats = 0;
      double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rows[k].response != end.value) continue;
        at_end[k] = 1;
        ++repeats;
        least = std::min(least, rows[k].condition.output_torque_Nm);
        greatest = std::max(greatest, rows[k].condition.output_torque_Nm);
      }
      const double spread = greatest - least;
      if (repeats < kSaturatedRows || spread <= kSaturatedLoadSpread * greatest ||
          slope * spread <= 2.0 * resolution) {
        continue;
      }
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if (at_end[k] != 0) marked[k] = 1;
      }
      count += repeats;
      found.push_back(fmt::format(
          "{}: {} rows hold the {} sun_torque_nm, {:g}, at loads from {:g} to {:g} Nm: the sensor "
          "is at its limit",
          places_of(file_.set, at_end), repeats, end.name, end.value, least, greatest));
    }
    if (count == 0) return;
    if (static_cast<double>(count) > kMostSaturated * static_cast<double>(rows.size())) {
      file_.complaints.add({}, fmt::format("{}; that is {} of {} rows, allowed: at most half",
                                           fmt::join(found, "; "), count, rows.size()));
      return;
    }
    for (const std::string& text : found) file_.set.notes.push_back(text + "; left out");
    drop(marked);
  }

  void finish_covariates() {
    for (HeaderColumn& h : header_) {
      if (h.column != nullptr) continue;
      if (h.first_text_line > 0) {
        note(fmt::format("column {} holds no number in line {}: ignored", h.name,
                         h.first_text_line));
      } else if (h.values == 0) {
        note(fmt::format("column {} is blank throughout: ignored", h.name));
      } else if (file_.set.kind == Kind::kTorqueAngle) {
        note(fmt::format("column {} is not used in a torque-angle record: ignored", h.name));
      } else {
        file_.set.covariates.push_back({.name = h.name, .value = std::move(h.value)});
      }
    }
  }

  MeasurementText& file_;
  std::string_view text_;
  CsvFields fields_;
  int line_ = 0, header_line_ = 0, locked_line_ = 0;
  bool kind_stated_ = false;
  std::vector<std::string> note_keys_;
  std::vector<HeaderColumn> header_;
  std::vector<int> header_columns_;
  std::unordered_map<std::string, int> run_index_;
  std::size_t rows_found_ = 0;
  std::vector<int> missing_lines_;
  std::vector<std::string> missing_shown_;
  // By row, to find repetitions.
  std::vector<std::size_t> row_begin_;
  std::vector<std::uint32_t> row_size_;
  std::vector<std::uint64_t> row_hash_;
};

/// Sessions of files that are pooled.
class Sessions {
 public:
  explicit Sessions(bool several_files) : several_files_(several_files) {}

  /// Index in the pooled set of each session of a file; the last entry is for rows without a label.
  std::vector<int> take(const MeasurementText& file, MeasurementSet& pooled) {
    std::vector<int> index;
    index.reserve(file.set.runs.size() + 1);
    for (const std::string& label : file.set.runs) {
      const auto known = shared_.find(label);
      if (file.notes.runs_shared && known != shared_.end()) {
        index.push_back(known->second);
        continue;
      }
      const bool taken = std::ranges::find(pooled.runs, label) != pooled.runs.end();
      index.push_back(static_cast<int>(pooled.runs.size()));
      pooled.runs.push_back(taken ? fmt::format("{} ({})", label, file.path) : label);
      if (file.notes.runs_shared) shared_.emplace(label, index.back());
    }
    index.push_back(-1);
    if (several_files_ && !file.has_run) {
      index.back() = static_cast<int>(pooled.runs.size());
      pooled.runs.push_back(file.path);
    }
    return index;
  }

 private:
  bool several_files_;
  std::map<std::string, int> shared_;
};

/// What two rows of different files have in common when one is a copy; the run may be named anew.
auto values_of(const Observation& o) {
  const calibrate::Condition& c = o.condition;
  return std::array<double, 13>{static_cast<double>(c.direction),
                                c.sun_speed_rad_s,
                                c.output_torque_Nm,
                                static_cast<double>(c.rotation),
                                c.test_torque_Nm,
                                static_cast<double>(c.driving_teeth),
                                static_cast<double>(c.driven_teeth),
                                c.module_m,
                                c.output_angle_rad,
                                c.temperature_K,
                                c.cycles,
                                o.response,
                                o.sigma};
}

bool same_values(const Observation& a, const Observation& b) {
  const auto x = values_of(a), y = values_of(b);
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (x[k] != y[k] && !(std::isnan(x[k]) && std::isnan(y[k]))) return false;
  }
  return true;
}

/// Rows with their time that stand in an earlier file too.
void drop_copies(MeasurementSet& set) {
  if (set.files.size() < 2) return;
  std::vector<std::uint32_t> order;
  order.reserve(set.rows.size());
  for (std::uint32_t k = 0; k < set.rows.size(); ++k) {
    if (!std::isnan(set.rows[k].condition.time_s)) order.push_back(k);
  }
  const auto key = [&](std::uint32_t k) {
    return std::tuple(set.rows[k].condition.time_s, set.rows[k].response, k);
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<char> marked(set.rows.size(), 0);
  std::size_t count = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Observation& row = set.rows[order[k]];
    for (std::size_t j = k; j-- > 0;) {
      const Observation& other = set.rows[order[j]];
      if (other.condition.time_s != row.condition.time_s || other.response != row.response) break;
      if (other.file != row.file && marked[order[j]] == 0 && same_values(other, row)) {
        marked[order[k]] = 1;
        ++count;
        break;
      }
    }
  }
  if (count == 0) return;
  set.notes.push_back(fmt::format("{}: {} left out, a copy of a row of an earlier file",
                                  places_of(set, marked), count == 1 ? "row" : "rows"));
  leave_out(set, marked);
}

MeasurementSet pooled(Kind kind, const std::vector<MeasurementText*>& files) {
  MeasurementSet set;
  set.kind = kind;
  std::size_t rows = 0;
  for (const MeasurementText* file : files) rows += file->set.rows.size();
  set.rows.reserve(rows);
  Sessions sessions(files.size() > 1);
  for (MeasurementText* file : files) {
    const std::vector<int> run = sessions.take(*file, set);
    const int index = static_cast<int>(set.files.size());
    set.files.push_back(file->path);
    set.notes.insert(set.notes.end(), file->set.notes.begin(), file->set.notes.end());
    const std::size_t before = set.rows.size();
    for (Observation o : file->set.rows) {
      o.file = index;
      o.condition.run =
          o.condition.run < 0 ? run.back() : run[static_cast<std::size_t>(o.condition.run)];
      set.rows.push_back(o);
    }
    for (calibrate::Covariate& covariate : file->set.covariates) {
      auto at = std::ranges::find(set.covariates, covariate.name, &calibrate::Covariate::name);
      if (at == set.covariates.end()) {
        set.covariates.push_back({.name = covariate.name, .value = {}});
        at = set.covariates.end() - 1;
      }
      at->value.resize(before, calibrate::kUnknown);
      at->value.insert(at->value.end(), covariate.value.begin(), covariate.value.end());
    }
    for (calibrate::Covariate& covariate : set.covariates) {
      covariate.value.resize(set.rows.size(), calibrate::kUnknown);
    }
    file->set.rows = {};
    file->set.covariates = {};
  }
  drop_copies(set);
  return set;
}

TorqueAngleFile loop_of(const MeasurementText& file) {
  TorqueAngleFile loop;
  loop.path = file.path;
  loop.sun_locked = file.notes.sun_locked.value_or(true);
  const std::size_t samples = file.set.rows.size();
  loop.time_s.reserve(samples);
  loop.angle_rad.reserve(samples);
  loop.torque_Nm.reserve(samples);
  if (file.has_run) loop.run.reserve(samples);
  for (const Observation& o : file.set.rows) {
    loop.time_s.push_back(o.condition.time_s);
    loop.angle_rad.push_back(o.condition.output_angle_rad);
    loop.torque_Nm.push_back(o.response);
    if (file.has_run) loop.run.push_back(file.set.runs[static_cast<std::size_t>(o.condition.run)]);
  }
  return loop;
}

/// Files one after the other, then all together.
class Pool {
 public:
  explicit Pool(std::size_t files) { files_.reserve(files); }

  void add(const std::string& path, std::string_view text) {
    MeasurementText& file = files_.emplace_back();
    file.path = path;
    file.size = text.size();
    file.hash = hashed(kHashBasis, text);
    for (const MeasurementText& other : files_) {
      if (&other != &file && other.size == file.size && other.hash == file.hash && file.size > 0) {
        file.complaints.add(
            {}, fmt::format("holds the same bytes as {}: allowed: each file once", other.path));
        return;
      }
    }
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    const std::string_view content =
        text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
    FileReader(file, content).read();
    if (!file.notes.kind) return;
    // The fingerprint goes on from file to file.
    std::uint64_t& hash = fingerprint_[static_cast<std::size_t>(*file.notes.kind)];
    hash = hashed(hash, text);
  }
  void add_unreadable(const std::string& path, const std::string& reason) {
    MeasurementText& file = files_.emplace_back();
    file.path = path;
    file.complaints.add({}, reason);
  }

  Measurements finish() {
    std::array<std::vector<MeasurementText*>, calibrate::kKindNames.size()> by_kind;
    for (MeasurementText& file : files_) {
      if (file.notes.kind) by_kind[static_cast<std::size_t>(*file.notes.kind)].push_back(&file);
    }
    for (const std::vector<MeasurementText*>& files : by_kind) {
      const auto stated = std::ranges::find_if(files, &MeasurementText::has_sigma);
      if (stated == files.end()) continue;
      for (MeasurementText* file : files) {
        if (file->has_sigma || !file->complaints.none()) continue;
        file->complaints.add({}, fmt::format("has no column of standard deviations (sigma) and {} "
                                             "has: allowed: in all files of a kind or in none",
                                             (*stated)->path));
      }
    }
    std::string errors;
    for (const MeasurementText& file : files_) {
      if (file.complaints.none()) continue;
      if (!errors.empty()) errors += '\n';
      errors += file.complaints.text(file.path);
    }
    if (!errors.empty()) throw InvalidInput(errors);
    Measurements measurements;
    for (std::size_t k = 0; k < by_kind.size(); ++k) {
      if (by_kind[k].empty()) continue;
      const auto kind = static_cast<Kind>(k);
      if (kind == Kind::kTorqueAngle) {
        for (MeasurementText* file : by_kind[k]) {
          measurements.loops.push_back(loop_of(*file));
          file->set.rows = {};
        }
      }
      measurements.sets.push_back(pooled(kind, by_kind[k]));
      measurements.sets.back().fingerprint = fingerprint_[k];
    }
    return measurements;
  }

 private:
  std::vector<MeasurementText> files_;
  std::array<std::uint64_t, calibrate::kKindNames.size()> fingerprint_{kHashBasis, kHashBasis,
                                                                       kHashBasis, kHashBasis};
};

}  // namespace

Measurements read_measurements(const std::vector<std::string>& paths) {
  Pool pool(paths.size());
  for (const std::string& path : paths) {
    std::error_code status;
    if (std::filesystem::is_directory(path, status)) {
      pool.add_unreadable(path, "is a directory, allowed: a CSV file");
      continue;
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) {
      pool.add_unreadable(path, fmt::format("cannot be read: {}", std::strerror(errno)));
      continue;
    }
    std::ostringstream text;
    text << file.rdbuf();
    pool.add(path, std::move(text).str());
  }
  return pool.finish();
}

Measurements parse_measurements(const std::vector<FileText>& files) {
  Pool pool(files.size());
  for (const FileText& file : files) pool.add(file.path, file.text);
  return pool.finish();
}

}  // namespace gear3k::io
