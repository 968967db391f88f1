#include "sweep/axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "io/files/specification_file.hpp"
#include "io/keys/specification_keys.hpp"
#include "io/text/csv_table.hpp"
#include "io/text/file_reader.hpp"
#include "report/display.hpp"

namespace gear3k::sweep {

namespace {

using io::TomlValue;

constexpr std::size_t kMostRowBytes = std::size_t{64} << 20U;

TomlValue* member_of(TomlValue& table, const std::string& key) {
  const auto found = std::ranges::find(table.table, key, &TomlValue::key);
  return found == table.table.end() ? nullptr : &*found;
}
const TomlValue* member_of(const TomlValue& table, const std::string& key) {
  const auto found = std::ranges::find(table.table, key, &TomlValue::key);
  return found == table.table.end() ? nullptr : &*found;
}

/// A part of a SPEC with nothing but one value.
TomlValue alone(const std::string& path, TomlValue value) {
  TomlValue document = io::table_value({});
  set_at(document, path, std::move(value));
  return document;
}

bool is_key(const std::string& path) {
  return io::specification_schema().index().by_path.contains(path);
}
bool is_table(const std::string& path) {
  return io::specification_schema().index().tables.contains(path);
}

/// A table that is a range rather than a value: { min, max } alone is a value of some keys.
bool is_range(const TomlValue& value) {
  return value.kind == TomlValue::Kind::kTable &&
         (member_of(value, "step") != nullptr || member_of(value, "count") != nullptr ||
          member_of(value, "log") != nullptr || member_of(value, "min") != nullptr);
}

/// The members of a range, checked.
struct RangeInput {
  std::optional<TomlValue> min, max, step;
  std::optional<std::int64_t> count;
  bool log = false;
};

class AxesReader {
 public:
  AxesReader(std::string folder, io::FileReading& reading)
      : folder_(std::move(folder)), reading_(reading) {}

  std::vector<Axis> axes;
  std::set<std::string> varied;
  bool varied_known = true;
  io::CollectedErrors of_rows;

  void walk(const TomlValue& table, const std::string& prefix) {
    for (const TomlValue& member : table.table) {
      if (prefix.empty() && member.key == "zip") {
        zips(member);
      } else if (prefix.empty() && member.key == "rows") {
        of_rows.attempt([&] { rows(member); });
      } else {
        key(member, prefix);
      }
    }
  }

 private:
  void key(const TomlValue& member, const std::string& prefix) {
    const std::string path = prefix.empty() ? member.key : fmt::format("{}.{}", prefix, member.key);
    if (!is_key(path) && is_table(path) && member.kind == TomlValue::Kind::kTable) {
      walk(member, path);
      return;
    }
    if (!known(path, member)) return;
    std::vector<TomlValue> values = values_of(path, member);
    if (values.empty()) return;
    Axis axis{.paths = {path}, .points = {}};
    for (TomlValue& value : values) axis.points.push_back({std::move(value)});
    axes.push_back(std::move(axis));
  }

  /// Says it where a path is no key, or is varied twice.
  bool known(const std::string& path, const TomlValue& member) {
    if (!is_key(path)) {
      varied_known = false;
      const bool table = member.kind == TomlValue::Kind::kTable && !is_range(member);
      TomlValue first = table ? member : io::integer_value(0);
      first.position = member.position;
      io::check_keys(alone(path, std::move(first)), reading_);
      return false;
    }
    if (path == "name") {
      reading_.error(member.position, "name: names no task: allowed: keys that change a result");
      return false;
    }
    if (varied.insert(path).second) return true;
    reading_.error(member.position, fmt::format("{} is varied twice: allowed: once", path));
    return false;
  }

  /// The values of a list or range, those that are any of the key.
  std::vector<TomlValue> values_of(const std::string& path, const TomlValue& member) {
    if (member.kind == TomlValue::Kind::kList) {
      if (member.list.empty()) {
        reading_.error(member.position,
                       fmt::format("vary.{} = []: allowed: one value or more", path));
      }
      return checked(path, member.list);
    }
    if (is_range(member)) {
      // What is wrong with both ends is told at both.
      return checked(path, range(path, member));
    }
    reading_.error(member.position,
                   fmt::format("vary.{} = {}: allowed: a list of values [..], or a range {{ min, "
                               "max, step }} or {{ min, max, count }}",
                               path, io::as_text(member)));
    return {};
  }

  std::vector<TomlValue> checked(const std::string& path, std::vector<TomlValue> values) {
    for (TomlValue& value : values) {
      value.key.clear();
      io::check_keys(alone(path, value), reading_);
    }
    return values;
  }

  std::vector<TomlValue> range(const std::string& path, const TomlValue& table) {
    const std::optional<RangeInput> input = range_input(path, table);
    if (!input) return {};
    const double min = input->min->number;
    const double max = input->max->number;
    std::int64_t count = 0;
    if (input->step) {
      const double steps = (max - min) / input->step->number;
      constexpr double kRounding = 1e-9;
      count = steps < static_cast<double>(kMostOnAxis)
                  ? static_cast<std::int64_t>(std::floor(steps * (1.0 + kRounding) + kRounding)) + 1
                  : kMostOnAxis + 1;
    } else {
      count = *input->count;
    }
    if (count > kMostOnAxis) {
      reading_.error(table.position,
                     fmt::format("vary.{} = {}: gives more values than may be: allowed: at most {}",
                                 path, io::as_text(table), kMostOnAxis));
      return {};
    }
    const bool whole = input->min->kind == TomlValue::Kind::kInteger && input->step &&
                       input->step->kind == TomlValue::Kind::kInteger;
    std::vector<TomlValue> values;
    for (std::int64_t k = 0; k < count; ++k) {
      if (whole) {
        values.push_back(io::integer_value(input->min->integer + k * input->step->integer));
      } else {
        values.push_back(number_on(path, *input, k));
      }
      values.back().position = table.position;
    }
    return values;
  }

  static TomlValue number_on(const std::string& path, const RangeInput& input, std::int64_t k) {
    const double min = input.min->number;
    const double max = input.max->number;
    double value = min;
    if (input.step) {
      value = min + static_cast<double>(k) * input.step->number;
    } else {
      const double share = static_cast<double>(k) / static_cast<double>(*input.count - 1);
      value = input.log ? min * std::pow(max / min, share) : min + share * (max - min);
      if (k + 1 == *input.count) value = max;
    }
    value = report::clean(value);
    // Of a key of whole numbers: one that is no whole number is refused as any other.
    const auto& index = io::specification_schema().index();
    const io::KeyType type = index.keys[index.by_path.at(path)].record->type;
    const bool whole = type == io::KeyType::kInteger || type == io::KeyType::kIntegers;
    constexpr double kGreatest = 1e15;
    if (whole && value == std::floor(value) && std::abs(value) < kGreatest) {
      return io::integer_value(static_cast<std::int64_t>(value));
    }
    return io::number_value(value);
  }

  std::optional<RangeInput> range_input(const std::string& path, const TomlValue& table) {
    RangeInput input;
    bool good = true;
    const auto refuse = [&](const TomlValue& at, const std::string& allowed) {
      reading_.error(at.position, fmt::format("vary.{}{} = {}: allowed: {}", path,
                                              at.key == table.key ? "" : "." + at.key,
                                              io::as_text(at), allowed));
      good = false;
    };
    for (const TomlValue& member : table.table) {
      const bool number = member.is_number() && std::isfinite(member.number);
      if (member.key == "min" || member.key == "max") {
        if (!number) refuse(member, "a number");
        (member.key == "min" ? input.min : input.max) = member;
      } else if (member.key == "step") {
        if (!number || !(member.number > 0.0)) refuse(member, "a number above 0");
        input.step = member;
      } else if (member.key == "count") {
        if (member.kind != TomlValue::Kind::kInteger || member.integer < 2) {
          refuse(member, "an integer, 2 or more");
        }
        input.count = member.integer;
      } else if (member.key == "log") {
        if (member.kind != TomlValue::Kind::kBoolean) refuse(member, "true or false");
        input.log = member.boolean;
      } else {
        const std::string hint =
            io::closest_word(member.key, {"min", "max", "step", "count", "log"});
        reading_.error(member.position,
                       fmt::format("unknown key vary.{}.{}{}", path, member.key,
                                   hint.empty() ? "" : fmt::format("; did you mean {}?", hint)));
        good = false;
      }
    }
    if (!good) return std::nullopt;
    if (!input.min || !input.max || input.step.has_value() == input.count.has_value()) {
      refuse(table, "min, max, and one of step and count");
    } else if (input.min->number > input.max->number ||
               (input.count && input.min->number == input.max->number)) {
      refuse(table, fmt::format("min {} max", input.count ? "<" : "<="));
    } else if (input.log && (!input.count || !(input.min->number > 0.0))) {
      refuse(table, "log = true with count, and min above 0");
    }
    return good ? std::optional(input) : std::nullopt;
  }

  void zips(const TomlValue& member) {
    const bool list = member.kind == TomlValue::Kind::kList;
    if (!list || member.list.empty()) {
      reading_.error(member.position, fmt::format("vary.zip = {}: allowed: [[vary.zip]] tables",
                                                  io::as_text(member)));
      return;
    }
    for (const TomlValue& table : member.list) zip(table);
  }

  void zip(const TomlValue& table) {
    if (table.kind != TomlValue::Kind::kTable) {
      reading_.error(table.position,
                     fmt::format("vary.zip = {}: allowed: a table of lists", io::as_text(table)));
      return;
    }
    std::vector<Axis> own;
    std::swap(own, axes);
    walk_zip(table, "");
    std::swap(own, axes);
    if (own.empty()) return;
    const auto uneven = std::ranges::find_if(
        own, [&](const Axis& axis) { return axis.points.size() != own.front().points.size(); });
    if (uneven != own.end()) {
      reading_.error(table.position,
                     fmt::format("vary.zip: {} has {} values and {} has {}: allowed: as many of "
                                 "each",
                                 own.front().paths.front(), own.front().points.size(),
                                 uneven->paths.front(), uneven->points.size()));
      return;
    }
    Axis zipped{.paths = {}, .points = std::vector<std::vector<TomlValue>>(own[0].points.size())};
    for (Axis& axis : own) {
      zipped.paths.push_back(axis.paths.front());
      for (std::size_t k = 0; k < axis.points.size(); ++k) {
        zipped.points[k].push_back(std::move(axis.points[k].front()));
      }
    }
    axes.push_back(std::move(zipped));
  }
  void walk_zip(const TomlValue& table, const std::string& prefix) {
    for (const TomlValue& member : table.table) key(member, prefix);
  }

  void rows(const TomlValue& member) {
    if (member.kind != TomlValue::Kind::kText) {
      reading_.error(member.position, fmt::format("vary.rows = {}: allowed: the name of a CSV file",
                                                  io::as_text(member)));
      return;
    }
    const bool known_before = std::exchange(varied_known, false);
    const std::string file = (std::filesystem::path(folder_) / member.text).string();
    const std::string text = io::text_of_named_file(
        [](const std::string& path) { return io::read_text(path, "a CSV file", kMostRowBytes); },
        file, "vary.rows", reading_.place_of(member.position));
    const io::CsvTable table = io::parse_csv(text, file);
    io::FileReading own(file);
    Axis axis;
    varied_known = known_before;
    std::vector<std::size_t> columns;  // of the paths
    for (std::size_t k = 0; k < table.header.size(); ++k) {
      const std::string& path = table.header[k];
      if (is_key(path) && path != "name" && varied.insert(path).second) {
        axis.paths.push_back(path);
        columns.push_back(k);
        continue;
      }
      TomlValue column = io::integer_value(0);
      column.position = {.line = 1, .column = 1};
      if (is_key(path)) {
        own.error(column.position, fmt::format("column {}: allowed: a key that is varied once, and "
                                               "not name",
                                               path));
      } else {
        varied_known = false;
        io::check_keys(alone(path, std::move(column)), own);
      }
    }
    if (table.rows.empty())
      own.error({.line = 1, .column = 1}, "has no rows: allowed: one or more");
    for (const io::CsvTable::Row& row : table.rows) {
      axis.points.emplace_back();
      for (std::size_t k = 0; k < axis.paths.size(); ++k) {
        TomlValue value = cell(row.fields[columns[k]]);
        value.position = {.line = row.line, .column = 1};
        for (TomlValue& element : value.list) element.position = value.position;
        io::check_keys(alone(axis.paths[k], value), own);
        axis.points.back().push_back(std::move(value));
      }
    }
    own.throw_if_invalid();
    axes.push_back(std::move(axis));
  }

  /// A value as TOML writes it, or a text without its quotes.
  static TomlValue cell(const std::string& field) {
    try {
      TomlValue document = io::parse_toml("x = " + field, "");
      document.table.front().key.clear();
      return std::move(document.table.front());
    } catch (const io::InvalidInput&) {
      return io::text_value(field);
    }
  }

  std::string folder_;
  io::FileReading& reading_;
};

}  // namespace

Vary read_vary(const TomlValue& vary, const std::string& folder, io::FileReading& reading) {
  AxesReader reader(folder, reading);
  reader.walk(vary, "");
  return {.axes = std::move(reader.axes),
          .paths = std::move(reader.varied),
          .paths_known = reader.varied_known,
          .of_rows = std::move(reader.of_rows)};
}

std::uint64_t combinations(const std::vector<Axis>& axes) {
  constexpr std::uint64_t kGreatest = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t count = 1;
  for (const Axis& axis : axes) {
    const std::uint64_t points = axis.points.size();
    if (points > 0 && count > kGreatest / points) return kGreatest;
    count *= points;
  }
  return count;
}

void set_at(TomlValue& document, const std::string& path, TomlValue value) {
  TomlValue* table = &document;
  std::size_t begin = 0;
  while (true) {
    const std::size_t dot = path.find('.', begin);
    const std::string key = path.substr(begin, dot - begin);
    TomlValue* member = member_of(*table, key);
    if (member == nullptr) {
      TomlValue made = io::table_value({});
      made.key = key;
      made.position = value.position;
      table->table.push_back(std::move(made));
      member = &table->table.back();
    }
    if (dot == std::string::npos) {
      value.key = key;
      *member = std::move(value);
      return;
    }
    table = member;
    begin = dot + 1;
  }
}

bool has_at(const TomlValue& document, const std::string& path) {
  const TomlValue* table = &document;
  std::size_t begin = 0;
  while (true) {
    const std::size_t dot = path.find('.', begin);
    const TomlValue* member = member_of(*table, path.substr(begin, dot - begin));
    if (member == nullptr || dot == std::string::npos) return member != nullptr;
    table = member;
    begin = dot + 1;
  }
}

}  // namespace gear3k::sweep
